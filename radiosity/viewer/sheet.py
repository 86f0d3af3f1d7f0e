"""How a contact sheet is laid out: panes in rows and columns, words beside them."""

from __future__ import annotations

from typing import Any

import numpy as np
import pyvista as pv
from matplotlib.artist import Artist
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from numpy.typing import NDArray

from .overlay import FAINT, INK
from .overlay import PANEL as PAPER


class _Pixels(Artist):
    """A picture as large as its figure, pixel for pixel: axes for every pane would take a second to make."""

    def __init__(self, image: NDArray[np.uint8]) -> None:
        super().__init__()
        self.image = np.dstack([image, np.full(image.shape[:2], 255, dtype=np.uint8)])

    def draw(self, renderer: Any) -> None:
        """Called by matplotlib."""
        pen = renderer.new_gc()
        renderer.draw_image(pen, 0, 0, self.image[::-1])
        pen.restore()


class Sheet:
    """Panes in rows and columns, with room for words beside and above them, never on them. Lengths in pixels."""

    left, gap, head, bottom = 190, 14, 84, 46

    def __init__(self, columns: int, rows: int, pane: int) -> None:
        self.pane_size = pane
        self.width = self.left + columns * (pane + self.gap) + self.gap
        self.height = rows * (pane + self.head) + self.bottom
        self.figure = Figure(figsize=(self.width / 100.0, self.height / 100.0), dpi=100, facecolor=PAPER)
        FigureCanvasAgg(self.figure)
        self.paper = np.tile(np.array(pv.Color(PAPER).int_rgb, dtype=np.uint8), (self.height, self.width, 1))

    def _place(self, row: int, column: int) -> tuple[int, int]:
        """Upper left corner of a pane, from the upper left of the sheet."""
        return self.left + column * (self.pane_size + self.gap), row * (self.pane_size + self.head) + self.head

    def pane(self, row: int, column: int, image: NDArray[np.uint8], title: str, words: str) -> None:
        """Put a picture in its place, with its formula and words above it."""
        x, y = self._place(row, column)
        self.paper[y : y + self.pane_size, x : x + self.pane_size] = image
        self._text(x, y - 34, title, INK, 13, va="center")
        self._text(x + self.pane_size, y - 34, words, FAINT, 10.5, va="center", ha="right")

    def row_title(self, row: int, title: str) -> None:
        """Say to the left of a row what it shows."""
        _, y = self._place(row, 0)
        self._text(self.gap + 10, y + self.pane_size / 2.0, title, INK, 12.5, va="center", linespacing=1.5)

    def foot(self, words: str) -> None:
        """Say below all panes what they have in common."""
        self._text(self.left, self.height - 16, words, FAINT, 10.5)

    def finished(self) -> Figure:
        """The figure with all panes on it."""
        self.figure.add_artist(_Pixels(self.paper))
        return self.figure

    def _text(self, x: float, y: float, words: str, colour: str, size: float, **style: Any) -> None:
        self.figure.text(x / self.width, 1.0 - y / self.height, words, color=colour, fontsize=size, **style)
