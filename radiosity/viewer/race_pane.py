"""Gathering in the left pane against shooting in the right one, with T in the corner: the row, the column in use."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .. import display
from .overlay import Raster
from .race import Frame, Race
from .state import PANES, Pane, coloured
from .status import put_in

if TYPE_CHECKING:
    from .window import Window

CORNER = (0.015, 0.02, 0.3, 0.33)


class RacePane:
    """What a window shows of the two solvers.

    Parameters
    ----------
    window : Window
    """

    def __init__(self, window: Window) -> None:
        self.window = window
        self.corners: dict[Pane, Raster] = {
            pane: Raster(window.panes[pane].renderer, CORNER, corner=True) for pane in PANES
        }

    @property
    def race(self) -> Race:
        """The solvers on the solution that is shown."""
        return self.window.model.race(self.window.solution)

    @property
    def frame(self) -> Frame:
        """Where they are."""
        return self.race[self.window.state.work]

    def refresh(self) -> None:
        """Bring both panes up to date with the state, if they show the solvers."""
        window, state = self.window, self.window.state
        if state.left != "solvers":
            for raster in self.corners.values():
                raster.show(None)
            return
        frame = self.frame
        matrix = window.model.matrix(window.solution)
        for pane, light in zip(PANES, (frame.gathered, frame.shot), strict=True):
            colours = coloured(window.series, state, "sum", display.as_rgb(light).astype("float32"))
            window.panes[pane].draw(window.series, state, colours)
        self.corners["order"].show(matrix.picture(row=frame.row))
        self.corners["sum"].show(matrix.picture(column=frame.column))
        window.say("order", "gathering", f"{frame.rows:,} rows of F used")
        window.say("sum", "shooting", f"{frame.rows:,} columns of F used")
        for pane in PANES:
            window.bars[pane].update(*window.series.scale(state, "sum"), state.false_colour)

    def lines(self) -> list[str]:
        """What the dashboard says of them."""
        frame, patches = self.frame, self.window.solution.patches
        names = [patches.surface_names[patches.surface[patch]] for patch in (frame.row, frame.column)]
        unit = "lm" if self.window.state.photometric else "W"
        given, called = put_in(self.window.solution)
        return [
            f"gathering (Gauss–Seidel): patch {frame.row} of {names[0]} takes in one row",
            f"shooting (Southwell): patch {frame.column} of {names[1]} sends one column",
            f"unshot power {frame.unshot_power:.3g} {unit}, {frame.unshot_power / (given or 1.0):.1%} of {called}",
            f"still missing: gathering {frame.missing_gathered:.1%}, shooting {frame.missing_shot:.1%}",
            "the same work in both panes · space plays, → goes on",
        ]
