"""Error against time of every estimator, factors and solve together, in one run.

Example: python tests/benchmarks/bench_error_vs_time.py --patches 2000 10000 --reference 65536

The error is the area-weighted relative L2 of B - E over patches and channels, against a converged answer on the same
patches: the mean of two independent runs of many rays, whose difference gives the error of their mean. Each method
runs with several budgets; all runs are shuffled and repeated, and seconds are medians, so that a machine that slows
down slows all of them. Processor seconds (of all threads) tell more on a machine with other work to do. Everything is
warm: compilers have run.
"""

from __future__ import annotations

import argparse
import random
import statistics
import time
from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

import radiosity as rad

FloatArray = NDArray[np.float64]

SOLVER_RTOL = 1e-5  # far below every sampling error here
GROUPED = 8000  # patches, from which two levels run too


METHODS = ("apart", "two levels", "plain", "random", "hemicube", "walks, looking", "walks")


class Run(NamedTuple):
    """A method with one budget."""

    method: str
    budget: str
    radiosity: Callable[[], FloatArray]


def solved(patches: rad.Patches, estimator: object, threads: int | None) -> FloatArray:
    """Radiosity (N, C) by form factors and Neumann."""
    factors = rad.form_factors(patches, estimator, threads=threads)
    operator = rad.TransportOperator(factors, patches, threads=threads)
    return rad.Neumann(rtol=SOLVER_RTOL, maxiter=1000).solve(operator, patches.emission, sky=patches.sky).radiosity


def runs(patches: rad.Patches, threads: int | None, quick: bool) -> Iterator[Run]:
    """All methods and budgets."""

    def by_factors(estimator: object) -> Callable[[], FloatArray]:
        return lambda: solved(patches, estimator, threads)

    def by_walks(paths: int, next_event: bool) -> Callable[[], FloatArray]:
        tracer = rad.PathTracer(paths, next_event=next_event, bounces=1, tail=True)
        return lambda: tracer.solve(patches, threads=threads).radiosity

    few = slice(0, 2) if quick else slice(None)
    budgets = [(256, 128), (1024, 256), (2048, 512), (4096, 1024), (4096, 2048), (16384, 4096)]
    if len(patches) < GROUPED:
        budgets.append((32768, 8192))
    for rays, light_rays in budgets[few]:
        yield Run("apart", f"{rays} + {light_rays} rays", by_factors(rad.MonteCarlo(rays, light_rays=light_rays)))
    if len(patches) >= GROUPED:
        for rays, light_rays in [(64, 64), (128, 64), (256, 128), (1024, 256), (4096, 1024)][few]:
            method = rad.TwoLevel(rays, group_rays=8 * rays, light_rays=light_rays)
            yield Run("two levels", f"{rays} + {light_rays} rays", by_factors(method))
    for rays in [256, 1024, 4096, 16384][few]:
        yield Run("plain", f"{rays} rays", by_factors(rad.MonteCarlo(rays, light_rays=0)))
    for rays in [256, 1024, 4096][few]:
        yield Run("random", f"{rays} rays", by_factors(rad.MonteCarlo(rays, sampling="random")))
    for resolution, samples in [(32, 1), (64, 1), (64, 6)][few]:
        yield Run("hemicube", f"{resolution}², {samples}", by_factors(rad.Hemicube(resolution, samples)))
    for paths in [16, 64, 256][few]:
        yield Run("walks, looking", f"{paths} paths", by_walks(paths, next_event=True))
    for paths in [64, 256][few]:
        yield Run("walks", f"{paths} paths", by_walks(paths, next_event=False))


def reference(patches: rad.Patches, rays: int, threads: int | None) -> tuple[FloatArray, float]:
    """B - E by two independent runs of half the rays each, and its relative error."""
    halves = [
        solved(patches, rad.MonteCarlo(rays // 2, seed, light_rays=8192), threads) - patches.emission
        for seed in (1001, 1002)
    ]
    mean = np.mean(halves, axis=0)
    return mean, relative_error(patches, halves[0], mean)


def relative_error(patches: rad.Patches, found: FloatArray, true: FloatArray) -> float:
    """Area-weighted relative L2 over patches and channels."""
    area = patches.area[:, None]
    return float(np.sqrt((area * (found - true) ** 2).sum() / (area * true**2).sum()))


def measure(patches: rad.Patches, true: FloatArray, everything: list[Run], repeats: int) -> None:
    """Run all, shuffled and repeated, and print a line each."""
    clock: dict[Run, list[float]] = {run: [] for run in everything}
    processor: dict[Run, list[float]] = {run: [] for run in everything}
    errors: dict[Run, float] = {}
    order = everything * repeats
    random.Random(0).shuffle(order)
    for run in order:
        begin = time.perf_counter(), time.process_time()
        radiosity = run.radiosity()
        clock[run].append(time.perf_counter() - begin[0])
        processor[run].append(time.process_time() - begin[1])
        errors[run] = relative_error(patches, radiosity - patches.emission, true)
    for run in everything:
        times = sorted(clock[run])
        print(
            f"{run.method:>15}  {run.budget:>16}  {100 * errors[run]:8.3f} %  {statistics.median(times):8.3f} s  "
            f"({times[0]:.3f} … {times[-1]:.3f})  {statistics.median(processor[run]):8.3f} s of processors"
        )


def main() -> None:
    """Print a table for each number of patches."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scene", default="cornell_box", help="a built-in scene")
    parser.add_argument("--arguments", type=int, nargs="*", default=[], help="of the scene, as 60 of cluttered_room")
    parser.add_argument("--methods", nargs="+", choices=METHODS, help="(default: all)")
    parser.add_argument("--patches", type=int, nargs="+", default=[2000, 10_000])
    parser.add_argument("--reference", type=int, default=1 << 16, help="rays a patch of the converged answer")
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--threads", type=int, default=None)
    parser.add_argument("--quick", action="store_true", help="the two smallest budgets of each method")
    options = parser.parse_args()
    scene = getattr(rad.scenes, options.scene)(*options.arguments)
    wanted = options.methods or METHODS
    for run in runs(rad.subdivide(scene, patch_count=GROUPED + 1000), options.threads, quick=True):
        if run.method in wanted:
            run.radiosity()  # warm: every kernel compiled or loaded
    for count in options.patches:
        patches = rad.subdivide(scene, patch_count=count)
        true, own = reference(patches, options.reference, options.threads)
        print(f"{options.scene}, {len(patches):,} patches; the reference's own error is {100 * own:.3f} %")
        everything = [run for run in runs(patches, options.threads, options.quick) if run.method in wanted]
        measure(patches, true, everything, options.repeats)


if __name__ == "__main__":
    main()
