"""Patches as a mesh that VTK draws, and their light at its corners for the smooth view."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
import pyvista as pv
from numpy.typing import NDArray
from scipy.sparse import csr_array, diags_array

if TYPE_CHECKING:
    from ..patches import Patches

CREASE = math.radians(30.0)  # neighbours that bend by more are not blended: an edge of a box stays an edge
MERGE = 1e-6  # corners nearer than this share of the scene are one point


def cells(faces: NDArray[np.integer]) -> NDArray[np.int64]:
    """VTK's list of cells (count, indices, count, indices, …) of quads and padded triangles (N, 4)."""
    corners = np.where(faces[:, 3] < 0, 3, 4)
    table = np.column_stack([corners, faces]).astype(np.int64)
    return table[np.arange(5) <= corners[:, None]]


def patch_mesh(patches: Patches) -> pv.PolyData:
    """Mesh whose cell i is patch i, and whose points 4 i … 4 i + 3 are its corners: nothing is shared."""
    count = len(patches)
    faces = np.arange(4 * count).reshape(count, 4)
    faces[patches.faces[:, 3] < 0, 3] = -1
    return pv.PolyData(corner_points(patches).reshape(-1, 3), faces=cells(faces))


def corner_points(patches: Patches) -> NDArray[np.float64]:
    """Corners (N, 4, 3), m; a triangle repeats its third."""
    faces = patches.faces
    return patches.vertices[np.where(faces < 0, faces[:, [0, 1, 2, 2]], faces)]


def corner_weights(patches: Patches) -> csr_array:
    """Light at the corners as a mean over the patches that meet there: sparse (4 N, N), rows sum to one.

    Patches of another surface, or bent away by more than `CREASE`, keep to themselves, so that neither the colour of
    a wall nor the shade of a box's side bleeds over its edge in the picture.
    """
    count = len(patches)
    points = corner_points(patches).reshape(-1, 3)
    size = float(np.ptp(points, axis=0).max()) or 1.0
    # The odd offset keeps round coordinates away from the borders of the grid that finds equal points.
    grid = np.floor((points - points.min(axis=0)) / (MERGE * size) + 0.381966).astype(np.int64)
    keys = np.column_stack([grid, np.repeat(patches.surface, 4)])
    _, group = np.unique(keys, axis=0, return_inverse=True)
    patch = np.repeat(np.arange(count), 4)
    drawn = np.ones((count, 4), dtype=bool)
    drawn[:, 3] = patches.faces[:, 3] >= 0  # the repeated corner of a triangle counts once
    members = csr_array((drawn.ravel().astype(np.float64), (group.ravel(), patch)), shape=(group.max() + 1, count))
    corners = csr_array((np.ones(4 * count), (np.arange(4 * count), group.ravel())), shape=(4 * count, group.max() + 1))
    meeting = (corners @ members).tocoo()
    aligned = np.einsum("pc,pc->p", patches.normal[patch[meeting.row]], patches.normal[meeting.col])
    weight = np.where(aligned > math.cos(CREASE), meeting.data, 0.0)
    weights = csr_array((weight, (meeting.row, meeting.col)), shape=meeting.shape)
    return csr_array(diags_array(1.0 / weights.sum(axis=1)) @ weights)
