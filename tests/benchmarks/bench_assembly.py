"""Rows of form factors beside bare tracing of the very same rays, in one run.

Example: python tests/benchmarks/bench_assembly.py --patches 10000 --rays 256

Bare tracing is Embree's own call on arrays that are ready, in the same batches on the same number of threads:
what no assembly can beat.
"""

from __future__ import annotations

import argparse
import statistics
import time

import numpy as np

import radiosity as rad
from radiosity.form_factors.monte_carlo import BATCH, MonteCarlo, cosine_rays
from radiosity.parallel import blocks, ordered_map
from radiosity.rays import Tracer
from radiosity.sequences import seed_key, sobol_points


def all_rays(patches, tracer, method):
    """Origins and directions of every batch."""
    grid, points, run = patches.grid, np.ascontiguousarray(sobol_points(method.rays, 4, 0).T), seed_key(0, 0)
    batches = []
    for begin, end in blocks(len(patches), max(1, BATCH // method.rays)):
        origins = np.empty(((end - begin) * method.rays, 3), np.float32)
        directions = np.empty_like(origins)
        cosine_rays(
            tracer.table,
            patches.face,
            patches.side,
            grid.front,
            grid.back,
            begin,
            end,
            method.rays,
            points,
            run,
            origins,
            directions,
        )
        batches.append((origins, directions))
    return batches


def bare(tracer, batches, threads):
    """Seconds that Embree takes for all rays."""
    begin = time.perf_counter()
    for _ in ordered_map(lambda batch: tracer._scene.run(*batch), batches, threads):
        pass
    return time.perf_counter() - begin


def main() -> None:
    """Print rays per second of both, and their ratio, medians over shuffled repeats."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--patches", type=int, nargs="+", default=[10_000])
    parser.add_argument("--rays", type=int, default=256)
    parser.add_argument("--threads", type=int, default=None)
    parser.add_argument("--repeats", type=int, default=5)
    options = parser.parse_args()
    scene = rad.scenes.cornell_box()
    for count in options.patches:
        patches = rad.subdivide(scene, patch_count=count)
        method = MonteCarlo(options.rays, light_rays=0)
        tracer = Tracer(patches.grid)
        batches = all_rays(patches, tracer, method)
        rays = len(patches) * options.rays / 1e6
        bare(tracer, batches, options.threads), rad.form_factors(patches, method, threads=options.threads)
        pairs = []
        for _ in range(options.repeats):
            begin = time.perf_counter()
            rad.form_factors(patches, method, threads=options.threads)
            pairs.append((time.perf_counter() - begin, bare(tracer, batches, options.threads)))
        assembly, tracing = (statistics.median(side) for side in zip(*pairs, strict=True))
        ratios = sorted(a / b for a, b in pairs)
        print(
            f"{len(patches):9,} patches × {options.rays} rays: bare {rays / tracing:6.1f} Mrays/s, "
            f"assembly {rays / assembly:6.1f} Mrays/s ({assembly:.2f} s), "
            f"ratio {statistics.median(ratios):.2f} ({ratios[0]:.2f} … {ratios[-1]:.2f})"
        )


if __name__ == "__main__":
    main()
