"""A room full of boxes: as much occlusion as one wants."""

from __future__ import annotations

import numpy as np

from ..errors import ParameterError
from ..scene import Scene, Surface
from .build import FloatArray, block, floor_around, paint, panel, room

SIZE = (6.0, 3.0, 6.0)  # m
COVERED = 0.3  # share of the floor that the circles around the boxes take, at most
GAP = 1.1  # distance between two boxes' circles, over the sum of their radii


def cluttered_room(objects: int = 30, seed: int = 0) -> Scene:
    """A closed white room, 6 × 3 × 6 m, with coloured boxes, turned every way, standing on the floor.

    The boxes do not touch each other or the walls; more of them are smaller. The floor is cut away under them. The
    same numbers give the same room anywhere: numpy's `Generator(PCG64(seed))` draws it.

    Parameters
    ----------
    objects : int, optional
        Number of boxes.
    seed : int, optional

    Returns
    -------
    Scene
        RGB; surfaces floor, ceiling, back_wall, front_wall, left_wall, right_wall, lamp, box_1, box_2, …, with
        `closed` True.

    Raises
    ------
    ParameterError
        A negative number of boxes.
    """
    if objects < 0:
        raise ParameterError(f"objects is {objects}; give 0 or more")
    generator = np.random.Generator(np.random.PCG64(seed))
    width, height, depth = SIZE
    centres, radii = _circles(objects, generator)
    prints = [_footprint(c, r, generator) for c, r in zip(centres, radii, strict=True)]
    tops = generator.uniform(0.15, 0.6, objects) * height * np.minimum(1.0, radii / 0.25)
    colours = generator.uniform(0.15, 0.8, (objects, 3))
    white = paint("white", [0.8, 0.8, 0.78])
    light = ((2.2, height, 2.2), (3.8, height, 3.8))
    surfaces = room((0, 0, 0), SIZE, white, {"ceiling": [light]}, leave_out=["floor"])
    outline = [(0.0, 0.0), (width, 0.0), (width, depth), (0.0, depth)]
    surfaces.insert(0, Surface("floor", *floor_around(outline, prints), paint("floor", [0.5, 0.48, 0.45])))
    surfaces.append(Surface("lamp", *panel(*light, -1), paint("lamp", [0.8] * 3, [12.0, 11.5, 10.5])))
    for k in range(objects):
        mesh = block(prints[k], 0.0, float(tops[k]), closed=False)
        surfaces.append(Surface(f"box_{k + 1}", *mesh, paint(f"paint_{k + 1}", colours[k])))
    return Scene(tuple(surfaces), name="cluttered_room", closed=True)


def _circles(count: int, generator: np.random.Generator) -> tuple[FloatArray, FloatArray]:
    """Centres (x, z) and radii of circles that lie apart on the floor, largest first.

    Dropped at random until they fit; where the floor is too full, all shrink a little.
    """
    width, _, depth = SIZE
    typical = min(0.7, np.sqrt(COVERED * width * depth / (np.pi * max(count, 1))))
    radii = np.sort(generator.uniform(0.6, 1.0, count))[::-1] * typical
    centres = np.zeros((count, 2))
    for k in range(count):
        for attempt in range(100_000):
            if attempt % 1000 == 999:
                radii[k:] *= 0.9
            margin = 1.05 * radii[k]
            spot = generator.uniform(margin, (width - margin, depth - margin))
            if (np.linalg.norm(centres[:k] - spot, axis=1) > GAP * (radii[:k] + radii[k])).all():
                centres[k] = spot
                break
    return centres, radii


def _footprint(centre: FloatArray, radius: float, generator: np.random.Generator) -> FloatArray:
    """Corners (4, 2) of a rectangle in a circle, turned by any angle."""
    slant, turn = generator.uniform(0.45, 1.1), generator.uniform(0.0, np.pi)
    angles = turn + np.array([slant, np.pi - slant, np.pi + slant, -slant])
    return np.asarray(centre + radius * np.column_stack([np.cos(angles), np.sin(angles)]))
