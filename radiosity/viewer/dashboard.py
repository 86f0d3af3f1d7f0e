"""The lower part of the window: sliders, words and a plot."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

import pyvista as pv

from .curves import Curves, power_curves, race_curves, sum_curves
from .overlay import FAINT, INK, Words, wrap
from .palette import STRONG
from .plot import Plot
from .state import EXPOSURES
from .status import lines
from .titles import units

if TYPE_CHECKING:
    from .window import Window

STATUS_SIZE, LINE = 14, 1.3
STATUS = (0.375, 0.93, 0.325)  # left, top, width, in shares of the dashboard
PLOT = (0.745, 0.34, 0.985, 0.8)
SLIDERS = {"reel": (0.02, 0.69), "exposure": (0.02, 0.22), "emission": (0.195, 0.69), "reflectance": (0.195, 0.22)}
WIDTH, RAISE = 0.15, 0.155  # of a slider, and of its words above it
SMALLEST = 0.6  # to which long texts shrink


class Slider:
    """One slider with its words, which acts while it is dragged.

    Parameters
    ----------
    plotter : pyvista.Plotter
        Its active renderer is drawn on.
    place : (float, float)
        Left end.
    drag : callable (float)
    """

    def __init__(self, plotter: pv.Plotter, place: tuple[float, float], drag: Callable[[float], None]) -> None:
        left, height = self.at = place
        self.renderer = plotter.renderer
        self.words = Words(plotter.renderer, (left, height + RAISE), STATUS_SIZE)
        self.drag = drag
        self.quiet = True  # the widget says its first value by itself
        self.widget = plotter.add_slider_widget(
            self._dragged, (0.0, 1.0), value=0.0, pointa=(left, height), pointb=(left + WIDTH, height),
            interaction_event="always", style="modern", color=FAINT, slider_width=0.05, tube_width=0.011,
        )  # fmt: skip
        self.quiet = False
        self.look = self.widget.GetRepresentation()
        self.look.ShowSliderLabelOff()
        self.look.GetSliderProperty().SetColor(pv.Color(INK).float_rgb)
        self.look.SetSliderLength(0.012)
        self.look.SetSliderWidth(0.055)

    def place(self) -> None:
        """Go where the dashboard has gone: VTK takes shares of the window, counted from the pane's lower left."""
        left, bottom, right, top = self.renderer.GetViewport()
        x, y = self.at
        for end, share in ((self.look.GetPoint1Coordinate(), x), (self.look.GetPoint2Coordinate(), x + WIDTH)):
            end.SetCoordinateSystemToNormalizedDisplay()
            end.SetValue(share * (right - left), y * (top - bottom), 0.0)
        self.look.Modified()

    def _dragged(self, value: float) -> None:
        if not self.quiet:
            self.drag(value)

    def show(self, words: str, value: float, low: float, high: float) -> None:
        """Put it where the state is."""
        self.quiet = True
        self.words.say(words)
        if (self.look.GetMinimumValue(), self.look.GetMaximumValue()) != (low, high):
            self.look.SetMinimumValue(low)
            self.look.SetMaximumValue(max(high, low + 1e-9))
        if self.look.GetValue() != value:
            self.look.SetValue(value)
        self.quiet = False

    def contrast(self, strong: bool) -> None:
        """Stronger colours, for a projector."""
        self.look.GetSliderProperty().SetColor(pv.Color(STRONG[INK] if strong else INK).float_rgb)
        self.look.GetTubeProperty().SetColor(pv.Color(STRONG[FAINT] if strong else FAINT).float_rgb)


class Dashboard:
    """Sliders, words and plot of a window.

    Parameters
    ----------
    window : Window
        Its plotter's active renderer is drawn on.
    """

    def __init__(self, window: Window) -> None:
        self.window = window
        self.renderer = window.plotter.renderer
        self.status = Words(self.renderer, STATUS[:2], STATUS_SIZE, vertical="top")
        self.plot = Plot(self.renderer, PLOT)
        drags = {
            "reel": self._drag_reel,
            "exposure": lambda value: window.show(window.state.exposed(value)),
            "emission": self._drag_emission,
            "reflectance": self._drag_reflectance,
        }
        self.sliders = {name: Slider(window.plotter, place, drags[name]) for name, place in SLIDERS.items()}

    def scale(self, scale: float) -> None:
        """Set all words larger or smaller than designed, each as large as it fits."""
        width = self.renderer.GetSize()[0]
        strong = self.window.state.projector
        for slider in self.sliders.values():
            slider.words.scale(scale, (WIDTH + 0.005) * width)
            slider.words.contrast(strong)
            slider.contrast(strong)
        for words in self.plot.words:
            words.scale(scale, (PLOT[2] - PLOT[0]) * width)
            words.contrast(strong)
        self.status.contrast(strong)
        self.write()

    def _drag_reel(self, value: float) -> None:
        state = self.window.state
        if round(value) != state.reel[0]:
            self.window.show(replace(state.moved_to(value), playing=False))

    def _drag_emission(self, value: float) -> None:
        state = self.window.state
        surface = self.window.model.sliders(state).surface
        self.window.change(changes=state.changes.emitting(surface, value))

    def _drag_reflectance(self, value: float) -> None:
        state = self.window.state
        surface = self.window.model.sliders(state).surface
        self.window.change(changes=state.changes.painted(surface, value))

    def refresh(self) -> None:
        """Bring everything up to date with the state."""
        window, state = self.window, self.window.state
        place, end = state.reel
        name = (
            f"bounce  k = {place}"
            if state.left != "solvers"
            else f"rows, columns: {window.inspector.race.frame.rows:,}"
        )
        self.sliders["reel"].show(name, place, 0, end)
        exposure = f"exposure  {state.exposure:+.1f} EV".replace("-", "−")
        self.sliders["exposure"].show(exposure, state.exposure, *EXPOSURES)
        held = window.model.sliders(state)
        density = units(state.photometric).density
        emission = f"E of {held.surface}  {held.emission:.3g} {density}"
        self.sliders["emission"].show(emission, held.emission, 0.0, held.most_emission)
        reflectance = f"ρ of {held.surface}  {held.reflectance:.2f}"
        self.sliders["reflectance"].show(reflectance, held.reflectance, 0.0, held.most_reflectance)
        self.plot.show(self._curves())

    def _curves(self) -> Curves:
        """What the plot shows."""
        window, state = self.window, self.window.state
        reading = window.inspector.reading
        if reading is not None:
            return sum_curves(reading.running, reading.solved, state.dome.theta)
        if state.left == "solvers":
            return race_curves(window.inspector.race.race, state.work)
        return power_curves(window.series, state)

    def write(self) -> None:
        """Set the words as large as they fit."""
        window = self.window
        width, height = self.renderer.GetSize()
        room = (STATUS[1] - 0.03) * height
        shrink = 1.0
        said = lines(window)
        while True:
            letters = STATUS_SIZE * window.word_scale() * shrink
            text = [part for line in said for part in wrap(line, STATUS[2] * width, letters)]
            if len(text) * LINE * letters <= room or shrink <= SMALLEST:
                break
            shrink -= 0.05
        self.status.say("\n".join(text))
        self.status.scale(window.word_scale() * shrink)
