"""Size of the page and time of a step from bounce to bounce, drawn by the processor alone.

    python -m tests.benchmarks.bench_page            10 000 and 100 000 patches, eleven orders, in headless Chromium

A step is a change of the bounce: the state, the words and curves beside the picture, the light and its drawing, read
back so that nothing is left waiting. A turn moves the camera instead, so that all patches are drawn anew.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import numpy as np

import radiosity as rad
from radiosity.viewer import page
from tests.viewer.browser import Browser

TIMES = """((act) => {
    const gl = viewer.painter.gl, times = [], pixel = new Uint8Array(4);
    for (let i = 0; i < 33; i++) {
        const begin = performance.now();
        act(i);
        viewer.draw();
        gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
        times.push(performance.now() - begin);
    }
    return times;
})"""
ACTS = {"step": "(i) => viewer.set({ k: i % 11 })", "turn": "() => turn(1, 0)"}


def main(counts: list[int]) -> None:
    """Print a line for each number of patches and each choice of panes."""
    with tempfile.TemporaryDirectory() as folder:
        files = [write(Path(folder), count) for count in counts]
        browser = Browser(Path(folder) / "chromium")
        browser.size(1280, 800)
        for patches, file in files:
            size = file.stat().st_size / 1024
            for show in ("sum", "both"):
                browser.open(file, f"#show={show}")
                said = f"{patches:>7} patches, {size:6.0f} KiB, panes: {show:<4}"
                for name, act in ACTS.items():
                    quarter, middle, most = np.percentile(browser.run(f"{TIMES}({act})")[11:], [25, 50, 95])
                    said += f"   {middle:5.1f} ms a {name} (quarter {quarter:.1f}, 95 % {most:.1f})"
                print(said)
        browser.close()


def write(folder: Path, count: int) -> tuple[int, Path]:
    """A page of the Cornell box, with the shortcuts where it is small."""
    solution = rad.solve(rad.scenes.cornell_box(), patch_count=count, estimator=rad.MonteCarlo(rays=64), bounces=10)
    wrong = count <= 20_000
    return len(solution.patches), page.write_page(solution, folder / f"{count}.html", wrong=wrong)


if __name__ == "__main__":
    main([int(word) for word in sys.argv[1:]] or [10_000, 100_000])
