"""Open scenes with answers known in closed form or by other software: plates, a wall under a sky, lone spheres."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ..scene import Material, Scene, Surface
from .build import paint, panel, sphere


def parallel_plates(
    reflectance: ArrayLike = 0.5, emission: ArrayLike = 1.0, size: float = 1.0, distance: float = 1.0
) -> Scene:
    """Two square plates face to face in a black void; the lower one emits.

    Between unit squares at distance 1 the form factor is 0.199824895698387 (J. R. Howell, "A Catalog of Radiation
    Heat Transfer Configuration Factors", C-11); close together it tends to 1.

    Parameters
    ----------
    reflectance : array_like (C,), optional
        Of both plates.
    emission : array_like (C,), optional
        Exitance of the lower plate, W/m².
    size, distance : float, optional
        m.

    Returns
    -------
    Scene
        Surfaces lower, upper, with `closed` False.
    """
    rho, light = np.asarray(reflectance, dtype=np.float64), np.asarray(emission, dtype=np.float64)
    lower = Surface("lower", *panel((0, 0, 0), (size, 0, size), +1), Material(rho, emission=light, name="lower"))
    upper = Surface("upper", *panel((0, distance, 0), (size, distance, size), -1), Material(rho, name="upper"))
    return Scene((lower, upper), name="parallel_plates", closed=False)


def open_rug(sky: ArrayLike = (1.0, 1.0, 1.0)) -> Scene:
    """A white floor, 4 × 4 m, with a red wall, 2 m high, on one edge, under a sky of constant radiance.

    The smallest scene with colour bleeding: the floor turns red towards the wall. Nothing hides anything, so that
    exact form factors exist.

    Parameters
    ----------
    sky : array_like (C,), optional
        Radiance from every direction, W/(m² sr).

    Returns
    -------
    Scene
        RGB; surfaces floor, red_wall, one-sided, with `closed` False.
    """
    floor = Surface("floor", *panel((0, 0, 0), (4, 0, 4), +1), paint("white", [0.7, 0.7, 0.7]))
    red = Surface("red_wall", *panel((0, 0, 0), (0, 2, 4), +1), paint("red", [0.63, 0.065, 0.05]))
    return Scene((floor, red), sky=np.asarray(sky, dtype=np.float64), name="open_rug", closed=False)


def uniform_dome(reflectance: ArrayLike = 0.5, sky: ArrayLike = 1.0, subdivisions: int = 2) -> Scene:
    """A matte ball under a sky of equal radiance from everywhere: it leaves ρ times the sky's radiance, exactly.

    Every point of a convex body sees half the sky and nothing of itself, so that its radiosity is ρ π L_sky whatever
    its shape. With ρ = 1 it would be invisible against the sky.

    Parameters
    ----------
    reflectance : array_like (C,), optional
    sky : array_like (C,), optional
        W/(m² sr).
    subdivisions : int, optional
        The ball has 20 × 4^subdivisions triangles.

    Returns
    -------
    Scene
        Surface ball of radius 1 m around the origin, with `closed` False.
    """
    ball = Surface("ball", *sphere((0, 0, 0), 1.0, subdivisions, +1), paint("matte", reflectance))
    return Scene((ball,), sky=np.asarray(sky, dtype=np.float64), name="uniform_dome", closed=False)


def lit_sphere(reflectance: ArrayLike = 0.8, subdivisions: int = 4) -> Scene:
    """A matte ball lit by one lamp ten radii away: Lambert's cosine fades it out towards the terminator.

    Without the cosine the lit half would be evenly bright up to a hard edge. The lamp, a black panel of 2 × 2 m, is as
    bright as makes the irradiance where its light falls straight on the middle of the ball π W/m² (in the limit of
    a small lamp), so that the brightest spot has about the radiance ρ.

    Parameters
    ----------
    reflectance : array_like (C,), optional
        Of the ball.
    subdivisions : int, optional
        The ball has 20 × 4^subdivisions triangles.

    Returns
    -------
    Scene
        Surfaces ball (radius 1 m, around the origin), lamp, with `closed` False.
    """
    rho = np.atleast_1d(np.asarray(reflectance, dtype=np.float64))
    ball = Surface("ball", *sphere((0, 0, 0), 1.0, subdivisions, +1), paint("matte", rho))
    distance, half = 10.0, 1.0
    towards = np.array([0.75, 0.6, 0.28])  # seen from +z: from the right, above, a little in front
    towards /= np.linalg.norm(towards)
    across = np.cross([0.0, 1.0, 0.0], towards)
    across /= np.linalg.norm(across)
    up = np.cross(towards, across)
    corners = [distance * towards + half * (u * across + v * up) for u, v in ((-1, -1), (-1, 1), (1, 1), (1, -1))]
    radiance = np.full(rho.shape, np.pi * (distance - 1.0) ** 2 / (2 * half) ** 2)
    lamp = Surface("lamp", np.array(corners), np.array([[0, 1, 2, 3]]), paint("lamp", np.zeros(rho.shape), radiance))
    return Scene((ball, lamp), name="lit_sphere", closed=False)
