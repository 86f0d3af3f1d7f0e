"""Closed rooms: the furnace, whose answer is known, and a lit room with a red rug."""

from __future__ import annotations

from numpy.typing import ArrayLike

from ..scene import Material, Scene, Surface
from .build import paint, panel, room


def furnace(
    reflectance: ArrayLike | None = None,
    absorptance: ArrayLike | None = None,
    emission: ArrayLike = 1.0,
    size: float = 1.0,
) -> Scene:
    """A closed cube whose six walls are all alike: every order is known, B_k = ρ^k E, and the sum is E / (1 - ρ).

    Whatever the form factors, as long as their rows sum to 1, this answer is exact, so that it tests everything
    but the factors themselves.

    Parameters
    ----------
    reflectance, absorptance : array_like (C,), optional
        Give one of them; a reflectance of 0.5 if neither.
    emission : array_like (C,), optional
        Exitance of the walls, W/m².
    size : float, optional
        Length of an edge, m.

    Returns
    -------
    Scene
        Surfaces floor, ceiling, back_wall, front_wall, left_wall, right_wall, with `closed` True.

    Examples
    --------
    >>> furnace(absorptance=1e-6).surfaces[0].material.given
    'absorptance'
    """
    if reflectance is None and absorptance is None:
        reflectance = 0.5
    walls = Material(reflectance, absorptance, emission, name="wall")  # type: ignore[arg-type]
    return Scene(tuple(room((0, 0, 0), (size, size, size), walls)), name="furnace", closed=True)


def red_rug() -> Scene:
    """A closed white room, 4 × 2.6 × 4 m, with a lamp in the ceiling and a red rug that turns the walls pink.

    The lamp fills a hole in the ceiling and the rug one in the wooden floor, so that no two faces coincide and no
    floor is covered. Under direct light alone the white ceiling is black and the walls are grey; the pink comes
    with order 2.

    Returns
    -------
    Scene
        RGB; surfaces floor, ceiling, back_wall, front_wall, left_wall, right_wall, rug, lamp, with `closed` True.
    """
    white, wood, red = paint("white", [0.8] * 3), paint("wood", [0.45, 0.38, 0.3]), paint("red", [0.63, 0.065, 0.05])
    lamp = paint("lamp", [0.8] * 3, radiance=[12.0, 11.0, 9.5])
    rug_area = ((0.5, 0.0, 0.5), (3.5, 0.0, 3.5))
    lamp_area = ((1.5, 2.6, 1.5), (2.5, 2.6, 2.5))
    surfaces = room(
        (0, 0, 0), (4, 2.6, 4), {"walls": white, "floor": wood}, {"floor": [rug_area], "ceiling": [lamp_area]}
    )
    surfaces += [Surface("rug", *panel(*rug_area, +1), red), Surface("lamp", *panel(*lamp_area, -1), lamp)]
    return Scene(tuple(surfaces), name="red_rug", closed=True)
