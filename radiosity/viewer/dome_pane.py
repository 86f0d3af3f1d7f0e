"""The hemisphere in the window: the dome in the left pane, and in the scene where it stands and which way one came."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np
import pyvista as pv
from numpy.typing import NDArray

from .. import display
from .dome import direction_under, lobe, on_dome
from .dome_reading import DomeReading, dome_pictures
from .dome_shapes import arrow, dome_mesh, graticule, line_actor, lobe_mesh, polyline, ring, texture
from .overlay import Words
from .palette import FAINT, INK, OTHER
from .scene_marks import LABEL, SceneMarks

if TYPE_CHECKING:
    from .window import Window

FloatArray = NDArray[np.float64]
Handle = Literal["in", "out"]

OUT = "#ffd54f"  # ω_o
EYE, LOOK_AT, ANGLE = (0.0, -4.0, 2.3), (0.0, 0.0, 0.4), 31.0
REACH = 16  # pixels from a handle within which it is taken
LOBE_SIZE = 0.55  # of Lambert's lobe where ρ = 1


class DomePane:
    """The dome in the left pane of a window, with a camera of its own.

    Parameters
    ----------
    window : Window
    """

    def __init__(self, window: Window) -> None:
        self.window = window
        self.renderer = window.panes["order"].renderer
        self.scene_camera = self.renderer.camera
        self.camera = pv.Camera()
        self.camera.position, self.camera.focal_point, self.camera.up = EYE, LOOK_AT, (0.0, 0.0, 1.0)
        self.camera.view_angle = ANGLE
        self.dragged: Handle | None = None
        self.shown = False
        self.actors: list[pv.Actor] = []
        self.dome = self._skin(dome_mesh(), "front")
        self.floor = self._skin(dome_mesh(flat=True), "none")
        self.grid = self._line(graticule(), FAINT, 1.0, opacity=0.55)
        self.horizon = self._line(ring(90.0, size=1.004), INK, 2.0)
        self.normal = self._line(polyline(np.array([[0, 0, 0], [0, 0, 1.16]])), INK, 3.0)
        self.incoming, self.outgoing, self.arc = (pv.PolyData() for _ in range(3))
        self._line(self.incoming, OTHER, 4.0)
        self._line(self.outgoing, OUT, 4.0)
        self._line(self.arc, INK, 2.0)
        self.handles = {"in": self._ball(OTHER), "out": self._ball(OUT)}
        self.lambert, self.glossy = (lobe_mesh() for _ in range(2))
        self.lambert_actor = self._solid(self.lambert, INK, 0.3)
        self.glossy_actor = self._solid(self.glossy, OUT, 0.45)
        self.labels = {
            "n": Words(self.renderer, (0, 0), LABEL, words="n", align="center", style="-Bold"),
            "in": Words(self.renderer, (0, 0), LABEL, colour=OTHER, align="center", style="-Bold"),
            "out": Words(self.renderer, (0, 0), LABEL, colour=OUT, words="ωₒ", align="center", style="-Bold"),
            "theta": Words(self.renderer, (0, 0), LABEL, align="center"),
            "hint": Words(self.renderer, (0.5, 0.045), 14, colour=FAINT, align="center"),
            "lobe": Words(self.renderer, (0.5, 0.955), 14, colour=OUT, align="center"),
        }
        self.labels["n"].stand_at([0, 0, 1.24])
        self.labels["theta"].on_ground()
        self.marks = SceneMarks(window, self.dome)
        self._visible(False)

    # Building --------------------------------------------------------------------------------------------------------

    def _add(self, actor: pv.Actor) -> pv.Actor:
        self.renderer.add_actor(actor, reset_camera=False, render=False)
        self.actors.append(actor)
        return actor

    def _skin(self, mesh: pv.PolyData, culling: str) -> pv.Actor:
        """A mesh that a picture lies on, unlit."""
        actor = pv.Actor(
            mapper=pv.DataSetMapper(mesh), prop=pv.Property(lighting=False, color="white", culling=culling)
        )
        actor.mapper.scalar_visibility = False
        return self._add(actor)

    def _line(self, mesh: pv.PolyData, colour: str, width: float, opacity: float = 1.0) -> pv.Actor:
        return self._add(line_actor(mesh, colour, width, opacity))

    def _ball(self, colour: str) -> pv.Actor:
        sphere = pv.Sphere(radius=0.042, theta_resolution=20, phi_resolution=20)
        actor = pv.Actor(mapper=pv.DataSetMapper(sphere), prop=pv.Property(lighting=False, color=colour))
        return self._add(actor)

    def _solid(self, mesh: pv.PolyData, colour: str, opacity: float) -> pv.Actor:
        """A lobe one can look through; lit, so that its shape is seen."""
        prop = pv.Property(lighting=True, color=colour, opacity=opacity, ambient=0.5, diffuse=0.5)
        actor = pv.Actor(mapper=pv.DataSetMapper(mesh), prop=prop)
        actor.mapper.scalar_visibility = False
        return self._add(actor)

    @property
    def words(self) -> list[Words]:
        """Every text."""
        return list(self.labels.values())

    # Drawing ---------------------------------------------------------------------------------------------------------

    def _visible(self, shown: bool) -> None:
        """Show everything of the dome or nothing, with the camera that belongs to it."""
        self.shown = shown
        for actor in self.actors:
            actor.visibility = shown
        for words in self.words:
            words.show(shown)
        self.renderer.camera = self.camera if shown else self.scene_camera
        if shown:
            width, height = self.renderer.GetSize()
            self.camera.SetUseHorizontalViewAngle(width < height)
            self.renderer.ResetCameraClippingRange()
        self.marks.show(shown)

    def refresh(self) -> DomeReading | None:
        """Bring the dome up to date with the state; what was read, if it is open on a patch."""
        state = self.window.state
        is_open = state.left == "hemisphere"
        if is_open != self.shown:
            self._visible(is_open)
        if not is_open:
            return None
        self.window.panes["order"].hide()
        if state.picked < 0:
            for actor in (self.dome, self.floor, *self.handles.values(), self.lambert_actor, self.glossy_actor):
                actor.visibility = False
            for mesh in (self.incoming, self.outgoing, self.arc):
                mesh.copy_from(pv.PolyData())
            for name in ("in", "out", "theta", "lobe"):
                self.labels[name].show(False)
            self.labels["hint"].say("click on a surface in the right pane")
            self.marks.show(False)
            return None
        reading = DomeReading.of(self.window.model, self.window.series, state)
        self._paint(reading)
        self._arrows()
        self._lobes(reading)
        back = " · u: back" if state.dome.path else ""
        onward = "drag ωᵢ, ωₒ · click a direction: go there (j)" if reading.ahead >= 0 else "ωᵢ sees no patch · drag it"
        self.labels["hint"].say(onward + back)
        self.marks.refresh(reading)
        return reading

    def _paint(self, reading: DomeReading) -> None:
        """Light on the dome and its floor."""
        pictures = dome_pictures(reading, self.window.series, self.window.state)
        for actor, image in zip((self.dome, self.floor), pictures, strict=True):
            actor.visibility = True
            actor.texture = texture(image)

    def _arrows(self) -> None:
        dome = self.window.state.dome
        into, out = on_dome(dome.theta, dome.azimuth), on_dome(dome.theta_out, dome.azimuth_out)
        self.incoming.copy_from(arrow(into, 0.22 * into, 0.06 * into))
        self.outgoing.copy_from(arrow(0.06 * out, 0.86 * out, 0.97 * out))
        steps = np.linspace(0.0, dome.theta, max(2, int(dome.theta / 3.0)))
        self.arc.copy_from(polyline([0.32 * on_dome(theta, dome.azimuth) for theta in steps]))
        for name, point in (("in", into), ("out", out)):
            handle = self.handles[name]
            handle.visibility = True
            handle.position = tuple(point)
            self.labels[name].show(True)
            self.labels[name].stand_at(1.14 * point)
        self.labels["in"].say("ωᵢ")
        self.labels["theta"].show(True)
        self.labels["theta"].stand_at(0.46 * on_dome(dome.theta / 2.0, dome.azimuth))
        self.labels["theta"].say(f"θ = {dome.theta:.0f}°")

    def _lobes(self, reading: DomeReading) -> None:
        """Lambert's lobe, and the glossy one; only while the dome shows L_i, as they cover its floor."""
        dome = self.window.state.dome
        shown = dome.stage == "radiance"
        self.lambert_actor.visibility = shown
        self.glossy_actor.visibility = shown and dome.glossy
        self.labels["lobe"].show(shown)
        reflectance = float(display.luminance(reading.reflectance)) * LOBE_SIZE
        into = on_dome(dome.theta, dome.azimuth)
        for mesh, glossy in ((self.lambert, False), (self.glossy, True)):
            unit = mesh.point_data["direction"]
            mesh.points = unit * lobe(unit, into, reflectance, glossy=glossy)[:, None]
        words = "BRDF: Lambert, f = ρ / π whatever ωᵢ and ωₒ"
        self.labels["lobe"].say(words + (" · glossy lobe: not solved here" if dome.glossy else ""))

    # The mouse -------------------------------------------------------------------------------------------------------

    def take(self, x: int, y: int) -> bool:
        """Take hold of a handle at a pixel of the window, if one is there."""
        if not self.shown or self.window.state.picked < 0:
            return False
        dome = self.window.state.dome
        ends = {"in": on_dome(dome.theta, dome.azimuth), "out": on_dome(dome.theta_out, dome.azimuth_out)}
        for name, point in ends.items():
            if np.hypot(*(self._on_screen(point) - (x, y))) <= REACH:
                self.dragged = name  # type: ignore[assignment]
                return True
        return False

    def drag(self, x: int, y: int) -> None:
        """Move what is held to a pixel."""
        state = self.window.state
        dome = state.dome
        held = (dome.theta, dome.azimuth) if self.dragged == "in" else (dome.theta_out, dome.azimuth_out)
        found = direction_under(*self.window.inspector.ray_at(x, y, self.renderer), near=on_dome(*held))
        if found is not None:
            moved = dome.aimed(*found) if self.dragged == "in" else dome.looked_from(*found)
            self.window.change(dome=moved)

    def direction_at(self, x: int, y: int) -> tuple[float, float] | None:
        """Direction that a pixel of the window shows."""
        return direction_under(*self.window.inspector.ray_at(x, y, self.renderer))

    def _on_screen(self, point: FloatArray) -> FloatArray:
        """Pixel of the window where a point of the dome is drawn, (2,)."""
        self.renderer.SetWorldPoint(*point, 1.0)
        self.renderer.WorldToDisplay()
        return np.array(self.renderer.GetDisplayPoint()[:2])
