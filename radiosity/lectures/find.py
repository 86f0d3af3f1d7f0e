"""Which lectures there are: those of the package by name, a teacher's own by file."""

from __future__ import annotations

import importlib
import pkgutil
from pathlib import Path
from types import ModuleType

from ..errors import ParameterError
from .blame import blamed
from .lecture import Lecture

PACKAGE = __package__ or "radiosity.lectures"
NOT_LECTURES = ("blame", "find", "lecture", "light", "page", "plots", "runner", "talk", "window")
ORDER = (
    "equation", "dome", "cornell", "rug", "series", "hemicube", "noise", "pinhole", "shortcuts", "daylight",
)  # fmt: skip


def names() -> list[str]:
    """The lectures that come with the package, in the order of a course."""
    package = importlib.import_module(PACKAGE)
    found = {module.name for module in pkgutil.iter_modules(package.__path__)} - set(NOT_LECTURES)
    return [name for name in ORDER if name in found] + sorted(found - set(ORDER))


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
        No such lecture, or a file without one, or with a mistake in it; the message has its line.
    """
    if name in names():
        module = importlib.import_module(f"{PACKAGE}.{name}")
    elif name.endswith(".py") and Path(name).is_file():
        module = own(Path(name))
    else:
        raise ParameterError(f"there is no lecture {name!r}; there are {', '.join(names())}, or give a file FILE.py")
    lecture = getattr(module, "LECTURE", None)
    if not isinstance(lecture, Lecture):
        raise ParameterError(f"{name} holds no lecture; set LECTURE = Lecture(…) in it")
    return lecture


def own(path: Path) -> ModuleType:
    """A teacher's file, run. It counts as one of the package's, so that what is copied from there works as it is."""
    module = ModuleType(f"{PACKAGE}.{path.stem}")
    module.__file__, module.__package__ = str(path), PACKAGE
    text = path.read_text(encoding="utf-8")
    blamed(str(path), lambda: exec(compile(text, str(path), "exec"), module.__dict__))
    return module
