"""Two levels beside plain rows: seconds, memory and error of both, up to a million patches, in one run.

Example: python tests/benchmarks/bench_two_level.py --patches 10000 100000 1000000

The error is the area-weighted relative L2 of B - E over channels, on patches chosen at random. There the light is
gathered anew: rows of many rays and many shadow rays, times the light of plain rows, whose noise a gather averages
away. Two such gathers, independent of each other, give the reference and its own error. Each measurement is a process
of its own, so that the peak of its memory is its own; compilers have run before the clock starts. In brackets: seconds
of all processors together, which tell more on a machine with other work to do. *Told* is the standard error that a
certificate gives, from replicates or from a spot check.
"""

from __future__ import annotations

import argparse
import json
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import radiosity as rad
from radiosity.certificate.sampling import sampling_error
from radiosity.form_factors.groups import _cells, _middles
from radiosity.form_factors.monte_carlo import MonteCarloRows
from radiosity.patches import locate
from radiosity.rays import Tracer

FloatArray = NDArray[np.float64]

SCENES = {
    "cornell": rad.scenes.cornell_box,
    "cluttered": lambda: rad.scenes.cluttered_room(60),
    "hidden": rad.scenes.hidden_lamp,
    "corridor": rad.scenes.corridor,
}
METHODS = {
    "plain 128": lambda seed: rad.MonteCarlo(128, seed, light_rays=64),
    "default": lambda seed: rad.MonteCarlo(256, seed, replicates=2),
    "plain 512": lambda seed: rad.MonteCarlo(512, seed, light_rays=256),
    "two levels": lambda seed: rad.TwoLevel(seed=seed),
    "two levels, 64": lambda seed: rad.TwoLevel(rays=64, group_rays=2048, seed=seed),
    "two levels, 256": lambda seed: rad.TwoLevel(rays=256, group_rays=8192, seed=seed),
}
WARM = 2000  # patches of the run that compiles
REFERENCE = rad.MonteCarlo(8192, light_rays=2048)
BOUNCES = 5  # timed
LIGHT = 100_000  # patches that carry the light of a reference, at most


def measured(scene: str, count: int, method: str, seed: int, out: Path) -> dict[str, float]:
    """One method in this process: seconds, bytes; its radiosity goes to a file."""
    for warm in (WARM, WARM + 1000):
        patches = rad.subdivide(SCENES[scene](), patch_count=warm)
        solved(patches, METHODS[method](seed))
    patches = rad.subdivide(SCENES[scene](), patch_count=count)
    begin = time.perf_counter(), time.process_time()
    factors = rad.form_factors(patches, METHODS[method](seed))
    made = time.perf_counter(), time.process_time()
    gathers, light = [], patches.emission + 1.0
    for _ in range(BOUNCES):
        start = time.perf_counter(), time.process_time()
        factors.gather(light)
        gathers.append((time.perf_counter() - start[0], time.process_time() - start[1]))
    start = time.perf_counter()
    T = rad.TransportOperator(factors, patches)
    result = rad.Neumann(rtol=1e-4, keep_bytes=0).solve(T, patches.emission, patches.sky)
    done = time.perf_counter()
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
    told = sampling_error(T, patches.emission, result.radiosity, patches.sky)
    np.save(out, result.radiosity)
    return {
        "patches": len(patches),
        "factors": made[0] - begin[0],
        "processor": made[1] - begin[1],
        "bounce": float(np.median([clock for clock, _ in gathers])),
        "bounce, processor": float(np.median([processor for _, processor in gathers])),
        "solve": done - start,
        "operator": factors.nbytes,
        "peak": peak,
        "told": told,
        **{name: value for name, value in factors.statistics.items() if name.startswith("levels/")},
    }


def solved(patches: rad.Patches, estimator: object) -> FloatArray:
    """Radiosity (N, C)."""
    T = rad.TransportOperator(rad.form_factors(patches, estimator), patches)
    return rad.Neumann(rtol=1e-4).solve(T, patches.emission, patches.sky).radiosity


