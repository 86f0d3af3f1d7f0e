"""Disks, spheres, cylinders and cones."""

from __future__ import annotations

import math
from typing import NamedTuple

from ...errors import ParameterError
from .checks import check_positive


class ConcentricFactors(NamedTuple):
    """Between an inner convex body and the surface around it."""

    inner_to_outer: float
    outer_to_inner: float
    outer_to_itself: float
    inner_to_ends: float = 0.0  # both open ends together
    outer_to_ends: float = 0.0


class CylinderFactors(NamedTuple):
    """Inside a closed right circular cylinder; `wall_to_base` is to one of the two bases."""

    wall_to_itself: float
    wall_to_base: float
    base_to_wall: float
    base_to_base: float


class ConeFactors(NamedTuple):
    """Inside a cone, or a spherical cap, closed by its base disk."""

    side_to_itself: float
    side_to_base: float


def coaxial_disks(first: float, second: float, distance: float) -> float:
    """Between two parallel disks on one axis.

    Parameters
    ----------
    first, second : float
        Their radii.
    distance : float

    Returns
    -------
    float

    References
    ----------
    Howell C-41; D. C. Hamilton and W. R. Morgan, NACA TN 2836 (1952).

    Examples
    --------
    >>> round(coaxial_disks(1, 1, 1), 12)
    0.38196601125
    """
    check_positive(first=first, second=second, distance=distance)
    root = math.hypot(first - second, distance) * math.hypot(first + second, distance)
    return 2.0 * second**2 / (first**2 + second**2 + distance**2 + root)


def sphere_to_coaxial_disk(disk_radius: float, distance: float) -> float:
    """From a sphere to a disk whose axis goes through its centre; the radius of the sphere does not matter.

    Parameters
    ----------
    disk_radius : float
    distance : float
        From the centre of the sphere to the disk, at least the radius of the sphere.

    Returns
    -------
    float

    References
    ----------
    A. Feingold and K. G. Gupta, J. Heat Transfer 92 (1970) 69, doi:10.1115/1.3449647.

    Examples
    --------
    >>> round(sphere_to_coaxial_disk(1, 1), 12)
    0.146446609407
    """
    check_positive(disk_radius=disk_radius, distance=distance)
    rim = math.hypot(disk_radius, distance)
    return 0.5 * (disk_radius / rim) * (disk_radius / (rim + distance))


def coaxial_disk_to_sphere(disk_radius: float, sphere_radius: float, distance: float) -> float:
    """From a disk to a sphere on its axis.

    Parameters
    ----------
    disk_radius, sphere_radius : float
    distance : float
        From the disk to the centre of the sphere, at least the radius of the sphere.

    Returns
    -------
    float

    Raises
    ------
    ParameterError
        If the sphere reaches through the disk.

    References
    ----------
    A. Feingold and K. G. Gupta, J. Heat Transfer 92 (1970) 69, doi:10.1115/1.3449647, and reciprocity.
    """
    check_positive(disk_radius=disk_radius, sphere_radius=sphere_radius, distance=distance)
    if sphere_radius > distance:
        raise ParameterError(f"sphere_radius {sphere_radius:g} is more than distance {distance:g}: it meets the disk")
    rim = math.hypot(disk_radius, distance)
    return 2.0 * (sphere_radius / rim) * (sphere_radius / (rim + distance))


def sphere_to_rectangle(a: float, b: float, distance: float) -> float:
    """From a sphere to a rectangle, one corner of which is the foot of the sphere's centre on its plane.

    The radius of the sphere does not matter. Rectangles placed otherwise are sums and differences of four such ones.

    Parameters
    ----------
    a, b : float
        Sides of the rectangle.
    distance : float
        From the centre of the sphere to the plane, at least the radius of the sphere.

    Returns
    -------
    float

    References
    ----------
    A. Feingold and K. G. Gupta, J. Heat Transfer 92 (1970) 69, doi:10.1115/1.3449647.

    Examples
    --------
    >>> round(24 * sphere_to_rectangle(1, 1, 1), 12)  # three such faces make a corner of a cube
    1.0
    """
    check_positive(a=a, b=b, distance=distance)
    diagonal = math.hypot(a, b, distance)
    return math.atan((a / distance) * (b / diagonal)) / (4.0 * math.pi)


def concentric_spheres(inner: float, outer: float) -> ConcentricFactors:
    """Between the outside of a sphere and the inside of one around it.

    Parameters
    ----------
    inner, outer : float
        Their radii.

    Returns
    -------
    ConcentricFactors

    References
    ----------
    R. Siegel and J. R. Howell, Thermal Radiation Heat Transfer.

    Examples
    --------
    >>> concentric_spheres(1, 2)[:3]
    (1.0, 0.25, 0.75)
    """
    _check_inside(inner, outer)
    return ConcentricFactors(1.0, (inner / outer) ** 2, ((outer - inner) / outer) * ((outer + inner) / outer))


