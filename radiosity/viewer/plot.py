"""A small plot in the dashboard: draws `Curves`."""

from __future__ import annotations

import numpy as np
import pyvista as pv

from .curves import Curves
from .overlay import FAINT, HERE, INK, Shapes, Words

Box = tuple[float, float, float, float]

MOST_CURVES, MOST_TICKS = 6, 16
DOT = (0.0028, 0.018)  # half width and height, in shares of the pane


class Plot:
    """Curves, ticks, a marker and words in a box of a pane.

    Parameters
    ----------
    renderer : pyvista.Renderer
    box : (left, bottom, right, top)
        Of the curves, in shares of the pane; words stand around it.
    """

    def __init__(self, renderer: pv.Renderer, box: Box) -> None:
        self.box = box
        self.shown: Curves | None = None
        left, bottom, _, top = box
        self.grid = Shapes(renderer, opacity=0.5)
        self.lines = [Shapes(renderer, width=2.0) for _ in range(MOST_CURVES)]
        self.dots = [Shapes(renderer) for _ in range(MOST_CURVES)]
        self.marker = Shapes(renderer, width=2.0)
        self.title = Words(renderer, (left, top + 0.1), 14, colour=INK)
        self.below = Words(renderer, ((left + box[2]) / 2, bottom - 0.21), 13, colour=FAINT, align="center")
        self.across = [Words(renderer, (0, 0), 12, colour=FAINT, align="center") for _ in range(MOST_TICKS)]
        self.up = [Words(renderer, (0, 0), 12, colour=FAINT, align="right") for _ in range(MOST_TICKS)]

    @property
    def words(self) -> list[Words]:
        """Every text."""
        return [self.title, self.below, *self.across, *self.up]

    def show(self, curves: Curves) -> None:
        """Draw other curves; often only the marker moves."""
        if not curves.same_but_for_marker(self.shown):
            self._draw(curves)
            self.shown = curves
        x = self.x(curves.marker)
        self.marker.boxes([(x - 0.0015, self.box[1], x + 0.0015, self.box[3])], [HERE])

    def _draw(self, curves: Curves) -> None:
        left, bottom, right, _ = self.box
        self.title.say(curves.title)
        self.below.say(curves.below)
        for words, tick in _pairs(self.across, curves.across):
            words.show(tick is not None)
            if tick is not None:
                words.actor.SetPosition(self.x(tick[0]), bottom - 0.09)
                words.say(tick[1])
        for words, tick in _pairs(self.up, curves.up):
            words.show(tick is not None)
            if tick is not None:
                words.actor.SetPosition(left - 0.008, self.y(tick[0]))
                words.say(tick[1])
        heights = [self.y(share) for share, _ in curves.up]
        self.grid.boxes([(left, y - 0.003, right, y + 0.003) for y in heights], ["#4a525d"] * len(heights))
        for number, (line, dots) in enumerate(zip(self.lines, self.dots, strict=True)):
            shown = number < len(curves.curves)
            line.show(shown)
            dots.show(shown and curves.curves[number].dots)
            if shown:
                curve = curves.curves[number]
                places = [(self.x(x), self.y(y)) for x, y in np.clip(curve.points, 0.0, 1.0)]
                line.lines(places, curve.colour)
                wide, high = DOT
                dots.boxes([(x - wide, y - high, x + wide, y + high) for x, y in places], [curve.colour] * len(places))

    def x(self, share: float) -> float:
        """Where a share of the box's width is, in shares of the pane."""
        return self.box[0] + (self.box[2] - self.box[0]) * share

    def y(self, share: float) -> float:
        """Where a share of the box's height is."""
        return self.box[1] + (self.box[3] - self.box[1]) * share


def _pairs(words: list[Words], ticks: tuple[tuple[float, str], ...]) -> list[tuple[Words, tuple[float, str] | None]]:
    """Each text with its tick, or with none."""
    padded = [*ticks[: len(words)], *[None] * (len(words) - len(ticks))]
    return list(zip(words, padded, strict=True))
