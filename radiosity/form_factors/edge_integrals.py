"""Double integrals of ln r over two straight edges, the terms of the contour form of an exchange area.

    ∬ ln |p(t) - q(s)| ds dt,     p(t) = a + t u on one edge, q(s) = b + s v on the other

Four ways, each where it is exact to 1e-12: a closed form for parallel edges; Gauss rules over both edges where they
are apart; a closed form for edges whose lines meet (edges that share a corner, and all others in one plane); and the
inner integral in closed form with a Gauss rule outside for the rest. That rule knows where its integrand is singular
in the complex plane, and divides the edge until every piece converges.

An edge is a row of seven numbers: start (3), unit direction (3), length.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..compiled import kernel
from .gauss import NODES, WEIGHTS
from .kernel import angle

FloatArray = NDArray[np.float64]

SMALL_EDGE = 0.01  # length² over distance² of an edge seen so small that its ends look alike
RIGHT_ANGLE = 1e-16  # cosine of the angle below which a pair of edges adds nothing
PARALLEL = 1e-24  # sin² of the angle below which edges count as parallel
SHORT = 0.03  # ratio of lengths below which the closed form for parallel edges loses digits
CROSSING = 1e-2  # sin² of the angle above which two lines meet at a well-defined point
COPLANAR = 1e-20  # distance² between two lines, in lengths² of the shorter edge, below which they meet
NEARBY = 4.0  # lengths of either edge from its start, beyond which a meeting point makes terms cancel
ELLIPSES = np.array([9.0, 5.0, 3.5, 2.6, 2.1, 1.7, 1.5])  # of the nearest singularity (see `_ellipse`) …
POINTS = np.array([5, 6, 7, 8, 9, 11, 12])  # … and the points that suffice beyond it, measured
GAPS = np.array([12.0, 3.7, 2.3, 1.75, 1.5])  # from either edge's middle to the other edge, in half its length …
PAIRED_POINTS = np.array([4, 6, 8, 10, 12])  # … and the even points on each edge that suffice, measured
SHORTEST = 1e-8  # piece of an edge, in units of its length, whose share in the integral is rounding


@kernel
def log_integral(x: float, y: float, z: float, edges: FloatArray, k: int) -> float:
    """∫ ln |p - q(s)| ds over edge k for the point p = (x, y, z).

    With s₀, s₁ the ends seen from the foot of p and d its distance from the line, the integral is
    s₁ ln r₁ - s₀ ln r₀ - length + d × (angle under which p sees the edge).
    """
    wx, wy, wz = x - edges[k, 0], y - edges[k, 1], z - edges[k, 2]
    ux, uy, uz, length = edges[k, 3], edges[k, 4], edges[k, 5], edges[k, 6]
    foot = wx * ux + wy * uy + wz * uz
    # The distance from the vector across: |w|² - foot² would lose half of the digits near the line.
    wx -= foot * ux
    wy -= foot * uy
    wz -= foot * uz
    d2 = wx * wx + wy * wy + wz * wz
    s0, s1 = -foot, length - foot
    r0, r1 = s0 * s0 + d2, s1 * s1 + d2
    total = -length
    if length * length < SMALL_EDGE * r0:  # here s₁ ln r₁ and s₀ ln r₀ are nearly the same
        total += 0.5 * (length * math.log(r0) + s1 * math.log1p(length * (s0 + s1) / r0))
    else:
        if r1 > 0.0:
            total += 0.5 * s1 * math.log(r1)
        if r0 > 0.0:
            total -= 0.5 * s0 * math.log(r0)
    if d2 > 0.0:
        d = math.sqrt(d2)
        total += d * angle(d * length, d2 + s0 * s1)
    return total


@kernel
def _second_antiderivative(x: float, d2: float) -> float:
    """H with H'' = ln √(x² + d²)."""
    r2 = x * x + d2
    if r2 == 0.0:
        return 0.0
    value = 0.25 * (x * x - d2) * math.log(r2) - 0.75 * x * x
    if d2 > 0.0:
        d = math.sqrt(d2)
        value += d * x * math.atan(x / d)
    return value


@kernel
def _parallel(p: FloatArray, i: int, q: FloatArray, j: int) -> float:
    """∬ ln r over parallel edges, which may overlap: second differences of H along the common direction."""
    ux, uy, uz = q[j, 3], q[j, 4], q[j, 5]
    # Middle to middle, so that what is left of an angle between the edges cancels.
    wx = p[i, 0] + 0.5 * p[i, 6] * p[i, 3] - q[j, 0]
    wy = p[i, 1] + 0.5 * p[i, 6] * p[i, 4] - q[j, 1]
    wz = p[i, 2] + 0.5 * p[i, 6] * p[i, 5] - q[j, 2]
    middle = wx * ux + wy * uy + wz * uz
    wx -= middle * ux
    wy -= middle * uy
    wz -= middle * uz
    d2 = wx * wx + wy * wy + wz * wz
    low, high = middle - 0.5 * p[i, 6], middle + 0.5 * p[i, 6]
    length = q[j, 6]
    grown = _second_antiderivative(high, d2) - _second_antiderivative(low, d2)
    return grown - (_second_antiderivative(high - length, d2) - _second_antiderivative(low - length, d2))


@kernel
def _meeting(p: FloatArray, i: int, q: FloatArray, j: int, t: float, s: float) -> float:
    """∬ ln r over edges whose lines meet at p(t) = q(s).

    With both coordinates measured from there, (s, t) · ∇ ln r = 1, so that the divergence theorem in the (s, t)
    plane leaves integrals along single edges: 2 ∬ ln r = ∮ ln r (s, t) · n - length × length.
    """
    begin, end = p[i, 6], q[j, 6]
    total = -begin * end
    for k in range(2):
        at = k * begin
        sign = 2.0 * k - 1.0
        x, y, z = p[i, 0] + at * p[i, 3], p[i, 1] + at * p[i, 4], p[i, 2] + at * p[i, 5]
        total += sign * (at - t) * log_integral(x, y, z, q, j)
        at = k * end
        x, y, z = q[j, 0] + at * q[j, 3], q[j, 1] + at * q[j, 4], q[j, 2] + at * q[j, 5]
        total += sign * (at - s) * log_integral(x, y, z, p, i)
    return 0.5 * total


@kernel
def _gauss(p: FloatArray, i: int, q: FloatArray, j: int, begin: float, end: float, count: int) -> float:
    """∬ ln r over a piece of edge i: outer Gauss rule, inner closed form."""
    first = count * (count - 1) // 2
    total = 0.0
    for k in range(first, first + count):
        t = begin + (end - begin) * NODES[k]
        x, y, z = p[i, 0] + t * p[i, 3], p[i, 1] + t * p[i, 4], p[i, 2] + t * p[i, 5]
        total += WEIGHTS[k] * log_integral(x, y, z, q, j)
    return total * (end - begin)


@kernel
def _ellipse(begin: float, end: float, x: float, h2: float) -> float:
    """Half the sum of Bernstein's ρ + 1/ρ: how far x ± i h is from an interval, as a sum of distances to its ends."""
    return (math.sqrt((x - begin) ** 2 + h2) + math.sqrt((x - end) ** 2 + h2)) / (end - begin)


