"""Rows of form factors from counted or weighted hits, straight into compressed form."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterable
from typing import Any, NamedTuple

import numba
import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from ..rays import MISS

FloatArray = NDArray[np.float64]

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
    weights: NDArray[np.int32] | FloatArray
    to_sky: NDArray[np.int64] | FloatArray
    to_backs: NDArray[np.int64] | FloatArray
    shadow_rays: int = 0


class Rows(NamedTuple):
    """A finished matrix with the shares beside it, and the columns (N,) that were not sampled, if any."""

    matrix: csr_array
    to_sky: FloatArray
    to_backs: FloatArray
    shadow_rays: int = 0
    exact_columns: NDArray[np.bool_] | None = None


def stack_rows(
    blocks: Iterable[RowBlock],
    count: int,
    most: int,
    divisor: float,
    dtype: type[np.float32] | type[np.float64],
    done: Callable[[int], None] | None = None,
) -> Rows:
    """Put row blocks, which come in order, into one CSR matrix.

    Room for the most entries there can be is reserved, written once and cut to size, so that the peak is
    the matrix itself and one block (the system hands out pages as they are first written).

    Parameters
    ----------
    blocks : iterable of RowBlock
    count : int
        Rows and columns N.
    most : int
        Upper bound of the entries.
    divisor : float
        Weights and shares are divided by this (the rays, where they are counts).
    dtype : float32 or float64
    done : callable, optional
        Told how many rows are ready.
    """
    indptr = np.zeros(count + 1, dtype=np.int64)
    indices = np.empty(most, dtype=np.int32)
    data = np.empty(most, dtype=dtype)
    to_sky, to_backs = np.empty(count), np.empty(count)
    filled = shadow_rays = 0
    for block in blocks:
        rows = slice(block.begin, block.begin + len(block.lengths))
        entries = slice(filled, filled + len(block.indices))
        indptr[rows.start + 1 : rows.stop + 1] = filled + np.cumsum(block.lengths)
        indices[entries] = block.indices
        np.divide(block.weights, divisor, out=data[entries], casting="unsafe")
        to_sky[rows] = block.to_sky / divisor
        to_backs[rows] = block.to_backs / divisor
        filled = entries.stop
        shadow_rays += block.shadow_rays
        if done is not None:
            done(rows.stop)
    indices.resize(filled, refcheck=False)
    data.resize(filled, refcheck=False)
    index_type = np.int32 if filled < np.iinfo(np.int32).max else np.int64
    matrix = csr_array(
        (data, indices.astype(index_type, copy=False), indptr.astype(index_type)), shape=(count, count), copy=False
    )
    matrix.has_sorted_indices = True
    matrix.has_canonical_format = True
    return Rows(matrix, to_sky, to_backs, shadow_rays)


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
