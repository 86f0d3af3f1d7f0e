"""Infinitely long surfaces of one cross-section: Hottel's strings, and cylinders."""

from __future__ import annotations

import math
from collections.abc import Sequence

from ...errors import ParameterError
from .checks import check_positive

Point = Sequence[float]


def crossed_strings(first: tuple[Point, Point], second: tuple[Point, Point]) -> float:
    """Between two strips of any cross-section that see each other whole, by the ends alone.

    Half the difference between the strings that cross over and those that do not, over the first strip's width.

    Parameters
    ----------
    first, second : tuple of two points (x, y)
        The ends of each strip in the cross-section. The straight strips face each other: neither reaches behind the
        line of the other.

    Returns
    -------
    float

    References
    ----------
    H. C. Hottel and A. F. Sarofim, Radiative Transfer (1967); Howell C-2a and C-5a.

    Examples
    --------
    >>> round(crossed_strings(((0, 0), (1, 0)), ((0, 1), (1, 1))), 12)
    0.414213562373
    """
    (a, b), (c, d) = first, second
    width = math.dist(a, b)
    if not (width > 0.0 and math.isfinite(width)):
        raise ParameterError(f"the first strip runs from {a} to {b}; give it a width")
    return abs(_difference(a, c, d) - _difference(b, c, d)) / (2.0 * width)


def _difference(p: Point, c: Point, d: Point) -> float:
    """|pc| - |pd| without subtracting lengths: (d - c) · (2 p - c - d) / (|pc| + |pd|)."""
    both = math.dist(p, c) + math.dist(p, d)
    if both == 0.0:
        return 0.0
    return sum((d[k] - c[k]) * ((p[k] - c[k]) + (p[k] - d[k])) for k in range(2)) / both


def parallel_strips(width: float, distance: float) -> float:
    """Between two directly opposed parallel strips of equal width.

    Parameters
    ----------
    width, distance : float

    Returns
    -------
    float

    References
    ----------
    Howell C-1.

    Examples
    --------
    >>> round(parallel_strips(1, 1), 12)
    0.414213562373
    """
    check_positive(width=width, distance=distance)
    return width / (math.hypot(width, distance) + distance)


def perpendicular_strips(width: float, height: float) -> float:
    """From a strip to another one that stands on its edge at a right angle.

    Parameters
    ----------
    width : float
        Of the first strip.
    height : float
        Of the second strip.

    Returns
    -------
    float

    References
    ----------
    Howell C-3.
    """
    check_positive(width=width, height=height)
    return height / (width + height + math.hypot(width, height))


def strips_in_a_wedge(angle: float) -> float:
    """Between two strips of equal width that share an edge.

    Parameters
    ----------
    angle : float
        Between them, 0 to π.

    Returns
    -------
    float
        1 - sin(angle / 2).

    Raises
    ------
    ParameterError
        An angle outside 0 … π.

    References
    ----------
    H. C. Hottel and A. F. Sarofim, Radiative Transfer (1967); Howell C-5 with equal widths.
    """
    if not 0.0 <= angle <= math.pi:
        raise ParameterError(f"angle {angle:g} is outside 0 … π")
    return 2.0 * math.sin(0.25 * (math.pi - angle)) ** 2


def long_triangular_duct(first: float, second: float, third: float) -> float:
    """From the first to the second side of a long duct of triangular cross-section.

    The sides may be bent inwards; their lengths are then those of taut strings.

    Parameters
    ----------
    first, second, third : float
        Lengths of the sides.

    Returns
    -------
    float

    Raises
    ------
    ParameterError
        Lengths that make no triangle.

    References
    ----------
    H. C. Hottel and A. F. Sarofim, Radiative Transfer (1967).

    Examples
    --------
    >>> round(long_triangular_duct(3, 4, 5), 12)
    0.333333333333
    """
    check_positive(first=first, second=second, third=third)
    a, b, c = sorted((first, second, third))
    if a + b < c:
        raise ParameterError(f"sides {first:g}, {second:g} and {third:g} make no triangle")
    low, high = sorted((first, second))
    excess = low - (third - high)  # this way exact for needles, whose first and second side nearly fill the third
    return max(0.0, excess) / (2.0 * first)


def parallel_cylinders(radius: float, gap: float) -> float:
    """Between two infinitely long parallel cylinders of equal radius.

    Parameters
    ----------
    radius : float
    gap : float
        Between the cylinders, where they are nearest; 0 if they touch.

    Returns
    -------
    float

    References
    ----------
    H. C. Hottel and A. F. Sarofim, Radiative Transfer (1967), by crossed strings.

    Examples
    --------
    >>> round(parallel_cylinders(1, 0), 12)
    0.181690113816
    """
    check_positive(radius=radius)
    if not (gap >= 0.0 and math.isfinite(gap)):
        raise ParameterError(f"gap is {gap:g}; the cylinders must not reach into each other")
    x = 1.0 + gap / (2.0 * radius)
    return (math.asin(1.0 / x) - 1.0 / (x + math.sqrt((x - 1.0) * (x + 1.0)))) / math.pi


def cylinder_to_strip(distance: float, near: float, far: float) -> float:
    """From an infinitely long cylinder to a parallel plane strip.

    Parameters
    ----------
    distance : float
        Of the cylinder's axis from the strip's plane, more than its radius (which does not matter).
    near, far : float
        Where the strip begins and ends, from the foot of the axis on its plane; may be negative.

    Returns
    -------
    float

    References
    ----------
    A. Feingold and K. G. Gupta, J. Heat Transfer 92 (1970) 69, doi:10.1115/1.3449647; Howell C-62.
    """
    check_positive(distance=distance)
    if not (math.isfinite(near) and math.isfinite(far) and near < far):
        raise ParameterError(f"the strip runs from {near:g} to {far:g}; give two finite ends, the lower one first")
    return math.atan2(distance * (far - near), distance * distance + near * far) / (2.0 * math.pi)
