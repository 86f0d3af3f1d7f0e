"""Lamps too near to what they shine on: rays start so far off their patch that they would begin behind it."""

from __future__ import annotations

import numpy as np

from ..coplanar import DEPTH, coplanar_pairs
from ..errors import GeometryError
from ..patches import Patches

TOUCHING = 1e-9  # of the scene's diagonal: faces nearer than that lie in each other, and their order is rounding


def check_gaps(patches: Patches) -> None:
    """Refuse emitting sides that look at a face nearer than rays can tell apart.

    Parameters
    ----------
    patches : Patches

    Raises
    ------
    GeometryError
        The two surfaces, the distance, and the least that rays resolve.
    """
    faces = patches.grid.faces
    lit = (patches.emission > 0).any(axis=1)
    if not lit.any() or len(faces) < 2:
        return
    shines = np.zeros((2, len(faces)), dtype=bool)  # front, back
    for k, side in enumerate((1, -1)):
        shines[k, patches.face[lit & (patches.side == side)]] = True
    pairs = coplanar_pairs(faces.corners, faces.surface)
    size = float(np.linalg.norm(np.ptp(faces.bounds, axis=0)))
    middle = faces.corners.mean(axis=1)
    for lamp, other in ((pairs.first, pairs.second), (pairs.second, pairs.first)):
        ahead = np.einsum("nx,nx->n", faces.normal[lamp], middle[other] - middle[lamp]) / size
        near = np.abs(ahead) > TOUCHING
        lost = np.flatnonzero(near & np.where(ahead > 0, shines[0, lamp], shines[1, lamp]))
        if lost.size:
            p = lost[0]
            names = [patches.surface_names[faces.surface[face[p]]] for face in (lamp, other)]
            raise GeometryError(
                f"surface {names[0]!r} shines on {names[1]!r} from {abs(ahead[p]) * size:.3g} m, and rays cannot tell "
                f"faces apart that are nearer than {DEPTH * size:.3g} m ({DEPTH:g} of the scene's diagonal): its light "
                "would be lost. Move them apart, or take Analytic() if nothing is hidden"
            )
