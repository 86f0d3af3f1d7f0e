"""What is left of one plate: carved in its own plane, and put back into space without moving a corner."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..coplanar import TOUCH
from ..geometry import unit
from .carve import carve, snapped

FloatArray = NDArray[np.float64]

IN_PLANE = 1e-9  # of the scene's diagonal: corners of others that are nearer to the plane are kept bit by bit


def pieces_left(
    plate: FloatArray, normal: FloatArray, cuts: list[FloatArray], divides: list[FloatArray], size: float
) -> FloatArray:
    """A plate without what cuts it, divided along the border of the rest.

    Parameters
    ----------
    plate : ndarray (4, 3)
        m; a triangle repeats its third corner.
    normal : ndarray (3,)
        Of the plate.
    cuts, divides : list of ndarray (4, 3)
        Faces in its plane.
    size : float
        Diagonal of the scene, m.

    Returns
    -------
    ndarray (n, 4, 3)
        Convex pieces that face as the plate does. Corners of the plate, and of others in its plane, come back bit by
        bit, so that what met in them still does.
    """
    polygons = [_distinct(polygon) for polygon in (plate, *cuts, *divides)]
    edges = np.roll(polygons[0], -1, axis=0) - polygons[0]
    u = unit(edges[np.argmax(np.linalg.norm(edges, axis=1))])
    v = np.cross(normal, u)
    origin, points = plate[0], np.concatenate(polygons)
    flat = snapped((points - origin) @ np.stack([u, v], axis=1), 0.1 * TOUCH * size)
    height = np.abs((points - origin) @ normal)
    height[: len(polygons[0])] = 0.0
    known: dict[tuple[float, float], FloatArray] = {}
    for place in np.flatnonzero(height <= IN_PLANE * size).tolist():
        known.setdefault(tuple(flat[place].tolist()), points[place])
    ends = np.cumsum([len(polygon) for polygon in polygons])[:-1]
    outline, *others = np.split(flat, ends)
    plain, covered = carve(outline, others[: len(cuts)], others[len(cuts) :], TOUCH * size)
    if not cuts and not (len(plain) and len(covered)):
        return plate[None]
    corners = np.concatenate([plain, covered]).reshape(-1, 2)
    lifted = origin + corners[:, :1] * u + corners[:, 1:] * v
    for place, corner in enumerate(corners.tolist()):
        lifted[place] = known.get(tuple(corner), lifted[place])
    return lifted.reshape(-1, 4, 3)


def _distinct(polygon: FloatArray) -> FloatArray:
    return polygon[:3] if (polygon[2] == polygon[3]).all() else polygon
