"""From small plane elements to rectangles, disks and spheres."""

from __future__ import annotations

import math

from ...errors import ParameterError
from .checks import check_not_negative, check_positive


def element_to_parallel_rectangle(a: float, b: float, distance: float) -> float:
    """From an element to a parallel rectangle with one corner straight above it.

    Rectangles placed otherwise are sums and differences of four such ones.

    Parameters
    ----------
    a, b : float
        Sides of the rectangle.
    distance : float
        Between the element and the corner.

    Returns
    -------
    float

    References
    ----------
    D. C. Hamilton and W. R. Morgan, Radiant-interchange configuration factors, NACA TN 2836 (1952).

    Examples
    --------
    >>> round(element_to_parallel_rectangle(1, 1, 1), 12)
    0.138531605995
    """
    check_positive(a=a, b=b, distance=distance)
    to_a, to_b = math.hypot(a, distance), math.hypot(b, distance)
    return (a / to_a * math.atan(b / to_a) + b / to_b * math.atan(a / to_b)) / (2.0 * math.pi)


def element_to_perpendicular_rectangle(height: float, width: float, distance: float) -> float:
    """From an element to a rectangle that stands on the element's plane, one foot straight in front of it.

    Parameters
    ----------
    height : float
        Of the rectangle, along the element's normal.
    width : float
        Of the rectangle's foot, which begins at the point nearest to the element.
    distance : float
        Between the element and that point; 0 (the element at the foot) is allowed.

    Returns
    -------
    float

    References
    ----------
    D. C. Hamilton and W. R. Morgan, Radiant-interchange configuration factors, NACA TN 2836 (1952).

    Examples
    --------
    >>> round(element_to_perpendicular_rectangle(1, 1, 1), 12)
    0.055734197003
    """
    check_positive(height=height, width=width)
    check_not_negative(distance=distance)
    top = math.hypot(height, distance)
    rise = height * height / (top + distance)  # top - distance
    below = math.atan(width * rise / (width * width + top * distance))  # atan(w / distance) - atan(w / top)
    return (below + rise / top * math.atan(width / top)) / (2.0 * math.pi)


def element_to_parallel_disk(radius: float, distance: float, offset: float = 0.0) -> float:
    """From an element to a disk in a parallel plane.

    Parameters
    ----------
    radius : float
        Of the disk.
    distance : float
        Between the two planes.
    offset : float, optional
        Of the element from the axis of the disk.

    Returns
    -------
    float

    References
    ----------
    D. C. Hamilton and W. R. Morgan, Radiant-interchange configuration factors, NACA TN 2836 (1952).

    Examples
    --------
    >>> element_to_parallel_disk(radius=1, distance=1)
    0.5
    """
    check_positive(radius=radius, distance=distance)
    check_not_negative(offset=offset)
    root = math.hypot(offset - radius, distance) * math.hypot(offset + radius, distance)
    outside = (offset - radius) * (offset + radius) + distance * distance
    if outside > 0.0:
        return 2.0 * (radius * distance / root) * (radius * distance / (root + outside))
    return 0.5 * (1.0 - outside / root)


def element_to_perpendicular_disk(radius: float, height: float, offset: float) -> float:
    """From an element to a disk whose plane is perpendicular to the element's, and which it looks towards.

    Parameters
    ----------
    radius : float
        Of the disk.
    height : float
        Of the element over the disk's plane.
    offset : float
        Of the element from the axis of the disk, at least `radius`: the whole disk is above its horizon. The
        element's normal points straight at the axis.

    Returns
    -------
    float

    Raises
    ------
    ParameterError
        If `offset` is less than `radius`.

    References
    ----------
    D. C. Hamilton and W. R. Morgan, Radiant-interchange configuration factors, NACA TN 2836 (1952).
    """
    check_positive(radius=radius, height=height, offset=offset)
    if offset < radius:
        raise ParameterError(f"offset {offset:g} is less than the radius {radius:g}; the horizon would cut the disk")
    root = math.hypot(offset - radius, height) * math.hypot(offset + radius, height)
    total = offset * offset + height * height + radius * radius
    return 2.0 * (radius * height / root) * (radius * offset / (total + root))


def element_to_sphere(radius: float, distance: float, angle: float = 0.0) -> float:
    """From an element to a sphere, of which the horizon may hide a part.

    Parameters
    ----------
    radius : float
        Of the sphere.
    distance : float
        From the element to the centre, more than `radius`.
    angle : float, optional
        Between the element's normal and the direction of the centre, 0 to π.

    Returns
    -------
    float

    Raises
    ------
    ParameterError
        If the element is inside the sphere, or the angle outside 0 … π.

    References
    ----------
    J. M. Snyder, Area light sources for real-time graphics, MSR-TR-96-11 (1996), for the part below the horizon.

    Examples
    --------
    >>> element_to_sphere(radius=1, distance=2)
    0.25
    """
    check_positive(radius=radius, distance=distance)
    if distance <= radius:
        raise ParameterError(f"distance {distance:g} is not more than the radius {radius:g}; stay out of the sphere")
    if not 0.0 <= angle <= math.pi:
        raise ParameterError(f"angle {angle:g} is outside 0 … π")
    sine, cosine = radius / distance, math.cos(angle)
    if cosine >= sine:
        return cosine * sine * sine
    if cosine <= -sine:
        return 0.0
    width = math.sqrt((1.0 - sine) * (1.0 + sine))  # cosine of the angular radius
    root = math.sqrt((sine - cosine) * (sine + cosine))
    lens = math.atan2(root, width) - width * root
    turn = math.atan2(root, -width * cosine)
    return max(0.0, lens + sine * sine * cosine * turn) / math.pi  # a last sliver is less than its rounding
