"""Between rectangles whose sides are parallel or perpendicular to each other."""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import pairwise, product
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .checks import check_interval, check_not_negative, check_positive

FloatArray = NDArray[np.float64]
Interval = tuple[float, float]
Rectangle = tuple[Interval, Interval]

APART = 3.0  # radii from the centre of a rectangle to the other one, from which a Gauss rule is exact to 1e-13 …
RULE = 10  # … with so many points along each side
HUGE = 20.0  # ratio of sizes from which a rectangle that touches a small one is cut up around it


def parallel_rectangles(a: float, b: float, distance: float) -> float:
    """Between two equal, parallel, directly opposed rectangles.

    Parameters
    ----------
    a, b : float
        Sides.
    distance : float

    Returns
    -------
    float

    References
    ----------
    Howell C-11; D. C. Hamilton and W. R. Morgan, NACA TN 2836 (1952).

    Examples
    --------
    >>> round(parallel_rectangles(1, 1, 1), 12)
    0.199824895698
    """
    check_positive(a=a, b=b, distance=distance)
    x, y = a / distance, b / distance
    p, q = math.hypot(1.0, y), math.hypot(1.0, x)
    diagonal = math.hypot(p, x)
    total = 0.5 * math.log1p((x * y / diagonal) ** 2)
    for side, root, other in ((x, p, y), (y, q, x)):
        # root × atan(side / root) - atan(side), without taking the nearly equal from each other
        rise = other * other / (root + 1.0)  # root - 1
        total += side * (rise * math.atan(side / root) - math.atan(side * rise / (root + side * side)))
    return 2.0 * total / (math.pi * x * y)


def perpendicular_rectangles(width: float, height: float, length: float) -> float:
    """From a rectangle to another that stands on one of its edges at a right angle.

    Parameters
    ----------
    width : float
        Of the first rectangle, away from the common edge.
    height : float
        Of the second rectangle.
    length : float
        Of the common edge.

    Returns
    -------
    float

    References
    ----------
    Howell C-14; D. C. Hamilton and W. R. Morgan, NACA TN 2836 (1952).

    Examples
    --------
    >>> round(perpendicular_rectangles(1, 1, 1), 12)
    0.200043776075
    """
    check_positive(width=width, height=height, length=length)
    w, h = width / length, height / length
    r = math.hypot(w, h)
    large, small = max(w, h), min(w, h)
    rise = small * small / (r + large)  # r - large
    total = large * math.atan(rise / (1.0 + r * large)) - rise * math.atan(1.0 / r) + small * math.atan(1.0 / small)
    logs = math.log1p((w * h) ** 2 / (1.0 + r * r))
    for this, other in ((w, h), (h, w)):
        logs += this * this * _log_one_minus(other * other / ((1.0 + this * this) * r * r), this, r)
    return (total + 0.25 * logs) / (math.pi * w)


def _log_one_minus(share: float, this: float, r: float) -> float:
    """ln(1 - share), the rest being this² (1 + r²) / ((1 + this²) r²)."""
    if share < 0.5:
        return math.log1p(-share)
    return math.log(this * this * (1.0 + r * r) / ((1.0 + this * this) * r * r))


def parallel_rectangles_offset(x: Interval, y: Interval, xi: Interval, eta: Interval, distance: float) -> float:
    """From a rectangle to any other in a parallel plane, their sides parallel.

    Parameters
    ----------
    x, y : tuple of two floats
        Where the first rectangle begins and ends along either axis.
    xi, eta : tuple of two floats
        The same for the second rectangle, along the same axes.
    distance : float
        Between the planes.

    Returns
    -------
    float

    References
    ----------
    Howell C-13; J. R. Ehlert and T. F. Smith, J. Thermophysics and Heat Transfer 7 (1993) 173, doi:10.2514/3.11587.

    Examples
    --------
    >>> round(parallel_rectangles_offset((0, 1), (0, 1), (1, 2), (0, 1), 1), 12)
    0.086050489152
    """
    check_positive(distance=distance)
    check_interval(x=x, y=y, xi=xi, eta=eta)

    def corner(u: float, other_u: float, v: float) -> float:
        u -= other_u
        p, q = math.hypot(u, distance), math.hypot(v, distance)
        return v * p * math.atan(v / p) + u * q * math.atan(u / q) - distance**2 * math.log(math.hypot(u, q))

    def element(u: FloatArray, other_u: float, v: FloatArray) -> FloatArray:
        u = other_u - u
        p, q = np.hypot(u, distance), np.hypot(v, distance)
        return u / p * np.arctan(v / p) + v / q * np.arctan(u / q)

    layout = _Layout(
        corner,
        element,
        foot=lambda u: u,
        distance2=lambda u, other_u, v: (u - other_u) ** 2 + v**2 + distance**2,
        cosines=lambda u, other_u: np.full(np.broadcast(u, other_u).shape, distance**2),
    )
    return _exchange_area(layout, (x, y), (xi, eta)) / ((x[1] - x[0]) * (y[1] - y[0]))


