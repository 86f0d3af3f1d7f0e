"""First hits of rays inside a convex closed room: a division for each wall instead of a search through a tree.

From inside a convex room every ray meets the wall whose plane it reaches first among those that it runs towards, so
that nothing has to be found out about what hides what. Embree and its tree are not needed, and no ray leaks.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .compiled import kernel
from .face_points import cell_at, face_table
from .faces import Faces
from .patches import Grid
from .rays import MISS, Tracer

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]
IntArray = NDArray[np.int32]

MOST_WALLS = 24  # planes: above that, a tree is as fast
MOST_FACES = 2000  # whose heights over each other are looked at
IN_PLANE = 1e-6  # of the scene's size: float32 coordinates are off by 1e-7


def heights(faces: Faces) -> tuple[FloatArray, FloatArray]:
    """Lowest and highest corner of face j over the plane of face i, (F, F) each, m; i's own corners included."""
    low, high = np.empty((2, len(faces), len(faces)))
    over = np.empty_like(low)
    for k in range(4):  # corner by corner: minima over a last axis of four would take ten times as long
        np.matmul(faces.normal, np.ascontiguousarray(faces.corners[:, k].T), out=over)
        if k == 0:
            low[:], high[:] = over, over
        else:
            np.minimum(low, over, out=low)
            np.maximum(high, over, out=high)
    offset = np.einsum("fx,fx->f", faces.corners[:, 0], faces.normal)[:, None]
    low -= offset
    high -= offset
    return low, high


def is_convex_room(faces: Faces, closed: bool) -> bool:
    """Whether faces are the one-sided inner faces of one convex closed room, with few enough walls for `ConvexTracer`.

    Every corner lies in front of every face or in its plane, so that no face hides a part of another.
    """
    if not closed or faces.two_sided.any() or len(faces) > MOST_FACES:
        return False
    size = float(np.ptp(faces.bounds, axis=0).max())
    low, _ = heights(faces)
    return bool(low.min() >= -IN_PLANE * size) and int(wall_of(faces).max()) < MOST_WALLS


def wall_of(faces: Faces) -> IntArray:
    """Which plane each face lies in, numbered from 0, (F,)."""
    size = float(np.ptp(faces.bounds, axis=0).max())
    offset = np.einsum("fx,fx->f", faces.corners[:, 0] - faces.bounds.mean(axis=0), faces.normal) / size
    wall = np.full(len(faces), -1, dtype=np.int32)
    found = 0
    while (wall < 0).any():
        first = int(np.argmax(wall < 0))
        alike = np.abs(faces.normal - faces.normal[first]).max(axis=1) < IN_PLANE
        wall[(wall < 0) & alike & (np.abs(offset - offset[first]) < IN_PLANE)] = found
        found += 1
    return wall


class ConvexTracer(Tracer):
    """`Tracer` of a convex closed room, see `is_convex_room`; no ray misses.

    Where a ray meets an edge between patches, it may count for another one of them than with Embree; elsewhere the
    patches are the same.

    Parameters
    ----------
    grid : Grid
    """

    def __init__(self, grid: Grid) -> None:
        faces = grid.faces
        bounds = faces.bounds
        self.centre = bounds.mean(axis=0)
        self.scale = 1.0 / float(np.linalg.norm(bounds[1] - bounds[0]))
        corners = (faces.corners - self.centre) * self.scale
        self.table = face_table(grid, corners)
        wall = wall_of(faces)
        self._faces = np.argsort(wall, kind="stable").astype(np.int32)
        self._begin = np.searchsorted(wall[self._faces], np.arange(wall.max() + 2)).astype(np.int32)
        first = self._faces[self._begin[:-1]]
        normal = faces.normal[first]
        self._planes = np.column_stack([normal, np.einsum("wx,wx->w", corners[first, 0], normal)])
        self._frames = _frames(self.table.along, self.table.across)

    def run(self, origins: NDArray[np.float32], directions: NDArray[np.float32]) -> IntArray:
        """The patch that each ray meets, (n,). See `Tracer.run`."""
        out = np.empty(len(origins), dtype=np.int32)
        _meet(origins, directions, self._planes, self._begin, self._faces, self._frames, self.table, out)
        return out


def _frames(along: FloatArray, across: FloatArray) -> FloatArray:
    """Rows (F, 2, 3) that turn a point of a face, from its origin, into its affine coordinates."""
    frame = np.stack([along, across], axis=1)
    return np.asarray(np.linalg.solve(frame @ frame.transpose(0, 2, 1), frame), dtype=np.float64)


@kernel
def _meet(origins, directions, planes, begin, faces, frames, table, out):  # type: ignore[no-untyped-def]
    """The nearest plane ahead, then the face in it that the point lies deepest in."""
    for r in range(origins.shape[0]):
        ox, oy, oz = np.float64(origins[r, 0]), np.float64(origins[r, 1]), np.float64(origins[r, 2])
        dx, dy, dz = np.float64(directions[r, 0]), np.float64(directions[r, 1]), np.float64(directions[r, 2])
        nearest, wall = np.inf, -1
        for w in range(planes.shape[0]):
            towards = planes[w, 0] * dx + planes[w, 1] * dy + planes[w, 2] * dz
            if towards < 0.0:
                height = planes[w, 0] * ox + planes[w, 1] * oy + planes[w, 2] * oz - planes[w, 3]
                if height < -towards * nearest:
                    nearest, wall = -height / towards, w
        if wall < 0:
            out[r] = MISS
            continue
        x, y, z = ox + nearest * dx, oy + nearest * dy, oz + nearest * dz
        face, a, b = faces[begin[wall]], 0.0, 0.0
        deepest = -np.inf
        for k in range(begin[wall], begin[wall + 1]):
            f = faces[k]
            px, py, pz = x - table.origin[f, 0], y - table.origin[f, 1], z - table.origin[f, 2]
            p = frames[f, 0, 0] * px + frames[f, 0, 1] * py + frames[f, 0, 2] * pz
            q = frames[f, 1, 0] * px + frames[f, 1, 1] * py + frames[f, 1, 2] * pz
            depth = min(p, q)  # inside of the edges that meet in the first corner, then of the others
            if table.quad[f]:
                g, h = table.skew[f, 0], table.skew[f, 1]
                depth = min(depth, (1.0 - p) * (1.0 + h) + g * q, (1.0 - q) * (1.0 + g) + h * p)
            else:
                depth = min(depth, 1.0 - p - q)
            if depth > deepest:
                deepest, face, a, b = depth, f, p, q
        out[r] = table.front[face] + cell_at(table, face, a, b)
