"""Solutions out, by suffix, and back in."""

from __future__ import annotations

import os
from pathlib import Path

from ..errors import FileFormatError, RadiosityError
from ..solution import Solution
from .solution_npz import read_npz, write_npz
from .vtp import write_vtp

WRITERS = {".npz": write_npz, ".vtp": write_vtp}
"""Writer of each suffix; pictures are the viewer's."""


def write_solution(solution: Solution, path: str | os.PathLike[str]) -> None:
    """Write a solution as .npz (everything, for `read_solution`) or .vtp (all orders on the patches).

    The file is written whole or not at all.

    Parameters
    ----------
    solution : Solution
    path : path

    Raises
    ------
    FileFormatError
        Another suffix.
    MissingFileError
        The folder is not there.
    """
    file = Path(path)
    if file.suffix.lower() not in WRITERS:
        raise FileFormatError(f"{file}: solutions are not written as {file.suffix!r}; choose {' or '.join(WRITERS)}")
    WRITERS[file.suffix.lower()](solution, file)


def read_solution(path: str | os.PathLike[str]) -> Solution:
    """Read a solution that was saved as .npz, with everything that belongs to it.

    Parameters
    ----------
    path : path

    Returns
    -------
    Solution
        The same to the last bit.

    Raises
    ------
    MissingFileError
        There is no such file.
    FileFormatError
        It is no solution, it is damaged, or a newer radiosity has written it.

    Warns
    -----
    RadiosityWarning
        It was made by an estimator or solver that is not part of this package.
    """
    file = Path(path)
    if file.suffix.lower() != ".npz":
        raise FileFormatError(f"{file}: solutions are read from .npz, not from {file.suffix!r}")
    try:
        return read_npz(file)
    except RadiosityError as error:
        raise type(error)(f"{file}: {error}") from error
