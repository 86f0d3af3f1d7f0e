"""Seconds of the window: until its first picture, and for a step of each slider, drawn by the processor in two panes.

Run it on a quiet machine::

    python tests/benchmarks/bench_window.py
    python tests/benchmarks/bench_window.py --patches 10000 --size 1920x1080

The bounce slider only draws; the sliders of emission and reflectance solve again, too, with ten bounces. The figures
are medians of 20 steps, without smoothed edges, as a window has them where there is no graphics card.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable

import numpy as np
from rich.console import Console
from rich.table import Table

import radiosity as rad
from radiosity.viewer.window import Window

STEPS = 20
BOUNCES = 10
CLAIMS = {10_000: 0.033, 100_000: 0.1}  # seconds for a step of the bounce slider


def median(step: Callable[[int], None]) -> float:
    """Seconds of a step, the median of some."""
    seconds = []
    for k in range(STEPS):
        began = time.perf_counter()
        step(k)
        seconds.append(time.perf_counter() - began)
    return float(np.median(seconds))


def measure(patches: int, size: tuple[int, int]) -> dict[str, float]:
    """Seconds of everything, for one number of patches."""
    estimator = rad.MonteCarlo(rays=64, light_rays=64)
    solution = rad.solve(rad.scenes.cornell_box(), patch_count=patches, estimator=estimator, bounces=BOUNCES)
    began = time.perf_counter()
    window = Window(solution, off_screen=True, size=size)
    window.plotter.render_window.SetMultiSamples(0)
    window.plotter.screenshot(return_img=True)  # draws at once, and from now on each step does
    found = {"first picture": time.perf_counter() - began}
    sliders = window.dashboard.sliders
    reach = float(sliders["emission"].look.GetMaximumValue())
    found["bounce"] = median(lambda k: sliders["reel"].drag(k % (BOUNCES + 1)))
    found["exposure"] = median(lambda k: sliders["exposure"].drag(0.1 * (k + 1)))
    found["emission"] = median(lambda k: sliders["emission"].drag(reach * (k + 1) / (STEPS + 1)))
    window.press("e")
    found["reflectance"] = median(lambda k: sliders["reflectance"].drag(0.5 * (k + 1) / (STEPS + 1)))
    window.press("r")
    window.press("o")
    floor = np.flatnonzero(solution.patches.surface == solution.patches.surface_names.index("floor"))
    found["pick, hemisphere"] = median(lambda k: window.show(window.state.pick(int(floor[7 * k % len(floor)]))))
    found["drag ωᵢ"] = median(lambda k: window.change(dome=window.state.dome.aimed(4.0 * k, 30.0)))
    window.close()
    return found


def main(arguments: list[str] | None = None) -> int:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--patches", type=int, nargs="+", default=[10_000, 100_000])
    parser.add_argument("--size", default="1280x720", help="pixels of the window (default: %(default)s)")
    options = parser.parse_args(arguments)
    width, _, height = options.size.partition("x")
    table = Table(title=f"milliseconds, {options.size}, median of {STEPS}")
    table.add_column("step of")
    rows: dict[str, list[str]] = {}
    measure(100, (int(width), int(height)))  # loads the libraries, compiles the kernels
    for patches in options.patches:
        table.add_column(f"{patches:,} patches", justify="right")
        for name, seconds in measure(patches, (int(width), int(height))).items():
            claim = CLAIMS.get(patches) if name == "bounce" else None
            words = f"{1e3 * seconds:,.0f}" + (f" (≤ {1e3 * claim:.0f})" if claim else "")
            rows.setdefault(name, []).append(words)
    for name, cells in rows.items():
        table.add_row(name, *cells)
    Console().print(table)
    return 0


if __name__ == "__main__":
    sys.exit(main())
