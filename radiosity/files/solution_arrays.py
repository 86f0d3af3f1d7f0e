"""The arrays of a solution by name: taken apart for a file, and checked when they come back.

Kernels read these arrays without looking, so that an index out of range would end the process: every length,
type and index is checked here.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import FileFormatError
from ..faces import Faces
from ..form_factors import FormFactors
from ..form_factors.factors import check_matrix, check_shares, row_sums
from ..form_factors.levels import TwoLevelFactors
from ..patches import Grid, Patches
from . import checked
from .checked import JSON
from .level_arrays import check_to_arrays, levels_from_arrays, levels_to_arrays
from .matrix_arrays import Reader, matrix_from_arrays, matrix_to_arrays, within

# Name → type and shape. Letters stand for lengths that have to agree: N patches, V vertices, C channels, F faces.
FACES = {
    "corners": ("<f8", "F43"),
    "quad": ("|b1", "F"),
    "surface": ("<i4", "F"),
    "two_sided": ("|b1", "F"),
    "normal": ("<f8", "F3"),
    "area": ("<f8", "F"),
}
GRID = {"columns": ("<i4", "F"), "rows": ("<i4", "F"), "front": ("<i4", "F"), "back": ("<i4", "F")}
PATCHES = {
    "vertices": ("<f8", "V3"),
    "faces": ("<i4", "N4"),
    "area": ("<f8", "N"),
    "normal": ("<f8", "N3"),
    "centroid": ("<f8", "N3"),
    "surface": ("<i4", "N"),
    "reflectance": ("<f8", "NC"),
    "absorptance": ("<f8", "NC"),
    "emission": ("<f8", "NC"),
    "sky": ("<f8", "C"),
    "face": ("<i4", "N"),
    "side": ("|i1", "N"),
}
RESULT = {"radiosity": ("<f8", "NC"), "orders": ("<f8", "KNC"), "history": ("<f8", "SC")}


def patches_to_arrays(patches: Patches) -> Iterator[tuple[str, NDArray[Any]]]:
    """Name and array of everything in patches that is an array."""
    for name in PATCHES:
        yield f"patches/{name}", getattr(patches, name)
    for name in GRID:
        yield f"grid/{name}", getattr(patches.grid, name)
    for name in FACES:
        yield f"faces/{name}", getattr(patches.grid.faces, name)


def patches_from_arrays(reader: Reader, closed: bool, surface_names: tuple[str, ...], name: str) -> Patches:
    """Patches of an archive, checked.

    Raises
    ------
    FileFormatError
    """
    faces = Faces(**reader.table("faces", FACES))
    grid = Grid(faces, **reader.table("grid", GRID))
    table = reader.table("patches", PATCHES)
    centroid = table.pop("centroid")
    patches = Patches(**table, grid=grid, closed=closed, surface_names=surface_names, name=name)
    _check_indices(patches)
    _check_grid(patches)
    if not np.allclose(patches.centroid, centroid, rtol=0.0, atol=1e-9 * float(np.abs(patches.vertices).max())):
        raise FileFormatError("patches/centroid does not agree with patches/vertices and patches/faces")
    shares = (patches.reflectance, patches.absorptance)
    good = all(((share >= 0) & (share <= 1)).all() for share in shares)
    if not (good and (patches.emission >= 0).all() and (patches.sky >= 0).all() and (patches.area > 0).all()):
        raise FileFormatError("patches hold a reflectance, emission, sky or area that no surface can have")
    return patches


def _check_indices(patches: Patches) -> None:
    surfaces = len(patches.surface_names)
    within("patches/faces", patches.faces[:, :3], len(patches.vertices))
    within("patches/faces", patches.faces[:, 3], len(patches.vertices), -1)
    within("patches/surface", patches.surface, surfaces)
    within("patches/face", patches.face, len(patches.grid.faces))
    within("faces/surface", patches.grid.faces.surface, surfaces)
    if not np.isin(patches.side, (-1, 1)).all():
        raise FileFormatError("patches/side holds values other than 1 and -1")


def _check_grid(patches: Patches) -> None:
    """Each face's patches are where the grid says: what kernels rely on to find a patch by arithmetic."""
    grid, count = patches.grid, len(patches)
    corners = grid.faces.corners
    if ((corners[:, 2] == corners[:, 3]).all(axis=1) == grid.faces.quad).any():
        raise FileFormatError("faces/quad and faces/corners do not agree about which faces are triangles")
    if (grid.columns < 1).any() or (grid.rows < 1).any() or (grid.columns != grid.rows)[~grid.faces.quad].any():
        raise FileFormatError("grid/columns and grid/rows do not cut the faces")
    two_sided = grid.back >= 0
    face = np.concatenate([np.arange(len(grid.cells)), np.flatnonzero(two_sided)])
    first = np.concatenate([grid.front, grid.back[two_sided]]).astype(np.int64)
    side = np.concatenate([np.ones(len(grid.cells)), -np.ones(two_sided.sum())])
    cells = grid.cells[face]
    if cells.sum() != count or (two_sided != grid.faces.two_sided).any():
        raise FileFormatError(f"the grid cuts the faces into {cells.sum()} patches; there are {count}")
    order = np.argsort(first, kind="stable")
    if not np.array_equal(first[order], np.cumsum(cells[order]) - cells[order]):
        raise FileFormatError("grid/front and grid/back do not number the patches without a gap")
    same_face = np.array_equal(patches.face, np.repeat(face[order], cells[order]))
    if not same_face or not np.array_equal(patches.side, np.repeat(side[order], cells[order])):
        raise FileFormatError("patches/face and patches/side do not agree with the grid")


