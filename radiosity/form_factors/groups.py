"""Groups of patches: each face cut once more, coarsely, and how light on the groups is spread over their patches.

A group is a cell of a coarse grid over the same face, on the same side; a patch belongs to the cell that its middle
lies in, which is arithmetic. What the groups send is the mean of their patches. What arrives is found at the corners
of the groups, the lattice points of the coarse grid, and spread over the patches between them by linear interpolation:
up to the edge of a face and never beyond, for light is smooth along a face, not around a corner.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..patches import Grid, Patches, locate

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

# Corners of a cell, in steps along and across from its first lattice point, in the order of CORNER_SAMPLES.
QUAD_STEPS = np.array([[0, 0], [1, 0], [1, 1], [0, 1]])
UPRIGHT_STEPS = np.array([[0, 0], [1, 0], [0, 1], [0, 1]])
TURNED_STEPS = np.array([[1, 1], [0, 1], [1, 0], [1, 0]])
# Where `patch_points` puts those corners: samples (s, t) of quads, of triangles.
CORNER_SAMPLES = np.array([[[0, 0], [1, 0], [1, 1], [0, 1]], [[0, 0], [1, 0], [1, 1], [1, 1]]], dtype=np.float64)


class _Cells(NamedTuple):
    """Places (n,) of patches in the grids of their faces; turned is 0 or 1, and 0 on quads."""

    face: NDArray[np.int32]
    back: BoolArray
    column: IntArray
    row: IntArray
    turned: IntArray

    def some(self, which: IntArray) -> _Cells:
        """These of them."""
        return _Cells(self.face[which], self.back[which], self.column[which], self.row[which], self.turned[which])


@dataclass(frozen=True, eq=False)
class Groups:
    """M groups of N patches.

    Attributes
    ----------
    grid : Grid
        The same faces, cut coarsely: "patches" of this grid are the groups.
    fine : Grid
        How the faces are cut into patches.
    face, side (M,)
        Of the groups.
    of_patch : ndarray of int32 (N,)
        Group of each patch.
    patches : ndarray of int (M,)
        How many patches each group holds.
    """

    grid: Grid
    fine: Grid
    face: NDArray[np.int32]
    side: NDArray[np.int8]
    of_patch: NDArray[np.int32]
    patches: IntArray

    def __len__(self) -> int:
        """Number of groups M."""
        return len(self.face)

    @property
    def area(self) -> FloatArray:
        """Mean area of the groups on each group's face, m², (M,)."""
        return self.grid.faces.area[self.face] / self.grid.cells[self.face]

    @property
    def corners(self) -> IntArray:
        """Lattice points at the corners of each group, (M, 4); of triangles the last is the third once more."""
        return _corner_points(self, _cells(self.grid, np.arange(len(self))))

    def first_point(self, face: NDArray[np.integer], back: BoolArray) -> IntArray:
        """Number of the first lattice point on these sides of faces; a side's points are numbered row by row."""
        points = (self.grid.columns.astype(np.int64) + 1) * (self.grid.rows + 1)
        sides = 1 + (self.grid.back >= 0)
        first = np.cumsum(points * sides) - points * sides
        return first[face] + np.where(back, points[face], 0)

    def spread(self, patch: IntArray) -> tuple[IntArray, FloatArray]:
        """How values at the corners of groups make values on patches: bilinear on quads, linear on triangles.

        Parameters
        ----------
        patch : ndarray of int (n,)

        Returns
        -------
        points : ndarray of int (n, 4)
            Lattice points.
        weights : ndarray (n, 4)
            Not negative; rows sum to one.
        """
        u, v = _middles(self.fine, _cells(self.fine, patch))
        group = _cells(self.grid, self.of_patch[patch].astype(np.int64))
        return _corner_points(self, group), _corner_weights(self, group, u, v)


