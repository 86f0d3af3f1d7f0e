"""The interactive window: T^k L_e beside its partial sum, one camera, sliders and keys that replace the state."""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from textwrap import wrap
from typing import TYPE_CHECKING, Any

import numpy as np
import pyvista as pv

from .. import display
from ..camera import Camera, presets
from . import probe
from .drawing import Drawing
from .figures import save_image
from .inspect import patch_lines
from .inspector import Inspector
from .overlay import DESIGN_HEIGHT, FAINT, INK, PANEL, PowerPanel, ScaleBar, Shapes, Words
from .state import COMMANDS, EXPOSURES, PANES, Pane, Series, ViewState, caption, formula, in_words, start

if TYPE_CHECKING:
    from ..solution import Solution

PROJECTOR_SCALE = 1.5
HELP_SIZE, HELP_LARGEST = 15, 1.1
PLAY_MILLISECONDS = 700
ROWS = (0.085, 0.715, 0.2)  # titles, panes, dashboard
STATUS_LETTERS = 66


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
        Pixels.
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
        self.keys: dict[str, Callable[[ViewState], ViewState]] = {
            key: command.change for command in COMMANDS for key in command.keys
        }
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
        self.panes: dict[Pane, Drawing] = {}
        self.titles: dict[Pane, tuple[Words, Words]] = {}
        self.bars: dict[Pane, ScaleBar] = {}
        for column, pane in enumerate(PANES, start=left):
            self.plotter.subplot(0, column)
            heading = Words(self.plotter.renderer, (0.03, 0.5), 27, style="-Oblique")
            words = Words(self.plotter.renderer, (0.97, 0.5), 16, colour=FAINT, align="right")
            self.titles[pane] = (heading, words)
            self.bars[pane] = ScaleBar(self.plotter.renderer, (0.2, 0.5, 0.47, 0.72))
            self.plotter.subplot(1, column)
            self.panes[pane] = Drawing(self.plotter, self.solution.patches, pane)
        self.panes["sum"].renderer.camera = self.panes["order"].renderer.camera
        self.inspector = Inspector(self)
        self._build_dashboard(left)
        self._build_help()
        self._listen()

    def _open(self, off_screen: bool, size: tuple[int, int], layout: dict[str, Any]) -> pv.Plotter:
        """An empty window. Lectures, which go from scene to scene, empty the one that they have."""
        title = "Radiosity, bounce by bounce"
        return pv.Plotter(off_screen=off_screen, window_size=list(size), title=title, border=False, **layout)

    def _build_dashboard(self, left: int) -> None:
        self.plotter.subplot(2, left)
        renderer = self.plotter.renderer
        self.status = Words(renderer, (0.33, 0.9), 14, vertical="top")
        self.power = PowerPanel(renderer, self.series, (0.72, 0.32, 0.97, 0.78))
        self.order_words = Words(renderer, (0.03, 0.84), 15)
        self.exposure_words = Words(renderer, (0.03, 0.42), 15)
        self.order_slider = self._slider((0, self.series.last), self.state.order, 0.64, self._drag_order)
        self.exposure_slider = self._slider(EXPOSURES, self.state.exposure, 0.22, self._drag_exposure)

    def _slider(self, ends: tuple[float, float], value: float, height: float, drag: Callable[[float], None]) -> Any:
        """A slider that acts while it is dragged. Its words are set apart, in our own font."""
        slider = self.plotter.add_slider_widget(
            drag, ends, value=value, pointa=(0.03, height), pointb=(0.28, height), interaction_event="always",
            style="modern", color=FAINT, slider_width=0.05, tube_width=0.008,
        )  # fmt: skip
        look = slider.GetRepresentation()
        look.ShowSliderLabelOff()
        look.GetSliderProperty().SetColor(pv.Color(INK).float_rgb)
        look.SetSliderLength(0.01)
        return slider

    def _build_help(self) -> None:
        """The list of keys, over everything."""
        renderer = self.panes["order"].renderer
        self.help_box = Shapes(renderer, opacity=0.9)
        self.help_box.boxes([(0.04, 0.03, 0.96, 0.97)], ["#0d0f12"])
        shown = [(command.shown, command.does) for command in COMMANDS]
        shown += [("drag", "turn"), ("wheel", "nearer / farther"), ("shift drag", "move")]
        shown += [("click", "pick a patch"), ("ctrl click", "a second one"), ("q", "quit")]
        self.help_words = []
        for line, (keys, does) in enumerate(shown):  # one by one: lines of different letters differ in height
            height = 0.935 - 0.9 * line / len(shown)
            self.help_words += [
                Words(renderer, (0.1, height), HELP_SIZE, style="-Bold", words=keys),
                Words(renderer, (0.27, height), HELP_SIZE, words=does),
            ]

    def _listen(self) -> None:
        """Take all keys from VTK, whose own would turn the scene to wireframe or close the window."""
        interactor = self.plotter.iren
        interactor.clear_key_event_callbacks()
        self.plotter.enable_terrain_style(mouse_wheel_zooms=True, shift_pans=True)  # keeps walls upright
        interactor.add_observer("KeyPressEvent", self._pressed)
        interactor.interactor.GetInteractorStyle().AddObserver("CharEvent", lambda *_: None)
        interactor.add_observer("TimerEvent", self._tick)
        self.inspector.listen(interactor)
        interactor.add_observer("ConfigureEvent", lambda *_: self._scale_words())

    # Acting ----------------------------------------------------------------------------------------------------------

    def _pressed(self, interactor: Any, _: str) -> None:
        self.press(interactor.GetKeySym())

    def press(self, key: str) -> None:
        """Do what a key does; unknown keys do nothing."""
        if key in ("q", "Q", "Escape"):
            self.plotter.iren.terminate_app()
        elif key in self.keys:
            self.show(self.keys[key](self.state))

    def show(self, state: ViewState) -> None:
        """Show another state."""
        if state.preset != self.state.preset:
            self.look(state.preset)
        self.state = state
        self.refresh()
        self.plotter.render()

    def _drag_order(self, value: float) -> None:
        if hasattr(self, "power") and round(value) != self.state.order:
            self.show(replace(self.state.at(value), playing=False))

    def _drag_exposure(self, value: float) -> None:
        if hasattr(self, "power") and value != self.state.exposure:
            self.show(self.state.exposed(value))

    def _tick(self, *_: Any) -> None:
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
        for pane, drawing in self.panes.items():
            if pane == "sum" or self.state.left == "order":
                drawing.draw(self.series, self.state)
                self.say(pane, formula(self.state.order, pane), caption(self.series, self.state, pane))
                self.bars[pane].update(*self.series.scale(self.state, pane), self.state.false_colour)
        self.inspector.refresh()
        self.order_slider.GetRepresentation().SetValue(self.state.order)
        self.exposure_slider.GetRepresentation().SetValue(self.state.exposure)
        self.order_words.say(f"bounce  k = {self.state.order}")
        self.exposure_words.say(f"exposure  {self.state.exposure:+.1f} EV".replace("-", "−"))
        self.power.mark(self.state.order)
        picked = self.state.picked
        self.power.show_patch(display.luminance(self.series.orders[:, picked]) if picked >= 0 else None)
        self.status.say("\n".join(self.status_lines()))
        self.help_box.show(self.state.help)
        for words in self.help_words:
            words.show(self.state.help)
        self._scale_words()

    def say(self, pane: Pane, heading: str, words: str) -> None:
        """Put words above a pane."""
        for place, text in zip(self.titles[pane], (heading, words), strict=True):
            place.say(text)

    def status_lines(self) -> list[str]:
        """What the dashboard says in words."""
        if self.state.verdict:
            return [part for line in str(self.solution.certificate).splitlines() for part in wrap(line, STATUS_LETTERS)]
        if self.state.left == "wrong":
            return self.inspector.compare.lines()
        if self.state.picked >= 0:
            picked = self.state.picked, self.state.other
            return patch_lines(self.solution, self.series, self.state.order, *picked, self.inspector.exchange())
        power = self.series.power[self.state.order]
        emitted = float(self.series.power[0].sum()) or 1.0
        total = float(self.series.power[: self.state.order + 1].sum())
        state = self.state
        switches = [
            "Reinhard" if state.tone == "reinhard" else "linear",
            "smooth" if state.smooth else "flat",
            *(name for name, on in (("false colour", state.false_colour), ("backs shown", state.backs)) if on),
            "playing" if state.playing else "",
        ]
        return [
            f"k = {state.order}: {in_words(state.order)}",
            f"this bounce: {display_watts(power)}",
            f"all so far: {total / emitted:.3f} × the emitted power",
            self.balance,
            f"{len(self.solution.patches):,} patches · " + " · ".join(word for word in switches if word),
            "? lists the keys",
        ]

    @functools.cached_property
    def balance(self) -> str:
        """Where all the power goes."""
        balance = self.solution.balance
        put_in = float(balance.put_in.sum()) or 1.0
        kept, gone = float(balance.absorbed.sum()) / put_in, float(balance.to_sky.sum()) / put_in
        return f"absorbed {kept:.1%}, escaped {gone:.1%}, defect {balance.defect:+.2%}".replace("-", "−")

    def word_scale(self) -> float:
        """Letters against their designed size: by the height of the window, and larger for a projector."""
        height = self.plotter.render_window.GetSize()[1] or DESIGN_HEIGHT
        return float(height / DESIGN_HEIGHT * (PROJECTOR_SCALE if self.state.projector else 1.0))

    def _scale_words(self) -> None:
        for words in self.all_words():
            words.scale(self.word_scale())
        if self.state.projector:
            for words in self.help_words:  # the list of keys fills its pane
                words.scale(self.word_scale() * HELP_LARGEST / PROJECTOR_SCALE)

    def all_words(self) -> list[Words]:
        """Every text of the window."""
        titles = [words for pair in self.titles.values() for words in pair]
        bars = [words for bar in self.bars.values() for words in bar.words]
        sliders = [self.order_words, self.exposure_words]
        return [*titles, *bars, *sliders, self.status, *self.power.words, *self.help_words]

    def image(self) -> np.ndarray[Any, np.dtype[np.uint8]]:
        """What the window shows, (height, width, 3)."""
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


def display_watts(power: Any) -> str:
    """Power of each channel in watts, to three digits.

    >>> display_watts([7.3, 0.5149, 0.0172])
    '7.3 / 0.515 / 0.0172 W'
    """
    values = np.atleast_1d(power)
    if len(values) > 3:
        return f"{float(values.sum()):.3g} W"
    return " / ".join(f"{float(value):.3g}" for value in values) + " W"
