"""Mistakes in a lecture's file, named with their line instead of a traceback."""

from __future__ import annotations

import inspect
import traceback
from collections.abc import Callable
from typing import Any, TypeVar

from ..errors import ParameterError, RadiosityError

T = TypeVar("T")


def blamed(file: str, run: Callable[[], T]) -> T:
    """What `run` returns; what goes wrong in it is said of a line of `file`.

    Errors that this package raises in the middle of a solve speak for themselves.

    Raises
    ------
    ParameterError
    """
    try:
        return run()
    except (OSError, MemoryError):
        raise
    except Exception as error:
        line = last_line(error, file)
        if line is None and isinstance(error, RadiosityError):
            raise
        where = f"{file}, line {line or '?'}"
        raise ParameterError(f"{where}: {type(error).__name__}: {error}") from error


def asked(function: Callable[..., T], *values: Any, **named: Any) -> T:
    """What a function of a lecture's file returns."""
    code = getattr(inspect.unwrap(function), "__code__", None)
    file = code.co_filename if code is not None else repr(function)
    return blamed(file, lambda: function(*values, **named))


def last_line(error: Exception, file: str) -> int | None:
    """The last line of a file that an error went through."""
    if isinstance(error, SyntaxError) and error.filename == file:
        return error.lineno
    lines = [frame.lineno for frame in traceback.extract_tb(error.__traceback__) if frame.filename == file]
    return lines[-1] if lines else None
