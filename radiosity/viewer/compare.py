"""Shortcuts beside the truth in the window: the wrong picture, the struck-out equation, how far off it is."""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from numpy.typing import NDArray

from .. import display
from ..shortcuts import ALL, WRONG, Shortcut
from .overlay import HERE, INK, PANEL, Raster, Words
from .palette import STRONG
from .state import coloured

if TYPE_CHECKING:
    from ..solution import Solution
    from .window import Window

EQUATION_DPI = 220
EQUATION = (0.2, 0.2, 0.62, 0.8)  # its box in the pane of the title
FULL_SCALE = 1.0  # relative difference at which the colours are full


class Compare:
    """What a window knows about shortcuts.

    Parameters
    ----------
    window : Window
    """

    def __init__(self, window: Window) -> None:
        self.window = window
        heading, _ = window.titles["order"]
        self.heading: Words = heading
        self.equation = Raster(window.bars["order"].renderer, EQUATION, smooth=True)

    @property
    def shortcut(self) -> Shortcut:
        """The one that is shown."""
        return ALL[self.window.state.wrong % len(ALL)]

    def light(self, number: int) -> NDArray[np.float32]:
        """Wrong light (N, 3), W/m²."""
        return self._light(number, self.window.solution)

    @functools.lru_cache(maxsize=16)  # noqa: B019 (lives as long as the window)
    def _light(self, number: int, solution: Solution) -> NDArray[np.float32]:
        wrong = ALL[number % len(ALL)].radiosity(solution.patches, solution.factors, solution.radiosity)
        return display.as_rgb(np.asarray(wrong)).astype(np.float32)

    def difference(self, number: int) -> NDArray[np.float64]:
        """Relative difference of luminance to the truth, (N,); 0 where both are black."""
        truth = display.luminance(self.window.series.sums[-1].astype(np.float64))
        wrong = display.luminance(self.light(number).astype(np.float64))
        return np.divide(wrong - truth, truth, out=np.zeros_like(truth), where=truth > 0)

    def refresh(self) -> None:
        """Bring the left pane up to date with the state, if it shows a shortcut."""
        window, state = self.window, self.window.state
        shown = state.left == "wrong"
        self.heading.colour(HERE if shown else INK)
        ground = STRONG[PANEL] if state.projector else PANEL
        self.equation.show(equation_image(self.shortcut.equation, ground) if shown else None)
        if not shown:
            return
        if state.difference:
            colours = display.diverging_colours(self.difference(state.wrong), FULL_SCALE)
        else:
            colours = coloured(window.series, state, "sum", self.light(state.wrong))
        window.panes["order"].draw(window.series, state, colours)
        window.say("order", WRONG, "difference" if state.difference else self.shortcut.name)
        window.bars["order"].update(1.0, 10.0, False)

    def lines(self) -> list[str]:
        """What the dashboard says about the shortcut."""
        off = self.difference(self.window.state.wrong)
        area = self.window.series.area
        typical = float(np.sum(area * np.abs(off)) / area.sum())
        legend = f"blue: too dark; orange: too bright; full colour at ±{FULL_SCALE:.0%}"
        return [
            f"{WRONG}: {self.shortcut.name} · off by {typical:.0%} on average",
            self.shortcut.sentence,
            *([legend] if self.window.state.difference else []),
        ]


@functools.lru_cache(maxsize=16)
def equation_image(mathtext: str, ground: str = PANEL) -> NDArray[np.uint8]:
    """An equation typeset by matplotlib on a ground, as pixels (height, width, 3) without a margin."""
    figure = Figure(figsize=(8.0, 1.2), dpi=EQUATION_DPI, facecolor=ground)
    canvas = FigureCanvasAgg(figure)
    figure.text(0.5, 0.5, mathtext, color=INK, fontsize=18, ha="center", va="center")
    canvas.draw()
    pixels = np.asarray(canvas.buffer_rgba())[..., :3]
    written = np.any(pixels != pixels[0, 0], axis=-1)
    rows, columns = (np.flatnonzero(written.any(axis=axis)) for axis in (1, 0))
    return pixels[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1].copy()
