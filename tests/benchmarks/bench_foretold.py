"""Seconds and entries foretold, beside what the assembly then took: several scenes, sizes and estimators.

Example: python tests/benchmarks/bench_foretold.py

Each case is a process of its own, whose kernels a small room has compiled. Foretold once, as a user would. Seconds are
by the clock; those of all processors together over their number stand beside, which other work of the machine hardly
lengthens. The last line is the range of errors of foretold seconds over both.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import time
import warnings

import radiosity as rad
from radiosity.errors import GeometryWarning
from radiosity.form_factors.cost import predict
from radiosity.parallel import thread_count

CASES = {
    "Cornell box, plain, 256 rays": ("cornell_box", 10_000, rad.MonteCarlo(256, light_rays=0)),
    "Cornell box, plain": ("cornell_box", 100_000, rad.MonteCarlo(128, light_rays=0)),
    "Cornell box, direct light apart": ("cornell_box", 100_000, rad.MonteCarlo(128)),
    "cluttered room, plain": ("cluttered_room", 100_000, rad.MonteCarlo(128, light_rays=0)),
    "cluttered room, apart": ("cluttered_room", 100_000, rad.MonteCarlo(128)),
    "two rooms, apart": ("two_rooms", 100_000, rad.MonteCarlo(128)),
    "open rug, apart": ("open_rug", 100_000, rad.MonteCarlo(128)),
    "integrating sphere, 256 rays": ("integrating_sphere", 50_000, rad.MonteCarlo(256)),
    "Cornell box, two replicates": ("cornell_box", 30_000, rad.MonteCarlo(256, replicates=2)),
    "window room, hemicube": ("window_room", 5_000, rad.Hemicube(64)),
    "Cornell box, plain, 32 rays": ("cornell_box", 1_000_000, rad.MonteCarlo(32, light_rays=0)),
    "cluttered room, apart, 32 rays": ("cluttered_room", 1_000_000, rad.MonteCarlo(32)),
}


def case(scene: str, count: int, method: object) -> dict[str, float]:
    """Figures of one case."""
    warnings.simplefilter("ignore", GeometryWarning)  # a small sphere has more faces than patches asked for
    make = getattr(rad.scenes, scene)
    for few in (1000, 2000):
        rad.form_factors(rad.subdivide(make(), patch_count=few), method)
    patches = rad.subdivide(make(), patch_count=count)
    begin = time.perf_counter()
    foretold = predict(patches, method)
    took = time.perf_counter() - begin
    begin, worked = time.perf_counter(), time.process_time()
    factors = rad.form_factors(patches, method)
    clock, worked = time.perf_counter() - begin, time.process_time() - worked
    found = {"patches": len(patches), "clock": clock, "processor": worked / thread_count(), "took": took}
    return found | {"foretold": foretold.seconds, "entries": foretold.nonzeros / factors.matrix.nnz - 1}


def main() -> None:
    """Print a table in markdown, or, called by itself, one case."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--case", choices=list(CASES), help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.case:
        print(json.dumps(case(*CASES[options.case])))
        return
    print("| scene | patches | foretold | by the clock | processors / their number | entries | foretelling took |")
    print("|---|---|---|---|---|---|---|")
    errors: dict[str, list[float]] = {"clock": [], "processor": []}
    for name in CASES:
        run = subprocess.run([sys.executable, __file__, "--case", name], capture_output=True, text=True, check=True)
        found = json.loads(run.stdout)
        cells = [name, f"{found['patches']:,}", f"{found['foretold']:.2f} s"]
        for side, seen in errors.items():
            seen.append(found["foretold"] / found[side] - 1)
            cells.append(f"{found[side]:.2f} s ({seen[-1]:+.0%})")
        cells += [f"{found['entries']:+.1%}", f"{found['took']:.2f} s"]
        print(f"| {' | '.join(cells)} |", flush=True)
    ranges = [f"{min(seen):+.0%} … {max(seen):+.0%}" for seen in errors.values()]
    print(f"\nseconds foretold are off by {ranges[0]} of the clock, {ranges[1]} of the processors")


if __name__ == "__main__":
    main()
