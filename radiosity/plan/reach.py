"""Which sides of faces light may reach at all: found from planes alone, before any ray.

Two sides may see each other only if each has a part of the other's face before it, and if no convex closed shell has
one inside and the other outside. What hides what is not looked at, so "may see" errs on the safe side, and a side
to which no chain of "may see" leads from a light is dark for certain.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..convex import IN_PLANE, heights
from ..faces import Faces, vertex_shells
from ..patches import Patches

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]
IntArray = NDArray[np.int64]

ROOM = 1e3  # of the tolerance: a plate with two faces is no room
MOST_SIDES = 2000  # beyond that the sides are not compared, and every patch is taken to be reached


class Reach(NamedTuple):
    """Patches (N,) by what light can do there.

    Attributes
    ----------
    dark : ndarray of bool (N,)
        No light ever arrives, and none starts.
    backs_only : ndarray of bool (N,)
        Of those, the ones before which there are black backs only.
    open : ndarray of bool (N,)
        Before them there is nothing at all: all that they send out goes to the sky, whether it is lit or not.
    """

    dark: BoolArray
    backs_only: BoolArray
    open: BoolArray


def reach(patches: Patches) -> Reach:
    """Find the patches that stay dark for certain.

    Parameters
    ----------
    patches : Patches

    Returns
    -------
    Reach
        All False where nothing is known; none are dark in a scene without any light, which is told otherwise.
    """
    faces, count = patches.grid.faces, len(patches)
    nothing = np.zeros(count, dtype=bool)
    lit = (patches.emission > 0).any(axis=1)
    sky = bool(patches.sky.any())
    if len(faces) + int(faces.two_sided.sum()) > MOST_SIDES:
        return Reach(nothing, nothing, nothing)
    back = np.flatnonzero(faces.two_sided)
    face = np.concatenate([np.arange(len(faces)), back])
    front = np.arange(len(face)) < len(faces)
    sees, inside, empty = _may_see(faces, face, front)
    of_patch = np.where(patches.side > 0, patches.face, len(faces) + np.searchsorted(back, patches.face))
    first = np.unique(of_patch, return_index=True)[1]
    emits, reflects = np.zeros((2, len(face)), dtype=bool)
    np.logical_or.at(emits, of_patch, lit)
    np.logical_or.at(reflects, of_patch, (patches.reflectance > 0).any(axis=1))
    assert len(first) == len(face)
    if not (lit.any() or sky):
        return Reach(nothing, nothing, empty[of_patch])
    dark = ~_flood(sees, emits, reflects, emits | (~inside if sky else False)) & ~empty
    return Reach(dark[of_patch], (dark & ~sees.any(axis=1))[of_patch], empty[of_patch])


def _flood(sees: BoolArray, senders: BoolArray, reflects: BoolArray, reached: BoolArray) -> BoolArray:
    """Sides that light reaches, in however many bounces."""
    reached, new = reached.copy(), senders | (reached & reflects)
    while new.any():
        found = sees[:, new].any(axis=1) & ~reached
        reached |= found
        new = found & reflects
    return reached


def _may_see(faces: Faces, face: IntArray, front: BoolArray) -> tuple[BoolArray, BoolArray, BoolArray]:
    """Whether side s may see side t, (S, S); which sides are inside of a convex closed shell, and see nothing, (S,)."""
    low, high = heights(faces)
    size = IN_PLANE * float(np.ptp(faces.bounds, axis=0).max())
    own_low, own_high = np.diagonal(low)[:, None], np.diagonal(high)[:, None]  # a face may be bent a little
    ahead = np.where(front[:, None], (high > own_low + size)[face], (low < own_high - size)[face])[:, face]
    np.logical_and(ahead, face[:, None] != face, out=ahead)
    sees = ahead & ahead.T
    flat = (own_high - own_low)[face, 0] <= size  # a bent face sees itself
    empty = flat & ~ahead.any(axis=1)
    inside = np.zeros(len(face), dtype=bool)
    shell, whole = vertex_shells(faces)
    for s in np.flatnonzero(whole):
        members = np.flatnonzero(shell == s)
        looking_in = _is_convex(low, high, members, size)
        if not looking_in and not _is_convex(-high, -low, members, size):
            continue
        within, beyond = _within_and_beyond(*((low, high) if looking_in else (-high, -low)), members, size)
        inner, outer = ((shell == s)[face] & (front == side) for side in (looking_in, not looking_in))
        held = inner | within[face]
        for apart in (outer, beyond[face]):
            sees[np.ix_(held, apart)] = sees[np.ix_(apart, held)] = False
        inside |= held
    return sees, inside, empty


def _is_convex(low: FloatArray, high: FloatArray, members: IntArray, size: float) -> bool:
    """Whether all faces of a closed shell are in front of each other, with room between them."""
    among = np.ix_(members, members)
    return bool((low[among] >= -size).all() and (high[among].max(axis=1) > ROOM * size).all())


def _within_and_beyond(
    low: FloatArray, high: FloatArray, members: IntArray, size: float
) -> tuple[BoolArray, BoolArray]:
    """Which faces are for certain inside of a convex shell, and which outside, (F,) each; its own are neither.

    What lies in the plane of a wall may be either, and rays may take it for the wall.
    """
    low, high = low[members], high[members]
    within = np.asarray(((low >= -size) & (high > size)).all(axis=0))
    beyond = np.asarray(((high <= size) & (low < -size)).any(axis=0))
    within[members] = beyond[members] = False
    return within, beyond