def factors_to_arrays(factors: FormFactors, prefix: str = "factors") -> Iterator[tuple[str, NDArray[Any]]]:
    """Name and array of everything in form factors that is an array, replicates included."""
    if isinstance(factors, TwoLevelFactors):
        yield from levels_to_arrays(factors.levels, f"{prefix}/levels")
        if factors.check is not None:
            yield from check_to_arrays(factors.check, f"{prefix}/check")
    else:
        yield from matrix_to_arrays(factors.matrix, prefix)
    yield f"{prefix}/to_sky", factors.to_sky
    yield f"{prefix}/to_backs", factors.to_backs
    if factors.exact_columns is not None:
        yield f"{prefix}/exact_columns", factors.exact_columns
    for number, replicate in enumerate(factors.replicates):
        yield from factors_to_arrays(replicate, f"{prefix}/replicates/{number}")


def factors_header(factors: FormFactors) -> list[JSON]:
    """What is not an array of form factors and of their replicates, and which arrays there are."""
    return [
        {
            "statistics": one.statistics,
            "exact_columns": one.exact_columns is not None,
            **({"group": one.levels.side, "check": one.check is not None} if isinstance(one, TwoLevelFactors) else {}),
        }
        for one in (factors, *factors.replicates)
    ]


def factors_from_arrays(
    reader: Reader, patches: Patches, headers: list[JSON], estimator: object, prefix: str = "factors"
) -> FormFactors:
    """Form factors of an archive, checked; `headers` has an entry for them and one for each replicate.

    Raises
    ------
    FileFormatError
    """
    if "group" in headers[0]:
        return levels_from_arrays(reader, patches, headers[0], estimator, prefix)
    matrix = matrix_from_arrays(reader, prefix, len(patches), len(patches))
    to_sky, to_backs = (reader.take(f"{prefix}/{name}", "<f8", "N") for name in ("to_sky", "to_backs"))
    try:
        check_matrix(matrix, patches.area)
        check_shares(row_sums(matrix), to_sky, to_backs)
    except ValueError as error:
        raise FileFormatError(f"{prefix}: {error}") from error
    replicates = tuple(
        factors_from_arrays(reader, patches, [own], estimator, f"{prefix}/replicates/{number}")
        for number, own in enumerate(headers[1:])
    )
    exact = reader.take(f"{prefix}/exact_columns", "|b1", "N") if headers[0].get("exact_columns") else None
    return FormFactors(
        matrix,
        to_sky,
        to_backs,
        patches.area,
        patches.surface,
        patches.surface_names,
        estimator,
        checked.mapping(headers[0], "statistics", prefix),
        replicates,
        exact,
    )
