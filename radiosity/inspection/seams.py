"""Edges that should meet and do not: corners on the middle of an edge, and cracks."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .mesh import Mesh

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

NEAR = 1e-6  # of the diagonal: what is nearer than this was meant to be in one place
MOST_PAIRS = 4_000_000  # corners near edges that are looked at


def t_junctions(mesh: Mesh) -> tuple[FloatArray, IntArray]:
    """Corners that lie on a free edge of another face, between its ends.

    Returns
    -------
    places : ndarray (P, 3)
        m.
    faces : ndarray of int (P,)
        Whose edge it is.
    """
    begin, end, points, _ = _free(mesh)
    edge, point = _on_edges(begin, end, points, NEAR * mesh.size)
    _, first = np.unique(point, return_index=True)
    return points[point[first]], mesh.edges.face[mesh.edges.free[edge[first]]]


def open_edges(mesh: Mesh) -> IntArray:
    """Free edges that no other free edges make up for: the rims of holes (E,)."""
    free = mesh.edges.free
    begin, end, _, _ = _free(mesh)
    length = np.linalg.norm(end - begin, axis=1)
    edge, part = _on_edges(begin, end, 0.5 * (begin + end), NEAR * mesh.size)
    inner = (edge != part) & (length[part] < length[edge] * (1 - 1e-9))
    edge, part = edge[inner], part[inner]
    covered = np.bincount(edge, length[part], minlength=len(free)) > length * (1 - 1e-6)
    covered[part] = True
    return free[~covered]


def _on_edges(begin: FloatArray, end: FloatArray, points: FloatArray, near: float) -> tuple[IntArray, IntArray]:
    """Pairs (edge, point) with the point on the edge, between its ends."""
    edge, point = _near_pairs(0.5 * (begin + end), 0.5 * np.linalg.norm(end - begin, axis=1), points)
    along = end[edge] - begin[edge]
    length = np.linalg.norm(along, axis=1)
    offset = points[point] - begin[edge]
    t = np.einsum("nx,nx->n", offset, along) / length
    away = np.linalg.norm(offset - along * (t / length)[:, None], axis=1)
    keep = (t > 2 * near) & (t < length - 2 * near) & (away < near)
    return edge[keep], point[keep]


def cracks(mesh: Mesh) -> tuple[FloatArray, IntArray, float]:
    """Corners of free edges that nearly meet: nearer than 1e-6 of the diagonal, and not equal.

    Returns
    -------
    places : ndarray (P, 3)
    faces : ndarray of int
    widest : float
        m.
    """
    from scipy.spatial import cKDTree

    _, _, points, owner = _free(mesh)
    none = np.zeros((0, 3)), np.zeros(0, dtype=np.int64), 0.0
    if len(points) < 2:
        return none
    near = NEAR * mesh.size
    distance, other = cKDTree(points).query(points, k=2, distance_upper_bound=near)
    keep = np.flatnonzero(np.isfinite(distance[:, 1]))
    if not len(keep):
        return none
    pair = np.unique(np.sort(np.column_stack([keep, other[keep, 1]]), axis=1), axis=0)
    widest = float(np.linalg.norm(points[pair[:, 0]] - points[pair[:, 1]], axis=1).max())
    return points[pair[:, 0]], owner[np.unique(pair)], widest


def _free(mesh: Mesh) -> tuple[FloatArray, FloatArray, FloatArray, IntArray]:
    """Free edges, begin and end; and their corners, each once, with a face that has it."""
    edges = mesh.edges
    free = edges.free
    vertex, where = np.unique(np.concatenate([edges.start[free], edges.stop[free]]), return_index=True)
    both = np.concatenate([edges.begin[free], edges.end[free]])
    owner = np.concatenate([edges.face[free], edges.face[free]])
    assert len(vertex) == len(where)
    return edges.begin[free], edges.end[free], both[where], owner[where]


def _near_pairs(centre: FloatArray, radius: FloatArray, points: FloatArray) -> tuple[IntArray, IntArray]:
    """Pairs (edge, point) with the point in the sphere around the edge; long edges last, as far as time allows."""
    from scipy.spatial import cKDTree

    if not len(centre):
        return np.zeros(0, dtype=np.int64), np.zeros(0, dtype=np.int64)
    tree = cKDTree(points)
    number = tree.query_ball_point(centre, radius, return_length=True)
    order = np.argsort(number, kind="stable")
    chosen = order[np.cumsum(number[order]) <= MOST_PAIRS]
    found = tree.query_ball_point(centre[chosen], radius[chosen])
    lengths = np.array([len(part) for part in found], dtype=np.int64)
    flat = np.concatenate([np.asarray(part, dtype=np.int64) for part in found]) if len(found) else np.zeros(0, np.int64)
    return np.repeat(chosen, lengths), flat
