"""The interactive window: T^k L_e beside its partial sum, one camera, sliders and keys that replace the state."""

from __future__ import annotations

from concurrent.futures import Future, ThreadPoolExecutor, wait
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pyvista as pv
from vtkmodules.vtkRenderingCore import vtkRenderer

from ..camera import Camera, presets
from ..errors import RadiosityError
from . import probe
from .commands import COMMANDS, Command
from .compare import EQUATION
from .dashboard import Dashboard
from .drawing import Drawing
from .figures import save_image
from .inspector import Inspector
from .keys_list import LARGEST, KeysList
from .model import Model
from .overlay import DESIGN_HEIGHT, FAINT, PANEL, ScaleBar, Words
from .palette import STRONG
from .state import PANES, Pane, Series, ViewState, caption, formula, start
from .titles import units

if TYPE_CHECKING:
    from ..certificate import Certificate
    from ..solution import Solution

PROJECTOR_SCALE = 1.5
FRAME = 0.95  # of a screen: what is left beside a window's own frame and the desktop's bars
PLAY_MILLISECONDS = 700
TURN = 0.1  # s, that work beside the window gets at every tick
ROWS = (0.085, 0.695, 0.22)  # titles, panes, dashboard
PROJECTOR_ROWS = (0.1, 0.59, 0.31)  # with room for larger type


def view(
    solution: Solution,
    *,
    screenshot: str | Path | None = None,
    size: tuple[int, int] = (1280, 720),
    **settings: Any,
) -> ViewState:
    """Show a solution bounce by bounce in a window, and wait until it is closed.

    Parameters
    ----------
    solution : Solution
    screenshot : path, optional
        Draw the window into this PNG file instead; needs no display.
    size : (int, int)
        Pixels. A window that the screen would not hold is made smaller.
    **settings
        Fields of `ViewState` to start with, such as ``order=2, exposure=1.0``.

    Returns
    -------
    ViewState
        As it was when the window closed.

    Raises
    ------
    DisplayError
        No display, or none that VTK can draw on; with what to do about it.
    ParameterError
        An unknown setting.

    Examples
    --------
    >>> view(rad.solve(rad.scenes.cornell_box()))  # doctest: +SKIP
    """
    window = Window(solution, off_screen=screenshot is not None, size=size, **settings)
    if screenshot is None:
        window.run()
    else:
        save_image(screenshot, window.image())
        window.close()
    return window.state


def fitted(size: tuple[int, int], screen: tuple[int, int]) -> tuple[int, int]:
    """A window's size, smaller and of the same shape where the screen would not hold it. Zero is an unknown screen.

    >>> fitted((1600, 900), (1280, 800))  # a projector in many a lecture hall
    (1216, 684)
    >>> fitted((1280, 720), (1280, 720))
    (1280, 720)
    """
    shrink = min(there / wanted if there > 0 else 1.0 for wanted, there in zip(size, screen, strict=True))
    return size if shrink >= 1.0 else (round(FRAME * shrink * size[0]), round(FRAME * shrink * size[1]))