def perpendicular_rectangles_offset(x: Interval, y: Interval, eta: Interval, xi: Interval) -> float:
    """From a rectangle to any other in a perpendicular plane, their sides parallel or perpendicular.

    Parameters
    ----------
    x : tuple of two floats
        Where the first rectangle begins and ends, measured from the line in which the planes meet; not negative.
    y : tuple of two floats
        Where it begins and ends along that line.
    eta : tuple of two floats
        Where the second rectangle begins and ends along the line.
    xi : tuple of two floats
        Where it begins and ends, measured from the line; not negative.

    Returns
    -------
    float

    References
    ----------
    Howell C-15; J. R. Ehlert and T. F. Smith, J. Thermophysics and Heat Transfer 7 (1993) 173, doi:10.2514/3.11587.

    Examples
    --------
    >>> round(perpendicular_rectangles_offset((1, 2), (0, 1), (0, 1), (1, 2)), 12)
    0.032938162258
    """
    check_interval(x=x, y=y, eta=eta, xi=xi)
    check_not_negative(x=x[0], xi=xi[0])

    def corner(u: float, other_u: float, v: float) -> float:
        p, r = math.hypot(u, other_u), math.hypot(u, other_u, v)
        if r == 0.0:
            return 0.0
        return v * p * math.atan2(v, p) - 0.5 * (p - v) * (p + v) * math.log(r)

    def element(u: FloatArray, other_u: float, v: FloatArray) -> FloatArray:
        p = np.hypot(u, other_u)
        return -u / p * np.arctan(v / p)

    layout = _Layout(
        corner,
        element,
        foot=lambda u: 0.0 * u,
        distance2=lambda u, other_u, v: u**2 + other_u**2 + v**2,
        cosines=lambda u, other_u: u * other_u,
    )
    return _exchange_area(layout, (x, y), (xi, eta)) / ((x[1] - x[0]) * (y[1] - y[0]))


class _Layout(NamedTuple):
    """How two planes lie to each other; u runs across them, v along the direction they share.

    All of it is the same when the two are exchanged.
    """

    corner: Callable[[float, float, float], float]  # (u, u', v - v'): 2π G as a fourfold antiderivative
    element: Callable[[FloatArray, float, FloatArray], FloatArray]  # (u, u', v' - v): 2π F of an element, twofold
    foot: Callable[[float], float]  # u' nearest to u
    distance2: Callable[..., FloatArray]  # (u, u', v - v')
    cosines: Callable[..., FloatArray]  # (u, u'): cos θ cos θ' r²


def _exchange_area(layout: _Layout, first: Rectangle, second: Rectangle) -> float:
    """Exchange area of two rectangles, by the way that keeps its digits.

    The closed form takes sixteen terms as large as the pair from each other. What is far, or small and at a distance,
    is a smooth integral instead, and so is all but the nearest part of what is huge.
    """
    if _radius(first) > _radius(second):
        first, second = second, first
    (u, v), (other_u, other_v) = _centre(first), _centre(second)
    between = math.sqrt(float(layout.distance2(u, other_u, v - other_v)))
    if between - _radius(first) > APART * _radius(second):
        return _both_apart(layout, first, second)
    near_u, near_v = _clamped(layout.foot(u), second[0]), _clamped(v, second[1])
    if layout.distance2(u, near_u, v - near_v) > (APART * _radius(first)) ** 2:
        return _one_apart(layout, first, second)
    if _radius(second) > HUGE * _radius(first):
        near = 0.5 * HUGE * _radius(first)
        pieces = product(_split(second[0], near_u, near), _split(second[1], near_v, near))
        return sum(_exchange_area(layout, first, piece) for piece in pieces)
    total = 0.0
    for i, j, k, m in product((0, 1), repeat=4):
        sign = (-1) ** (i + j + k + m)
        total += sign * layout.corner(first[0][i], second[0][k], first[1][j] - second[1][m])
    return total / (2.0 * math.pi)


def _both_apart(layout: _Layout, first: Rectangle, second: Rectangle) -> float:
    """∬∬ cos θ cos θ' / (π r²) by a Gauss rule over both areas."""
    u, v, weight = _gauss(first)
    other_u, other_v, other_weight = _gauss(second)
    r2 = layout.distance2(u[:, None], other_u, v[:, None] - other_v)
    return float(weight @ (layout.cosines(u[:, None], other_u) / r2**2) @ other_weight) / math.pi


def _one_apart(layout: _Layout, first: Rectangle, second: Rectangle) -> float:
    """∬ F by a Gauss rule over the first area, F from its elements to the second rectangle in closed form."""
    u, v, weight = _gauss(first)
    total = np.zeros(len(u))
    for k, m in product((0, 1), repeat=2):
        total += (-1) ** (k + m) * layout.element(u, second[0][k], second[1][m] - v)
    return float(weight @ total) / (2.0 * math.pi)


def _gauss(rectangle: Rectangle) -> tuple[FloatArray, FloatArray, FloatArray]:
    nodes, weights = np.polynomial.legendre.leggauss(RULE)
    u, v = (low + 0.5 * (high - low) * (nodes + 1.0) for low, high in rectangle)
    area = (rectangle[0][1] - rectangle[0][0]) * (rectangle[1][1] - rectangle[1][0])
    return np.repeat(u, RULE), np.tile(v, RULE), 0.25 * area * np.outer(weights, weights).ravel()


def _centre(rectangle: Rectangle) -> tuple[float, float]:
    (a, b), (c, d) = rectangle
    return 0.5 * (a + b), 0.5 * (c + d)


def _radius(rectangle: Rectangle) -> float:
    (a, b), (c, d) = rectangle
    return 0.5 * math.hypot(b - a, d - c)


def _split(interval: Interval, at: float, near: float) -> list[Interval]:
    """What of an interval is near a place, and what is beyond on either side."""
    low, high = interval
    cuts = [low, *(cut for cut in (at - near, at + near) if low < cut < high), high]
    return list(pairwise(cuts))


def _clamped(value: float, interval: Interval) -> float:
    return min(max(value, interval[0]), interval[1])
