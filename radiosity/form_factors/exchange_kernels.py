"""Kernels for the exchange area of two convex polygons with nothing in between.

Every pair is taken by the way that keeps its digits:

* both polygons small beside the distance between them: Gauss rules over both areas, here;
* one of them small: a Gauss rule over that one, Lambert's formula for the other (see `near_kernels`);
* near each other, or touching: the double contour integral (see `contour`), in which distant edges would cancel.

Polygons that reach behind each other's plane are cut there first. Which way is taken depends on ratios of lengths
only, and on neither the order of the two nor the unit of length.

Two passes, because the kernels of the second take half a minute to compile, and many scenes have no lamp so near to
anything that they need it.

Frames of polygons are those of `polygon_kernels`.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..compiled import kernel
from .polygon_kernels import MAX_CORNERS, clip_to_front, enclose, heights_over, polygon_points

FloatArray = NDArray[np.float64]

ON_PLANE = 1e-12  # height over a plane, in units of the pair's extent, that is rounding

# Radii of a polygon from its centre to the other one …
APART = np.array([1000.0, 50.0, 12.0, 6.0, 3.3, 2.5])
# … and the points per direction of a Gauss rule with which the exchange area is then off by 1e-9 of itself at most,
# measured on squares, quads and triangles in thousands of positions.
RULES = np.array([2, 3, 4, 5, 6, 7])
SCRATCH_POINTS = 2 * 7 * 7  # a polygon of five corners is two quads

NEAR = -1.0  # stands for an exchange area that the second pass is to compute

ALL, LATER, SAME = 0, 1, 2  # which columns a row is paired with: every one, those after it, the one of its number


class Scratch(NamedTuple):
    """Memory that a kernel works in, one for each call."""

    p: FloatArray  # corners of both polygons, from a point nearby
    q: FloatArray
    cut: FloatArray
    p_heights: FloatArray
    q_heights: FloatArray
    p_frame: FloatArray
    q_frame: FloatArray
    p_edges: FloatArray
    q_edges: FloatArray
    x: FloatArray  # Gauss points and weights, or feet of singularities
    y: FloatArray
    sums: FloatArray


@kernel
def new_scratch() -> Scratch:
    """Memory to work in."""
    return Scratch(
        np.zeros((MAX_CORNERS, 3)),
        np.zeros((MAX_CORNERS, 3)),
        np.zeros((MAX_CORNERS, 3)),
        np.zeros(MAX_CORNERS),
        np.zeros(MAX_CORNERS),
        np.zeros(8),
        np.zeros(8),
        np.zeros((MAX_CORNERS, 7)),
        np.zeros((MAX_CORNERS, 7)),
        np.zeros((4, SCRATCH_POINTS)),
        np.zeros((4, SCRATCH_POINTS)),
        np.zeros(SCRATCH_POINTS),
    )


@kernel
def rule_for(ratio: float) -> int:
    """Points per direction of a Gauss rule over a polygon `ratio` of its radii away, 0 if too near for any."""
    for k in range(len(APART)):
        if ratio > APART[k]:
            return RULES[k]
    return 0


@kernel
def _height(points: FloatArray, k: int, frame: FloatArray) -> float:
    return (
        (points[0, k] - frame[3]) * frame[0]
        + (points[1, k] - frame[4]) * frame[1]
        + (points[2, k] - frame[5]) * frame[2]
    )


@kernel
def _both_apart(p_rule: int, q_rule: int, work: Scratch) -> float:
    """G by Gauss rules over both areas: 1/π ΣΣ w h w' h' / r⁴, with h the height of a point over the other's plane."""
    x, y, sums = work.x, work.y, work.sums
    p_count = polygon_points(work.p, int(work.p_frame[7]), work.p_frame, p_rule, x)
    q_count = polygon_points(work.q, int(work.q_frame[7]), work.q_frame, q_rule, y)
    for j in range(q_count):
        sums[j] = 0.0
    for i in range(p_count):
        px, py, pz = x[0, i], x[1, i], x[2, i]
        weight = x[3, i] * _height(x, i, work.q_frame)
        for j in range(q_count):
            dx, dy, dz = y[0, j] - px, y[1, j] - py, y[2, j] - pz
            r2 = dx * dx + dy * dy + dz * dz
            sums[j] += weight / (r2 * r2)
    total = 0.0
    for j in range(q_count):
        total += sums[j] * y[3, j] * _height(y, j, work.p_frame)
    return total / math.pi


