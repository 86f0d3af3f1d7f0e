"""Which cases there are, and running them one after the other."""

from __future__ import annotations

import runpy
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path

from ...errors import MissingFileError, ParameterError
from ...progress import Progress, quiet
from . import albedo, poison, rooms, shapes
from .case import Case, Outcome

SOURCES: tuple[Callable[[], Iterator[Case]], ...] = (albedo.cases, rooms.cases, shapes.cases, poison.cases)


def built_in() -> list[Case]:
    """All cases of the package, in the order in which they are shown."""
    return [case for source in SOURCES for case in source()]


def cases_of(path: str | Path) -> list[Case]:
    """Cases that a Python file makes at its top: whatever `Case` its names hold, and lists of them.

    Raises
    ------
    MissingFileError
        There is no such file.
    ParameterError
        It holds none.
    """
    if not Path(path).is_file():
        raise MissingFileError(f"there is no file {path} with cases")
    found: list[Case] = []
    for value in runpy.run_path(str(path)).values():
        members = value if isinstance(value, (list, tuple)) else [value]
        found += [member for member in members if isinstance(member, Case) and member not in found]
    if not found:
        raise ParameterError(
            f"{path} holds no case: write @case(name, expected=…) from radiosity.study.stress before a function that "
            "gives within(found, true, rtol), truth(good, words) or refuses(Error, work)"
        )
    return found


def chosen(cases: Iterable[Case], words: Iterable[str]) -> list[Case]:
    """Cases whose group or name holds all the words.

    Raises
    ------
    ParameterError
        None does.
    """
    wanted = [word.lower() for word in words]
    found = [case for case in cases if all(word in f"{case.group} {case.name}".lower() for word in wanted)]
    if not found:
        raise ParameterError(f"no case has {' and '.join(map(repr, wanted))} in its name; --list shows all")
    return found


def run_cases(cases: list[Case], progress: Progress = quiet) -> list[Outcome]:
    """Run them; one that fails does not stop the others."""
    outcomes = []
    progress("cases", 0, len(cases))
    for done, case in enumerate(cases, 1):
        outcomes.append(case.run())
        progress("cases", done, len(cases))
    return outcomes
