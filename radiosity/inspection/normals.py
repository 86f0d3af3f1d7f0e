"""Faces turned to the side that they should look to."""

from __future__ import annotations

import warnings
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ..errors import GeometryWarning
from ..finding import names
from ..scene import Scene
from .mesh import Mesh
from .orientation import orientation

IntArray = NDArray[np.int64]


def fixed_normals(scene: Scene) -> Scene:
    """Turn round the faces of closed shells that look the wrong way; say which.

    Within a shell, the faces that disagree with most of it (by area) are turned; then shells that are inside out, as
    `radiosity.inspection.orientation` has them: bodies face outwards, rooms inwards. Open shells are left as they are,
    because nothing tells which side of them is meant.

    Parameters
    ----------
    scene : Scene

    Returns
    -------
    Scene
        The same one if there is nothing to turn.

    Warns
    -----
    GeometryWarning
        Which surfaces had faces turned, and how many.

    Examples
    --------
    >>> from radiosity.scenes import furnace
    >>> room = furnace()
    >>> fixed_normals(room) is room
    True
    """
    mesh = Mesh.of(scene)
    found = orientation(mesh)
    of_whole = (found.shell >= 0) & found.whole[found.shell]
    wrong = of_whole & (found.turned ^ found.inside_out[found.shell])
    if not wrong.any():
        return scene
    faces = np.flatnonzero(wrong)
    warnings.warn(
        f"{len(faces)} of {len(mesh)} faces were turned round, so that closed shells face the right way: "
        f"{names(mesh.names(faces))}",
        GeometryWarning,
        stacklevel=2,
    )
    surfaces = tuple(
        surface.turned(mesh.face[faces[mesh.surface[faces] == k]]) for k, surface in enumerate(scene.surfaces)
    )
    return replace(scene, surfaces=surfaces)
