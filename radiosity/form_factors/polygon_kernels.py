"""Kernels on one convex polygon: cut it at a plane, see it from a point, spread a Gauss rule over it.

A polygon is an array of corners (≥ count, 3), counter-clockwise seen from its front, and their count. Its frame is a
row of eight numbers: normal (3), centre (3) and radius of a ball around it, number of corners.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..compiled import kernel
from .gauss import NODES, WEIGHTS
from .kernel import angle

FloatArray = NDArray[np.float64]

MAX_CORNERS = 6  # of a quad cut by one plane: five if it is flat, six if it is bent across it


@kernel
def clip_to_front(corners: FloatArray, count: int, heights: FloatArray, tolerance: float, out: FloatArray) -> int:
    """Part of a convex polygon in front of a plane (Sutherland and Hodgman 1974); returns its number of corners.

    `heights` are those of the corners over the plane; what lies within `tolerance` counts as on it, and is kept.
    """
    kept = 0
    for k in range(count):
        after = (k + 1) % count
        here, there = heights[k], heights[after]
        if here >= -tolerance:
            for x in range(3):
                out[kept, x] = corners[k, x]
            kept += 1
        if (here > tolerance and there < -tolerance) or (here < -tolerance and there > tolerance):
            share = here / (here - there)
            for x in range(3):
                out[kept, x] = corners[k, x] + share * (corners[after, x] - corners[k, x])
            kept += 1
    return kept


@kernel
def heights_over(corners: FloatArray, count: int, frame: FloatArray, out: FloatArray) -> tuple[float, float]:
    """Signed distances of corners from the plane of a frame; returns the lowest and the highest."""
    low, high = 1e300, -1e300
    for k in range(count):
        height = 0.0
        for x in range(3):
            height += (corners[k, x] - frame[3 + x]) * frame[x]
        out[k] = height
        low, high = min(low, height), max(high, height)
    return low, high


@kernel
def lambert(x: float, y: float, z: float, normal: FloatArray, corners: FloatArray, count: int) -> float:
    """2π F from the element at (x, y, z) to a polygon above its horizon, whose front it sees."""
    total = 0.0
    for k in range(count):
        after = (k + 1) % count
        vx, vy, vz = corners[k, 0] - x, corners[k, 1] - y, corners[k, 2] - z
        wx, wy, wz = corners[after, 0] - x, corners[after, 1] - y, corners[after, 2] - z
        ex = corners[after, 0] - corners[k, 0]
        ey = corners[after, 1] - corners[k, 1]
        ez = corners[after, 2] - corners[k, 2]
        # v × edge is v × w, without the digits that two long vectors would lose against each other.
        cx, cy, cz = vy * ez - vz * ey, vz * ex - vx * ez, vx * ey - vy * ex
        cross = math.sqrt(cx * cx + cy * cy + cz * cz)
        if cross > 0.0:
            seen = angle(cross, vx * wx + vy * wy + vz * wz)
            total -= seen * (cx * normal[0] + cy * normal[1] + cz * normal[2]) / cross
    return total


@kernel
def gauss_points(
    corners: FloatArray,
    first: int,
    second: int,
    third: int,
    fourth: int,
    normal: FloatArray,
    rule: int,
    points: FloatArray,
    begin: int,
) -> int:
    """Append the points (x, y, z) and area weights of a rule × rule Gauss rule on one planar quad.

    Four rows of `points`, from column `begin`; returns the column after the last. A triangle repeats a corner: the
    bilinear map then closes up on it, and its area density, linear on every planar quad, falls to zero there.
    """
    ax, ay, az = corners[first, 0], corners[first, 1], corners[first, 2]
    bx, by, bz = corners[second, 0] - ax, corners[second, 1] - ay, corners[second, 2] - az
    dx, dy, dz = corners[fourth, 0] - ax, corners[fourth, 1] - ay, corners[fourth, 2] - az
    cx, cy, cz = corners[third, 0] - ax, corners[third, 1] - ay, corners[third, 2] - az
    nx, ny, nz = normal[0], normal[1], normal[2]
    at_a = nx * (by * dz - bz * dy) + ny * (bz * dx - bx * dz) + nz * (bx * dy - by * dx)
    at_b = nx * (by * cz - bz * cy) + ny * (bz * cx - bx * cz) + nz * (bx * cy - by * cx)
    at_d = nx * (cy * dz - cz * dy) + ny * (cz * dx - cx * dz) + nz * (cx * dy - cy * dx)
    tx, ty, tz = cx - bx - dx, cy - by - dy, cz - bz - dz
    offset = rule * (rule - 1) // 2
    at = begin
    for j in range(offset, offset + rule):
        v = NODES[j]
        for i in range(offset, offset + rule):
            u = NODES[i]
            points[0, at] = ax + u * bx + v * (dx + u * tx)
            points[1, at] = ay + u * by + v * (dy + u * ty)
            points[2, at] = az + u * bz + v * (dz + u * tz)
            points[3, at] = WEIGHTS[i] * WEIGHTS[j] * (at_a + u * (at_b - at_a) + v * (at_d - at_a))
            at += 1
    return at


@kernel
def polygon_points(corners: FloatArray, count: int, normal: FloatArray, rule: int, points: FloatArray) -> int:
    """Gauss points and area weights on a convex polygon of 3 … 6 corners, (4, …); returns how many."""
    at = 0
    for k in range(0, count - 2, 2):
        at = gauss_points(corners, 0, k + 1, k + 2, min(k + 3, count - 1), normal, rule, points, at)
    return at


@kernel
def distance2_to_polygon(x: float, y: float, z: float, corners: FloatArray, count: int, normal: FloatArray) -> float:
    """Square of the distance from a point to the nearest point of a polygon."""
    inside, nearest = True, 1e300
    height = 0.0
    for k in range(count):
        after = (k + 1) % count
        ex, ey, ez = (
            corners[after, 0] - corners[k, 0],
            corners[after, 1] - corners[k, 1],
            corners[after, 2] - corners[k, 2],
        )
        wx, wy, wz = x - corners[k, 0], y - corners[k, 1], z - corners[k, 2]
        height = wx * normal[0] + wy * normal[1] + wz * normal[2]
        left = normal[0] * (ey * wz - ez * wy) + normal[1] * (ez * wx - ex * wz) + normal[2] * (ex * wy - ey * wx)
        inside = inside and left >= 0.0
        length2 = ex * ex + ey * ey + ez * ez
        share = 0.0
        if length2 > 0.0:
            share = min(1.0, max(0.0, (wx * ex + wy * ey + wz * ez) / length2))
        wx -= share * ex
        wy -= share * ey
        wz -= share * ez
        nearest = min(nearest, wx * wx + wy * wy + wz * wz)
    return height * height if inside else nearest


@kernel
def enclose(corners: FloatArray, count: int, frame: FloatArray) -> None:
    """Write the centre and radius of a ball around a polygon into its frame."""
    for x in range(3):
        total = 0.0
        for k in range(count):
            total += corners[k, x]
        frame[3 + x] = total / count
    radius2 = 0.0
    for k in range(count):
        distance2 = 0.0
        for x in range(3):
            distance2 += (corners[k, x] - frame[3 + x]) ** 2
        radius2 = max(radius2, distance2)
    frame[6] = math.sqrt(radius2)
    frame[7] = count
