"""What makes two assemblies of form factors the same, to the last bit."""

from __future__ import annotations

import dataclasses
import hashlib
from importlib import metadata
from typing import TYPE_CHECKING, Any

import numpy as np

from .._version import __version__
from ..patches import Patches
from .assembly import Float

if TYPE_CHECKING:
    from .estimate import Estimator

LAYOUT = 2  # of rows; another one when rows of the same parameters come to be made in another way
LIBRARIES = ("embreex", "numba", "numpy", "scipy")  # another version may round another way


def fingerprint(patches: Patches, estimator: Estimator, dtype: Float) -> str:
    """A hash of all that rows of form factors depend on, 64 hexadecimal digits.

    That is shapes, which patches emit (not how strongly), the estimator, the type of the weights, and the versions of
    what computes them. Not the number of threads or workers, nor the materials.
    """
    digest = hashlib.sha256()
    words = [__version__, str(LAYOUT), np.dtype(dtype).name, repr(estimator), str(patches.closed)]
    digest.update("\n".join([*words, *map(metadata.version, LIBRARIES)]).encode())
    lit = (patches.emission > 0).any(axis=1)
    grid, faces = patches.grid, patches.grid.faces
    of_faces = [getattr(faces, field.name) for field in dataclasses.fields(faces)]
    of_grid = [grid.columns, grid.rows, grid.front, grid.back]
    for array in (*of_faces, *of_grid, patches.vertices, patches.faces, patches.area, patches.face, patches.side, lit):
        _add(digest, np.asarray(array))
    return digest.hexdigest()


def _add(digest: Any, array: np.ndarray[Any, Any]) -> None:
    digest.update(f"\n{array.dtype.str}{array.shape}\n".encode())
    digest.update(np.ascontiguousarray(array).data)
