"""Where to look from: a pinhole, and presets worked out from the patches, so that a scene needs no camera."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from .patches import Patches

Vector = tuple[float, float, float]
FloatArray = NDArray[np.float64]

UP = (0.0, 1.0, 0.0)  # of glTF, and of the built-in scenes
PINHOLE_FOV = 39.3  # degrees: the Cornell box's lens, 2·atan(12.5 mm / 35 mm)
PINHOLE_MARGIN = 1.0276  # and its distance: the opening fills all but 2.7 % of the picture
INSIDE_FOV = 70.0
PREFER_FRONT = 1.2  # another wall must show so much more than the front
OUTSIDE_FOV = 30.0
OUTSIDE_DIRECTION = (0.62, 0.5, 1.0)  # to the right, up, to the front
OPEN_SIDE = 0.05  # a side of the bounding box is open if patches cover less than this share of it
FLAT = 1e-9


@dataclass(frozen=True)
class Camera:
    """A pinhole.

    Attributes
    ----------
    name : str
    position, focal_point : tuple of float (3,)
        m.
    up : tuple of float (3,)
    fov : float
        Angle between the top and the bottom of the picture, degrees.
    """

    name: str
    position: Vector
    focal_point: Vector
    up: Vector = UP
    fov: float = PINHOLE_FOV


def presets(patches: Patches, up: Vector = UP) -> tuple[Camera, ...]:
    """Cameras for a scene, the best first.

    A room with one open wall is seen through it, as the Cornell box is in its photographs. A closed room is seen
    from within; from outside, with the faces that look away left out, it is seen as a doll's house.
    """
    open_sides = _open_sides(patches, np.asarray(up))
    outside = _outside(patches, np.asarray(up), open_sides[0] if len(open_sides) == 1 else (2, 1))
    if len(open_sides) == 1:
        return (_through(patches, open_sides[0], up), outside)
    if _is_room(patches):
        return (_inside(patches, np.asarray(up)), outside)
    return (outside, _inside(patches, np.asarray(up)))


def _vector(values: FloatArray) -> Vector:
    x, y, z = (float(v) for v in values)
    return (x, y, z)


def _bounds(patches: Patches) -> tuple[FloatArray, FloatArray]:
    """Lowest and highest corner of the box around the patches; vertices that no patch uses do not count."""
    used = patches.vertices[np.unique(patches.faces[patches.faces >= 0])]
    return used.min(axis=0), used.max(axis=0)


def _covered(patches: Patches, axis: int, end: int) -> float:
    """Which share of one side of the bounding box is closed by patches that look inwards."""
    low, high = _bounds(patches)
    size = high - low
    across = np.delete(size, axis).prod()
    if across <= FLAT * size.max() ** 2:
        return 0.0
    distance = np.abs(patches.centroid[:, axis] - (high if end else low)[axis])
    inwards = patches.normal[:, axis] * (-1.0 if end else 1.0)
    near = (distance < 0.02 * size.max()) & (inwards > 0.7)
    return float(patches.area[near].sum() / across)


def _open_sides(patches: Patches, up: FloatArray) -> list[tuple[int, int]]:
    """Upright sides (axis, end) of the bounding box without a wall, if the other sides have theirs."""
    sides = [(axis, end) for axis in range(3) for end in (0, 1) if abs(up[axis]) < 0.5]
    return [side for side in sides if _covered(patches, *side) < OPEN_SIDE]


def _is_room(patches: Patches) -> bool:
    """Whether most sides of the bounding box have walls that look inwards."""
    covered = [_covered(patches, axis, end) for axis in range(3) for end in (0, 1)]
    return bool(patches.closed) or sum(share > 0.5 for share in covered) >= 5


def _through(patches: Patches, side: tuple[int, int], up: Vector) -> Camera:
    """Front view through an open side. Of the Cornell box this gives the official camera, to 2 mm."""
    axis, end = side
    low, high = _bounds(patches)
    middle = 0.5 * (low + high)
    opening = np.delete(high - low, axis).max() / 2.0
    distance = PINHOLE_MARGIN * opening / math.tan(math.radians(PINHOLE_FOV) / 2.0)
    position = middle.copy()
    position[axis] = high[axis] + distance if end else low[axis] - distance
    return Camera("front", _vector(position), _vector(middle), up)


def _inside(patches: Patches, up: FloatArray) -> Camera:
    """From the middle of one wall to the opposite one: the wall that has most patches facing it, else the front."""
    low, high = _bounds(patches)
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    best, most = middle, -1.0
    for axis, end in ((2, 1.0), (2, -1.0), (0, 1.0), (0, -1.0), (1, 1.0), (1, -1.0)):
        if abs(up[axis]) > 0.5:
            continue
        position = middle + 0.1 * half * up
        position[axis] += 0.97 * end * half[axis]
        seen = _area_in_front(patches, position, middle)
        if seen > PREFER_FRONT * most:
            best, most = position, seen
    target = middle - 0.1 * half * np.abs(up)
    return Camera("inside", _vector(best), _vector(target), _vector(up), INSIDE_FOV)


def _area_in_front(patches: Patches, position: FloatArray, target: FloatArray) -> float:
    """Area of the patches that face a camera and stand in its picture, hidden or not, m²."""
    to_patch = patches.centroid - position
    distance = np.linalg.norm(to_patch, axis=1) + FLAT
    forward = (target - position) / np.linalg.norm(target - position)
    in_view = to_patch @ forward > math.cos(math.radians(INSIDE_FOV) / 2.0) * distance
    facing = np.einsum("nc,nc->n", to_patch, patches.normal) < 0.0
    return float(patches.area[in_view & facing].sum())


def _outside(patches: Patches, up: FloatArray, front: tuple[int, int]) -> Camera:
    """From above a corner of the front side, far enough to see everything."""
    low, high = _bounds(patches)
    radius = 0.5 * float(np.linalg.norm(high - low))
    axis, end = front
    forward = np.zeros(3)
    forward[axis] = 1.0 if end else -1.0
    if abs(up[axis]) > 0.5:  # the usual front is above
        forward = np.roll(forward, 1)
    to_right = np.cross(up, forward)
    direction = sum(share * axis for share, axis in zip(OUTSIDE_DIRECTION, (to_right, up, forward), strict=True))
    distance = radius / math.sin(math.radians(OUTSIDE_FOV) / 2.0)
    position = 0.5 * (low + high) + direction / np.linalg.norm(direction) * distance
    return Camera("outside", _vector(position), _vector(0.5 * (low + high)), _vector(up), OUTSIDE_FOV)