@kernel
def _points(ellipse: float) -> int:
    """Gauss points for an error below 1e-12 of the product of the lengths, or 0 if the piece must be divided."""
    for k in range(len(ELLIPSES)):
        if ellipse > ELLIPSES[k]:
            return POINTS[k]
    return 0


@kernel
def _graded(p: FloatArray, i: int, q: FloatArray, j: int, x: FloatArray, h2: FloatArray, count: int) -> float:
    """∬ ln r with edge i cut at the feet of the singularities x ± i h, and finer and finer towards them."""
    length = p[i, 6]
    total, begin, step = 0.0, 0.0, length
    while begin < length:
        end = length if begin + 1.001 * step >= length else begin + step
        while True:
            worst, place = 1e300, 0.0
            for k in range(count):
                ellipse = _ellipse(begin, end, x[k], h2[k])
                if ellipse < worst:
                    worst, place = ellipse, x[k]
            points = _points(worst)
            if points > 0 or end - begin < SHORTEST * length:
                break
            inside = begin + SHORTEST * length < place < end - SHORTEST * length
            end = place if inside else 0.5 * (begin + end)
        total += _gauss(p, i, q, j, begin, end, max(points, 4))
        step, begin = 4.0 * (end - begin), end
    return total


@kernel
def _foot(edges: FloatArray, i: int, x: float, y: float, z: float) -> tuple[float, float]:
    """Where along the line of edge i the foot of a point lies, and the square of its distance from the line."""
    wx, wy, wz = x - edges[i, 0], y - edges[i, 1], z - edges[i, 2]
    ux, uy, uz = edges[i, 3], edges[i, 4], edges[i, 5]
    foot = wx * ux + wy * uy + wz * uz
    wx -= foot * ux
    wy -= foot * uy
    wz -= foot * uz
    return foot, wx * wx + wy * wy + wz * wz


@kernel
def _gap2(p: FloatArray, i: int, q: FloatArray, j: int) -> float:
    """Square of the distance from the middle of edge i to edge j, in units of half the length of edge i."""
    half = 0.5 * p[i, 6]
    foot, d2 = _foot(q, j, p[i, 0] + half * p[i, 3], p[i, 1] + half * p[i, 4], p[i, 2] + half * p[i, 5])
    beyond = max(0.0, foot - q[j, 6], -foot)
    return (d2 + beyond * beyond) / (half * half)


