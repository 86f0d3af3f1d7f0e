"""What a lecture is: steps of text, each with a view, and now and then a question to be answered before looking.

A lecture is data. A teacher copies a file such as `cornell.py`, changes its words and views, and runs it.
"""

from __future__ import annotations

import re
import textwrap
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from ..errors import ParameterError
from ..solution import Solution
from ..viewer.state import ViewState

Solved = Solution | Mapping[str, Solution]
VIEW = frozenset(ViewState.__dataclass_fields__) - {"last"}
BESIDES = frozenset({"scene", "beside", "figure", "pick", "pick_other", "camera", "titles"})


@dataclass(frozen=True)
class Step:
    """One thing to see and to say.

    Attributes
    ----------
    title : str
    text : str
        What is to be said. Indentation of the source is removed; an empty line begins a paragraph. ``{name}`` and
        ``{name:.0%}`` stand for what the lecture's `numbers` gives, in Python's format; a brace itself is written
        ``{{``.
    show : mapping
        Fields of `ViewState`, such as ``{"order": 1, "normalised": True}``; the rest is as the viewer begins. And:

        ``"scene"``
            which of the lecture's solutions, if it has several; else the first;
        ``"beside"``
            another solution on the same patches, whose light up to the same order stands in the left pane, under its
            name, instead of one bounce;
        ``"figure"``
            a function from what `solve` returned to a matplotlib figure, which stands in the left pane;
        ``"pick"``, ``"pick_other"``
            places (x, y, z) in metres: the patch whose middle is nearest is picked;
        ``"camera"``
            a `radiosity.Camera` instead of a preset;
        ``"titles"``
            (left, right), words above the panes instead of the terms of the series; an empty one changes nothing.
    question : str
        Asked, under the text, before the answer is shown. Empty: nothing is asked.
    answer : str
        Shown on the next key.
    reveal : mapping
        What changes with the answer; as `show`.
    minutes : float
        How long the step takes in class.
    """

    title: str
    text: str
    show: Mapping[str, Any] = field(default_factory=dict)
    question: str = ""
    answer: str = ""
    reveal: Mapping[str, Any] = field(default_factory=dict)
    minutes: float = 1.0

    def __post_init__(self) -> None:
        if bool(self.question) != bool(self.answer):
            raise ParameterError(f"step {self.title!r} needs a question and an answer, or neither")
        if self.reveal and not self.question:
            raise ParameterError(f"step {self.title!r} reveals something, but asks nothing")
        if unknown := sorted((set(self.show) | set(self.reveal)) - VIEW - BESIDES):
            raise ParameterError(
                f"step {self.title!r} shows {', '.join(unknown)}; a step can show {', '.join(sorted(VIEW | BESIDES))}"
            )

    @property
    def paragraphs(self) -> list[str]:
        """The text, one line a paragraph, as it was written. No-break spaces stay."""
        return paragraphs(self.text)


def paragraphs(text: str) -> list[str]:
    """A text of a lecture's file as lines, one a paragraph."""
    parts = textwrap.dedent(text).split("\n\n")
    return [re.sub(r"[ \t\n]+", " ", part).strip() for part in parts if part.strip()]


@dataclass(frozen=True)
class Lecture:
    """A talk through the light of one or several scenes.

    Attributes
    ----------
    name : str
        What the command line calls it.
    title : str
    solve : callable () -> Solution, or mapping of str to Solution
        Computes what is shown. If it takes ``patch_count``, the command line can ask for fewer or more patches.
    steps : tuple of Step
    numbers : callable, optional
        From what `solve` returned to the numbers that stand in the texts, by name.
    """

    name: str
    title: str
    solve: Callable[..., Solved]
    steps: tuple[Step, ...]
    numbers: Callable[[Any], Mapping[str, Any]] | None = None

    def __post_init__(self) -> None:
        if not self.steps:
            raise ParameterError(f"lecture {self.name!r} has no steps")

    @property
    def minutes(self) -> float:
        """How long the whole takes in class."""
        return sum(step.minutes for step in self.steps)


@dataclass(frozen=True)
class Place:
    """Where in a lecture one is.

    Attributes
    ----------
    lecture : Lecture
    number : int
        Step, from 0.
    revealed : bool
        Whether the answer is shown.
    """

    lecture: Lecture
    number: int = 0
    revealed: bool = False

    @property
    def step(self) -> Step:
        """The step one is at."""
        return self.lecture.steps[self.number]

    @property
    def asking(self) -> bool:
        """Whether a question waits for its answer."""
        return bool(self.step.question) and not self.revealed

    def forward(self) -> Place:
        """The answer if a question waits, else the next step; the last place leads nowhere."""
        if self.asking:
            return replace(self, revealed=True)
        if self.number + 1 == len(self.lecture.steps):
            return self
        return replace(self, number=self.number + 1, revealed=False)

    def back(self) -> Place:
        """To the question before the answer, or to the step before, with its answer."""
        if self.revealed and self.step.question:
            return replace(self, revealed=False)
        if self.number == 0:
            return self
        before = replace(self, number=self.number - 1)
        return replace(before, revealed=bool(before.step.question))

    @property
    def shown(self) -> dict[str, Any]:
        """What the step says is shown here."""
        return {**self.step.show, **(self.step.reveal if self.revealed else {})}

    def view(self, begin: ViewState) -> ViewState:
        """What the panes show here; `begin` is the view that the viewer begins with."""
        return replace(begin, **{name: value for name, value in self.shown.items() if name in VIEW})

    @property
    def minutes_before(self) -> float:
        """How long one has talked when this step begins."""
        return sum(step.minutes for step in self.lecture.steps[: self.number])

    def all(self) -> list[Place]:
        """Every place from the first to the last, questions and answers apart."""
        places = [Place(self.lecture)]
        while (onward := places[-1].forward()) != places[-1]:
            places.append(onward)
        return places
