"""Kernels for the exchange area of two convex polygons with nothing in between.

Every pair is taken by the way that keeps its digits:

* both polygons small beside the distance between them: Gauss rules over both areas;
* one of them small: a Gauss rule over that one, Lambert's formula for the other;
* near each other, or touching: the double contour integral (see `contour`), in which distant edges would cancel.

Polygons that reach behind each other's plane are cut there first. Which way is taken depends on ratios of lengths
only, and on neither the order of the two nor the unit of length.

Frames of polygons are those of `polygons`.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .edge_integrals import edge_pair
from .kernel import kernel
from .polygon_kernels import (
    MAX_CORNERS,
    clip_to_front,
    distance2_to_polygon,
    enclose,
    heights_over,
    lambert,
    polygon_points,
)

FloatArray = NDArray[np.float64]

ON_PLANE = 1e-12  # height over a plane, in units of the pair's extent, that is rounding

# Radii of a polygon from its centre to the other one …
APART = np.array([1000.0, 50.0, 12.0, 6.0, 3.3, 2.5])
# … and the points per direction of a Gauss rule with which the exchange area is then off by 1e-9 of itself at most,
# measured on squares, quads and triangles in thousands of positions.
RULES = np.array([2, 3, 4, 5, 6, 7])
LAMBERT_RULE = 4  # the largest rule with which Lambert's formula at every point costs less than the contours
SCRATCH_POINTS = 2 * 7 * 7  # a polygon of five corners is two quads

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
    """Scratch memory for `exchange`."""
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
def _rule(ratio: float) -> int:
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
def _one_apart(p: FloatArray, p_frame: FloatArray, rule: int, q: FloatArray, q_count: int, x: FloatArray) -> float:
    """G by a Gauss rule over the small polygon p and Lambert's formula for q."""
    total = 0.0
    for i in range(polygon_points(p, int(p_frame[7]), p_frame, rule, x)):
        total += x[3, i] * lambert(x[0, i], x[1, i], x[2, i], p_frame, q, q_count)
    return total / (2.0 * math.pi)


@kernel
def _edges(corners: FloatArray, count: int, scale: float, edges: FloatArray) -> int:
    """Edges (start, direction, length) of a polygon in units of `scale`; returns how many have a length."""
    kept = 0
    for k in range(count):
        after = (k + 1) % count
        ex = (corners[after, 0] - corners[k, 0]) / scale
        ey = (corners[after, 1] - corners[k, 1]) / scale
        ez = (corners[after, 2] - corners[k, 2]) / scale
        length = math.sqrt(ex * ex + ey * ey + ez * ez)
        if length > 0.0:
            for x in range(3):
                edges[kept, x] = corners[k, x] / scale
            edges[kept, 3], edges[kept, 4], edges[kept, 5] = ex / length, ey / length, ez / length
            edges[kept, 6] = length
            kept += 1
    return kept


@kernel
def contour_integral(extent: float, work: Scratch) -> float:
    """G = 1/2π ∮∮ ln r dp · dq.

    In units of a power of two near the extent of the pair: the logarithms are then small, and a scene scaled by a
    power of two gives the same digits.
    """
    scale = math.ldexp(1.0, math.frexp(extent)[1])
    p_count = _edges(work.p, int(work.p_frame[7]), scale, work.p_edges)
    q_count = _edges(work.q, int(work.q_frame[7]), scale, work.q_edges)
    total = 0.0
    for i in range(p_count):
        for j in range(q_count):
            total += edge_pair(work.p_edges, i, work.q_edges, j, work.x[0], work.x[1])
    return total * scale * scale / (2.0 * math.pi)


@kernel
def _unclipped(extent: float, work: Scratch) -> float:
    """G of the polygons in `work`, each in front of the other's plane."""
    p, q, f, g = work.p, work.q, work.p_frame, work.q_frame
    distance = math.sqrt((g[3] - f[3]) ** 2 + (g[4] - f[4]) ** 2 + (g[5] - f[5]) ** 2)
    p_rule, q_rule = _rule((distance - g[6]) / f[6]), _rule((distance - f[6]) / g[6])
    if p_rule > 0 and q_rule > 0:
        return _both_apart(p_rule, q_rule, work)
    if f[6] > g[6]:
        p, q, f, g = q, p, g, f
    away = math.sqrt(distance2_to_polygon(f[3], f[4], f[5], q, int(g[7]), g))
    rule = _rule(away / f[6])
    if 0 < rule <= LAMBERT_RULE:
        return _one_apart(p, f, rule, q, int(g[7]), work.x)
    # Nothing that is in front of a front is negative: what is below zero is rounding, 1e-16 of the extent squared.
    return max(0.0, contour_integral(extent, work))


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
def exchange(a: FloatArray, a_frame: FloatArray, b: FloatArray, b_frame: FloatArray, work: Scratch) -> float:
    """G of two polygons, m²; the same bits for (a, b) and (b, a)."""
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
    return _unclipped(extent, work)


@kernel
def exchange_rows(
    a: FloatArray,
    a_frames: FloatArray,
    b: FloatArray,
    b_frames: FloatArray,
    begin: int,
    end: int,
    columns: int,
    out: FloatArray,
) -> None:
    """Exchange areas of polygons a[begin:end] with polygons b, into rows begin … end of out.

    `columns` is ALL, LATER (j > i, the others are left alone) or SAME (j = i only, into column 0).
    """
    work = new_scratch()
    for i in range(begin, end):
        first = 0 if columns == ALL else (i if columns == SAME else i + 1)
        last = i + 1 if columns == SAME else len(b)
        for j in range(first, last):
            out[i, 0 if columns == SAME else j] = exchange(a[i], a_frames[i], b[j], b_frames[j], work)
