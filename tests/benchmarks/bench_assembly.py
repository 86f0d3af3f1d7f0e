"""Rows of form factors beside bare tracing of the very same rays, in one run.

Example: python tests/benchmarks/bench_assembly.py --patches 10000 --rays 256

Bare tracing is Embree's own call on arrays that are ready, in the same batches on the same number of threads: what
no assembly can beat. Where there are too many rays to keep, evenly chosen batches stand for all. Both sides take turns,
in shuffled order. Times are by the clock, and by the processor, which tells more on a machine with other work to do.
"""

from __future__ import annotations

import argparse
import random
import statistics
import time

import numpy as np

import radiosity as rad
from radiosity.form_factors.monte_carlo import BATCH, MonteCarlo, Places, cosine_rays
from radiosity.parallel import blocks, ordered_map
from radiosity.rays import Tracer
from radiosity.sequences import seed_key, sobol_points

MOST_RAYS = 1 << 23  # kept for bare tracing: 200 MB


def some_rays(patches, tracer, method):
    """Origins and directions of batches, all or evenly chosen."""
    grid, points, run = patches.grid, np.ascontiguousarray(sobol_points(method.rays, 4, 0).T), seed_key(0, 0)
    spans = blocks(len(patches), max(1, BATCH // method.rays))
    every = -(-len(patches) * method.rays // MOST_RAYS)
    batches = []
    places = Places(tracer.table, patches.face, patches.side, grid.front, grid.back)
    for begin, end in spans[::every]:
        batches.append(cosine_rays(places, np.arange(begin, end), method.rays, points, run))
    return batches


def seconds(work, *args, **kwargs):
    """By the clock, and by the processor (all threads)."""
    clock, processor = time.perf_counter(), time.process_time()
    work(*args, **kwargs)
    return time.perf_counter() - clock, time.process_time() - processor


def bare(tracer, batches, threads):
    """Embree alone."""
    for _ in ordered_map(lambda batch: tracer._scene.run(*batch), batches, threads):
        pass


def compare(scene, count, rays_per_patch, threads, repeats):
    """Print rays per second of both, by the clock and for each core, and their share; medians over repeats."""
    patches = rad.subdivide(scene, patch_count=count)
    method = MonteCarlo(rays_per_patch, light_rays=0)
    tracer = Tracer(patches.grid)
    batches = some_rays(patches, tracer, method)
    kept = sum(len(origins) for origins, _ in batches)
    work = {
        "bare": (kept, lambda: bare(tracer, batches, threads)),
        "assembly": (len(patches) * method.rays, lambda: rad.form_factors(patches, method, threads=threads)),
    }
    rates: dict[str, list[tuple[float, float]]] = {name: [] for name in work}
    for repeat in range(repeats + 1):
        for name in random.Random(repeat).sample(list(work), 2):
            rays, call = work[name]
            clock, processor = seconds(call)
            rates[name].append((rays / clock / 1e6, rays / processor / 1e6))
    (by_clock, by_core), (own_clock, own_core) = (
        [statistics.median(side) for side in zip(*rates[name][1:], strict=True)] for name in work
    )
    print(
        f"{len(patches):9,} patches × {rays_per_patch} rays: bare {by_clock:5.1f} Mrays/s ({by_core:.1f} a core), "
        f"assembly {own_clock:5.1f} ({own_core:.1f}): {own_clock / by_clock:.0%} of bare by the clock, "
        f"{own_core / by_core:.0%} by the processor"
    )


def main() -> None:
    """Compare for each number of patches."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scene", default="cornell_box", help="a built-in scene")
    parser.add_argument("--patches", type=int, nargs="+", default=[10_000])
    parser.add_argument("--rays", type=int, default=256)
    parser.add_argument("--threads", type=int, default=None)
    parser.add_argument("--repeats", type=int, default=5)
    options = parser.parse_args()
    scene = getattr(rad.scenes, options.scene)()
    for count in options.patches:
        compare(scene, count, options.rays, options.threads, options.repeats)


if __name__ == "__main__":
    main()
