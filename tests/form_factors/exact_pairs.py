"""The exchange area of two polygons in 30 digits: the readable twin of the kernels, slow and without shortcuts.

2π G = Σ_edges (u · v) ∬ ln r ds dt, the inner integral in closed form, the outer one by Gauss rules on pieces that
shrink fourfold towards every foot of the other edge's ends and towards the point where the two lines are nearest.
"""

from __future__ import annotations

import functools
import itertools

import mpmath
import numpy as np
from mpmath import mpf

DIGITS = 30


# Corners are lists of mpf. Called with workdps(DIGITS).


def _dot(a, b):
    return sum(x * y for x, y in zip(a, b, strict=True))


def _sub(a, b):
    return [x - y for x, y in zip(a, b, strict=True)]


def _along(a, b, t):
    return [x + t * y for x, y in zip(a, b, strict=True)]


def _cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


@functools.cache
def _rule():
    """Nodes and weights of the Gauss-Legendre rule of 16 points on [0, 1]."""
    n, rule = 16, []
    for guess in np.polynomial.legendre.leggauss(n)[0]:
        x = mpmath.findroot(lambda t: mpmath.legendre(n, t), mpf(guess))
        slope = n * mpmath.legendre(n - 1, x) / (1 - x**2)
        rule.append(((1 + x) / 2, 1 / ((1 - x**2) * slope**2)))
    return rule


def _inner(point, start, direction, length):
    """∫ ln r along an edge."""
    w = _sub(point, start)
    foot = _dot(w, direction)
    across = _along(w, direction, -foot)
    d2, s0, s1 = _dot(across, across), -foot, length - foot
    total = -length
    for sign, s in ((1, s1), (-1, s0)):
        if s * s + d2 > 0:
            total += sign * s * mpmath.log(s * s + d2) / 2
    if d2 > 0:
        d = mpmath.sqrt(d2)
        total += d * mpmath.atan2(d * length, d2 + s0 * s1)
    return total


def edge_integral(a, b, c, d):
    """(u · v) ∬ ln r over the edges from a to b and from c to d."""
    p, q = _sub(b, a), _sub(d, c)
    p_length, q_length = mpmath.sqrt(_dot(p, p)), mpmath.sqrt(_dot(q, q))
    if not p_length or not q_length:
        return mpf(0)
    u, v = [x / p_length for x in p], [x / q_length for x in q]
    cosine = _dot(u, v)
    w = _sub(a, c)
    feet = [-_dot(w, u), _dot(_sub(d, a), u)]
    if 1 - cosine**2 > mpf(10) ** (4 - DIGITS):
        feet.append((cosine * _dot(w, v) - _dot(w, u)) / (1 - cosine**2))
    cuts = {mpf(0), p_length}
    for foot in feet:
        cuts |= {foot + sign * p_length * mpf(4) ** -k for k in range(8) for sign in (1, -1)} | {foot}
    cuts = sorted(t for t in cuts if 0 <= t <= p_length)
    total = mpf(0)
    for begin, end in itertools.pairwise(cuts):
        for t, weight in _rule():
            total += (end - begin) * weight * _inner(_along(a, u, begin + (end - begin) * t), c, v, q_length)
    return cosine * total


def _in_front(polygon, point, normal):
    heights = [_dot(_sub(corner, point), normal) for corner in polygon]
    kept = []
    for k, here in enumerate(heights):
        there, after = heights[(k + 1) % len(polygon)], polygon[(k + 1) % len(polygon)]
        if here >= 0:
            kept.append(polygon[k])
        if here * there < 0:
            kept.append(_along(polygon[k], _sub(after, polygon[k]), here / (here - there)))
    return kept


def exchange_area(polygon_a, polygon_b):
    """G of two convex polygons, lists of corners, as a float."""
    with mpmath.workdps(DIGITS):
        a, b = ([[mpf(float(x)) for x in corner] for corner in polygon] for polygon in (polygon_a, polygon_b))
        a_normal, b_normal = (_cross(_sub(p[1], p[0]), _sub(p[2], p[0])) for p in (a, b))
        a, b = _in_front(a, b[0], b_normal), _in_front(b, a[0], a_normal)
        if len(a) < 3 or len(b) < 3:
            return 0.0
        total = mpf(0)
        for i in range(len(a)):
            for j in range(len(b)):
                total += edge_integral(a[i], a[(i + 1) % len(a)], b[j], b[(j + 1) % len(b)])
        return float(total / (2 * mpmath.pi))
