"""Where each nanosecond of a ray goes: every step of `MonteCarlo` by itself, on one thread, on the same batch.

Example: python tests/benchmarks/bench_ray.py --patches 10000 100000 1000000 --rays 128

Batches are those of an assembly, evenly chosen, so that caches see what they see there. Each figure is the median over
the batches of the fastest of some repeats, in time of the processor: what else the machine does hardly counts. "Embree
alone" is its call on arrays that are ready; the line below it adds what it takes to have the coordinates on the
triangle as well, which say which patch of a face was met.
"""

from __future__ import annotations

import argparse
import statistics
import time
from collections.abc import Callable

import numpy as np

import radiosity as rad
from radiosity.form_factors import monte_carlo
from radiosity.form_factors.assembly import RowBlock, count_hits
from radiosity.form_factors.starts import numbers, starts
from radiosity.parallel import blocks
from radiosity.rays import Tracer, _find_patches
from radiosity.sequences import keys

REPEATS = 7


def fastest(work: Callable[[], object], rays: int) -> float:
    """Nanoseconds of the processor a ray."""
    times = []
    for _ in range(REPEATS):
        begin = time.thread_time()
        work()
        times.append(time.thread_time() - begin)
    return 1e9 * min(times) / rays


def steps(maker: monte_carlo.MonteCarloRows, span: tuple[int, int]) -> dict[str, float]:
    """Nanoseconds a ray of each step on one batch."""
    patches, tracer, grid = maker.patches, maker.tracer, maker.patches.grid
    (begin, end), each = span, maker.rays
    rays, rows = (end - begin) * each, end - begin
    origins, directions = np.empty((rays, 3), np.float32), np.empty((rays, 3), np.float32)
    samples = np.empty((4, rays))
    number = np.arange(begin, end)
    face, up = patches.face[begin:end].astype(np.int64), patches.side[begin:end].astype(np.float64)
    cell = number - np.where(up > 0.0, grid.front[face], grid.back[face])
    frame = tracer.table.tangent, tracer.table.normal
    found: dict[str, float] = {}

    def timed(name: str, work: Callable[[], object]) -> object:
        found[name] = fastest(work, rays)
        return work()

    timed("low-discrepancy numbers", lambda: numbers(keys(maker.run, number), maker.points, True, each, samples))
    timed(
        "points on the patch",
        lambda: starts(tracer.table, face, cell, up, samples[0], samples[1], origins),
    )
    timed("cosine directions", lambda: monte_carlo._directions(*frame, face, up, samples[2], samples[3], directions))
    timed("Embree alone", lambda: tracer._scene.run(origins, directions))
    hits = tracer._scene.run(origins, directions, output=True)
    with_uv = fastest(lambda: tracer._scene.run(origins, directions, output=True), rays)
    found["… and where on the triangle"] = with_uv - found["Embree alone"]
    out = np.empty(rays, np.int32)
    met = hits["primID"], hits["u"], hits["v"], directions, tracer._triangle_face, tracer._to_affine, tracer.table
    timed("which patch that is", lambda: _find_patches(*met, tracer._whole, out))
    counted = timed("counting hits, in order", lambda: count_hits(out, rows, len(patches)))
    block = RowBlock(begin, *counted)
    finished = timed("shares from counts", lambda: block.finished(maker.divisor, np.float32))
    data, indices = np.empty(len(finished.weights), np.float32), np.empty(len(finished.weights), np.int32)

    def put() -> None:
        data[:], indices[:] = finished.weights, finished.indices

    whole = fastest(lambda: maker(span).finished(maker.divisor, np.float32), rays)
    found["new memory, calls"] = whole - sum(found.values())
    timed("into the matrix", put)
    found["all of it"] = whole + found["into the matrix"]
    return found


def main() -> None:
    """Print a table in markdown."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scene", default="cornell_box", help="a built-in scene")
    parser.add_argument("--patches", type=int, nargs="+", default=[10_000, 100_000, 1_000_000])
    parser.add_argument("--rays", type=int, default=128)
    parser.add_argument("--batches", type=int, default=8)
    options = parser.parse_args()
    table: dict[str, list[float]] = {}
    for count in options.patches:
        patches = rad.subdivide(getattr(rad.scenes, options.scene)(), patch_count=count)
        maker = rad.MonteCarlo(options.rays, light_rays=0).rows(patches, Tracer(patches.grid))
        spans = blocks(len(patches), maker.rows_at_once)
        steps(maker, spans[0])
        chosen = [steps(maker, span) for span in spans[:: -(-len(spans) // options.batches)]]
        for name in chosen[0]:
            table.setdefault(name, []).append(statistics.median(one[name] for one in chosen))
    print(
        f"| ns a ray, {options.scene}, {options.rays} rays | "
        + " | ".join(f"{n:,} patches" for n in options.patches)
        + " |"
    )
    print("|---|" + "---|" * len(options.patches))
    for name, values in table.items():
        print(f"| {name} | " + " | ".join(f"{value:.1f}" for value in values) + " |")
    share = [a / b for a, b in zip(table["Embree alone"], table["all of it"], strict=True)]
    print("| **share of the bare rate** | " + " | ".join(f"{value:.0%}" for value in share) + " |")


if __name__ == "__main__":
    main()
