"""Arrays and sparse matrices of an archive, checked when they come back."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from ..errors import FileFormatError
from .npz import Archive

Arrays = dict[str, NDArray[Any]]


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


def within(name: str, index: NDArray[Any], count: int, low: int = 0) -> None:
    """Refuse numbers outside low … count - 1.

    Raises
    ------
    FileFormatError
    """
    if index.size and not (index.min() >= low and index.max() < count):
        raise FileFormatError(f"{name} reaches {index.min()} … {index.max()}; there are {count}")


def matrix_to_arrays(matrix: csr_array, prefix: str) -> Iterator[tuple[str, NDArray[Any]]]:
    """Name and array of what a compressed matrix is made of."""
    yield f"{prefix}/indptr", matrix.indptr
    yield f"{prefix}/indices", matrix.indices
    yield f"{prefix}/data", matrix.data


def matrix_from_arrays(reader: Reader, prefix: str, rows: int, columns: int) -> csr_array:
    """A compressed matrix (rows, columns), sorted, that kernels can read without looking.

    Raises
    ------
    FileFormatError
        Pointers or columns that are none: kernels would read beyond the arrays.
    """
    reader.lengths.pop("P", None)  # each matrix has as many rows and entries as it has
    reader.lengths.pop("E", None)
    indptr = reader.take(f"{prefix}/indptr", ("<i4", "<i8"), "P")
    indices = reader.take(f"{prefix}/indices", indptr.dtype.str, "E")
    data = reader.take(f"{prefix}/data", ("<f4", "<f8"), "E")
    _check_rows(prefix, indptr, indices, rows, columns)
    matrix = csr_array((data, indices, indptr), shape=(rows, columns), copy=False)
    matrix.has_sorted_indices = matrix.has_canonical_format = True
    return matrix


def _check_rows(prefix: str, indptr: NDArray[Any], indices: NDArray[Any], rows: int, columns: int) -> None:
    """Refuse compressed rows that are no rows."""
    if len(indptr) != rows + 1 or indptr[0] != 0 or indptr[-1] != len(indices) or (np.diff(indptr) < 0).any():
        raise FileFormatError(f"{prefix}/indptr does not divide {len(indices)} entries into {rows} rows")
    within(f"{prefix}/indices", indices, columns)
    rising = np.diff(indices.astype(np.int64)) > 0
    borders = indptr[1:-1]
    rising[borders[(borders > 0) & (borders < len(indices))] - 1] = True
    if not rising.all():
        raise FileFormatError(f"{prefix}/indices are not in order of columns, near entry {int(np.argmin(rising)) + 1}")