def gathered(patches: rad.Patches, light: FloatArray, chosen: NDArray[np.int64], seed: int) -> FloatArray:
    """B - E of some patches, from many rays of each."""
    method = rad.MonteCarlo(REFERENCE.rays, seed, light_rays=REFERENCE.light_rays)
    rows = MonteCarloRows(method, patches, Tracer(patches.grid), 0)
    out = np.empty((len(chosen), patches.channels))
    for n, i in enumerate(chosen):
        row = rows((int(i), int(i) + 1))
        arriving = (row.weights[:, None] * light[row.indices]).sum(axis=0) + np.pi * row.to_sky[0] * patches.sky
        out[n] = patches.reflectance[i] * arriving / rows.divisor
    return out


def reference(scene: str, patches: rad.Patches, samples: int) -> tuple[NDArray[np.int64], FloatArray, float]:
    """Patches chosen at random, their B - E, and its relative error.

    The light that is gathered is that of plain rows on at most `LIGHT` patches: each of more is lit as the one of these
    that it lies in.
    """
    sources = rad.subdivide(SCENES[scene](), patch_count=min(len(patches), LIGHT))
    at = _cells(patches.grid, np.arange(len(patches)))
    source = locate(sources.grid, at.face, *_middles(patches.grid, at), at.back)
    light = solved(sources, METHODS["plain 128"](77))[source]
    chosen = np.sort(np.random.default_rng(0).choice(len(patches), min(samples, len(patches)), replace=False))
    halves = [gathered(patches, light, chosen, seed) for seed in (901, 902)]
    return chosen, np.mean(halves, axis=0), relative(patches.area[chosen], halves[0], halves[1]) / 2.0


def relative(area: FloatArray, found: FloatArray, true: FloatArray) -> float:
    """Area-weighted relative L2 over patches and channels."""
    return float(np.sqrt((area[:, None] * (found - true) ** 2).sum() / (area[:, None] * true**2).sum()))


def compare(scene: str, count: int, methods: list[str], samples: int) -> None:
    """Print a line for each method."""
    with tempfile.TemporaryDirectory() as folder:
        runs = {}
        for number, method in enumerate(methods):
            out = Path(folder) / f"{number}.npy"
            words = ["--one", method, "--scenes", scene, "--patches", str(count), "--out", str(out)]
            text = subprocess.run([sys.executable, __file__, *words], check=True, capture_output=True, text=True).stdout
            runs[method] = json.loads(text), np.load(out)
    patches = rad.subdivide(SCENES[scene](), patch_count=count)
    chosen, true, own = reference(scene, patches, samples)
    area = patches.area[chosen]
    print(f"{scene}, {len(patches):,} patches; error of the reference on {len(chosen)} of them {own:.2%}")
    for method, (figures, radiosity) in runs.items():
        error = relative(area, radiosity[chosen] - patches.emission[chosen], true)
        alone = figures.get("levels/patches alone", 0) / len(patches)
        print(
            f"  {method:>16}  factors {figures['factors']:6.2f} s ({figures['processor']:6.2f})  "
            f"bounce {1e3 * figures['bounce']:6.1f} ms ({1e3 * figures['bounce, processor']:6.1f})  "
            f"solve {figures['solve']:6.2f} s  operator {figures['operator'] / 1e6:6.0f} MB  "
            f"peak {figures['peak'] / 1e9:5.2f} GB  error {error:6.2%}  "
            + ("not told" if figures["told"] is None else f"told {figures['told']:.2%}")
            + (f"  ({alone:.0%} of patches alone)" if alone else ""),
            flush=True,
        )


def main() -> None:
    """Compare for each scene and number of patches."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scenes", nargs="+", default=["cornell", "cluttered"], choices=list(SCENES))
    parser.add_argument("--patches", type=int, nargs="+", default=[10_000, 30_000, 100_000])
    parser.add_argument("--methods", nargs="+", default=["plain 128", "two levels"], choices=list(METHODS))
    parser.add_argument("--samples", type=int, default=3000, help="patches on which the error is measured")
    parser.add_argument("--one", choices=list(METHODS), help=argparse.SUPPRESS)
    parser.add_argument("--out", type=Path, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.one:
        print(json.dumps(measured(options.scenes[0], options.patches[0], options.one, 0, options.out)))
        return
    for scene in options.scenes:
        for count in options.patches:
            compare(scene, count, options.methods, options.samples)


if __name__ == "__main__":
    main()
