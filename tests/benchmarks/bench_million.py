"""Form factors of a million patches and more: seconds, memory, a bounce, and what was foretold.

Example: python tests/benchmarks/bench_million.py --patches 1000000 --scene cornell_box cluttered_room --rays 128

Every case runs in a process of its own, whose largest memory is what the case took, patches and Python included; the
memory of the patches alone stands beside it. Kernels run once on a small room before. "plain" leaves emitters to the
sampling rays (light_rays=0); "apart" is the default. A bounce is `T @ B` in three channels, the median of five. Seconds
of all threads tell more on a machine that has other work to do; over the number of processors they are about what a
quiet one would take.
"""

from __future__ import annotations

import argparse
import json
import resource
import statistics
import subprocess
import sys
import time

import radiosity as rad
from radiosity.errors import MemoryLimitError
from radiosity.form_factors.cost import predict


def peak() -> int:
    """Largest memory of this process so far, bytes."""
    return 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss


def seconds(work) -> tuple[float, float]:
    """Time of one call, by the clock and of all threads."""
    begin, worked = time.perf_counter(), time.process_time()
    work()
    return time.perf_counter() - begin, time.process_time() - worked


def case(scene: str, count: int, rays: int, apart: bool, replicates: int, only_foretell: bool) -> dict[str, float]:
    """Figures of one case."""
    light = {} if apart else {"light_rays": 0}
    method = rad.MonteCarlo(rays * replicates, replicates=replicates, **light)
    small = rad.subdivide(getattr(rad.scenes, scene)(), patch_count=1000)
    rad.TransportOperator(rad.form_factors(small, method), small) @ small.emission
    patches = rad.subdivide(getattr(rad.scenes, scene)(), patch_count=count)
    found: dict[str, float] = {"patches": len(patches), "before": peak()}
    foretold = predict(patches, method)
    found |= {"foretold_seconds": foretold.seconds, "foretold_bytes": foretold.bytes, "foretold": foretold.nonzeros}
    if only_foretell:
        return found
    begin, worked = time.perf_counter(), time.process_time()
    factors = rad.form_factors(patches, method)
    found |= {"seconds": time.perf_counter() - begin, "processor": time.process_time() - worked}
    found |= {"peak": peak(), "nonzeros": factors.matrix.nnz}
    T = rad.TransportOperator(factors, patches)
    times = [seconds(lambda: T @ patches.emission) for _ in range(6)]
    clock, processor = (statistics.median(side) for side in zip(*times[1:], strict=True))
    return found | {"bounce": clock, "bounce_processor": processor}


def main() -> None:
    """Print a table in markdown, or, called by itself, one case."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scene", nargs="+", default=["cornell_box", "cluttered_room"])
    parser.add_argument("--patches", type=int, nargs="+", default=[1_000_000])
    parser.add_argument("--rays", type=int, default=128)
    parser.add_argument("--replicates", type=int, default=1)
    parser.add_argument("--kinds", nargs="+", default=["plain", "apart"], choices=["plain", "apart"])
    parser.add_argument("--foretell", action="store_true", help="do not assemble")
    parser.add_argument("--case", action="store_true", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.case:
        arguments = options.scene[0], options.patches[0], options.rays, options.kinds == ["apart"], options.replicates
        try:
            print(json.dumps(case(*arguments, options.foretell)))
        except MemoryLimitError as error:
            print(json.dumps({"refused": str(error)}))
        return
    columns = (
        "scene",
        "patches",
        "rays",
        "non-zeros (foretold)",
        "seconds (foretold)",
        "of all threads",
        "peak memory",
    )
    columns = (*columns, "of which patches", "matrix", "bounce", "of all threads")
    print(f"| {' | '.join(columns)} |\n{'|---' * len(columns)}|")
    for scene in options.scene:
        for count in options.patches:
            for kind in options.kinds:
                one = [sys.executable, __file__, "--case", "--scene", scene, "--patches", str(count), "--kinds", kind]
                more = ["--rays", str(options.rays), "--replicates", str(options.replicates)]
                run = subprocess.run(
                    [*one, *more, *["--foretell"] * options.foretell], capture_output=True, text=True, check=False
                )
                told = (
                    run.stdout.strip().splitlines()[-1] if run.returncode == 0 else f'{{"refused": "{run.returncode}"}}'
                )
                print(line(f"{scene}, {kind}", options.rays * options.replicates, json.loads(told)), flush=True)


def line(name: str, rays: int, found: dict[str, float]) -> str:
    """One row of the table."""
    if "refused" in found:
        return f"| {name} | | {rays} | {found['refused']} |" + " |" * 7
    cells = [name, f"{found['patches']:,.0f}", f"{rays}"]
    if "seconds" not in found:
        cells += [f"({found['foretold'] / 1e6:.0f} M)", f"({found['foretold_seconds']:.0f} s)", "", ""]
        cells += [f"{found['before'] / 1e9:.2f} GB", f"({found['foretold_bytes'] / 1e9:.2f} GB)", "", ""]
    else:
        cells += [f"{found['nonzeros'] / 1e6:.0f} M ({found['foretold'] / found['nonzeros'] - 1:+.1%})"]
        cells += [f"{found['seconds']:.1f} s ({found['foretold_seconds']:.1f})", f"{found['processor']:.1f} s"]
        cells += [f"{found[name] / 1e9:.2f} GB" for name in ("peak", "before")]
        cells += [f"{8 * found['nonzeros'] / 1e9:.2f} GB", f"{found['bounce']:.2f} s"]
        cells += [f"{found['bounce_processor']:.2f} s"]
    return f"| {' | '.join(cells)} |"


if __name__ == "__main__":
    main()
