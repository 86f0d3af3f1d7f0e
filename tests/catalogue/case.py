"""A case of the catalogue: what is built, what is expected, what came."""

from __future__ import annotations

import re
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import radiosity as rad

Run = Callable[[Path], str]


@dataclass(frozen=True)
class Case:
    """One case; `run` does it in an empty folder, fails if what came is not what is expected, and tells what came."""

    group: str
    name: str
    construction: str
    expected: str
    run: Run


def refused(do: Callable[[Path], object], error: type[Exception], words: str) -> Run:
    """The error that a case has to end in, and words of its message."""

    def run(folder: Path) -> str:
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                found = do(folder)
        except error as caught:
            message = " ".join(str(caught).replace(f"{folder}/", "").split())
            assert re.search(words, message), f"{message!r} lacks {words!r}"
            if not isinstance(caught, rad.RadiosityError):
                raise AssertionError("an error that is not ours") from caught
            return f"{type(caught).__name__}: {message}"
        raise AssertionError(f"nothing was refused: {found!r}")

    return run


def warned(do: Callable[[Path], object], category: type[Warning], words: str) -> Run:
    """The warning that a case has to give while it goes on."""

    def run(folder: Path) -> str:
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            do(folder)
        told = [" ".join(str(w.message).replace(f"{folder}/", "").split()) for w in caught if w.category is category]
        (message, *_) = [text for text in told if re.search(words, text)]
        return f"{category.__name__}: {message}"

    return run


def value(do: Callable[[], object], expected: float, rel: float = 0.0, abs_: float = 0.0) -> Run:
    """The number that a case has to give, everywhere if it gives many."""

    def run(_: Path) -> str:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            found = np.atleast_1d(np.asarray(do(), dtype=float))
        off = float(np.abs(found - expected).max())
        assert off <= rel * abs(expected) + abs_, f"{found} is off by {off:.3g}"
        within = f"{off / abs(expected):.1g} of it" if expected else f"{off:.1g}"
        worst = float(found.ravel()[np.argmax(np.abs(found.ravel() - expected))])
        return f"{worst:.9g}, off by {within if off else 'nothing'}"

    return run


def found(make: Callable[[], rad.Scene], kind: str, words: str) -> Run:
    """The finding that `scene.validate()` has to report."""

    def run(_: Path) -> str:
        (one, *_others) = [finding for finding in make().validate() if finding.kind == kind]
        assert re.search(words, str(one)), str(one)
        return str(one)

    return run
