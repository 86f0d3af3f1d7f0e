"""Kernels for the exchange area of two convex polygons near each other: the second pass after `exchange_kernels`.

A Gauss rule over the smaller polygon with Lambert's formula for the other where that polygon is small, else the double
contour integral.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..compiled import kernel
from .edge_integrals import edge_pair
from .exchange_kernels import NEAR, SAME, Scratch, columns_of, new_scratch, place, rule_for
from .polygon_kernels import distance2_to_polygon, lambert, polygon_points

FloatArray = NDArray[np.float64]

LAMBERT_RULE = 4  # the largest rule with which Lambert's formula at every point costs less than the contours


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
def _near(extent: float, work: Scratch) -> float:
    """G of the polygons in `work`, each in front of the other's plane."""
    p, q, f, g = work.p, work.q, work.p_frame, work.q_frame
    if f[6] > g[6]:
        p, q, f, g = q, p, g, f
    away = math.sqrt(distance2_to_polygon(f[3], f[4], f[5], q, int(g[7]), g))
    rule = rule_for(away / f[6])
    if 0 < rule <= LAMBERT_RULE:
        return _one_apart(p, f, rule, q, int(g[7]), work.x)
    # Nothing that is in front of a front is negative: what is below zero is rounding, 1e-16 of the extent squared.
    return max(0.0, contour_integral(extent, work))


@kernel
def near_rows(
    a: FloatArray,
    a_frames: FloatArray,
    b: FloatArray,
    b_frames: FloatArray,
    begin: int,
    end: int,
    columns: int,
    out: FloatArray,
) -> None:
    """Put exchange areas where `apart_rows` has left `NEAR`."""
    work = new_scratch()
    for i in range(begin, end):
        first, last = columns_of(i, columns, len(b))
        for j in range(first, last):
            column = 0 if columns == SAME else j
            if out[i, column] == NEAR:
                extent = place(a[i], a_frames[i], b[j], b_frames[j], work)
                out[i, column] = _near(extent, work)
