"""A lecture with its light computed: words with numbers in them, and which solution each step shows."""

from __future__ import annotations

import inspect
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import ParameterError
from ..solution import Solution
from ..viewer.state import PANES, Pane, ViewState
from .blame import asked
from .lecture import Lecture, Place, Solved, paragraphs
from .light import nearest

if TYPE_CHECKING:
    from matplotlib.figure import Figure

ONLY = "scene"  # what a lone solution is called


@dataclass(frozen=True, eq=False)
class Talk:
    """A lecture and what it shows.

    Attributes
    ----------
    lecture : Lecture
    solved : Solution, or mapping of str to Solution
        What the lecture's `solve` returned.

    Raises
    ------
    ParameterError
        A step that speaks of a solution or a number that the lecture does not have; it is named.
    """

    lecture: Lecture
    solved: Solved

    def __post_init__(self) -> None:
        for place in Place(self.lecture).all():
            self.words(place)
            solution = self.solution(place)
            self.picks(place)
            beside = self.beside(place)
            if beside is not None and len(beside.patches) != len(solution.patches):
                raise ParameterError(
                    f"step {place.step.title!r} shows {place.shown['beside']!r} ({len(beside.patches)} patches) beside "
                    f"a scene of {len(solution.patches)}; give solutions on the same patches"
                )

    @classmethod
    def prepare(cls, lecture: Lecture, patch_count: int | None = None) -> Talk:
        """Solve what a lecture shows.

        Raises
        ------
        ParameterError
            A number of patches for a lecture whose `solve` takes none.
        """
        if patch_count is None:
            return cls(lecture, asked(lecture.solve))
        if "patch_count" not in inspect.signature(lecture.solve).parameters:
            raise ParameterError(
                f"lecture {lecture.name!r} has its own number of patches: its function solve takes no patch_count"
            )
        return cls(lecture, asked(lecture.solve, patch_count=patch_count))

    @cached_property
    def solutions(self) -> Mapping[str, Solution]:
        """All solutions by name, the first first."""
        return {ONLY: self.solved} if isinstance(self.solved, Solution) else dict(self.solved)

    @cached_property
    def numbers(self) -> Mapping[str, Any]:
        """What stands in the texts."""
        return {} if self.lecture.numbers is None else asked(self.lecture.numbers, self.solved)

    def fill(self, text: str, title: str) -> str:
        """A text with its numbers in it."""
        try:
            return text.format_map(self.numbers)
        except (KeyError, IndexError) as error:
            known = ", ".join(sorted(self.numbers)) or "none; give the lecture a function for its `numbers`"
            raise ParameterError(
                f"step {title!r} has {{{error.args[0]}}} in its text; the lecture's numbers are {known}"
            ) from error
        except (ValueError, TypeError, AttributeError) as error:
            raise ParameterError(f"step {title!r}: its text has braces that are no number: {error}") from error

    def words(self, place: Place) -> Words:
        """What is said at a place."""
        step = place.step
        said = (self.fill(text, step.title) for text in (step.title, step.text, step.question, step.answer))
        title, text, question, answer = said
        return Words(title, paragraphs(text), paragraphs(question), paragraphs(answer))

    def name(self, place: Place) -> str:
        """Name of the solution that is shown."""
        return self._known(place, place.shown.get("scene") or next(iter(self.solutions)))

    def solution(self, place: Place) -> Solution:
        """What is shown."""
        return self.solutions[self.name(place)]

    def beside(self, place: Place) -> Solution | None:
        """Whose light stands in the left pane instead of one bounce, if any."""
        name = place.shown.get("beside")
        return self.solutions[self._known(place, name)] if name else None

    def figure(self, place: Place) -> Figure | None:
        """The plot in the left pane, if there is one."""
        draw = place.shown.get("figure")
        return None if draw is None else asked(draw, self.solved)

    def titles(self, place: Place) -> dict[Pane, str]:
        """Words above the panes that stand for the terms of the series; what stands beside is none of them."""
        left, right = place.shown.get("titles", ("", ""))
        left_right = (left or place.shown.get("beside", ""), right)
        return {
            pane: self.fill(words, place.step.title) for pane, words in zip(PANES, left_right, strict=True) if words
        }

    def picks(self, place: Place) -> dict[str, int]:
        """Patches that a step picks by places in the scene."""
        solution = self.solution(place)
        picked = {}
        for word, name in (("pick", "picked"), ("pick_other", "other")):
            if (point := place.shown.get(word)) is not None:
                where = np.asarray(point, dtype=np.float64)
                if where.shape != (3,):
                    raise ParameterError(f"step {place.step.title!r}: {word} is {point!r}; give x, y, z in metres")
                picked[name] = nearest(solution, where)
        return picked

    def view(self, place: Place, begin: ViewState) -> ViewState:
        """What the panes show at a place; `begin` is the view that the viewer begins with on this solution."""
        changes: dict[str, Any] = dict(self.picks(place))
        return place.view(replace(begin, **changes))

    def _known(self, place: Place, name: str) -> str:
        if name not in self.solutions:
            raise ParameterError(
                f"step {place.step.title!r} shows {name!r}; the lecture has solved {', '.join(self.solutions)}"
            )
        return name


@dataclass(frozen=True)
class Words:
    """What is said at a place, the numbers in it: title, and paragraphs of text, question and answer."""

    title: str
    text: list[str]
    question: list[str]
    answer: list[str]
