"""Rows of form factors from counted or weighted hits, straight into compressed form."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterable, Sequence
from functools import reduce
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from ..compiled import kernel
from ..parallel import blocks, ordered_map
from ..rays import MISS

FloatArray = NDArray[np.float64]
Float = type[np.float32] | type[np.float64]

MEAN_ENTRIES = 1 << 18  # of all estimates, that are added at a time
FIRST_ROOM = 1.5  # taken at first, over what the first rows foretell: pages that are never written cost nothing
MORE_ROOM = 1.05  # and where that was too little: numpy writes zeros into what it adds
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


def joined(parts: Sequence[RowBlock]) -> RowBlock:
    """One block of several that follow each other."""
    if len(parts) == 1:
        return parts[0]
    arrays = {name: np.concatenate([getattr(part, name) for part in parts]) for name in ARRAYS}
    return RowBlock(parts[0].begin, **arrays, shadow_rays=sum(part.shadow_rays for part in parts))


def stack_rows(
    made: Iterable[RowBlock],
    count: int,
    dtype: Float,
    done: Callable[[int], None] | None = None,
    columns: int | None = None,
    most: int | None = None,
) -> Rows:
    """Put finished row blocks, which come in order, into one CSR matrix.

    Room is taken as the blocks so far foretell and grows where they err, so that the peak is the matrix itself and one
    block: the system moves large arrays without a copy, and hands out pages as they are first written.

    Parameters
    ----------
    made : iterable of RowBlock
    count : int
        Rows N.
    dtype : float32 or float64
    done : callable, optional
        Told how many rows are ready.
    columns : int, optional
        As many as rows by default.
    most : int, optional
        Entries in all, at most; to be given where the first rows are longer than others.
    """
    lengths = np.zeros(count, dtype=np.int32)
    indices, data = np.empty(0, dtype=np.int32), np.empty(0, dtype=dtype)
    to_sky, to_backs = np.zeros(count), np.zeros(count)
    filled = shadow_rays = 0
    for block in made:
        rows, entries = slice(block.begin, block.end), slice(filled, filled + len(block.indices))
        if entries.stop > len(indices):
            factor = MORE_ROOM if len(indices) else FIRST_ROOM
            foretold = int(factor * entries.stop / block.end * count)
            room = max(entries.stop, foretold if most is None else min(foretold, most))
            indices, data = _with_room(indices, room), _with_room(data, room)
        lengths[rows] = block.lengths
        indices[entries], data[entries] = block.indices, block.weights
        for shares, found in ((to_sky, block.to_sky), (to_backs, block.to_backs)):
            if found.any():  # zeros that nobody writes take no memory
                shares[rows] = found
        filled = entries.stop
        shadow_rays += block.shadow_rays
        if done is not None:
            done(rows.stop)
    indices.resize(filled, refcheck=False)
    data.resize(filled, refcheck=False)
    shape = count, count if columns is None else columns
    return Rows(compressed(lengths, indices, data, shape), to_sky, to_backs, shadow_rays)


def mean_rows(runs: Sequence[Rows], dtype: Float, threads: int | None = None) -> Rows:
    """Mean of independent estimates, added in their order and rounded once.

    Block by block, so that nothing but the mean itself is added to the memory that they take.
    """
    count, columns = runs[0].matrix.shape
    to_sky, to_backs = (np.mean([getattr(run, name) for run in runs], axis=0) for name in ("to_sky", "to_backs"))
    per_row = max(1, sum(run.matrix.nnz for run in runs) // count)

    def mean(span: tuple[int, int]) -> RowBlock:
        parts = [(run.matrix.indptr[span[0] : span[1] + 1], run.matrix.indices, run.matrix.data) for run in runs]
        indptr, indices, total = reduce(lambda one, other: _sum_of_rows(*one, *other), parts)
        weights, rows = (total / len(runs)).astype(dtype), slice(*span)
        return RowBlock(span[0], np.diff(indptr), indices, weights, to_sky[rows], to_backs[rows])

    made = ordered_map(mean, blocks(count, max(1, MEAN_ENTRIES // per_row)), threads)
    rows = stack_rows(made, count, dtype, columns=columns)
    return rows._replace(shadow_rays=sum(run.shadow_rays for run in runs), exact_columns=runs[0].exact_columns)


@kernel
def _sum_of_rows(indptr, indices, weights, other_indptr, other_indices, other_weights):  # type: ignore[no-untyped-def]
    """Sum of the same rows of two matrices, in order of columns, as indptr, indices and float64 weights."""
    rows = indptr.shape[0] - 1
    most = indptr[rows] - indptr[0] + other_indptr[rows] - other_indptr[0]
    out_indptr = np.zeros(rows + 1, dtype=np.int64)
    out_indices, out_weights = np.empty(most, dtype=np.int32), np.empty(most)
    filled = 0
    for k in range(rows):
        p, end, q, other_end = indptr[k], indptr[k + 1], other_indptr[k], other_indptr[k + 1]
        while p < end or q < other_end:
            j = indices[p] if p < end else other_indices[q]
            if q < other_end and other_indices[q] < j:
                j = other_indices[q]
            total = 0.0
            if p < end and indices[p] == j:
                total += np.float64(weights[p])
                p += 1
            if q < other_end and other_indices[q] == j:
                total += np.float64(other_weights[q])
                q += 1
            out_indices[filled], out_weights[filled] = j, total
            filled += 1
        out_indptr[k + 1] = filled
    return out_indptr, out_indices[:filled], out_weights[:filled]


def _with_room(array: NDArray[Any], size: int) -> NDArray[Any]:
    """An array with room for more; new room at the first time, which costs nothing before it is written."""
    if not len(array):
        return np.empty(size, dtype=array.dtype)
    array.resize(size, refcheck=False)
    return array


def compressed(
    lengths: NDArray[np.int32], indices: NDArray[np.int32], data: NDArray[Any], shape: tuple[int, int]
) -> csr_array:
    """A `csr_array` of rows in order of columns, without copying what is large. Both index arrays need one type."""
    index_type = np.int32 if len(indices) < np.iinfo(np.int32).max else np.int64
    indptr = np.zeros(len(lengths) + 1, dtype=index_type)
    np.cumsum(lengths, out=indptr[1:])
    matrix = csr_array((data, indices.astype(index_type, copy=False), indptr), shape=shape, copy=False)
    matrix.has_sorted_indices = True
    matrix.has_canonical_format = True
    return matrix


class _Room(threading.local):
    """Where a thread counts, all zero between blocks.

    Further hits of N patches; a bit for each that was hit; for each that was hit again; for every 64 of the first.
    """

    tally = np.empty(0, dtype=np.int32)

    def of(self, count: int) -> tuple[NDArray[np.int32], *tuple[NDArray[np.uint64], ...]]:
        """Arrays for `count` patches, kept from one block to the next: touching new memory costs more than counting."""
        if len(self.tally) != count:
            self.tally = np.zeros(count, dtype=np.int32)
            self.marks, self.again = np.zeros((2, (count >> 6) + 1), dtype=np.uint64)
            self.groups = np.zeros((count >> 12) + 1, dtype=np.uint64)
        return self.tally, self.marks, self.again, self.groups


_room = _Room()


def count_hits(hits: NDArray[np.int32], rows: int, count: int) -> Any:
    """Hits (rows × rays,) of one block to row lengths, sorted columns, counts, and counts to sky and backs."""
    return _count_hits(hits, rows, *_room.of(count))


@kernel
def _count_hits(hits, rows, tally, marks, again, groups):  # type: ignore[no-untyped-def]
    """`count_hits`. The bits give the columns in order without a sort; what was written is zero again at the end.

    Bits stay in cache where a number for each patch would not, so numbers are for patches that are hit again.
    """
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
                w, bit = j >> 6, ONE << np.uint64(j & 63)
                if marks[w] & bit:
                    tally[j] += 1
                    again[w] |= bit
                else:
                    marks[w] |= bit
                    groups[j >> 12] |= ONE << np.uint64(w & 63)
            elif j == MISS:
                to_sky[k] += 1
            else:
                to_backs[k] += 1
        for g in range(groups.shape[0]):
            while groups[g] != 0:
                w = (g << 6) + _lowest_bit(groups[g])
                groups[g] &= groups[g] - ONE
                repeated = again[w]
                again[w] = 0
                while marks[w] != 0:
                    b = _lowest_bit(marks[w])
                    j = (w << 6) + b
                    marks[w] &= marks[w] - ONE
                    indices[filled], counts[filled] = j, 1
                    if (repeated >> np.uint64(b)) & ONE:
                        counts[filled] += tally[j]
                        tally[j] = 0
                    filled += 1
        lengths[k] = filled - begin
    return lengths, indices[:filled].copy(), counts[:filled].copy(), to_sky, to_backs


@kernel(inline="always")
def _lowest_bit(word):  # type: ignore[no-untyped-def]
    """Number of the lowest bit that is set, by a de Bruijn sequence (Leiserson, Prokop & Randall 1998)."""
    return BIT_OF[((word & (~word + ONE)) * DE_BRUIJN) >> np.uint64(58)]
