"""Products with light that is larger than the processor's caches: it is asked for before it is needed.

Entries of a row stand for patches anywhere in the scene, whose light no cache foresees. A processor waits for some ten
such places at a time, and for each of them longer than its sums take. So each entry asks for the light of the entry
that comes `AHEAD` later, which has then arrived. The sums are those of `radiosity.sparse`, to the last bit.
"""

from __future__ import annotations

import numpy as np

from .compiled import ask_for, kernel

AHEAD = 128  # entries; their light, some two lines of a cache each, fits the smallest of the caches


@kernel
def far_rows_times_columns(indptr, indices, weights, columns, begin, end, out):  # type: ignore[no-untyped-def]
    """Rows begin … end of a product with one or three columns, as `sparse._rows_times_columns`."""
    width = columns.shape[1]
    flat = columns.reshape(-1)
    one, two, three = np.uint64(1), np.uint64(2), np.uint64(3)
    last = indices.shape[0] - 1
    for i in range(begin, end):
        if width == 3:
            r = g = b = 0.0
            for p in range(indptr[i], indptr[i + 1]):
                later = three * np.uint64(indices[min(p + AHEAD, last)])
                ask_for(flat, later)  # may lie across two lines
                ask_for(flat, later + two)
                j, w = three * np.uint64(indices[p]), np.float64(weights[p])
                r += w * flat[j]
                g += w * flat[j + one]
                b += w * flat[j + two]
            out[i, 0], out[i, 1], out[i, 2] = r, g, b
        elif width == 1:
            s = 0.0
            for p in range(indptr[i], indptr[i + 1]):
                ask_for(flat, np.uint64(indices[min(p + AHEAD, last)]))
                s += np.float64(weights[p]) * flat[np.uint64(indices[p])]
            out[i, 0] = s


@kernel
def far_rows_times_differences(indptr, indices, weights, own, x, y, with_y, begin, end, out):  # type: ignore[no-untyped-def]
    """Rows begin … end of differences in three columns, as `sparse._rows_times_differences`."""
    flat, flat_y = x.reshape(-1), y.reshape(-1)
    one, two, three = np.uint64(1), np.uint64(2), np.uint64(3)
    last = indices.shape[0] - 1
    for i in range(begin, end):
        r = g = b = 0.0
        r0, g0, b0 = own[i, 0], own[i, 1], own[i, 2]
        for p in range(indptr[i], indptr[i + 1]):
            later = three * np.uint64(indices[min(p + AHEAD, last)])
            ask_for(flat, later)
            ask_for(flat, later + two)
            j, w = three * np.uint64(indices[p]), np.float64(weights[p])
            if with_y:
                ask_for(flat_y, later)
                ask_for(flat_y, later + two)
                r += w * ((r0 - flat[j]) + flat_y[j])
                g += w * ((g0 - flat[j + one]) + flat_y[j + one])
                b += w * ((b0 - flat[j + two]) + flat_y[j + two])
            else:
                r += w * (r0 - flat[j])
                g += w * (g0 - flat[j + one])
                b += w * (b0 - flat[j + two])
        out[i, 0], out[i, 1], out[i, 2] = r, g, b
