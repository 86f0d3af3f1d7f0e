"""Where the hemisphere stands in the scene, what ω_i sees, and which way one came."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pyvista as pv
from numpy.typing import NDArray

from .dome_reading import DomeReading
from .dome_shapes import graticule, line_actor, polyline
from .overlay import Words
from .palette import HERE, INK, OTHER

if TYPE_CHECKING:
    from ..hemisphere import Hemisphere
    from .window import Window

FloatArray = NDArray[np.float64]

IN_THE_SCENE = 0.11  # radius of the small dome, in sizes of the scene
LABEL = 17
MOST_NAMES = 8  # of the path's last patches


class SceneMarks:
    """In the right pane: a small dome where the hemisphere stands, ω_i up to what it sees, and the path so far.

    Parameters
    ----------
    window : Window
    skin : pyvista.Actor
        The dome of the left pane, whose picture the small one shares.
    """

    def __init__(self, window: Window, skin: pv.Actor) -> None:
        self.window = window
        self.skin = skin
        renderer = window.panes["sum"].renderer
        vertices = window.solution.patches.vertices
        self.size = float(np.ptp(vertices, axis=0).max())
        self.small = pv.Actor(mapper=skin.mapper, prop=pv.Property(lighting=False, color="white", culling="front"))
        self.grid = line_actor(graticule(), INK, 1.0, 0.6)
        self.ray, self.path = pv.PolyData(), pv.PolyData()
        self.actors = [self.small, self.grid, line_actor(self.ray, OTHER, 3.0), line_actor(self.path, HERE, 3.0)]
        self.dots = pv.Actor(
            mapper=pv.DataSetMapper(self.path),
            prop=pv.Property(
                lighting=False, color=HERE, style="points", point_size=11.0, render_points_as_spheres=True
            ),
        )
        self.dots.mapper.scalar_visibility = False
        self.actors.append(self.dots)
        for actor in self.actors:
            renderer.add_actor(actor, reset_camera=False, render=False)
        self.names = [Words(renderer, (0, 0), LABEL, colour=HERE, style="-Bold") for _ in range(MOST_NAMES)]
        for words in self.names:
            words.on_ground()
        self.show(False)

    def show(self, shown: bool) -> None:
        """Show or hide everything."""
        for actor in self.actors:
            actor.visibility = shown
        for words in self.names:
            words.show(False)

    def refresh(self, reading: DomeReading) -> None:
        """Bring the marks up to date with the state."""
        model, state = self.window.model, self.window.state
        self.show(True)
        view = model.hemisphere(state.picked)
        matrix = np.eye(4)
        matrix[:3, :3] = IN_THE_SCENE * self.size * view.frame.T
        matrix[:3, 3] = view.point + 2e-3 * self.size * view.frame[2]
        for actor in (self.small, self.grid):
            actor.user_matrix = matrix
        self.small.texture = self.skin.texture
        self.ray.copy_from(polyline([view.point, self._end(view, reading.ahead)]))
        walked = [*(patch for patch, _ in state.dome.path), state.picked]
        patches = self.window.solution.patches
        points = patches.centroid[walked] + 3e-3 * self.size * patches.normal[walked]
        self.path.copy_from(polyline(points))
        first = max(0, len(walked) - len(self.names))
        for number, words in zip(range(first, first + len(self.names)), self.names, strict=True):
            words.show(len(walked) > 1 and number < len(walked))
            if number < len(walked):
                words.say(f"p{number}")
                words.stand_at(points[number] + 0.04 * self.size * patches.normal[walked[number]])

    def _end(self, view: Hemisphere, ahead: int) -> FloatArray:
        """Where ω_i meets the plane of the patch that it sees; out of the picture where it sees none."""
        dome, patches = self.window.state.dome, self.window.solution.patches
        direction = view.direction(dome.theta, dome.azimuth)
        if ahead < 0:
            return view.point + 0.4 * self.size * direction
        normal = patches.normal[ahead]
        towards = float(direction @ normal)
        if abs(towards) < 1e-3:
            return patches.centroid[ahead]
        return view.point + direction * (float((patches.centroid[ahead] - view.point) @ normal) / towards)
