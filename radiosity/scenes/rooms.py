"""Single rooms: some with a known answer, some with a lesson."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from ..scene import Material, Scene, Surface
from .build import block, floor_around, paint, panel, room, sphere


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
    walls = Material(reflectance, absorptance, emission, name="wall")
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


def window_room(sky: ArrayLike = (4.0, 4.5, 5.5)) -> Scene:
    """A room, 5 × 2.7 × 4 m, softly lit by the sky through one window, with an orange chest.

    The window is an opening in the left wall; whatever leaves through it is lost to the sky. Order 1 is the sky's
    light; behind the chest and beside the window only later orders arrive.

    Parameters
    ----------
    sky : array_like (3,), optional
        Radiance, W/(m² sr).

    Returns
    -------
    Scene
        RGB; surfaces floor, ceiling, back_wall, front_wall, left_wall (with the opening), right_wall, chest, with
        `closed` False.
    """
    white, wood = paint("white", [0.8, 0.8, 0.78]), paint("wood", [0.45, 0.34, 0.24])
    size = (5.0, 2.7, 4.0)
    window = ((0.0, 0.9, 1.2), (0.0, 2.2, 2.8))
    foot = np.array([[2.6, 1.3], [3.5, 1.0], [3.7, 1.6], [2.8, 1.9]])
    surfaces = room((0, 0, 0), size, white, {"left_wall": [window]}, leave_out=["floor"])
    outline = [(0.0, 0.0), (size[0], 0.0), (size[0], size[2]), (0.0, size[2])]
    surfaces.insert(0, Surface("floor", *floor_around(outline, [foot]), wood))
    surfaces.append(Surface("chest", *block(foot, 0.0, 0.8, closed=False), paint("orange", [0.7, 0.28, 0.06])))
    return Scene(tuple(surfaces), sky=np.asarray(sky, dtype=np.float64), name="window_room", closed=False)


def hidden_lamp() -> Scene:
    """A closed room, 4 × 2.6 × 4 m, lit only by way of its ceiling: the lamp is the upper side of a hanging board.

    No light goes straight below the board's upper side: at order 1 the floor, the blue chest and the lower parts of
    the walls, which are separate surfaces, are exactly black. All that one sees of them is indirect light.

    Returns
    -------
    Scene
        RGB; surfaces floor, ceiling, back_wall, front_wall, left_wall, right_wall (below the lamp's height), the four
        walls again with _above, board, lamp, chest, with `closed` True.
    """
    white, wood = paint("white", [0.8, 0.8, 0.78]), paint("wood", [0.45, 0.34, 0.24])
    level, height = 1.9, 2.6
    foot = np.array([[0.7, 0.8], [1.5, 0.6], [1.7, 1.3], [0.9, 1.5]])
    outline = [(0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (0.0, 4.0)]
    surfaces = [Surface("floor", *floor_around(outline, [foot]), wood)]
    surfaces += room((0, 0, 0), (4, level, 4), white, leave_out=["floor", "ceiling"])
    for surface in room((0, level, 0), (4, height, 4), white, leave_out=["floor"]):
        surfaces.append(surface if surface.name == "ceiling" else replace(surface, name=f"{surface.name}_above"))
    vertices, faces = block([[1.0, 1.2], [3.0, 1.2], [3.0, 2.8], [1.0, 2.8]], level - 0.1, level, closed=True)
    surfaces.append(Surface("board", vertices, faces[1:], white))
    surfaces.append(Surface("lamp", vertices, faces[:1], paint("lamp", [0.8] * 3, radiance=[12.0, 11.5, 10.5])))
    surfaces.append(Surface("chest", *block(foot, 0.0, 0.8, closed=False), paint("blue", [0.1, 0.2, 0.6])))
    return Scene(tuple(surfaces), name="hidden_lamp", closed=True)


def integrating_sphere(
    reflectance: ArrayLike = 0.95, emission: ArrayLike = 1.0, radius: float = 1.0, subdivisions: int = 3
) -> Scene:
    """A hollow matte sphere with a lamp on its top: it lights itself evenly, wherever the lamp is.

    In a sphere every point sees every other equally, F = 1 / (4π R²) per area, so that from order 1 on the irradiance
    is the same everywhere: power of the lamp × ρ^(k-1) / (4π R²) at order k (D. G. Goebel, "Generalized
    integrating-sphere theory", Applied Optics 6 (1967), doi:10.1364/AO.6.000125). The mesh is a sphere of flat
    triangles, so this holds up to their coarseness, about 2 % rms per facet for 1280.

    Parameters
    ----------
    reflectance : array_like (C,), optional
        Of wall and lamp.
    emission : array_like (C,), optional
        Exitance of the lamp, W/m².
    radius : float, optional
        m.
    subdivisions : int, optional
        The sphere has 20 × 4^subdivisions triangles; those within 25° of the top are the lamp.

    Returns
    -------
    Scene
        Surfaces wall, lamp, with `closed` True.
    """
    vertices, faces = sphere((0, 0, 0), radius, subdivisions, -1)
    middles = vertices[faces].mean(axis=1)
    top = middles[:, 1] > np.cos(np.deg2rad(25)) * np.linalg.norm(middles, axis=1)
    rho, light = np.asarray(reflectance, dtype=np.float64), np.asarray(emission, dtype=np.float64)
    wall = Surface("wall", vertices, faces[~top], Material(rho, name="wall"))
    lamp = Surface("lamp", vertices, faces[top], Material(rho, emission=light, name="lamp"))
    return Scene((wall, lamp), name="integrating_sphere", closed=True)
