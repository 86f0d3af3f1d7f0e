"""Picking in the window: the mouse, the marks around picked patches, and what the left pane then shows."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
import pyvista as pv
from numpy.typing import NDArray

from .compare import Compare
from .dome_pane import DomePane
from .dome_reading import DomeReading
from .inspect import factor_colours, patch_on_ray
from .mesh import corner_points
from .overlay import Raster, Words
from .palette import HERE, OTHER
from .race_pane import RacePane
from .state import Pane, picture

if TYPE_CHECKING:
    from .window import Window

CLICK = 3  # pixels that the mouse may move between press and release
FIRST = 10.0  # priority of an observer: before the camera and the sliders
LIFT = 1e-3  # of the scene, so that a mark stands before its patch


class Inspector:
    """What a window knows about picked patches.

    Parameters
    ----------
    window : Window
    """

    def __init__(self, window: Window) -> None:
        self.window = window
        self.patches = window.solution.patches
        self.raster = Raster(window.panes["order"].renderer)
        self.compare = Compare(window)
        self.left_marks: list[pv.Actor] = []
        self.marks = {"picked": self._mark(HERE), "other": self._mark(OTHER)}
        self.dome = DomePane(window)
        self.race = RacePane(window)
        self.reading: DomeReading | None = None
        self._pressed_at = (-1, -1)

    def _mark(self, colour: str) -> pv.PolyData:
        """An outline in both panes; without points until something is picked."""
        mesh = pv.PolyData()
        for pane, drawing in self.window.panes.items():
            mapper = pv.DataSetMapper(mesh)
            mapper.scalar_visibility = False
            prop = pv.Property(lighting=False, color=colour, line_width=4.0)
            actor = pv.Actor(mapper=mapper, prop=prop)
            drawing.renderer.add_actor(actor, reset_camera=False, render=False)
            if pane == "order":
                self.left_marks.append(actor)
        return mesh

    def exchange(self) -> tuple[float, float] | None:
        """Form factors between the two picked patches, there and back, by hemicubes; None if two are not picked."""
        state, count = self.window.state, len(self.patches)
        if state.picked < 0 or state.other < 0:
            return None
        there, back = (
            self.window.model.hemicube(state.picked).row(count),
            self.window.model.hemicube(state.other).row(count),
        )
        return float(there[state.other]), float(back[state.picked])

    # The mouse -------------------------------------------------------------------------------------------------------

    def listen(self, interactor: Any) -> list[int]:
        """Take clicks, and the handles of the dome; other drags stay with the camera and the sliders.

        A press that nobody keeps is grabbed by the camera, and its release is heard from the camera only.
        Returns the tags of the observers on VTK's own interactor.
        """
        interactor.add_observer("LeftButtonReleaseEvent", self._release)
        vtk = interactor.interactor
        self._tags = [
            vtk.AddObserver("LeftButtonPressEvent", self._press, FIRST),
            vtk.AddObserver("MouseMoveEvent", self._move, FIRST),
            vtk.AddObserver("LeftButtonReleaseEvent", self._let_go, FIRST),
        ]
        return self._tags

    @property
    def words(self) -> list[Words]:
        """Every text in the panes."""
        return [*self.dome.words, *self.dome.marks.names]

    def _keep(self, event: int) -> None:
        """Let nobody else see the event that is being handled."""
        self.window.plotter.iren.interactor.GetCommand(self._tags[event]).SetAbortFlag(1)

    def _press(self, *_: Any) -> None:
        x, y = self._pressed_at = self.window.plotter.iren.get_event_position()
        if self._pane_at(x, y) == "order" and self.dome.take(x, y):
            self._keep(0)

    def _move(self, *_: Any) -> None:
        if self.dome.dragged:
            self.dome.drag(*self.window.plotter.iren.get_event_position())
            self._keep(1)

    def _let_go(self, *_: Any) -> None:
        if self.dome.dragged:
            self.dome.dragged = None
            self._keep(2)

    def _release(self, *_: Any) -> None:
        x, y = self.window.plotter.iren.get_event_position()
        moved = max(abs(x - self._pressed_at[0]), abs(y - self._pressed_at[1]))
        pane = self._pane_at(x, y)
        if moved > CLICK or pane is None or (pane == "order" and self.raster.actor.GetVisibility()):
            return
        if pane == "order" and self.dome.shown:
            self._click_dome(x, y)
            return
        patch = self.patch_at(x, y)
        state = self.window.state
        second = self.window.plotter.iren.interactor.GetControlKey()
        self.window.show(state.pick_other(patch) if second else state.pick(patch))

    def _click_dome(self, x: int, y: int) -> None:
        """Aim ω_i where the mouse is, and go to what is seen there."""
        window, state = self.window, self.window.state
        found = self.dome.direction_at(x, y)
        if found is None or state.picked < 0:
            return
        aimed = replace(state, dome=state.dome.aimed(*found))
        window.show(aimed.walk(window.model.ahead(aimed)))

    def _pane_at(self, x: int, y: int) -> str | None:
        """Which pane a pixel of the window is in, from the lower left."""
        for pane, drawing in self.window.panes.items():
            left, bottom = drawing.renderer.GetOrigin()
            width, height = drawing.renderer.GetSize()
            if left <= x < left + width and bottom <= y < bottom + height:
                return pane
        return None

    def patch_at(self, x: int, y: int) -> int:
        """Patch that a pixel of the window shows; -1 for none."""
        pane = self._pane_at(x, y)
        if pane is None:
            return -1
        renderer = self.window.panes[pane].renderer  # type: ignore[index]
        return patch_on_ray(self.patches, *self.ray_at(x, y, renderer))

    @staticmethod
    def ray_at(x: int, y: int, renderer: pv.Renderer) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Origin and direction of the ray that a pixel of the window shows in a pane."""
        ends = []
        for depth in (0.0, 1.0):
            renderer.SetDisplayPoint(x + 0.5, y + 0.5, depth)
            renderer.DisplayToWorld()
            point = np.array(renderer.GetWorldPoint())
            ends.append(point[:3] / point[3])
        return ends[0], ends[1] - ends[0]

    # Drawing ---------------------------------------------------------------------------------------------------------

    def refresh(self) -> None:
        """Bring the marks and the left pane up to date with the state."""
        window, state = self.window, self.window.state
        self._outline("picked", state.picked)
        self._outline("other", state.other)
        image = None
        if state.left == "factors":
            self._show_factors(state.picked)
        elif state.left == "hemicube":
            image = self.window.model.hemicube(state.picked).picture(picture(window.series, state, "sum"))
            window.say("order", "hemicube", f"what patch {state.picked} sees, bounces 0…{state.order}")
        elif state.left == "matrix":
            image = window.model.matrix(window.solution).picture(state.picked)
            words = "; lit up: row receives, column sends" if state.picked >= 0 else ": each row receives"
            window.say("order", "T = ρ F", f"patches by surface{words}")
        self.compare.refresh()
        self.race.refresh()
        self.reading = self.dome.refresh()
        if state.left == "hemisphere":
            self._name_dome()
        self.raster.show(image)
        if image is not None:
            window.bars["order"].update(1.0, 10.0, False)
            window.panes["order"].hide()
        for actor in self.left_marks:
            actor.visibility = image is None and state.left != "hemisphere"

    def _name_dome(self) -> None:
        """Words above the hemisphere."""
        window, state = self.window, self.window.state
        heading = {"radiance": "Lᵢ", "cosine": "Lᵢ cos θ", "sum": "Σ Lᵢ cos θ Δω"}[state.dome.stage]
        words = "no patch is picked"
        if state.picked >= 0:
            here, before = f"p{len(state.dome.path)}", state.order - 1
            words = f"bounce {before} arriving at {here}" if state.dome.single else f"bounces 0…{before} at {here}"
            words = words if state.order else f"nothing arrives at {here} before bounce 1"
        window.say("order", heading, words)
        pane: Pane = "order" if state.dome.single else "sum"
        window.bars["order"].update(*window.series.scale(state, pane), state.false_colour)

    def _show_factors(self, patch: int) -> None:
        """The picked patch's row of F in the left pane."""
        window = self.window
        view = self.window.model.hemicube(patch)
        colours, low, high = factor_colours(view.row(len(self.patches)))
        window.panes["order"].draw(window.series, window.state, colours)
        window.say("order", "F[i, ·]", f"of patch {patch}, by {view.resolution}² hemicube")
        window.bars["order"].update(low, high, True, "")

    def _outline(self, name: str, patch: int) -> None:
        points: NDArray[np.float64] = np.zeros((0, 3))
        if patch >= 0:
            size = float(np.ptp(self.patches.vertices, axis=0).max())
            points = corner_points(self.patches)[patch] + LIFT * size * self.patches.normal[patch]
        count = len(points)
        lines = [count + 1, *range(count), 0] if count else []
        self.marks[name].copy_from(pv.PolyData(points, lines=lines) if count else pv.PolyData())
