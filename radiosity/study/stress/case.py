"""A case, and the few words in which cases say what they found."""

from __future__ import annotations

import time
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ...errors import RadiosityError, RadiosityWarning

SHOWN = 200  # letters of a message


class Got(NamedTuple):
    """What a case found: whether that is as expected, and what it was, in words."""

    good: bool
    words: str


class Outcome(NamedTuple):
    """What came of a case."""

    group: str
    name: str
    expected: str
    got: str
    verdict: str  # "as expected" or "FAILED"
    seconds: float

    @property
    def good(self) -> bool:
        """Whether it came out as expected."""
        return self.verdict == "as expected"


@dataclass(frozen=True)
class Case:
    """One case.

    Attributes
    ----------
    name : str
        What is put to the test.
    expected : str
        What should come of it, in words.
    check : callable
        Does the work and gives a `Got`. An error that it lets through is a failure.
    group : str
        Under which heading it is shown.
    """

    name: str
    expected: str
    check: Callable[[], Got]
    group: str = "your own"

    def run(self) -> Outcome:
        """Do it; never raises but for an interrupt."""
        began = time.perf_counter()
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", RadiosityWarning)
                good, words = self.check()
        except Exception as error:
            good, words = False, f"{type(error).__name__}: {error}"
        verdict = "as expected" if good else "FAILED"
        return Outcome(self.group, self.name, self.expected, _one_line(words), verdict, time.perf_counter() - began)


def case(name: str, expected: str, group: str = "your own") -> Callable[[Callable[[], Got]], Case]:
    """Make a function without arguments into a `Case`.

    Parameters
    ----------
    name, expected : str
        See `Case`.
    group : str, optional
    """

    def made(check: Callable[[], Got]) -> Case:
        return Case(name, expected, check, group)

    return made


def within(found: ArrayLike, true: ArrayLike, rtol: float) -> Got:
    """Whether numbers are right to a relative tolerance, everywhere.

    >>> within([1.0, 2.0], [1.0, 2.02], 0.1)
    Got(good=True, words='off by 0.0099 at most')
    >>> within(np.nan, 1.0, 0.1)
    Got(good=False, words='off by nan at most')
    """
    a, b = np.broadcast_arrays(np.asarray(found, dtype=np.float64), np.asarray(true, dtype=np.float64))
    size = np.where(b == 0.0, 1.0, np.abs(b))
    worst = float(np.max(np.abs(a / size - b / size), initial=0.0))
    return Got(worst <= rtol, f"off by {worst:.2g} at most")


def truth(good: bool, words: str) -> Got:
    """Anything else that holds or does not."""
    return Got(bool(good), words)


def refuses(kind: type[RadiosityError], work: Callable[[], Any], *words: str) -> Got:
    """Whether work is refused by an error of that very kind whose message holds some words.

    >>> import radiosity as rad
    >>> refuses(rad.errors.ParameterError, lambda: rad.MonteCarlo(rays=0), "rays is 0").good
    True
    """
    try:
        work()
    except kind as error:
        missing = [word for word in words if word not in str(error)]
        said = f"{type(error).__name__}: {error}"
        return Got(not missing, f"says nothing of {missing[0]!r}: {said}" if missing else said)
    return Got(False, f"no {kind.__name__}")


def warns(kind: type[RadiosityWarning], work: Callable[[], Any], *words: str) -> Got:
    """Whether work warns in that kind, with some words."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        work()
    said = [str(warning.message) for warning in caught if issubclass(warning.category, kind)]
    good = [one for one in said if all(word in one for word in words)]
    return Got(bool(good), f"{kind.__name__}: {good[0]}" if good else f"warned of {said or 'nothing'}")


def _one_line(words: str) -> str:
    flat = " ".join(words.split())
    return flat if len(flat) <= SHOWN else flat[: SHOWN - 1] + "…"