@kernel
def _four(t: float, s: float, w2: float, wu: float, wv: float, cosine: float) -> float:
    """Product of r² over the points ±t and ±s of two edges, measured from their middles, which are w apart."""
    both, x, y, z = w2 + t * t + s * s, 2.0 * t * wu, 2.0 * s * wv, 2.0 * cosine * t * s
    return ((both + x - y - z) * (both - x + y - z)) * ((both + x + y + z) * (both - x - y + z))


@kernel
def _apart(p: FloatArray, i: int, q: FloatArray, j: int, cosine: float, count: int) -> float:
    """∬ ln r by Gauss rules of an even number of points on both edges.

    Points come in fours and eights of one weight, so that a logarithm serves as many of them at once.
    """
    a, b = 0.5 * p[i, 6], 0.5 * q[j, 6]
    wx = p[i, 0] + a * p[i, 3] - q[j, 0] - b * q[j, 3]
    wy = p[i, 1] + a * p[i, 4] - q[j, 1] - b * q[j, 4]
    wz = p[i, 2] + a * p[i, 5] - q[j, 2] - b * q[j, 5]
    w2 = wx * wx + wy * wy + wz * wz
    wu = wx * p[i, 3] + wy * p[i, 4] + wz * p[i, 5]
    wv = wx * q[j, 3] + wy * q[j, 4] + wz * q[j, 5]
    first = count * (count - 1) // 2 + count // 2  # nodes beyond the middle
    total = 0.0
    for k in range(first, first + count // 2):
        at = 2.0 * NODES[k] - 1.0
        for m in range(first, k):
            other = 2.0 * NODES[m] - 1.0
            eight = _four(a * at, b * other, w2, wu, wv, cosine) * _four(a * other, b * at, w2, wu, wv, cosine)
            total += WEIGHTS[k] * WEIGHTS[m] * math.log(eight)
        total += WEIGHTS[k] * WEIGHTS[k] * math.log(_four(a * at, b * at, w2, wu, wv, cosine))
    return 2.0 * total * a * b


@kernel
def edge_pair(p: FloatArray, i: int, q: FloatArray, j: int, x: FloatArray, h2: FloatArray) -> float:
    """(u · v) ∬ ln r ds dt over edge i of p and edge j of q; `x` and `h2` (≥ 3,) are scratch."""
    if p[i, 6] > q[j, 6]:  # edge i is the shorter one: the other's ends are farther from it, in its lengths
        p, i, q, j = q, j, p, i
    ux, uy, uz = p[i, 3], p[i, 4], p[i, 5]
    vx, vy, vz = q[j, 3], q[j, 4], q[j, 5]
    cosine = ux * vx + uy * vy + uz * vz
    if abs(cosine) < RIGHT_ANGLE:
        return 0.0
    cx, cy, cz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
    sine2 = cx * cx + cy * cy + cz * cz
    end = q[j, 6]
    if sine2 < PARALLEL and p[i, 6] > SHORT * end:
        return cosine * _parallel(p, i, q, j)
    gap2 = min(_gap2(p, i, q, j), _gap2(q, j, p, i))
    for k in range(len(GAPS)):
        if gap2 > GAPS[k] * GAPS[k]:
            return cosine * _apart(p, i, q, j, cosine, PAIRED_POINTS[k])
    count = 2
    if sine2 >= PARALLEL:
        wx, wy, wz = p[i, 0] - q[j, 0], p[i, 1] - q[j, 1], p[i, 2] - q[j, 2]
        wu, wv = wx * ux + wy * uy + wz * uz, wx * vx + wy * vy + wz * vz
        t, s = (cosine * wv - wu) / sine2, (wv - cosine * wu) / sine2  # where the lines are nearest to each other
        gap = wx * cx + wy * cy + wz * cz
        gap2 = gap * gap / sine2
        near = abs(t) < NEARBY * p[i, 6] and abs(s) < NEARBY * end
        if near and sine2 > CROSSING and gap2 < COPLANAR * p[i, 6] * p[i, 6]:
            return cosine * _meeting(p, i, q, j, t, s)
        if 0.0 < s < end:  # beyond the other edge's ends the crossing leaves no trace
            x[2], h2[2] = t, gap2 / sine2
            count = 3
    x[0], h2[0] = _foot(p, i, q[j, 0], q[j, 1], q[j, 2])
    x[1], h2[1] = _foot(p, i, q[j, 0] + end * vx, q[j, 1] + end * vy, q[j, 2] + end * vz)
    return cosine * _graded(p, i, q, j, x, h2, count)
