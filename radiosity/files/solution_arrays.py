"""The arrays of a solution by name: taken apart for a file, and checked when they come back.

Kernels read these arrays without looking, so that an index out of range would end the process: every length,
type and index is checked here.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from ..errors import FileFormatError
from ..faces import Faces
from ..form_factors import FormFactors
from ..form_factors.factors import check_matrix, check_shares, row_sums
from ..patches import Grid, Patches
from . import checked
from .checked import JSON
from .npz import Archive

Arrays = dict[str, NDArray[Any]]

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


class Reader:
    """Takes arrays out of an archive and holds their lengths against each other."""

    def __init__(self, archive: Archive) -> None:
        self.archive = archive
        self.lengths: dict[str, int] = {}

    def take(self, name: str, dtype: str | tuple[str, ...], shape: str) -> NDArray[Any]:
        """An array of the expected type and shape, all of it finite."""
        array = self.archive.array(name)
        kinds = (dtype,) if isinstance(dtype, str) else dtype
        if array.dtype.str not in kinds:
            raise FileFormatError(f"{name} is of type {array.dtype.str}; expected {' or '.join(kinds)}")
        if array.ndim != len(shape):
            raise FileFormatError(f"{name} has shape {array.shape}; expected {len(shape)} axes")
        for length, letter in zip(array.shape, shape, strict=True):
            wanted = int(letter) if letter.isdigit() else self.lengths.setdefault(letter, length)
            if length != wanted:
                raise FileFormatError(f"{name} has shape {array.shape}; an axis should be {wanted} long, as elsewhere")
        if array.dtype.kind == "f" and not np.isfinite(array).all():
            raise FileFormatError(f"{name} holds values that are not finite")
        return array

    def table(self, prefix: str, table: dict[str, tuple[str, str]]) -> Arrays:
        """All arrays of a table."""
        return {name: self.take(f"{prefix}/{name}", *kind) for name, kind in table.items()}


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
    patches = Patches(
        **reader.table("patches", PATCHES), grid=grid, closed=closed, surface_names=surface_names, name=name
    )
    _check_indices(patches)
    _check_grid(patches)
    shares = (patches.reflectance, patches.absorptance)
    good = all(((share >= 0) & (share <= 1)).all() for share in shares)
    if not (good and (patches.emission >= 0).all() and (patches.sky >= 0).all() and (patches.area > 0).all()):
        raise FileFormatError("patches hold a reflectance, emission, sky or area that no surface can have")
    return patches


def _within(name: str, index: NDArray[Any], count: int, low: int = 0) -> None:
    if index.size and not (index.min() >= low and index.max() < count):
        raise FileFormatError(f"{name} reaches {index.min()} … {index.max()}; there are {count}")


def _check_indices(patches: Patches) -> None:
    surfaces = len(patches.surface_names)
    _within("patches/faces", patches.faces[:, :3], len(patches.vertices))
    _within("patches/faces", patches.faces[:, 3], len(patches.vertices), -1)
    _within("patches/surface", patches.surface, surfaces)
    _within("patches/face", patches.face, len(patches.grid.faces))
    _within("faces/surface", patches.grid.faces.surface, surfaces)
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
    matrix = factors.matrix
    yield f"{prefix}/indptr", matrix.indptr
    yield f"{prefix}/indices", matrix.indices
    yield f"{prefix}/data", matrix.data
    yield f"{prefix}/to_sky", factors.to_sky
    yield f"{prefix}/to_backs", factors.to_backs
    if factors.exact_columns is not None:
        yield f"{prefix}/exact_columns", factors.exact_columns
    for number, replicate in enumerate(factors.replicates):
        yield from factors_to_arrays(replicate, f"{prefix}/replicates/{number}")


def factors_header(factors: FormFactors) -> list[JSON]:
    """What is not an array of form factors and of their replicates, and which arrays there are."""
    return [
        {"statistics": one.statistics, "exact_columns": one.exact_columns is not None}
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
    indptr = reader.take(f"{prefix}/indptr", ("<i4", "<i8"), "P")
    reader.lengths.pop("E", None)  # each matrix has as many entries as it has
    indices = reader.take(f"{prefix}/indices", indptr.dtype.str, "E")
    data = reader.take(f"{prefix}/data", ("<f4", "<f8"), "E")
    _check_rows(prefix, indptr, indices, len(patches))
    matrix = csr_array((data, indices, indptr), shape=(len(patches), len(patches)), copy=False)
    matrix.has_sorted_indices = matrix.has_canonical_format = True
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


def _check_rows(prefix: str, indptr: NDArray[Any], indices: NDArray[Any], count: int) -> None:
    """Refuse compressed rows that are no rows: kernels would read beyond the arrays."""
    if len(indptr) != count + 1 or indptr[0] != 0 or indptr[-1] != len(indices) or (np.diff(indptr) < 0).any():
        raise FileFormatError(f"{prefix}/indptr does not divide {len(indices)} entries into {count} rows")
    _within(f"{prefix}/indices", indices, count)
    rising = np.diff(indices.astype(np.int64)) > 0
    borders = indptr[1:-1]
    rising[borders[(borders > 0) & (borders < len(indices))] - 1] = True
    if not rising.all():
        raise FileFormatError(f"{prefix}/indices are not in order of columns, near entry {int(np.argmin(rising)) + 1}")
