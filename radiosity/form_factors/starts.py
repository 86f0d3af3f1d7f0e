"""Where rays start: numbers for each ray, and the points of patches that they give."""

from __future__ import annotations

import numpy as np

from ..compiled import kernel
from ..face_points import patch_points
from ..sequences import BITS_TO_UNIT, high_bits, key


@kernel
def numbers(keys, points, shifted, count, out):  # type: ignore[no-untyped-def]
    """Fill out (4, keys × count) with numbers in [0, 1) for `count` rays of each key.

    `points` (4, count) uint32, shifted by the key or as they are; hashes of (key, ray) where there are none.
    """
    for p in range(keys.shape[0]):
        first = p * count
        if points.shape[1] > 0:
            for d in range(4):
                shift = high_bits(key(keys[p], d)) if shifted else np.uint32(0)
                for r in range(count):
                    out[d, first + r] = (points[d, r] ^ shift) * BITS_TO_UNIT
        else:
            for r in range(count):
                ray = key(keys[p], r + 4)
                for d in range(4):
                    out[d, first + r] = high_bits(key(ray, d)) * BITS_TO_UNIT


@kernel
def starts(table, face, cell, side, s, t, out):  # type: ignore[no-untyped-def]
    """Fill out (cells × count, 3) with `patch_points` of many cells (n,), for s and t (n × count,)."""
    count = s.shape[0] // max(face.shape[0], 1)
    for p in range(face.shape[0]):
        here = slice(p * count, (p + 1) * count)
        patch_points(table, face[p], cell[p], side[p], s[here], t[here], out[here])
