"""Scenes that have, each, one thing that need not be computed."""

from __future__ import annotations

import radiosity as rad
from radiosity.scenes.build import block, panel, room

GREY = rad.Material([0.5, 0.5, 0.5])
BLACK = rad.Material([0.0, 0.0, 0.0])
LAMP = rad.Surface("lamp", *panel((1.5, 2.5, 1.5), (2.5, 2.5, 2.5), -1), rad.Material([0.5] * 3, emission=[9.0] * 3))


def box(low, high, name, material=GREY):
    """A closed block whose fronts look outwards."""
    (x0, y0, z0), (x1, y1, z1) = low, high
    return rad.Surface(name, *block([[x0, z0], [x1, z0], [x1, z1], [x0, z1]], y0, y1, True), material)


def flat(x, name="", material=GREY):
    """Walls of a room 4 × 3 × 4 m that begins at x, looking inwards."""
    walls = room((x, 0, 0), (x + 4, 3, 4), material)
    return [rad.Surface(name + s.name, s.vertices, s.faces, s.material) for s in walls]


def two_flats():
    """A lit room and, behind a thick wall, a dark one with a block in it."""
    inside = box((6, 0.5, 1), (7, 1.5, 2), "block")
    return rad.Scene([*flat(0), LAMP, *flat(4.5, "dark "), inside], name="two_flats")


def thin_walls():
    """A lit room whose walls have two sides: half of all patches look at a black sky."""
    return rad.Scene([*flat(0, material=rad.Material([0.5] * 3, two_sided=True)), LAMP], name="thin_walls")


def black_dome(emission=(3.0, 2.0, 1.0)):
    """A grey floor under a black dome of five panels that shines: light is reflected once."""
    dome = [s for s in flat(0, material=rad.Material([0.0] * 3, emission=emission)) if s.name != "floor"]
    floor = next(s for s in flat(0) if s.name == "floor")
    return rad.Scene([floor, *dome], name="black_dome")


def nested_boxes():
    """A block inside of a block: it sees black backs only."""
    inner, outer = box((1.2, 0.7, 1.2), (1.8, 1.3, 1.8), "inner"), box((1, 0.5, 1), (2, 1.5, 2), "outer")
    return rad.Scene([*flat(0), LAMP, inner, outer], name="nested_boxes")
