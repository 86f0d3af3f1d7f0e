"""Rows of form factors from counted or weighted hits, straight into compressed form."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import Any, NamedTuple, Protocol

import numba
import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from ..rays import MISS

FloatArray = NDArray[np.float64]
Float = type[np.float32] | type[np.float64]

MEAN_ENTRIES = 1 << 20  # of a mean that are summed at a time
ROOM = 1.02  # taken for entries still to come, over what the rows so far foretell
ONE = np.uint64(1)
DE_BRUIJN = np.uint64(0x03F79D71B4CB0A89)  # its 64 runs of six bits are all different
BIT_OF = np.zeros(64, dtype=np.int64)
BIT_OF[[((0x03F79D71B4CB0A89 << bit) & (2**64 - 1)) >> 58 for bit in range(64)]] = np.arange(64)


class RowBlock(NamedTuple):
    """Rows begin … end of a matrix under way.

    lengths (rows,) entries in each row; indices, weights (Σ lengths,) in order of columns; to_sky and to_backs
    (rows,). Weights and shares are hits (int) or already shares (float). shadow_rays were traced beside those counted.
    """

    begin: int
    lengths: NDArray[np.int64]
    indices: NDArray[np.int32]
    weights: NDArray[np.int32] | NDArray[np.floating[Any]]
    to_sky: NDArray[np.int64] | FloatArray
    to_backs: NDArray[np.int64] | FloatArray
    shadow_rays: int = 0

    @property
    def end(self) -> int:
        """The row after the last one."""
        return self.begin + len(self.lengths)

    def finished(self, divisor: float, dtype: Float) -> RowBlock:
        """Shares of the final type, from weights and shares that have still to be divided (by the rays, say)."""
        weights = np.empty(len(self.weights), dtype=dtype)
        np.divide(self.weights, divisor, out=weights, casting="unsafe")
        return self._replace(weights=weights, to_sky=self.to_sky / divisor, to_backs=self.to_backs / divisor)


ARRAYS = RowBlock._fields[1:6]


class RowMaker(Protocol):
    """What makes the rows of one estimate. Rows must not depend on which others are made with them, or before.

    Attributes
    ----------
    rows_at_once : int
        Rows whose rays and hits fit the processor's caches.
    most : int
        Entries of a row, at most.
    divisor : float
        What weights and shares have still to be divided by.
    exact_columns : ndarray of bool (N,) or None
        Columns that are not sampled.
    """

    rows_at_once: int
    most: int
    divisor: float
    exact_columns: NDArray[np.bool_] | None

    def __call__(self, span: tuple[int, int]) -> RowBlock:
        """Make the rows begin … end."""
        ...


class Rows(NamedTuple):
    """A finished matrix with the shares beside it, and the columns (N,) that were not sampled, if any."""

    matrix: csr_array
    to_sky: FloatArray
    to_backs: FloatArray
    shadow_rays: int = 0
    exact_columns: NDArray[np.bool_] | None = None


def joined(blocks: Sequence[RowBlock]) -> RowBlock:
    """One block of several that follow each other."""
    if len(blocks) == 1:
        return blocks[0]
    arrays = {name: np.concatenate([getattr(block, name) for block in blocks]) for name in ARRAYS}
    return RowBlock(blocks[0].begin, **arrays, shadow_rays=sum(block.shadow_rays for block in blocks))


def stack_rows(
    blocks: Iterable[RowBlock],
    count: int,
    dtype: Float,
    done: Callable[[int], None] | None = None,
    columns: int | None = None,
) -> Rows:
    """Put finished row blocks, which come in order, into one CSR matrix.

    Room is taken as the blocks so far foretell and grows where they err, so that the peak is the matrix itself and one
    block: the system moves large arrays without a copy, and hands out pages as they are first written.

    Parameters
    ----------
    blocks : iterable of RowBlock
    count : int
        Rows N.
    dtype : float32 or float64
    done : callable, optional
        Told how many rows are ready.
    columns : int, optional
        As many as rows by default.
    """
    indptr = np.zeros(count + 1, dtype=np.int64)
    indices, data = np.empty(0, dtype=np.int32), np.empty(0, dtype=dtype)
    to_sky, to_backs = np.empty(count), np.empty(count)
    filled = shadow_rays = 0
    for block in blocks:
        rows, entries = slice(block.begin, block.end), slice(filled, filled + len(block.indices))
        if entries.stop > len(indices):
            room = max(entries.stop, int(ROOM * entries.stop / block.end * count))
            indices, data = _with_room(indices, room), _with_room(data, room)
        indptr[rows.start + 1 : rows.stop + 1] = filled + np.cumsum(block.lengths)
        indices[entries], data[entries] = block.indices, block.weights
        to_sky[rows], to_backs[rows] = block.to_sky, block.to_backs
        filled = entries.stop
        shadow_rays += block.shadow_rays
        if done is not None:
            done(rows.stop)
    indices.resize(filled, refcheck=False)
    data.resize(filled, refcheck=False)
    shape = count, count if columns is None else columns
    return Rows(compressed(indptr, indices, data, shape), to_sky, to_backs, shadow_rays)


def mean_rows(runs: Sequence[Rows], dtype: Float, done: Callable[[int], None] | None = None) -> Rows:
    """Mean of independent estimates, rounded once; block by block, so that nothing but the mean itself is added."""
    count, columns = runs[0].matrix.shape

    def blocks() -> Iterator[RowBlock]:
        per_row = max(1, sum(run.matrix.nnz for run in runs) // count)
        for begin in range(0, count, max(1, MEAN_ENTRIES // per_row)):
            total = sum(run.matrix[begin : begin + max(1, MEAN_ENTRIES // per_row)].astype(np.float64) for run in runs)
            weights = (total.data / len(runs)).astype(dtype)
            rows = slice(begin, begin + total.shape[0])
            yield RowBlock(begin, np.diff(total.indptr), total.indices, weights, to_sky[rows], to_backs[rows])

    to_sky, to_backs = (np.mean([getattr(run, name) for run in runs], axis=0) for name in ("to_sky", "to_backs"))
    rows = stack_rows(blocks(), count, dtype, done, columns)
    return rows._replace(shadow_rays=sum(run.shadow_rays for run in runs), exact_columns=runs[0].exact_columns)


def _with_room(array: NDArray[Any], size: int) -> NDArray[Any]:
    """An array with room for more; new room at the first time, which costs nothing before it is written."""
    if not len(array):
        return np.empty(size, dtype=array.dtype)
    array.resize(size, refcheck=False)
    return array


def compressed(
    indptr: NDArray[np.int64], indices: NDArray[np.int32], data: NDArray[Any], shape: tuple[int, int]
) -> csr_array:
    """A `csr_array` of rows in order of columns, without copying what is large. Both index arrays need one type."""
    index_type = np.int32 if len(indices) < np.iinfo(np.int32).max else np.int64
    matrix = csr_array(
        (data, indices.astype(index_type, copy=False), indptr.astype(index_type)), shape=shape, copy=False
    )
    matrix.has_sorted_indices = True
    matrix.has_canonical_format = True
    return matrix


class _Room(threading.local):
    """Where a thread counts: hits of N patches, a bit for each that was hit, one for every 64 of those; all zero."""

    tally = np.empty(0, dtype=np.int32)

    def of(self, count: int) -> tuple[NDArray[np.int32], NDArray[np.uint64], NDArray[np.uint64]]:
        """Arrays for `count` patches, kept from one block to the next: touching new memory costs more than counting."""
        if len(self.tally) != count:
            self.tally = np.zeros(count, dtype=np.int32)
            self.marks = np.zeros((count >> 6) + 1, dtype=np.uint64)
            self.groups = np.zeros((count >> 12) + 1, dtype=np.uint64)
        return self.tally, self.marks, self.groups


_room = _Room()


def count_hits(hits: NDArray[np.int32], rows: int, count: int) -> Any:
    """Hits (rows × rays,) of one block to row lengths, sorted columns, counts, and counts to sky and backs."""
    return _count_hits(hits, rows, *_room.of(count))


@numba.njit(nogil=True, cache=True)
def _count_hits(hits, rows, tally, marks, groups):  # type: ignore[no-untyped-def]
    """`count_hits`. The bits give the columns in order without a sort; what was written is zero again at the end."""
    rays = hits.shape[0] // rows
    lengths = np.empty(rows, dtype=np.int64)
    indices = np.empty(hits.shape[0], dtype=np.int32)
    counts = np.empty(hits.shape[0], dtype=np.int32)
    to_sky = np.zeros(rows, dtype=np.int64)
    to_backs = np.zeros(rows, dtype=np.int64)
    filled = 0
    for k in range(rows):
        begin = filled
        for r in range(k * rays, (k + 1) * rays):
            j = hits[r]
            if j >= 0:
                tally[j] += 1
                marks[j >> 6] |= ONE << np.uint64(j & 63)
                groups[j >> 12] |= ONE << np.uint64((j >> 6) & 63)
            elif j == MISS:
                to_sky[k] += 1
            else:
                to_backs[k] += 1
        for g in range(groups.shape[0]):
            while groups[g] != 0:
                w = (g << 6) + _lowest_bit(groups[g])
                groups[g] &= groups[g] - ONE
                while marks[w] != 0:
                    j = (w << 6) + _lowest_bit(marks[w])
                    marks[w] &= marks[w] - ONE
                    indices[filled], counts[filled] = j, tally[j]
                    tally[j] = 0
                    filled += 1
        lengths[k] = filled - begin
    return lengths, indices[:filled].copy(), counts[:filled].copy(), to_sky, to_backs


@numba.njit(nogil=True, cache=True, inline="always")
def _lowest_bit(word):  # type: ignore[no-untyped-def]
    """Number of the lowest bit that is set, by a de Bruijn sequence (Leiserson, Prokop & Randall 1998)."""
    return BIT_OF[((word & (~word + ONE)) * DE_BRUIJN) >> np.uint64(58)]
