"""Faces of any number of corners, as files have them, as the triangles and quads that a scene has."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..errors import FileFormatError, GeometryError
from ..polygons import triangulate
from ..scene import FloatArray, IntArray


def cut_polygon(points: FloatArray, where: str) -> IntArray:
    """Triangles of a flat polygon, concave ones included, as places among its corners.

    Parameters
    ----------
    points : ndarray (n, 3)
        Corners in order; slightly bent is fine.
    where : str
        Place in the file, for the message.

    Returns
    -------
    ndarray of int64 (T, 3)
        In the polygon's sense of rotation.

    Raises
    ------
    FileFormatError
        A polygon without area, or one that crosses itself.
    """
    points = points - points.mean(axis=0)
    points = points / (np.abs(points).max() or 1.0)
    normal = np.cross(points, np.roll(points, -1, axis=0)).sum(axis=0)  # Newell's: twice the area, along the normal
    keep = np.flatnonzero((points != np.roll(points, 1, axis=0)).any(axis=1))
    length = float(np.linalg.norm(normal))
    if len(keep) < 3 or not length > 1e-14:
        raise FileFormatError(f"{where}: a polygon of {len(points)} corners without area; leave it out")
    u = np.linalg.svd((normal / length)[None, :])[2][1]
    flat = np.column_stack([points @ u, points @ np.cross(normal / length, u)])
    try:
        _, triangles = triangulate(flat[keep])
    except GeometryError as error:
        raise FileFormatError(f"{where}: {error}") from error
    return keep[triangles]


def face_rows(
    polygons: Sequence[NDArray[np.int64]], vertices: FloatArray, what: str
) -> tuple[IntArray, NDArray[np.int64]]:
    """Rows (M, 4) of triangles, padded by -1, and quads, and the polygon (M,) that each comes from.

    Polygons of three and four corners stay as they are; larger ones are cut. `what` names them in messages.
    """
    rows: list[list[int]] = []
    source: list[int] = []
    for k, corners in enumerate(polygons):
        if len(corners) < 3:
            raise FileFormatError(f"{what} {k} has {len(corners)} corners; it needs 3")
        if corners.min() < 0 or corners.max() >= len(vertices):
            bad = corners.min() if corners.min() < 0 else corners.max()
            raise FileFormatError(f"{what} {k} names vertex {bad}; there are {len(vertices)}, counted from 0")
        if len(corners) <= 4:
            new = [[*corners.tolist(), -1][:4]]
        else:
            new = [[*row, -1] for row in corners[cut_polygon(vertices[corners], f"{what} {k}")].tolist()]
        rows += new
        source += [k] * len(new)
    return np.array(rows, dtype=np.int64).reshape(-1, 4), np.array(source, dtype=np.int64)


def narrow(faces: IntArray) -> IntArray:
    """Faces (M, 4) as (M, 3) where all are triangles."""
    return faces if faces.shape[1] == 3 or (faces[:, 3] >= 0).any() else faces[:, :3]


def merged(vertices: FloatArray, faces: IntArray) -> tuple[FloatArray, IntArray]:
    """The same mesh with equal vertices made one and unused ones left out; nothing is moved."""
    used, places = np.unique(vertices, axis=0, return_inverse=True)
    faces = np.where(faces >= 0, places.reshape(-1)[faces], -1)
    return compact(used, faces)


def compact(vertices: FloatArray, faces: IntArray) -> tuple[FloatArray, IntArray]:
    """The same mesh without the vertices that no face uses."""
    used, places = np.unique(faces[faces >= 0], return_inverse=True)
    result = np.full_like(faces, -1)
    result[faces >= 0] = places
    return vertices[used], result