def group_patches(patches: Patches, size: int) -> Groups:
    """Groups of about size × size patches; faces of fewer make one group a side.

    Parameters
    ----------
    patches : Patches
    size : int
    """
    fine = patches.grid
    columns, rows = (np.maximum(1, np.rint(steps / size)).astype(np.int32) for steps in (fine.columns, fine.rows))
    cells = columns.astype(np.int64) * rows
    sides = 1 + (fine.back >= 0)
    ends = np.cumsum(cells * sides)
    front = ends - cells * sides
    grid = replace(
        fine,
        columns=columns,
        rows=rows,
        front=front.astype(np.int32),
        back=np.where(fine.back >= 0, front + cells, -1).astype(np.int32),
    )
    face = np.repeat(np.arange(len(cells), dtype=np.int32), cells * sides)
    side = np.where(np.arange(len(face)) < front[face] + cells[face], 1, -1).astype(np.int8)
    at = _cells(fine, np.arange(len(patches)))
    of_patch = locate(grid, at.face, *_middles(fine, at), at.back).astype(np.int32)
    return Groups(grid, fine, face, side, of_patch, np.bincount(of_patch, minlength=len(face)))


def _cells(grid: Grid, patch: IntArray) -> _Cells:
    """Where some patches are in the grids of their faces."""
    firsts = np.where(grid.back >= 0, grid.back, grid.front)  # last run of cells of each face
    face = np.searchsorted(grid.front, patch, side="right") - 1
    back = (grid.back[face] >= 0) & (patch >= firsts[face])
    cell = patch - np.where(back, grid.back[face], grid.front[face])
    columns = grid.columns[face].astype(np.int64)
    row, column = cell // columns, cell % columns
    turned = np.zeros_like(row)
    triangle = np.flatnonzero(~grid.faces.quad[face])
    if triangle.size:
        n, c = columns[triangle], cell[triangle]
        row[triangle] = n - np.ceil(np.sqrt(n * n - c)).astype(np.int64)
        place: IntArray = c - row[triangle] * (2 * n - row[triangle])
        column[triangle], turned[triangle] = place >> 1, place & 1
    return _Cells(face.astype(np.int32), back, column, row, turned)


def _middles(grid: Grid, at: _Cells) -> tuple[FloatArray, FloatArray]:
    """Coordinates (u, v) of the middles of cells: bilinear on quads, barycentric on triangles."""
    inside = np.where(grid.faces.quad[at.face], 0.5, (1.0 + at.turned) / 3.0)
    return (at.column + inside) / grid.columns[at.face], (at.row + inside) / grid.rows[at.face]


def _corner_points(groups: Groups, at: _Cells) -> IntArray:
    """Lattice points at the corners of groups, (n, 4); of triangles the last is the third once more."""
    quad = groups.grid.faces.quad[at.face]
    steps = (
        QUAD_STEPS
        if not len(quad)
        else np.where(
            quad[:, None, None], QUAD_STEPS, np.where(at.turned[:, None, None] == 1, TURNED_STEPS, UPRIGHT_STEPS)
        )
    )
    column, row = at.column[:, None] + steps[..., 0], at.row[:, None] + steps[..., 1]
    return groups.first_point(at.face, at.back)[:, None] + row * (groups.grid.columns[at.face, None] + 1) + column


def _corner_weights(groups: Groups, group: _Cells, u: FloatArray, v: FloatArray) -> FloatArray:
    """Weights (n, 4) of the corners of groups at points in them: bilinear on quads, barycentric on triangles."""
    grid = groups.grid
    x = u * grid.columns[group.face] - group.column
    y = v * grid.rows[group.face] - group.row
    bilinear = np.stack([(1.0 - x) * (1.0 - y), x * (1.0 - y), x * y, (1.0 - x) * y], axis=1)
    upright = np.stack([1.0 - x - y, x, y, np.zeros_like(x)], axis=1)
    turned = np.stack([x + y - 1.0, 1.0 - x, 1.0 - y, np.zeros_like(x)], axis=1)
    flat = np.where(group.turned[:, None] == 1, turned, upright)
    weights: FloatArray = np.clip(np.where(grid.faces.quad[group.face, None], bilinear, flat), 0.0, 1.0)
    return weights / weights.sum(axis=1, keepdims=True)
