"""The list of keys, over both panes."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .commands import GROUPS, MOUSE
from .overlay import FAINT, INK, Shapes, Words

if TYPE_CHECKING:
    import pyvista as pv

    from .window import Window

SIZE, LARGEST = 15, 1.15
COLUMNS = (("bounces", "light", "scene"), ("left pane", "the hemisphere"), ("play with light", "window", "mouse"))
TOP, BOTTOM = 0.955, 0.03


class KeysList:
    """Keys in three columns, on a veil over a renderer of its own that spans both panes.

    Parameters
    ----------
    window : Window
    renderer : pyvista.Renderer
        Drawn over the panes.
    """

    def __init__(self, window: Window, renderer: pv.Renderer) -> None:
        self.window = window
        self.box = Shapes(renderer, opacity=0.93)
        self.box.boxes([(0.0, 0.0, 1.0, 1.0)], ["#0b0d10"])
        self.words: list[Words] = []
        self.listed: list[tuple[str, str]] = []
        tables = {name: [(c.shown, c.does) for c in group] for name, group in GROUPS.items()} | {"mouse": list(MOUSE)}
        longest = max(sum(len(tables[name]) + 2 for name in names) - 1 for names in COLUMNS)
        step = (TOP - BOTTOM) / longest
        for column, names in enumerate(COLUMNS):
            line = 0
            for name in names:
                self._word(renderer, column, 0.0, TOP - step * line, name, FAINT, "")
                for keys, does in tables[name]:
                    line += 1
                    self._word(renderer, column, 0.0, TOP - step * line, keys, INK, "-Bold")
                    self._word(renderer, column, 0.075, TOP - step * line, does, INK, "")
                    self.listed.append((keys, does))
                line += 2

    def _word(
        self, renderer: pv.Renderer, column: int, indent: float, height: float, words: str, colour: str, style: str
    ) -> None:
        """One text, by itself: lines of different letters differ in height."""
        place = (0.025 + 0.33 * column + indent, height)
        self.words.append(Words(renderer, place, SIZE, colour=colour, style=style, words=words))

    def refresh(self) -> None:
        """Show the list, or hide it, as the state says."""
        shown = self.window.state.help
        self.box.show(shown)
        for words in self.words:
            words.show(shown)