@kernel
def _take(corners: FloatArray, frame: FloatArray, origin: FloatArray, out: FloatArray, out_frame: FloatArray) -> None:
    """Copy a polygon and its frame, seen from the centre of another."""
    for k in range(int(frame[7])):
        for x in range(3):
            out[k, x] = corners[k, x] - origin[3 + x]
    for x in range(8):
        out_frame[x] = frame[x]
    for x in range(3, 6):
        out_frame[x] -= origin[x]


@kernel
def _cut(corners: FloatArray, frame: FloatArray, heights: FloatArray, tolerance: float, cut: FloatArray) -> None:
    """Cut a polygon, and its frame, at the plane that its corners have these heights over."""
    count = clip_to_front(corners, int(frame[7]), heights, tolerance, cut)
    for k in range(count):
        for x in range(3):
            corners[k, x] = cut[k, x]
    enclose(corners, count, frame)


@kernel
def _comes_first(a: FloatArray, b: FloatArray) -> bool:
    """An order of two frames, so that exchange areas do not depend on which polygon is named first."""
    for x in (6, 3, 4, 5, 0, 1):
        if a[x] != b[x]:
            return a[x] < b[x]
    return True


@kernel
def place(a: FloatArray, a_frame: FloatArray, b: FloatArray, b_frame: FloatArray, work: Scratch) -> float:
    """Put two polygons into `work`, each cut to what is in front of the other; the same for (a, b) and (b, a).

    Returns the extent of the pair, or 0 if they exchange nothing.
    """
    if not _comes_first(a_frame, b_frame):
        a, a_frame, b, b_frame = b, b_frame, a, a_frame
    dx, dy, dz = b_frame[3] - a_frame[3], b_frame[4] - a_frame[4], b_frame[5] - a_frame[5]
    extent = math.sqrt(dx * dx + dy * dy + dz * dz) + a_frame[6] + b_frame[6]
    tolerance = ON_PLANE * extent
    q_low, q_high = heights_over(b, int(b_frame[7]), a_frame, work.q_heights)
    if q_high <= tolerance:
        return 0.0
    p_low, p_high = heights_over(a, int(a_frame[7]), b_frame, work.p_heights)
    if p_high <= tolerance:
        return 0.0
    _take(a, a_frame, a_frame, work.p, work.p_frame)
    _take(b, b_frame, a_frame, work.q, work.q_frame)
    if q_low < -tolerance:
        _cut(work.q, work.q_frame, work.q_heights, tolerance, work.cut)
    if p_low < -tolerance:
        _cut(work.p, work.p_frame, work.p_heights, tolerance, work.cut)
    return extent


@kernel
def _apart(work: Scratch) -> float:
    """G of the polygons in `work` by Gauss rules over both, or `NEAR`."""
    f, g = work.p_frame, work.q_frame
    distance = math.sqrt((g[3] - f[3]) ** 2 + (g[4] - f[4]) ** 2 + (g[5] - f[5]) ** 2)
    p_rule, q_rule = rule_for((distance - g[6]) / f[6]), rule_for((distance - f[6]) / g[6])
    return _both_apart(p_rule, q_rule, work) if p_rule > 0 and q_rule > 0 else NEAR


@kernel
def columns_of(i: int, columns: int, count: int) -> tuple[int, int]:
    """Which of `count` polygons row i is paired with, first … last."""
    if columns == SAME:
        return i, i + 1
    return (0 if columns == ALL else i + 1), count


@kernel
def apart_rows(
    a: FloatArray,
    a_frames: FloatArray,
    b: FloatArray,
    b_frames: FloatArray,
    begin: int,
    end: int,
    columns: int,
    out: FloatArray,
) -> int:
    """Exchange areas of polygons a[begin:end] with polygons b, into rows begin … end of out; the first pass.

    `columns` is ALL, LATER (j > i, the others are left alone) or SAME (j = i only, into column 0). Returns how many
    are `NEAR`.
    """
    work = new_scratch()
    near = 0
    for i in range(begin, end):
        first, last = columns_of(i, columns, len(b))
        for j in range(first, last):
            found = 0.0
            if place(a[i], a_frames[i], b[j], b_frames[j], work) > 0.0:
                found = _apart(work)
            out[i, 0 if columns == SAME else j] = found
            near += found == NEAR
    return near
