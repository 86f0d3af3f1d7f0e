"""Rooms in a row, joined by doors or pinholes: light finds the far ones late, and solvers find them hard."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from ..errors import ParameterError
from ..scene import Material, Scene, Surface
from .build import Mesh, Range, frame, panel, wall

WIDTH, HEIGHT, DEPTH = 4.0, 2.6, 4.0  # of one room, m: x, y, z
DOOR = (0.9, 2.0)


def two_rooms(
    door: float | Sequence[float] = DOOR,
    reflectance: ArrayLike | None = None,
    absorptance: ArrayLike | None = None,
) -> Scene:
    """Two rooms with a door or a pinhole between them, and a lamp in the ceiling of the first.

    The smaller the opening, the longer light stays in the first room: of what arrives at the wall between them only
    the share of the opening's area gets through, so that the second room fills slowly, and solvers that pass light
    on bounce by bounce need many of them when the walls absorb little.

    Parameters
    ----------
    door : float or (float, float), optional
        Width and height of a door that stands on the floor, m; one number: the side of a square hole in the
        middle of the wall, down to a pinhole.
    reflectance, absorptance : array_like (C,), optional
        Of everything; give one of them; a reflectance of 0.8 if neither.

    Returns
    -------
    Scene
        Surfaces floor_1, ceiling_1, back_wall_1, front_wall_1, the same with _2, left_wall, right_wall, lamp, and
        partition_1 between the rooms, which is thin and two-sided; with `closed` True.

    Raises
    ------
    ParameterError
        An opening that does not fit into the wall.
    """
    return _chain("two_rooms", [door], False, _wall_material(reflectance, absorptance))


def corridor(
    rooms: int = 4,
    door: float | Sequence[float] = DOOR,
    reflectance: ArrayLike | None = None,
    absorptance: ArrayLike | None = None,
) -> Scene:
    """A row of rooms with doors on alternating sides, and a lamp in the ceiling of the first only.

    No straight line passes through three doors, so that light has to bounce on its way: each room is fainter than
    the one before, and gets its light some bounces later.

    Parameters
    ----------
    rooms : int, optional
        At least 1.
    door, reflectance, absorptance
        As for `two_rooms`. Square holes are in the middle of their walls and do not alternate.

    Returns
    -------
    Scene
        Surfaces named as in `two_rooms`, counted from 1; with `closed` True.

    Raises
    ------
    ParameterError
        No room, or an opening that does not fit into the wall.
    """
    if rooms < 1:
        raise ParameterError(f"rooms is {rooms}; a corridor has at least 1")
    return _chain("corridor", [door] * (rooms - 1), True, _wall_material(reflectance, absorptance))


def _wall_material(reflectance: ArrayLike | None, absorptance: ArrayLike | None) -> Material:
    if reflectance is None and absorptance is None:
        reflectance = 0.8
    return Material(reflectance, absorptance, name="wall")


def _chain(name: str, doors: Sequence[float | Sequence[float]], alternate: bool, walls: Material) -> Scene:
    surfaces = []
    lamp = ((1.5, HEIGHT, 1.5), (2.5, HEIGHT, 2.5))
    for k in range(len(doors) + 1):
        low, high = (k * WIDTH, 0.0, 0.0), ((k + 1) * WIDTH, HEIGHT, DEPTH)
        for part in ("floor", "ceiling", "back_wall", "front_wall"):
            holes = [lamp] if part == "ceiling" and k == 0 else []
            surfaces.append(Surface(f"{part}_{k + 1}", *wall(part, low, high, holes), walls))
    ends = (0.0, 0.0, 0.0), ((len(doors) + 1) * WIDTH, HEIGHT, DEPTH)
    surfaces += [Surface(part, *wall(part, *ends), walls) for part in ("left_wall", "right_wall")]
    light = np.full(walls.channels, np.pi * 10.0)
    surfaces.append(Surface("lamp", *panel(*lamp, -1), walls.replace(emission=light, name="lamp")))
    for k, door in enumerate(doors):
        mesh = _partition((k + 1) * WIDTH, door, side=k % 2 if alternate else None)
        if mesh is not None:
            surfaces.append(Surface(f"partition_{k + 1}", *mesh, walls.replace(two_sided=True, name="partition")))
    return Scene(tuple(surfaces), name=name, closed=True)


def _partition(x: float, door: float | Sequence[float], side: int | None) -> Mesh | None:
    """The wall at x with its opening, or None where the opening is all of it."""
    low, high = (x, 0.0, 0.0), (x, HEIGHT, DEPTH)
    size = np.atleast_1d(np.asarray(door, dtype=np.float64))
    if size.shape not in ((1,), (2,)):
        raise ParameterError(f"door is {door!r}; give width and height, or the side of a square hole, m")
    width, height = float(size[0]), float(size[-1])
    if not (0 < width <= DEPTH and 0 < height <= HEIGHT):
        raise ParameterError(f"door is {width:g} × {height:g} m; it must fit into a wall of {DEPTH:g} × {HEIGHT:g} m")
    if width == DEPTH and height == HEIGHT:
        return None
    if size.size == 1 and width < HEIGHT:
        y, z = (HEIGHT - width) / 2, (DEPTH - width) / 2
        return frame(low, high, +1, ((x, y, z), (x, y + width, z + width)))
    gap = DEPTH - width
    start = gap / 2 if side is None else (0.1 * gap if side == 0 else 0.9 * gap)
    hole: Range = ((x, 0.0, start), (x, height, min(start + width, DEPTH)))
    return panel(low, high, +1, [hole])
