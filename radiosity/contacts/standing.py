"""What a plate belongs to: the skin of a body, a room, an open shell or a lone sheet. The rules turn on that."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..coplanar import DEPTH
from .plates import Plates
from .shells import Shells, encloses, shells, weld

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]


MANY = 1000  # directions of the plates of one shell: it is no crate


@dataclass(frozen=True, eq=False)
class Standing:
    """What is known of P plates.

    Attributes
    ----------
    solid : ndarray of bool (P,)
        Part of a closed skin, with the body behind the plate.
    backed : ndarray of bool (P,)
        Part of an open shell that lies wholly behind the plate, as the bottom of an open crate.
    low, high : ndarray (P, 3)
        Box around all that hangs together with the plate, m.
    """

    solid: NDArray[np.bool_]
    backed: NDArray[np.bool_]
    low: FloatArray
    high: FloatArray


def standing(
    plates: Plates, corners: FloatArray, surface: IntArray, stands: NDArray[np.bool_], size: float
) -> tuple[Standing, bool]:
    """Find out what plates belong to, and whether the scene lets no light escape.

    A shell is looked for within a surface first, and in the whole scene where the surface is open: a box may have a
    surface for each side, and a floor may have corners just where a box has them.

    Parameters
    ----------
    plates : Plates
    corners, surface : ndarray (T, 3, 3), (T,)
        All triangles of the scene and their surfaces.
    stands : ndarray of bool (T,)
        Which are of bodies that lack bottoms and stand on something: they count as closed.
    size : float
        Diagonal of the scene, m.
    """
    own, own_shell = _shells(plates, corners, surface)
    rest = np.isin(surface, surface[~own.whole[own.shell]])
    every, every_shell = _shells(plates, corners[rest], None)
    low, high = own.low[own_shell], own.high[own_shell]
    solid = own.solid[own_shell] | plates.missing
    wider = np.flatnonzero(~plates.missing & ~own.whole[own_shell])
    closed_below = np.bincount(own.shell, stands) > 0
    solid[wider] = every.solid[every_shell[wider]] | closed_below[own_shell[wider]]
    low[wider], high[wider] = every.low[every_shell[wider]], every.high[every_shell[wider]]
    backed = np.zeros(len(solid), dtype=bool)
    for s in np.unique(own_shell[wider]):
        here = wider[own_shell[wider] == s]
        backed[here] = _backed(plates.corners[here, 0], plates.normal[here], corners[own.shell == s], size)
    return Standing(solid, backed & ~solid, low, high), _closed(own, every)


def _backed(place: FloatArray, normal: FloatArray, shell: FloatArray, size: float) -> NDArray[np.bool_]:
    """Whether a shell (T, 3, 3) lies wholly behind planes through places (n, 3), and not in them."""
    points = shell.reshape(-1, 3)
    directions, which = np.unique(np.round(normal, 9), axis=0, return_inverse=True)
    if len(directions) > MANY:
        return np.zeros(len(place), dtype=bool)
    reach = np.array([[low, high] for low, high in ((h.min(), h.max()) for h in (points @ d for d in directions))])
    level = np.einsum("nx,nx->n", directions[which.reshape(-1)], place)
    low, high = (reach[which.reshape(-1)] - level[:, None]).T
    return (high < DEPTH * size) & (low < -10 * DEPTH * size)


def _shells(plates: Plates, corners: FloatArray, group: IntArray | None) -> tuple[Shells, IntArray]:
    """Shells of triangles, of each group or of all together, and the shell of each plate (P,), 0 if it has none."""
    owner = None if group is None else np.concatenate([group, plates.surface])
    vertex = weld(np.concatenate([corners, plates.corners[:, :3]]), owner)
    of_triangles, of_plates = vertex[: len(corners)], vertex[len(corners) :, 0]
    _, place = np.unique(of_triangles, return_inverse=True)  # missing bottoms may have corners of their own
    found = shells(corners, place.reshape(-1, 3))
    shell_of = np.zeros(vertex.max(initial=-1) + 1, dtype=np.int64)
    shell_of[of_triangles] = found.shell[:, None]
    return found, shell_of[of_plates]


def _closed(own: Shells, every: Shells) -> bool:
    """Whether no light escapes: shells of one surface count where they are whole, all others as they hang together."""
    every_shell = np.ones(len(every.whole), dtype=bool)
    parts = [(s.hollow[keep], s.low[keep], s.high[keep]) for s, keep in ((own, own.whole), (every, every_shell))]
    return encloses(*(np.concatenate(part) for part in zip(*parts, strict=True)))
