"""Families of scenes with one parameter each, to see how cost and error of a method grow with it.

In the manner of A. J. Willmott and P. S. Heckbert, "An Empirical Comparison of Radiosity Algorithms" (Carnegie Mellon
University, CMU-CS-97-115, 1997): a gap that closes on a singularity, blockers that cut up the light, walls that
reflect ever more, rooms that fill with things, a tube that grows longer.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

import radiosity as rad

from ..errors import GeometryWarning
from ..scenes.build import panel, room
from .subject import Subject

PATCHES = 600


def singularity(gap: float) -> rad.Scene:
    """A floor, 1 × 1 m, and a shining wall that stands on its edge but for a gap: near the edge r goes to nought."""
    grey = rad.Material(0.5)
    floor = rad.Surface("floor", *panel((0, 0, 0), (1, 0, 1), +1), grey)
    wall = rad.Surface("wall", *panel((0, gap, 0), (0, 1 + gap, 1), +1), grey.replace(emission=1.0))
    return rad.Scene([floor, wall], name="singularity", closed=False)


def occlusion(blockers: float) -> rad.Scene:
    """A lamp above blockers, n² thin squares half-way up a room: the more, the smaller, with a quarter of its plan."""
    number = round(blockers**0.5)
    walls = rad.Material(0.6)
    light = ((1.5, 3.0, 1.5), (2.5, 3.0, 2.5))
    surfaces = room((0, 0, 0), (4, 3, 4), walls, {"ceiling": [light]})
    surfaces.append(rad.Surface("lamp", *panel(*light, -1), walls.replace(emission=10.0)))
    cell = 4.0 / number
    side, start = cell / 2, cell / 4
    for i in range(number):
        for k in range(number):
            x, z = start + i * cell, start + k * cell
            mesh = panel((x, 1.5, z), (x + side, 1.5, z + side), +1)
            surfaces.append(rad.Surface(f"blocker_{i}_{k}", *mesh, walls.replace(two_sided=True)))
    return rad.Scene(surfaces, name="occlusion", closed=True)


def reflectance(passes: float) -> rad.Scene:
    """An empty room with a lamp whose walls absorb one part in `passes` of what arrives."""
    walls = rad.Material(absorptance=1.0 / passes)
    light = ((1.5, 3.0, 1.5), (2.5, 3.0, 2.5))
    surfaces = room((0, 0, 0), (4, 3, 4), walls, {"ceiling": [light]})
    surfaces.append(rad.Surface("lamp", *panel(*light, -1), walls.replace(emission=10.0)))
    return rad.Scene(surfaces, name="reflectance", closed=True)


def complexity(objects: float) -> rad.Scene:
    """The cluttered room with so many boxes."""
    return rad.scenes.cluttered_room(objects=round(objects))


def tube(length: float) -> rad.Scene:
    """A square tube, 1 × 1 m, so many metres long, with a lamp for its one end."""
    walls = rad.Material(0.8)
    surfaces = room((0, 0, 0), (length, 1, 1), walls, leave_out=["left_wall"])
    surfaces.append(rad.Surface("lamp", *panel((0, 0, 0), (0, 1, 1), +1), walls.replace(emission=1.0)))
    return rad.Scene(surfaces, name="tube", closed=True)


@dataclass(frozen=True)
class SceneFamily:
    """Scenes along one parameter.

    Attributes
    ----------
    make : callable
        Value → scene.
    parameter : str
        What the value is, with its unit, as an axis would say it.
    values : tuple of float
    few : tuple of float
        Those of a quick study.
    patch_size : float or None
        m; by default every scene has about `PATCHES` patches (or as many as it has faces).
    """

    make: Callable[[float], rad.Scene]
    parameter: str
    values: tuple[float, ...]
    few: tuple[float, ...]
    patch_size: float | None = None


SCENE_FAMILIES = {
    "singularity": SceneFamily(singularity, "gap, m", (1.0, 0.3, 0.1, 0.03, 0.01, 0.003), (1.0, 0.1, 0.01)),
    "occlusion": SceneFamily(occlusion, "blockers", (1, 4, 16, 64, 144), (1, 16, 64)),
    "reflectance": SceneFamily(reflectance, "1 / absorptance", (1.25, 2, 5, 10, 20, 50), (1.25, 5, 20)),
    "complexity": SceneFamily(complexity, "boxes", (3, 6, 12, 24, 48), (3, 12, 24)),
    "tube": SceneFamily(tube, "length, widths", (1, 2, 4, 8, 16), (1, 4, 8), patch_size=0.25),
}


def by_parameter(name: str, *, few: bool = False) -> list[Subject]:
    """The scenes of a family, cut into patches."""
    family = SCENE_FAMILIES[name]
    subjects = []
    for value in family.few if few else family.values:
        scene = family.make(value)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", GeometryWarning)
            if family.patch_size is None:
                patches = rad.subdivide(scene, patch_count=PATCHES)
            else:
                patches = rad.subdivide(scene, patch_size=family.patch_size)
        word = family.parameter.partition(",")[0]
        subjects.append(Subject(f"{word} {value:g}", family.parameter, float(np.float64(value)), scene, patches))
    return subjects
