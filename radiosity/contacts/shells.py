"""Shells: triangles that hang together by their edges. Which have no hole, and on which side of them is inside."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Shells:
    """The S shells of T triangles.

    Attributes
    ----------
    shell : ndarray of int (T,)
        Shell of each triangle. Triangles hang together by edges that no third one has.
    rim : ndarray of int (R,)
        Edges around holes, 3 t + k for the one from corner k of triangle t to the next: those that their shell does
        not also run the other way.
    whole : ndarray of bool (S,)
        Without a hole.
    solid, hollow : ndarray of bool (S,)
        Whole, with the inside behind the faces, as the skin of a body; or before them, as the walls of a room.
    low, high : ndarray (S, 3)
        Boxes around the shells, m.
    """

    shell: IntArray
    rim: IntArray
    whole: NDArray[np.bool_]
    solid: NDArray[np.bool_]
    hollow: NDArray[np.bool_]
    low: FloatArray
    high: FloatArray


def shells(corners: FloatArray, vertex: IntArray) -> Shells:
    """Take triangles apart into shells.

    Parameters
    ----------
    corners : ndarray (T, 3, 3)
        m.
    vertex : ndarray of int (T, 3)
        Which corners are one: see `weld`.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    edge, undirected, first, count = _edges(vertex)
    pair = first[count == 2]
    joined = coo_array((np.ones(len(pair), bool), (edge[pair] // 3, edge[pair + 1] // 3)), shape=(len(vertex),) * 2)
    number, part = connected_components(joined, directed=False)
    shell = part.astype(np.int64)
    rim = _rim(vertex, shell, edge, undirected, first, count)
    whole = np.ones(number, dtype=bool)
    whole[shell[rim // 3]] = False
    low, high = np.full((number, 3), np.inf), np.full((number, 3), -np.inf)
    for k in range(3):
        np.minimum.at(low, shell, corners[:, k])
        np.maximum.at(high, shell, corners[:, k])
    volume = np.bincount(shell, volumes(corners, low[shell]), minlength=number)
    least = 1e-9 * np.prod(high - low, axis=1)
    return Shells(shell, rim, whole, whole & (volume > least), whole & (volume < -least), low, high)


def _edges(vertex: IntArray) -> tuple[IntArray, IntArray, IntArray, IntArray]:
    """Edges sorted by their two ends, a number for those, where in the list a new one starts, and how many it has."""
    begin, end = vertex.ravel(), np.roll(vertex, -1, axis=1).ravel()
    undirected = np.minimum(begin, end) * (vertex.max(initial=0) + 1) + np.maximum(begin, end)
    real = np.flatnonzero(begin != end)
    edge = real[np.argsort(undirected[real], kind="stable")]
    undirected = undirected[edge]
    first = np.flatnonzero(np.diff(undirected, prepend=-1) != 0)
    return edge, undirected, first, np.diff(first, append=len(edge))


def _rim(
    vertex: IntArray, shell: IntArray, edge: IntArray, undirected: IntArray, first: IntArray, count: IntArray
) -> IntArray:
    """Edges that their shell runs more often in one direction than in the other."""
    rising = (vertex.ravel() < np.roll(vertex, -1, axis=1).ravel())[edge]
    matched = first[count == 2]
    matched = matched[rising[matched] != rising[matched + 1]]
    odd = np.ones(len(edge), dtype=bool)
    odd[matched] = odd[matched + 1] = False
    odd_place = np.flatnonzero(odd)
    owner = shell[edge[odd_place] // 3]
    _, group = np.unique(np.column_stack([undirected[odd_place], owner]), axis=0, return_inverse=True)
    surplus = np.bincount(group.reshape(-1), np.where(rising[odd_place], 1, -1))[group.reshape(-1)]
    return np.sort(edge[odd_place[(surplus > 0) & rising[odd_place] | (surplus < 0) & ~rising[odd_place]]])


def weld(corners: FloatArray, group: IntArray | None = None) -> IntArray:
    """Numbers of the vertices (T, k) at corners (T, k, 3): equal where the corners are, bit by bit, and their group."""
    odd = np.array([0x9E3779B97F4A7C15, 0xC2B2AE3D27D4EB4F, 0x165667B19E3779F9, 0xD6E8FEB86659FD93], dtype=np.uint64)
    mixed = np.zeros(corners.shape[:2], dtype=np.uint64)
    for k in range(3):
        bits = np.ascontiguousarray(corners[..., k] + 0.0).view(np.uint64)  # + 0.0: no negative zeros
        bits = (bits ^ (bits >> np.uint64(32))) * odd[k]
        mixed += bits ^ (bits >> np.uint64(29))
    if group is not None:
        mixed += (group.astype(np.uint64) * odd[3])[:, None]
    return np.unique(mixed, return_inverse=True)[1].reshape(corners.shape[:2]).astype(np.int64)


def open_vertices(vertex: IntArray) -> NDArray[np.bool_]:
    """Which vertices lie on the border of a mesh of triangles (T, 3), by their numbers; quick.

    Around a vertex inside a mesh, the opposite edges of its triangles close up: the sum of (end - start) over them
    vanishes, whatever numbers stand for the vertices. With random ones, that does not happen by chance.
    """
    count = int(vertex.max(initial=-1)) + 1
    label = np.random.default_rng(0).integers(0, 1 << 40, count).astype(np.float64)  # their sums are exact
    total = np.zeros(count)
    for k in range(3):
        step = label[vertex[:, (k + 1) % 3]] - label[vertex[:, (k + 2) % 3]]
        total += np.bincount(vertex[:, k], step, minlength=count)
    return total != 0


def volumes(corners: FloatArray, origin: FloatArray) -> FloatArray:
    """Signed volumes of the tetrahedra from the origins (T, 3) to triangles; the sum over a shell is its volume."""
    a, b, c = (corners[:, k] - origin for k in range(3))
    return np.einsum("tx,tx->t", a, np.cross(b, c)) / 6.0


def encloses(hollow: NDArray[np.bool_], low: FloatArray, high: FloatArray) -> bool:
    """Whether no light can escape from shells, as `Shells` has them: the largest is hollow and holds all the others.

    As `radiosity.faces.encloses`, from triangles.
    """
    outer = int(np.argmax((high - low).max(axis=1)))
    return bool(hollow[outer] and (low >= low[outer]).all() and (high <= high[outer]).all())