def coaxial_cylinders(inner: float, outer: float, length: float = math.inf) -> ConcentricFactors:
    """Between the outside of a cylinder and the inside of one of equal length around it.

    Parameters
    ----------
    inner, outer : float
        Their radii.
    length : float, optional
        Of both, which begin and end together; infinite by default.

    Returns
    -------
    ConcentricFactors
        With the shares that leave through the two open ends.

    Notes
    -----
    Subtracts nearly equal numbers where the gap is wide beside the length: about 1e-16 (radius / length)² is lost.

    References
    ----------
    D. C. Hamilton and W. R. Morgan, NACA TN 2836 (1952); Howell C-91.

    Examples
    --------
    >>> coaxial_cylinders(1, 2)[:3]
    (1.0, 0.5, 0.5)
    """
    _check_inside(inner, outer)
    if length == math.inf:
        return ConcentricFactors(1.0, inner / outer, (outer - inner) / outer)
    check_positive(length=length)
    from_outer = _outer_to_inner(inner / outer, length / outer)
    itself = _outer_to_itself(inner / length, outer / length)
    from_inner = from_outer * outer / inner
    return ConcentricFactors(from_inner, from_outer, itself, 1.0 - from_inner, 1.0 - from_outer - itself)


def _outer_to_inner(radius: float, length: float) -> float:
    """From the outer cylinder to the inner one, in units of the outer radius."""
    r2, l2 = radius * radius, length * length
    a, b = l2 + (1.0 - r2), l2 - (1.0 - r2)
    root = math.hypot(length, 1.0 - radius) * math.hypot(length, 1.0 + radius) / radius
    inner = root * math.acos(radius * b / a) + (b / radius) * math.asin(radius) - 0.5 * math.pi * a / radius
    return radius * (1.0 - (math.acos(b / a) - inner / (2.0 * length)) / math.pi)


def _outer_to_itself(inner: float, outer: float) -> float:
    """From the outer cylinder to itself around the inner one, in units of the length."""
    gap = math.sqrt((outer - inner) * (outer + inner))
    diameter = math.hypot(1.0, 2.0 * outer)
    total = math.pi * (outer - inner) + math.acos(inner / outer)
    total += 2.0 * inner * math.atan(2.0 * gap) - diameter * math.atan(diameter * gap / inner)
    return total / (math.pi * outer)


def _check_inside(inner: float, outer: float) -> None:
    check_positive(inner=inner, outer=outer)
    if inner >= outer:
        raise ParameterError(f"inner {inner:g} is not less than outer {outer:g}")


def cylinder_interior(radius: float, height: float) -> CylinderFactors:
    """Inside a closed right circular cylinder.

    Parameters
    ----------
    radius, height : float

    Returns
    -------
    CylinderFactors

    References
    ----------
    Howell C-78 (wall to itself) and C-40 (base to base); the rest by closure and reciprocity.

    Examples
    --------
    >>> wall, wall_to_base, base_to_wall, base = cylinder_interior(1, 2)
    >>> round(wall + 2 * wall_to_base, 12), round(base + base_to_wall, 12)
    (1.0, 1.0)
    """
    check_positive(radius=radius, height=height)
    h = height / (2.0 * radius)
    slant = math.hypot(1.0, h)
    to_base = 0.5 / (slant + h)
    itself = h * (1.0 - h / (slant + 1.0)) if h < 1.0 else 1.0 - 2.0 * to_base  # 1 + h - slant
    return CylinderFactors(itself, to_base, 4.0 * h * to_base, 1.0 / (slant + h) ** 2)


def cone_interior(radius: float, height: float) -> ConeFactors:
    """Inside a right circular cone closed by its base.

    Parameters
    ----------
    radius : float
        Of the base.
    height : float

    Returns
    -------
    ConeFactors

    References
    ----------
    By closure and reciprocity: all that leaves the base arrives at the side.

    Examples
    --------
    >>> side_to_itself, side_to_base = cone_interior(3, 4)
    >>> side_to_itself, side_to_base
    (0.4, 0.6)
    """
    check_positive(radius=radius, height=height)
    slant = math.hypot(radius, height)
    return ConeFactors((height / slant) * (height / (slant + radius)), radius / slant)


def sphere_interior(area: float, radius: float) -> float:
    """From anywhere inside a sphere to a piece of it: its share of the sphere's area.

    Parameters
    ----------
    area : float
        Of the receiving piece.
    radius : float
        Of the sphere.

    Returns
    -------
    float

    Raises
    ------
    ParameterError
        A piece larger than the sphere.

    References
    ----------
    J. A. Jacquez and H. F. Kuppenheim, J. Opt. Soc. Am. 45 (1955) 460, doi:10.1364/JOSA.45.000460.
    """
    check_positive(area=area, radius=radius)
    share = area / (4.0 * math.pi * radius**2)
    if share > 1.0 + 1e-12:
        raise ParameterError(f"area {area:g} is more than that of a sphere of radius {radius:g}")
    return min(share, 1.0)


def spherical_cap_interior(angle: float) -> ConeFactors:
    """Inside a spherical cap closed by its base disk.

    Parameters
    ----------
    angle : float
        Half the angle under which the cap is seen from the centre of its sphere: π / 2 for a hemisphere.

    Returns
    -------
    ConeFactors

    Raises
    ------
    ParameterError
        An angle outside 0 … π.

    References
    ----------
    J. A. Jacquez and H. F. Kuppenheim, J. Opt. Soc. Am. 45 (1955) 460, doi:10.1364/JOSA.45.000460.
    """
    if not 0.0 < angle < math.pi:
        raise ParameterError(f"angle {angle:g} is outside 0 … π")
    return ConeFactors(math.sin(0.5 * angle) ** 2, math.cos(0.5 * angle) ** 2)
