"""Bodies without a bottom: what stands on a floor needs none, and hides the floor under it all the same."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..coplanar import DEPTH, TOUCH
from ..geometry import unit
from .carve import carve
from .shells import Shells, shells, volumes, weld

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

LONGEST = 10_000  # edges of a rim; a mesh with longer ones is torn, and no block


class Bottoms(NamedTuple):
    """Bottoms that bodies lack.

    Attributes
    ----------
    corners : ndarray (K, 4, 3)
        Convex pieces, m.
    body, surface : ndarray of int (K,)
        The body that each closes, and a surface of it.
    body_of : ndarray of int (T,)
        The body of each triangle, -1 of those of no such body.
    """

    corners: FloatArray
    body: IntArray
    surface: IntArray
    body_of: IntArray


def missing_bottoms(corners: FloatArray, surface: IntArray, size: float) -> Bottoms:
    """Flat bottoms that would close open bodies.

    Parameters
    ----------
    corners : ndarray (T, 3, 3)
        Triangles, m.
    surface : ndarray of int (T,)
    size : float
        Diagonal of the scene, m.

    Returns
    -------
    Bottoms
        Of bodies of which each hole is flat, and which have their inside behind their faces once those are closed.
        They face outwards. Whether anything closes the holes is not asked.
    """
    pieces: list[FloatArray] = []
    bodies: list[int] = []
    owners: list[int] = []
    body_of = np.full(len(corners), -1)
    if len(corners):
        vertex = weld(corners)
        found = shells(corners, vertex)
        for body, rim in enumerate(_bulging(corners, found)):
            members = found.shell == found.shell[rim[0] // 3]
            closing = _closing(corners[members], _loops(corners, vertex, rim), size)
            body_of[members] = body
            pieces += closing
            bodies += [body] * len(closing)
            owners += [int(surface[rim[0] // 3])] * len(closing)
    owner = np.array(owners, dtype=np.int64)
    return Bottoms(np.array(pieces).reshape(-1, 4, 3), np.array(bodies, dtype=np.int64), owner, body_of)


def _bulging(corners: FloatArray, found: Shells) -> list[IntArray]:
    """Rims of the open shells that enclose space as seen from there: neither sheets nor rooms."""
    owner = found.shell[found.rim // 3]
    seen_from = np.zeros((len(found.whole), 3))
    seen_from[owner] = corners.reshape(-1, 3)[found.rim]
    volume = np.bincount(found.shell, volumes(corners, seen_from[found.shell]), minlength=len(found.whole))
    bulging = volume > 1e-6 * np.prod(found.high - found.low, axis=1)
    bulging &= np.bincount(owner, minlength=len(bulging)) <= LONGEST
    rim = found.rim[bulging[owner]]
    rim = rim[np.argsort(found.shell[rim // 3], kind="stable")]
    starts = np.flatnonzero(np.diff(found.shell[rim // 3])) + 1
    return [part for part in np.split(rim, starts) if len(part)]


def _loops(corners: FloatArray, vertex: IntArray, rim: IntArray) -> list[FloatArray]:
    """A rim as loops (n, 3), in the direction of its faces; none where several meet in a corner, or one has no end."""
    begin, end = vertex.ravel()[rim], np.roll(vertex, -1, axis=1).ravel()[rim]
    after = dict(zip(begin.tolist(), zip(end.tolist(), rim.tolist(), strict=True), strict=True))
    if len(after) < len(rim) or set(begin.tolist()) != set(end.tolist()):
        return []
    loops = []
    while after:
        first, (here, edge) = after.popitem()
        loop = [edge]
        while here != first:
            here, edge = after.pop(here)
            loop.append(edge)
        loops.append(corners.reshape(-1, 3)[loop])
    return loops


def _closing(corners: FloatArray, loops: list[FloatArray], size: float) -> list[FloatArray]:
    """Convex pieces (4, 3) that close all holes of a shell; none unless all are flat and a body results."""
    pieces: list[FloatArray] = []
    for loop in loops:
        border = loop[::-1]
        normal = unit(np.cross(border - border[0], np.roll(border, -1, axis=0) - border[0]).sum(axis=0))
        if np.abs((border - border[0]) @ normal).max() > DEPTH * size:
            return []
        u = unit(border[1] - border[0])
        frame = np.stack([u, np.cross(normal, u)])
        plain, _ = carve((border - border[0]) @ frame.T, [], [], TOUCH * size)
        pieces += [border[0] + piece @ frame for piece in plain]
    halves = np.array([piece[list(half)] for piece in pieces for half in ((0, 1, 2), (0, 2, 3))]).reshape(-1, 3, 3)
    whole = np.concatenate([corners, halves])
    middle = np.broadcast_to(corners.mean(axis=(0, 1)), (len(whole), 3))
    return pieces if volumes(whole, middle).sum() > 0 else []
