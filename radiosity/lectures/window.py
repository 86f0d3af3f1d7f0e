"""The viewer's window with a lecture's text at its left."""

from __future__ import annotations

import functools
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import ImageFont

from ..camera import presets
from ..viewer.overlay import FAINT, HERE, Words, font
from ..viewer.state import Series, ViewState, coloured, start
from ..viewer.window import Window
from .lecture import Place
from .plots import pixels
from .talk import Talk

SIDE = 0.29  # share of the window for the text
FORWARD = ("Next", "Return", "KP_Enter")
BACK = ("Prior", "BackSpace")
TEXT_SIZE, TITLE_SIZE, LINE = 18, 25, 1.35
SMALLEST = 0.6  # to which long texts shrink
MARGIN, TEXT_WIDTH = 0.07, 0.86
TOP, GAP, BOTTOM = 0.965, 0.03, 0.1  # of the column of text


class LectureWindow(Window):
    """The viewer with the lecture's text at its left.

    Page down, as on a presenter's remote control, or Enter goes on; page up or Backspace goes back. All other keys
    are the viewer's, so that a teacher can follow a question from the class and then go on.

    Parameters
    ----------
    talk : Talk
    **settings
        Of `Window`.
    """

    def __init__(self, talk: Talk, **settings: Any) -> None:
        self.talk = talk
        self.place = Place(talk.lecture)
        self.figures: dict[tuple[int, bool], NDArray[np.uint8] | None] = {}
        self.all_series: dict[str, Series] = {}
        super().__init__(talk.solution(self.place), side=SIDE, **settings)
        self.go(self.place)

    def _build(self, off_screen: bool, size: tuple[int, int]) -> None:
        super()._build(off_screen, size)
        self.plotter.subplot(0, 0)
        renderer = self.plotter.renderer
        self.heading = Words(renderer, (MARGIN, TOP), TITLE_SIZE, vertical="top", style="-Bold")
        self.body = Words(renderer, (MARGIN, 0.84), TEXT_SIZE, vertical="top")
        self.question = Words(renderer, (MARGIN, 0.3), TEXT_SIZE, vertical="top", colour=HERE)
        self.foot = Words(renderer, (MARGIN, 0.04), 14, colour=FAINT)

    def _open(self, off_screen: bool, size: tuple[int, int], layout: dict[str, Any]) -> Any:
        """The window that is open already, emptied; a new one at first."""
        if "plotter" not in self.__dict__:
            return super()._open(off_screen, size, layout)
        self.plotter.iren.remove_observers()
        self.plotter.clear_slider_widgets()
        for renderer in self.plotter.renderers:
            renderer.RemoveAllViewProps()
        return self.plotter

    def press(self, key: str) -> None:
        """Go on, go back, or do what the viewer does with the key."""
        if key in FORWARD:
            self.go(self.place.forward())
        elif key in BACK:
            self.go(self.place.back())
        else:
            super().press(key)

    def go(self, place: Place) -> None:
        """Show a place of the lecture. Large type stays as the teacher set it."""
        solution = self.talk.solution(place)
        moved = self._camera(place) != self._camera(self.place)
        self.place = place
        if solution is not self.solution:
            self._enter()
            moved = True
        begin = start(self.series, projector=self.state.projector)
        state = self.talk.view(place, begin)
        if not moved:
            state = replace(state, preset=self.state.preset)  # as the teacher turned it
        if moved:
            self.look(state.preset)  # first, for the hemisphere has a camera of its own
        self.show(state)

    def _camera(self, place: Place) -> tuple[Any, ...]:
        """What a step says of where to look from."""
        return (self.talk.name(place), place.shown.get("camera"), place.shown.get("preset", 0))

    def _enter(self) -> None:
        """Go over to the scene of the place."""
        self.solution = self.talk.solution(self.place)
        self.series = self.series_of(self.talk.name(self.place))
        self.cameras = presets(self.solution.patches)
        self.state = start(self.series, projector=self.state.projector)
        for kind in type(self).__mro__:  # what was worked out for the scene before
            for name, value in vars(kind).items():
                if isinstance(value, functools.cached_property):
                    self.__dict__.pop(name, None)
        self._build(off_screen=False, size=(0, 0))  # neither is asked for: the window is there

    def series_of(self, name: str) -> Series:
        """The light of one of the talk's solutions, prepared once."""
        if name not in self.all_series:
            self.all_series[name] = Series.of(self.talk.solutions[name])
        return self.all_series[name]

    def look(self, preset: int) -> None:
        """Put the camera of both panes to a preset, or to the step's own camera."""
        camera = self.place.shown.get("camera")
        if camera is None:
            super().look(preset)
            return
        for drawing in self.panes.values():
            drawing.look(camera)

    # Drawing ---------------------------------------------------------------------------------------------------------

    def refresh(self) -> None:
        """Bring words and pictures up to date."""
        super().refresh()
        if self.state.left == "order":
            self._show_left()
        self._speak()

    def _show_left(self) -> None:
        """What a step puts in the place of one bounce."""
        name = self.place.shown.get("beside")
        image = self._figure()
        if name:
            self.panes["order"].draw(self.series, self.state, self._light_beside(self.series_of(name), self.state))
        if image is not None:
            self.inspector.raster.show(image)
            self.panes["order"].hide()
            self.say("order", "", "")
            self.bars["order"].update(1.0, 10.0, False)
        for pane, words in self.talk.titles(self.place).items():
            if pane == "sum" or image is None:  # a plot says itself what it is
                self.say(pane, words, "")

    def _light_beside(self, other: Series, state: ViewState) -> NDArray[np.uint8]:
        """Light of another solution up to the same order, on the exposure of the right pane."""
        return coloured(self.series, state, "sum", other.sums[min(state.order, other.last)])

    def _figure(self) -> NDArray[np.uint8] | None:
        key = self.place.number, self.place.revealed
        if key not in self.figures:
            figure = self.talk.figure(self.place)
            self.figures[key] = None if figure is None else pixels(figure)
        return self.figures[key]

    def _speak(self) -> None:
        """Title, text, question and answer, one below the other, as large as they fit."""
        words = self.talk.words(self.place)
        asked = [*words.question, *(words.answer if self.place.revealed else [])]
        shrink = 1.0
        while True:
            y = self._flow(self.heading, [words.title], TITLE_SIZE, TOP, shrink, "-Bold")
            y = self._flow(self.body, words.text, TEXT_SIZE, y - GAP, shrink)
            y = self._flow(self.question, asked, TEXT_SIZE, y - GAP, shrink)
            if y > BOTTOM or shrink <= SMALLEST:
                break
            shrink -= 0.05
        for each in (self.heading, self.body, self.question):
            each.scale(self.word_scale() * shrink)
        self.foot.say(self.progress())

    def _flow(
        self, words: Words, paragraphs: list[str], size: float, top: float, shrink: float, style: str = ""
    ) -> float:
        """Set paragraphs below `top`, a share of the height; returns where they end."""
        width, height = self.plotter.render_window.GetSize()
        letters = size * self.word_scale() * shrink
        text = "\n\n".join(wrap(part, TEXT_WIDTH * SIDE * width, letters, style) for part in paragraphs)
        words.say(text)
        words.actor.SetPosition(MARGIN, top)
        return top - (text.count("\n") + 1) * LINE * letters / height if text else top

    def _scale_words(self) -> None:
        super()._scale_words()
        if hasattr(self, "foot"):
            self._speak()

    def progress(self) -> str:
        """Where one is, how long it took so far, and which key leads on."""
        place, lecture = self.place, self.talk.lecture
        last = place.number + 1 == len(lecture.steps)
        where = f"{place.number + 1} of {len(lecture.steps)} · minute {place.minutes_before:g} of {lecture.minutes:g}"
        if place.asking:
            return f"{where}\npage down: the answer"
        return f"{where}\n" + ("the end · page up: back" if last else "page down: on · page up: back")

    def all_words(self) -> list[Words]:
        """Every text of the window whose size does not depend on how much is said."""
        return [*super().all_words(), self.foot]


def wrap(text: str, width: float, size: float, style: str = "") -> str:
    """Break a text into lines that are not wider than `width` pixels in letters of `size` pixels."""
    face = ImageFont.truetype(font(style), max(6, round(size)))
    lines = [""]
    for word in text.split(" "):  # not at no-break spaces, which hold formulas together
        longer = f"{lines[-1]} {word}".strip()
        if face.getlength(longer) <= width or not lines[-1]:
            lines[-1] = longer
        else:
            lines.append(word)
    return "\n".join(lines)