class Window:
    """A window on one solution. `view` opens it; lectures and tests drive it.

    Parameters
    ----------
    solution : Solution
    off_screen : bool
        Draw into memory.
    size : (int, int)
        Pixels.
    side : float
        Share of the width that is left free for a text at the left (lectures).
    **settings
        Fields of `ViewState` to start with.

    Attributes
    ----------
    state : ViewState
    series : Series
    plotter : pyvista.Plotter
    """

    def __init__(
        self,
        solution: Solution,
        *,
        off_screen: bool = False,
        size: tuple[int, int] = (1280, 720),
        side: float = 0.0,
        **settings: Any,
    ) -> None:
        probe.require("off-screen" if off_screen else "window")
        probe.hush()
        self.samples = probe.smoothing_samples("off-screen" if off_screen else "window")
        self.solution = solution
        self.series = Series.of(solution)
        self.state = start(self.series, **settings)
        self.cameras: tuple[Camera, ...] = presets(solution.patches)
        self.keys: dict[str, Command] = {key: command for command in COMMANDS for key in command.keys}
        self.side = side
        self._build(off_screen, size)
        self.look(self.state.preset)
        self.refresh()

    # Building --------------------------------------------------------------------------------------------------------

    def _build(self, off_screen: bool, size: tuple[int, int]) -> None:
        # Rows: titles, panes, dashboard. With a side, a column of its own stands at the left.
        left = 1 if self.side else 0
        groups = [(2, [left, left + 1])] + ([(slice(None), 0)] if self.side else [])
        widths = [self.side] * left + [(1 - self.side) / 2] * 2
        layout = {"shape": (3, left + 2), "row_weights": list(ROWS), "col_weights": widths, "groups": groups}
        self.plotter = self._open(off_screen, size, layout)
        self.plotter.render_window.SetMultiSamples(self.samples)
        self.plotter.set_background(PANEL)
        self.model = Model(self.solution, self.series)
        self.complaint = ""
        self.panes: dict[Pane, Drawing] = {}
        self.titles: dict[Pane, tuple[Words, Words]] = {}
        self.bars: dict[Pane, ScaleBar] = {}
        self.title_renderers: dict[Pane, pv.Renderer] = {}
        for column, pane in enumerate(PANES, start=left):
            self.plotter.subplot(0, column)
            heading = Words(self.plotter.renderer, (0.03, 0.5), 27, style="-Oblique")
            words = Words(self.plotter.renderer, (0.97, 0.5), 16, colour=FAINT, align="right")
            self.titles[pane] = (heading, words)
            self.title_renderers[pane] = self.plotter.renderer
            self.bars[pane] = ScaleBar(self.plotter.renderer, (0.3, 0.55, 0.56, 0.77))
            self.plotter.subplot(1, column)
            self.panes[pane] = Drawing(self.plotter, self.solution.patches, pane)
        self.panes["sum"].renderer.camera = self.panes["order"].renderer.camera
        self.inspector = Inspector(self)
        self.plotter.subplot(2, left)
        self.dashboard = Dashboard(self)
        self.keys_list = KeysList(self, self._veil())
        self._rows = ROWS
        self._begin_certificate()
        self._listen()

    def _veil(self) -> vtkRenderer:
        """A layer over both panes."""
        if "veil" not in self.__dict__:
            self.veil = vtkRenderer()
            self.veil.SetLayer(1)
            self.veil.InteractiveOff()
            self.plotter.render_window.SetNumberOfLayers(2)
            self.plotter.render_window.AddRenderer(self.veil)
        self.veil.RemoveAllViewProps()
        return self.veil

    def _open(self, off_screen: bool, size: tuple[int, int], layout: dict[str, Any]) -> pv.Plotter:
        """An empty window. Lectures, which go from scene to scene, empty the one that they have."""
        title = "Radiosity, bounce by bounce"
        plotter = pv.Plotter(off_screen=off_screen, window_size=list(size), title=title, border=False, **layout)
        if not off_screen:
            plotter.window_size = fitted(size, plotter.render_window.GetScreenSize() or (0, 0))
        return plotter

    def _listen(self) -> None:
        """Take all keys from VTK, whose own would turn the scene to wireframe or close the window."""
        interactor = self.plotter.iren
        for tag in self.__dict__.get("tags", []):
            interactor.interactor.RemoveObserver(tag)
        interactor.clear_key_event_callbacks()
        self.plotter.enable_terrain_style(mouse_wheel_zooms=True, shift_pans=True)  # keeps walls upright
        interactor.add_observer("KeyPressEvent", self._pressed)
        interactor.interactor.GetInteractorStyle().AddObserver("CharEvent", lambda *_: None)
        interactor.add_observer("TimerEvent", self._tick)
        self.tags = self.inspector.listen(interactor)
        interactor.add_observer("ConfigureEvent", lambda *_: self._scale_words())

    # Acting ----------------------------------------------------------------------------------------------------------

    def _pressed(self, interactor: Any, _: str) -> None:
        self.press(interactor.GetKeySym())

    def press(self, key: str) -> None:
        """Do what a key does; unknown keys do nothing."""
        if key in ("q", "Q", "Escape"):
            self.plotter.iren.terminate_app()
        elif key in self.keys:
            self.show(self.keys[key].change(self.state, self.model))

    def show(self, state: ViewState) -> None:
        """Show another state; what cannot be computed is said, and things stay as they were."""
        if state.preset != self.state.preset:
            self.look(state.preset)
        before, self.state = self.state, state
        self.complaint = ""
        try:
            self.refresh()
        except RadiosityError as error:
            self.state, self.complaint = replace(before, playing=False), str(error)
            self.refresh()
        self.plotter.render()

    def change(self, **fields: Any) -> None:
        """Show the state with some of its fields changed."""
        self.show(replace(self.state, **fields))

    def _tick(self, *_: Any) -> None:
        if self._certify():
            self.show(self.state)
        if self.state.playing:
            self.show(self.state.tick())

    def look(self, preset: int) -> None:
        """Put the camera of both panes to a preset."""
        camera = self.cameras[preset % len(self.cameras)]
        for drawing in self.panes.values():
            drawing.look(camera)

    # Drawing ---------------------------------------------------------------------------------------------------------

    def refresh(self) -> None:
        """Bring everything up to date with the state; the caller renders."""
        self.solution, self.series = self.model.lit(self.state.changes)
        state = self.state
        for pane, drawing in self.panes.items():
            if state.left != "solvers" and (pane == "sum" or state.left == "order"):
                drawing.draw(self.series, state)
                self.say(pane, formula(state.order, pane), caption(self.series, state, pane))
                unit = units(state.photometric).density
                self.bars[pane].update(*self.series.scale(state, pane), state.false_colour, unit)
        self.inspector.refresh()
        self.dashboard.refresh()
        self.keys_list.refresh()
        self.veil.SetDraw(state.help)
        self._scale_words()

    def say(self, pane: Pane, heading: str, words: str) -> None:
        """Put words above a pane."""
        for place, text in zip(self.titles[pane], (heading, words), strict=True):
            place.say(text)

    # How sure the light is -------------------------------------------------------------------------------------------

    def _begin_certificate(self) -> None:
        """Nothing is being worked out; the solution is settled."""
        self._settled = self.solution
        self._pending: Future[Certificate] | None = None

    def certificate(self) -> Certificate | None:
        """The certificate of what is shown, if it is there."""
        return self.solution.__dict__.get("certificate")

    def _certify(self) -> bool:
        """Have the certificate worked out, beside the window, once nothing moves; True when it has just come."""
        if self._settled is not self.solution:
            self._settled, self._pending = self.solution, None
        elif self._pending is None and self.certificate() is None:
            solution = self.solution
            worker = ThreadPoolExecutor(1)
            self._pending = worker.submit(lambda: solution.certificate)
            worker.shutdown(wait=False)
        elif self._pending is not None:
            wait([self._pending], timeout=TURN)  # VTK holds the interpreter while it waits: the work has no other turn
            if self._pending.done():
                self._pending = None
                return self.certificate() is not None
        return False

    def word_scale(self) -> float:
        """Letters against their designed size: by the height of the window, and larger for a projector."""
        height = self.plotter.render_window.GetSize()[1] or DESIGN_HEIGHT
        return float(height / DESIGN_HEIGHT * (PROJECTOR_SCALE if self.state.projector else 1.0))

    def _scale_words(self) -> None:
        self._place_rows()
        strong = self.state.projector
        for words in self.all_words():
            words.scale(self.word_scale())
            words.contrast(strong)
        width = self.plotter.render_window.GetSize()[0] * (1.0 - self.side) / 2.0
        for pane, (heading, words) in self.titles.items():
            between = self._between(pane)
            if between:
                heading.scale(self.word_scale(), (between[0] - 0.06) * width)
                words.scale(self.word_scale(), (0.94 - between[1]) * width)
            else:
                heading.scale(self.word_scale())
                words.scale(self.word_scale(), 0.9 * width - heading.width(heading.size * self.word_scale()))
        for words in (
            self.keys_list.words if self.state.help else ()
        ):  # the list of keys fills its layer whatever the type
            words.scale(self.word_scale() * (LARGEST / PROJECTOR_SCALE if strong else 1.0))
            words.contrast(strong)
        self.dashboard.scale(self.word_scale())

    def _between(self, pane: Pane) -> tuple[float, float] | None:
        """Ends of what stands between the words above a pane, in shares of its width."""
        if self.bars[pane].shown:
            return self.bars[pane].box[::2]
        return EQUATION[::2] if pane == "order" and self.state.left == "wrong" else None

    def _place_rows(self) -> None:
        """Give titles, panes and dashboard their share of the height."""
        rows = PROJECTOR_ROWS if self.state.projector else ROWS
        self.veil.SetViewport(self.side, rows[2], 1.0, 1.0)
        if rows == self._rows:
            return
        self._rows = rows
        background = pv.Color(STRONG[PANEL] if self.state.projector else PANEL).float_rgb
        for number, pane in enumerate(PANES):
            left = self.side + number * (1.0 - self.side) / 2.0
            right = left + (1.0 - self.side) / 2.0
            self.panes[pane].renderer.SetViewport(left, rows[2], right, rows[2] + rows[1])
            title = self.title_renderers[pane]
            title.SetViewport(left, rows[2] + rows[1], right, 1.0)
            title.SetBackground(background)
        self.dashboard.renderer.SetViewport(self.side, 0.0, 1.0, rows[2])
        self.dashboard.renderer.SetBackground(background)
        for slider in self.dashboard.sliders.values():
            slider.place()

    def all_words(self) -> list[Words]:
        """Every text of the window whose size does not depend on how much is said, but for the list of keys."""
        titles = [words for pair in self.titles.values() for words in pair]
        bars = [words for bar in self.bars.values() for words in bar.words]
        return [*titles, *bars, *self.inspector.words]

    def image(self) -> np.ndarray[Any, np.dtype[np.uint8]]:
        """What the window shows, (height, width, 3), with the certificate if it says so."""
        if self.certificate() is None and self.state.left == "order" and self.state.picked < 0:
            _ = self.solution.certificate
            self.refresh()
        self.plotter.render()
        return np.asarray(self.plotter.screenshot(return_img=True))

    def run(self) -> None:
        """Open the window and wait until it is closed."""
        self.plotter.iren.initialize()
        self.plotter.iren.create_timer(PLAY_MILLISECONDS, repeating=True)
        self.plotter.show(auto_close=True)

    def close(self) -> None:
        """Give back what the graphics library holds."""
        self.plotter.close()
