"""Text of files that nobody has checked: lines in UTF-8, and numbers that are nothing else."""

from __future__ import annotations

import math

from ..errors import FileFormatError

REPLACED = "\N{REPLACEMENT CHARACTER}"


def text_lines(content: bytes, comment: str = "#") -> list[str]:
    """Lines without their comments, which may be in any encoding; the rest is UTF-8.

    Raises
    ------
    FileFormatError
        Bytes that are no text, with their line.
    """
    lines = content.decode("utf-8-sig", errors="replace").splitlines()
    for number, line in enumerate(lines, start=1):
        if comment in line:
            lines[number - 1] = line = line[: line.index(comment)]
        if REPLACED in line or "\0" in line:
            raise FileFormatError(
                f"line {number} is not UTF-8 text ({line[:30]!r}): damaged, or save it as UTF-8 where it was made"
            )
    return lines


def real(word: str) -> float:
    """A finite number.

    Raises
    ------
    ValueError
        Anything else, Python's own ``1_000`` included.
    """
    value = float(word)
    if not math.isfinite(value) or not _plain(word):
        raise ValueError(f"{word!r} is not a finite number")
    return value


def whole(word: str) -> int:
    """A whole number.

    Raises
    ------
    ValueError
        Anything else, Python's own ``1_000`` included.
    """
    if not _plain(word) or len(word) > 20:  # no file has as much of anything
        raise ValueError(f"{word[:30]!r} is not a whole number")
    return int(word)


def _plain(word: str) -> bool:
    return word.isascii() and "_" not in word
