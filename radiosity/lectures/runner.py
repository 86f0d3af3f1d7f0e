"""Runs a lecture: in the viewer's window with the text beside it, or as pictures for slides."""

from __future__ import annotations

import importlib
import importlib.util
import pkgutil
from dataclasses import replace
from pathlib import Path
from typing import Any

from PIL import ImageFont

from ..errors import ParameterError
from ..solution import Solution
from ..viewer.figures import save_image
from ..viewer.overlay import FAINT, HERE, Words, font
from ..viewer.window import Window
from .lecture import Lecture, Place

SIDE = 0.29  # share of the window for the text
FORWARD = ("Next", "Return", "KP_Enter")
BACK = ("Prior", "BackSpace")
SIZE = (1600, 900)
TEXT_SIZE, TITLE_SIZE, LINE = 18, 25, 1.35
MARGIN, TEXT_WIDTH = 0.07, 0.86
NOT_LECTURES = ("lecture", "runner")


def names() -> list[str]:
    """The lectures that come with the package."""
    package = importlib.import_module(__package__ or "radiosity.lectures")
    return sorted(module.name for module in pkgutil.iter_modules(package.__path__) if module.name not in NOT_LECTURES)


def find(name: str) -> Lecture:
    """A lecture of the package by its name, or a teacher's own by the path of its file.

    Parameters
    ----------
    name : str
        Such as ``"cornell"`` or ``"my_lecture.py"``. A file must make a `Lecture` called ``LECTURE``; it may say
        ``from radiosity.lectures import Lecture, Step``.

    Raises
    ------
    ParameterError
        No such lecture, or a file without one.
    """
    if name in names():
        module = importlib.import_module(f".{name}", __package__)
    elif name.endswith(".py") and Path(name).is_file():
        # Named as one of ours, so that a copy of a lecture runs with its relative imports unchanged.
        spec = importlib.util.spec_from_file_location(f"{__package__}.{Path(name).stem}", name)
        if spec is None or spec.loader is None:
            raise ParameterError(f"{name} cannot be loaded as Python")
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
    else:
        raise ParameterError(f"there is no lecture {name!r}; there are {', '.join(names())}, or give a file FILE.py")
    lecture = getattr(module, "LECTURE", None)
    if not isinstance(lecture, Lecture):
        raise ParameterError(f"{name} holds no lecture; set LECTURE = Lecture(…) in it")
    return lecture


def run(lecture: Lecture, solution: Solution | None = None, size: tuple[int, int] = SIZE) -> None:
    """Give a lecture in a window, and wait until it is closed.

    Parameters
    ----------
    lecture : Lecture
    solution : Solution, optional
        Shown instead of the one that the lecture would compute.
    size : (int, int)
        Pixels.

    Raises
    ------
    DisplayError
        No display; `export` works without.
    """
    LectureWindow(lecture, solution or lecture.solve(), size=size).run()


def export(
    lecture: Lecture, folder: str | Path, solution: Solution | None = None, size: tuple[int, int] = SIZE
) -> list[Path]:
    """Write every step of a lecture as a picture; questions and answers are two pictures.

    Parameters
    ----------
    lecture : Lecture
    folder : path
        Made if it is not there.
    solution : Solution, optional
        Shown instead of the one that the lecture would compute.
    size : (int, int)
        Pixels.

    Returns
    -------
    list of Path
        ``01.png``, ``02.png``, ``02_answer.png``, …
    """
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    window = LectureWindow(lecture, solution or lecture.solve(), off_screen=True, size=size)
    written = []
    for place in Place(lecture).all():
        window.go(place)
        written.append(folder / f"{place.number + 1:02d}{'_answer' if place.revealed else ''}.png")
        save_image(written[-1], window.image())
    window.close()
    return written


class LectureWindow(Window):
    """The viewer with the lecture's text at its left.

    Page down, as on a presenter's remote control, or Enter goes on; page up or Backspace goes back. All other keys
    are the viewer's, so that a teacher can follow a question from the class and then go on.
    """

    def __init__(self, lecture: Lecture, solution: Solution, **settings: Any) -> None:
        self.place = Place(lecture)
        super().__init__(solution, side=SIDE, **settings)
        self.begin = self.state
        self.go(self.place)

    def _build(self, off_screen: bool, size: tuple[int, int]) -> None:
        super()._build(off_screen, size)
        self.plotter.subplot(0, 0)
        renderer = self.plotter.renderer
        self.heading = Words(renderer, (MARGIN, 0.965), TITLE_SIZE, vertical="top", style="-Bold")
        self.body = Words(renderer, (MARGIN, 0.84), TEXT_SIZE, vertical="top")
        self.question = Words(renderer, (MARGIN, 0.3), TEXT_SIZE, vertical="top", colour=HERE)
        self.foot = Words(renderer, (MARGIN, 0.04), 14, colour=FAINT)

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
        self.place = place
        self.show(place.view(replace(self.begin, projector=self.state.projector)))

    def refresh(self) -> None:
        """Bring words and pictures up to date."""
        super().refresh()
        step = self.place.step
        asked = [step.question] if step.question else []
        answer = [" ".join(step.answer.split())] if self.place.revealed else []
        y = self._flow(self.heading, [step.title], TITLE_SIZE, 0.965, "-Bold")
        y = self._flow(self.body, step.paragraphs, TEXT_SIZE, y - 0.03)
        self._flow(self.question, asked + answer, TEXT_SIZE, y - 0.05)
        self.foot.say(self.progress())

    def _flow(self, words: Words, paragraphs: list[str], size: float, top: float, style: str = "") -> float:
        """Set paragraphs below `top`, a share of the height; returns where they end."""
        width, height = self.plotter.render_window.GetSize()
        letters = size * self.word_scale()
        text = "\n\n".join(wrap(part, TEXT_WIDTH * SIDE * width, letters, style) for part in paragraphs)
        words.say(text)
        words.actor.SetPosition(MARGIN, top)
        return top - (text.count("\n") + 1) * LINE * letters / height

    def progress(self) -> str:
        """Where one is, how long it took so far, and which key leads on."""
        place, lecture = self.place, self.place.lecture
        last = place.number + 1 == len(lecture.steps)
        where = f"{place.number + 1} of {len(lecture.steps)} · minute {place.minutes_before:g} of {lecture.minutes:g}"
        if place.asking:
            return f"{where}\npage down: the answer"
        return f"{where}\n" + ("the end · page up: back" if last else "page down: on · page up: back")

    def all_words(self) -> list[Words]:
        """Every text of the window."""
        return [*super().all_words(), self.heading, self.body, self.question, self.foot]


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
