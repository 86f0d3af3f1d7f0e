"""Form factors from points to polygons: Lambert's formula, the polygon cut at the horizon.

The share of what a small plane element sends out that arrives at a polygon (J. H. Lambert, Photometria, 1760; H. C.
Hottel and A. F. Sarofim, Radiative Transfer, 1967): with v_k the corners seen from the element and n its normal,

    F = 1/2π Σ_k angle(v_k, v_k+1) n · (v_k+1 × v_k) / |v_k+1 × v_k|

Seen the other way round, F × radiosity of the polygon is the irradiance that it brings to the point, nothing being
in between.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..compiled import kernel
from ..errors import ParameterError
from ..parallel import blocks, ordered_map
from .exchange_kernels import ON_PLANE
from .frames import prepare
from .polygon_kernels import MAX_CORNERS, clip_to_front, heights_over, lambert, polygon_points

FloatArray = NDArray[np.float64]

FAR = 30.0  # radii of the polygon from which a Gauss rule keeps more digits than Lambert's formula
FAR_RULE = 4  # its points per direction; off by less than 1e-12 there
BLOCK_PAIRS = 1 << 15  # pairs in one task: a few milliseconds


@kernel
def _distant(points: FloatArray, count: int, normal: FloatArray, plane_normal: FloatArray) -> float:
    """π F of the element at the origin to the polygon whose Gauss points these are."""
    total = 0.0
    for k in range(count):
        x, y, z = points[0, k], points[1, k], points[2, k]
        r2 = x * x + y * y + z * z
        here = x * normal[0] + y * normal[1] + z * normal[2]
        there = x * plane_normal[0] + y * plane_normal[1] + z * plane_normal[2]
        total -= points[3, k] * here * there / (r2 * r2)
    return total


@kernel
def point_rows(
    points: FloatArray,
    normals: FloatArray,
    polygons: FloatArray,
    frames: FloatArray,
    begin: int,
    end: int,
    out: FloatArray,
) -> None:
    """Form factors from the elements begin … end to all polygons, into rows of out (n, m)."""
    seen, cut, horizon = np.zeros((MAX_CORNERS, 3)), np.zeros((MAX_CORNERS, 3)), np.zeros(6)
    heights, gauss = np.zeros(MAX_CORNERS), np.zeros((4, 2 * FAR_RULE * FAR_RULE))
    for i in range(begin, end):
        for x in range(3):
            horizon[x] = normals[i, x]
        for j in range(len(polygons)):
            out[i, j] = 0.0
            count = int(frames[j, 7])
            distance2, over = 0.0, 0.0
            for x in range(3):
                distance2 += (frames[j, 3 + x] - points[i, x]) ** 2
                over += (points[i, x] - frames[j, 3 + x]) * frames[j, x]
                for k in range(count):
                    seen[k, x] = polygons[j, k, x] - points[i, x]
            distance, radius = math.sqrt(distance2), frames[j, 6]
            tolerance = ON_PLANE * (distance + radius)
            low, high = heights_over(seen, count, horizon, heights)
            if over <= tolerance or high <= tolerance:
                continue
            corners = seen
            if low < -tolerance:
                count = clip_to_front(seen, count, heights, tolerance, cut)
                corners = cut
            if distance > FAR * radius:
                count = polygon_points(corners, count, frames[j], FAR_RULE, gauss)
                out[i, j] = _distant(gauss, count, normals[i], frames[j]) / math.pi
            else:
                out[i, j] = max(0.0, lambert(0.0, 0.0, 0.0, normals[i], corners, count) / (2.0 * math.pi))


def point_to_polygons(
    points: ArrayLike, normals: ArrayLike, polygons: ArrayLike, *, threads: int | None = None
) -> FloatArray:
    """Form factors from plane elements at points to convex polygons, nothing being in between.

    What is below the horizon of an element, or shows it its back, counts as nothing.

    Parameters
    ----------
    points, normals : array_like (n, 3)
        m; normals of any length but zero.
    polygons : array_like (m, 3, 3) or (m, 4, 3)
        Corners of triangles or planar convex quads, counter-clockwise seen from the front, m. In (m, 4, 3) a
        triangle repeats its third corner.
    threads : int, optional
        The result has the same bits for any number of threads.

    Returns
    -------
    ndarray (n, m)
        Shares in [0, 1]. Zero for points in the plane of a polygon.

    Raises
    ------
    ParameterError
        Points and normals that are not (n, 3), not finite, or of different numbers; a normal of length zero.
    GeometryError
        Corners that are not finite; a quad that is bent or not convex.

    Examples
    --------
    A square of side 2 at distance 1, its middle straight ahead (Hamilton and Morgan, NACA TN 2836):

    >>> ceiling = [[[-1, -1, 1], [-1, 1, 1], [1, 1, 1], [1, -1, 1]]]
    >>> point_to_polygons([[0, 0, 0]], [[0, 0, 1]], ceiling).round(9)
    array([[0.55412642]])
    """
    places = _vectors(points, "points")
    directions = _vectors(normals, "normals")
    if len(places) != len(directions):
        raise ParameterError(f"there are {len(places)} points and {len(directions)} normals; give as many of either")
    length = np.linalg.norm(directions, axis=1, keepdims=True)
    if not length.all():
        raise ParameterError(f"normal {int(np.argmin(length))} is zero; a plane element needs a direction")
    corners, frames = prepare(polygons, "polygons")
    out = np.zeros((len(places), len(corners)))
    directions = directions / length

    def work(rows: tuple[int, int]) -> None:
        point_rows(places, directions, corners, frames, rows[0], rows[1], out)

    for _ in ordered_map(work, blocks(len(places), math.ceil(BLOCK_PAIRS / max(1, len(corners)))), threads):
        pass
    return out


def _vectors(values: ArrayLike, name: str) -> FloatArray:
    array = np.ascontiguousarray(values, dtype=np.float64)
    if array.ndim != 2 or array.shape[1] != 3:
        raise ParameterError(f"{name} have shape {array.shape}; give (n, 3)")
    bad = np.flatnonzero(~np.isfinite(array).all(axis=1))
    if bad.size:
        raise ParameterError(f"{name}: number {bad[0]} is not finite ({bad.size} such)")
    return array
