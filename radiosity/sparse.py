"""Compressed rows times several columns at once.

``scipy``'s product of a float32 matrix sums in float32 (0.9 % off over a million terms) and goes through the
matrix once per column. Here sums are float64 whatever the weights are, rows are shared over threads, and
each row is summed from left to right, so the bits do not depend on the number of threads.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from .compiled import kernel
from .parallel import blocks, ordered_map
from .prefetch import far_rows_times_columns, far_rows_times_differences

FloatArray = NDArray[np.float64]

BAND_BYTES = 1 << 20  # of light that is gone through at a time, where there are many columns
FAR_BYTES = 1 << 22  # of light above which its places are asked for ahead; below, that costs more than it saves
PANEL = 64  # columns that are summed together, eight vectors of eight, where there are as many
BLOCK_NONZEROS = 1 << 19  # ≈ 1 ms of work: enough blocks to share out, few enough to hand around


@kernel
def _rows_times_columns(indptr, indices, weights, columns, begin, end, out):  # type: ignore[no-untyped-def]
    width = columns.shape[1]
    flat = columns.reshape(-1)
    for i in range(begin, end):
        if width == 3:  # RGB: sums stay in registers, and unsigned places need no test for a negative one
            r = g = b = 0.0
            for p in range(indptr[i], indptr[i + 1]):
                j = np.uint64(3) * np.uint64(indices[p])
                w = np.float64(weights[p])
                r += w * flat[j]
                g += w * flat[j + np.uint64(1)]
                b += w * flat[j + np.uint64(2)]
            out[i, 0] = r
            out[i, 1] = g
            out[i, 2] = b
        elif width == 1:
            s = 0.0
            for p in range(indptr[i], indptr[i + 1]):
                s += np.float64(weights[p]) * columns[indices[p], 0]
            out[i, 0] = s


@kernel
def _rows_times_many(indptr, indices, weights, columns, band, begin, end, out):  # type: ignore[no-untyped-def]
    """Many columns, e.g. many emissions.

    The light of `band` patches at a time stays in cache for all rows, and four entries are taken at once; each row is
    still added from left to right.
    """
    width = columns.shape[1]
    out[begin:end] = 0.0
    place = indptr[begin : end + 1].copy()
    for limit in range(band, columns.shape[0] + band, band):
        for i in range(begin, end):
            total = out[i]
            p, last = place[i - begin], indptr[i + 1]
            while p + 3 < last and indices[p + 3] < limit:
                x0, x1 = columns[indices[p]], columns[indices[p + 1]]
                x2, x3 = columns[indices[p + 2]], columns[indices[p + 3]]
                w0, w1 = np.float64(weights[p]), np.float64(weights[p + 1])
                w2, w3 = np.float64(weights[p + 2]), np.float64(weights[p + 3])
                for c in range(width):
                    total[c] = (((total[c] + w0 * x0[c]) + w1 * x1[c]) + w2 * x2[c]) + w3 * x3[c]
                p += 4
            while p < last and indices[p] < limit:
                x0, w0 = columns[indices[p]], np.float64(weights[p])
                for c in range(width):
                    total[c] += w0 * x0[c]
                p += 1
            place[i - begin] = p


@kernel
def _rows_times_panel(indptr, indices, weights, flat, first, band, begin, end, out):  # type: ignore[no-untyped-def]
    """`PANEL` of many columns, those of `out` from `first` on, in the same order.

    Their number is known when this is compiled, so that each entry is multiplied by whole vectors of light.
    """
    place = indptr[begin : end + 1].copy()
    width = np.uint64(PANEL)
    for limit in range(band, len(flat) // PANEL + band, band):
        for i in range(begin, end):
            total = out[i, first : first + PANEL]
            if limit == band:
                total[:] = 0.0
            p, last = place[i - begin], indptr[i + 1]
            while p + 3 < last and indices[p + 3] < limit:
                j0, w0 = width * np.uint64(indices[p]), np.float64(weights[p])
                j1, w1 = width * np.uint64(indices[p + 1]), np.float64(weights[p + 1])
                j2, w2 = width * np.uint64(indices[p + 2]), np.float64(weights[p + 2])
                j3, w3 = width * np.uint64(indices[p + 3]), np.float64(weights[p + 3])
                for column in range(PANEL):
                    c = np.uint64(column)
                    some = ((total[c] + w0 * flat[j0 + c]) + w1 * flat[j1 + c]) + w2 * flat[j2 + c]
                    total[c] = some + w3 * flat[j3 + c]
                p += 4
            while p < last and indices[p] < limit:
                j0, w0 = width * np.uint64(indices[p]), np.float64(weights[p])
                for column in range(PANEL):
                    c = np.uint64(column)
                    total[c] += w0 * flat[j0 + c]
                p += 1
            place[i - begin] = p


@kernel
def _rows_times_differences(indptr, indices, weights, own, x, y, with_y, begin, end, out):  # type: ignore[no-untyped-def]
    width = x.shape[1]
    one, two, three = np.uint64(1), np.uint64(2), np.uint64(3)
    flat, flat_y = x.reshape(-1), y.reshape(-1)
    for i in range(begin, end):
        if width == 3:
            r = g = b = 0.0
            r0, g0, b0 = own[i, 0], own[i, 1], own[i, 2]
            for p in range(indptr[i], indptr[i + 1]):
                j, w = three * np.uint64(indices[p]), np.float64(weights[p])
                if with_y:
                    r += w * ((r0 - flat[j]) + flat_y[j])
                    g += w * ((g0 - flat[j + one]) + flat_y[j + one])
                    b += w * ((b0 - flat[j + two]) + flat_y[j + two])
                else:
                    r += w * (r0 - flat[j])
                    g += w * (g0 - flat[j + one])
                    b += w * (b0 - flat[j + two])
            out[i, 0], out[i, 1], out[i, 2] = r, g, b
        else:
            total, here = out[i], own[i]
            total[:] = 0.0
            for p in range(indptr[i], indptr[i + 1]):
                j, w = indices[p], np.float64(weights[p])
                other, beside = x[j], y[j]
                if with_y:
                    for c in range(width):
                        total[c] += w * ((here[c] - other[c]) + beside[c])
                else:
                    for c in range(width):
                        total[c] += w * (here[c] - other[c])


def row_blocks(indptr: NDArray[Any]) -> list[tuple[int, int]]:
    """Row ranges of about `BLOCK_NONZEROS` entries each."""
    rows = len(indptr) - 1
    per_row = max(1, int(indptr[-1]) // max(rows, 1))
    return blocks(rows, max(1, BLOCK_NONZEROS // per_row))


def _panels(columns: FloatArray, threads: int | None) -> list[tuple[int, FloatArray]]:
    """First column and values of each `PANEL` columns, each in one piece, which takes fewer pages of memory.

    The last goes over columns of the one before again, to the same bits, rather than be a narrow one.
    """
    width = columns.shape[1]
    firsts = [min(first, width - PANEL) for first in range(0, width, PANEL)]
    return list(ordered_map(lambda first: (first, columns[:, first : first + PANEL].ravel()), firsts, threads))


def csr_matmul(
    matrix: csr_array, columns: NDArray[Any], threads: int | None = None, *, ahead: bool = True
) -> FloatArray:
    """`matrix @ columns` with float64 sums.

    Parameters
    ----------
    matrix : csr_array (M, N)
        float32 or float64 weights.
    columns : ndarray (N,), (N, C) or (N, C, S)
        Any number of right-hand sides in the trailing axes.
    threads : int, optional
        As many as there are processors by default.
    ahead : bool
        Ask for light before it is needed where there is much of it. In vain where rows next to each other take theirs
        from the same places.

    Returns
    -------
    ndarray of float64 (M,), (M, C) or (M, C, S)
    """
    columns = np.asarray(columns)
    if columns.shape[0] != matrix.shape[1]:
        raise ValueError(f"matrix has {matrix.shape[1]} columns but the light has {columns.shape[0]} rows")
    width = int(np.prod(columns.shape[1:], dtype=np.int64))
    flat = np.ascontiguousarray(columns.reshape(columns.shape[0], width), dtype=np.float64)
    out = np.empty((matrix.shape[0], width))
    arrays = matrix.indptr, matrix.indices, matrix.data, flat
    together = min(max(1, width), PANEL)
    band = max(1, BAND_BYTES // (8 * together)) if matrix.has_sorted_indices else matrix.shape[1]
    panels = _panels(flat, threads) if width >= PANEL else []

    def rows(block: tuple[int, int]) -> None:
        if width in (1, 3):
            (far_rows_times_columns if ahead and flat.nbytes > FAR_BYTES else _rows_times_columns)(*arrays, *block, out)
        elif width < PANEL:
            _rows_times_many(*arrays, band, *block, out)
        else:
            for first, panel in panels:
                _rows_times_panel(*arrays[:3], panel, first, band, *block, out)

    for _ in ordered_map(rows, row_blocks(matrix.indptr), threads):
        pass
    return out.reshape((matrix.shape[0], *columns.shape[1:]))


def csr_differences(
    matrix: csr_array,
    x: NDArray[Any],
    y: NDArray[Any] | None = None,
    threads: int | None = None,
    first: int = 0,
) -> FloatArray:
    """Σ_j M_ij [(x_i - x_j) + y_j] for each row i, with float64 sums from left to right.

    Nearly equal x_i and x_j subtract without rounding, so that small exchanges between them keep their digits.

    Parameters
    ----------
    matrix : csr_array (M, N)
    x, y : ndarray (N,), (N, C) or (N, C, S)
        y is zero if not given.
    threads : int, optional
    first : int, optional
        Which i the first row of the matrix is of: M < N rows of a larger matrix begin there.

    Returns
    -------
    ndarray of float64, in the shape of x, with M rows
    """
    flat = np.ascontiguousarray(x.reshape(len(x), -1), dtype=np.float64)
    beside = flat if y is None else np.ascontiguousarray(y.reshape(len(x), -1), dtype=np.float64)
    own = flat[first : first + matrix.shape[0]]
    out = np.empty_like(own)
    arrays = matrix.indptr, matrix.indices, matrix.data, own, flat, beside
    far = flat.shape[1] == 3 and flat.nbytes > FAR_BYTES
    differences = far_rows_times_differences if far else _rows_times_differences

    def rows(block: tuple[int, int]) -> None:
        differences(*arrays, y is not None, *block, out)

    for _ in ordered_map(rows, row_blocks(matrix.indptr), threads):
        pass
    return out.reshape(out.shape[:1] + x.shape[1:])
