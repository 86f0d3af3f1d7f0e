"""Draws the pictures of the page about the viewer: ``python docs/howto/viewer/pictures.py``. Takes a minute."""

from dataclasses import replace
from pathlib import Path

import numpy as np
from PIL import Image

import radiosity as rad
from radiosity.viewer.dome import Dome
from radiosity.viewer.dome_pane import OUT
from radiosity.viewer.palette import CHANNEL_COLOURS, GATHERING, HERE, OTHER, SHOOTING
from radiosity.viewer.window import Window

FOLDER = Path(__file__).parent
SIZE = (1120, 630)
LINES = (*CHANNEL_COLOURS, HERE, OTHER, OUT, GATHERING, SHOOTING)
STRIP = 8  # rows of each of them, for the choice of colours


def save(window: Window, name: str) -> None:
    """Few colours keep the files small; those of thin lines are among them, however few pixels they have."""
    picture = Image.fromarray(window.image())
    kept = Image.new("RGB", (picture.width, picture.height + STRIP * len(LINES)))
    for number, colour in enumerate(LINES):
        kept.paste(colour, (0, STRIP * number, picture.width, STRIP * (number + 1)))
    kept.paste(picture, (0, STRIP * len(LINES)))
    palette = kept.quantize(256)
    picture.quantize(palette=palette, dither=Image.Dither.NONE).save(FOLDER / f"{name}.png", optimize=True)


def main() -> None:
    """One window, from state to state."""
    solution = rad.solve(rad.scenes.cornell_box(), patch_count=6_000, bounces=12)
    patches = solution.patches
    floor = np.flatnonzero(patches.surface == patches.surface_names.index("floor"))
    picked = int(floor[np.argmin(np.linalg.norm(patches.centroid[floor] - [0.4, 0.0, 0.12], axis=1))])
    window = Window(solution, off_screen=True, size=SIZE, order=2, normalised=True)
    save(window, "bounce")
    begin = replace(window.state, normalised=False, order=12, picked=picked, left="hemisphere")
    window.show(replace(begin, dome=Dome(theta=60.0, azimuth=105.0, glossy=True)))
    save(window, "hemisphere")
    window.show(replace(begin, dome=Dome(stage="sum", theta=50.0, azimuth=70.0)))
    save(window, "sum")
    window.show(replace(begin, dome=Dome(stage="cosine", theta=75.0, azimuth=110.0)))
    window.press("j")
    window.change(dome=window.state.dome.aimed(55.0, 270.0))
    if window.model.ahead(window.state) >= 0:
        window.press("j")
    window.change(dome=window.state.dome.aimed(60.0, 100.0))
    save(window, "walk")
    window.show(replace(begin, left="solvers", work=34, picked=-1))
    save(window, "solvers")
    window.close()


if __name__ == "__main__":
    main()
