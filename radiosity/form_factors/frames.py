"""Polygons made ready for the kernels: checked, padded to four corners, with a frame each (see `polygon_kernels`)."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..compiled import kernel
from ..errors import GeometryError
from .polygon_kernels import enclose

FloatArray = NDArray[np.float64]

FLAT = math.radians(0.11)  # corners this far out of their mean plane, seen from the centre; patches may have 0.1°
CONVEX = 1e-9  # sine of a reflex corner that is rounding


@kernel
def _shape(corners: FloatArray, frame: FloatArray) -> tuple[float, float]:
    """Largest height over the mean plane in units of the radius, and least sine of the corners, of a quad."""
    height, sine = 0.0, 1.0
    nx, ny, nz = frame[0], frame[1], frame[2]
    for k in range(4):
        here, after, before = corners[k], corners[(k + 1) % 4], corners[(k + 3) % 4]
        over = (here[0] - frame[3]) * nx + (here[1] - frame[4]) * ny + (here[2] - frame[5]) * nz
        height = max(height, abs(over) / frame[6])
        ax, ay, az = after[0] - here[0], after[1] - here[1], after[2] - here[2]
        bx, by, bz = before[0] - here[0], before[1] - here[1], before[2] - here[2]
        turn = nx * (ay * bz - az * by) + ny * (az * bx - ax * bz) + nz * (ax * by - ay * bx)
        lengths2 = (ax * ax + ay * ay + az * az) * (bx * bx + by * by + bz * bz)
        if lengths2 > 0.0:
            sine = min(sine, turn / math.sqrt(lengths2))
    return height, sine


@kernel
def frames_of(polygons: FloatArray, frames: FloatArray) -> tuple[int, float, float]:
    """Fill the frames (n, 8) of polygons (n, 4, 3), of which triangles repeat their third corner.

    Returns the number of the first polygon that is not flat and convex (-1: all are), the largest height of its
    corners over its mean plane in units of its radius, and the least sine of its corners.
    """
    for i in range(len(polygons)):
        c, frame = polygons[i], frames[i]
        same = c[2, 0] == c[3, 0] and c[2, 1] == c[3, 1] and c[2, 2] == c[3, 2]
        enclose(c, 3 if same else 4, frame)
        ax, ay, az = c[2, 0] - c[0, 0], c[2, 1] - c[0, 1], c[2, 2] - c[0, 2]
        bx, by, bz = c[3, 0] - c[1, 0], c[3, 1] - c[1, 1], c[3, 2] - c[1, 2]
        nx, ny, nz = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
        length = math.sqrt(nx * nx + ny * ny + nz * nz)
        if length > 0.0:
            frame[0], frame[1], frame[2] = nx / length, ny / length, nz / length
        if same or length == 0.0:
            continue  # a triangle is flat; what has no area exchanges nothing
        height, sine = _shape(c, frame)
        if height > FLAT or sine < -CONVEX:
            return i, height, sine
    return -1, 0.0, 0.0


def prepare(polygons: ArrayLike, name: str) -> tuple[FloatArray, FloatArray]:
    """Corners (n, 4, 3) and frames (n, 8) of polygons (n, 3, 3) or (n, 4, 3) that are fit for the kernels.

    Raises
    ------
    GeometryError
        Another shape; corners that are not finite; a quad that is bent or not convex, with its number.
    """
    corners = np.ascontiguousarray(polygons, dtype=np.float64)
    if corners.ndim != 3 or corners.shape[1] not in (3, 4) or corners.shape[2] != 3:
        raise GeometryError(f"{name} have shape {corners.shape}; give (n, 3, 3) triangles or (n, 4, 3) quads")
    if corners.shape[1] == 3:
        corners = np.ascontiguousarray(corners[:, [0, 1, 2, 2]])
    bad = np.flatnonzero(~np.isfinite(corners).all(axis=(1, 2)))
    if bad.size:
        raise GeometryError(f"{name}: corners of polygon {bad[0]} are not finite ({bad.size} such polygons)")
    frames = np.zeros((len(corners), 8))
    number, height, sine = frames_of(corners, frames)
    if number >= 0:
        raise GeometryError(
            f"{name}: polygon {number} is not a planar convex quad (its corners lie {height:.2g} of its radius off "
            f"its mean plane, the sine of its sharpest turn is {sine:.2g}); cut it into triangles"
        )
    return corners, frames
