"""Patches inside patches: the same faces cut a whole number of times finer, and means taken back to the coarse ones."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .errors import ParameterError
from .patches import Grid, Patches, cut, grid_with, locate
from .scene import Scene

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]


def refined(scene: Scene, patches: Patches, factor: int) -> Patches:
    """Cut every patch into factor² smaller ones.

    Parameters
    ----------
    scene : Scene
        What `patches` were cut from.
    patches : Patches
    factor : int
        At least 1.

    Returns
    -------
    Patches
        Each inside one of `patches`; see `parents` for which.

    Raises
    ------
    ParameterError

    Examples
    --------
    >>> import radiosity as rad
    >>> scene = rad.scenes.furnace()
    >>> len(refined(scene, rad.subdivide(scene, patch_count=24), 3))
    216
    """
    return cut(scene, finer(patches.grid, factor))


def finer(grid: Grid, factor: int) -> Grid:
    """The grid of `refined`.

    Raises
    ------
    ParameterError
    """
    if factor < 1:
        raise ParameterError(f"factor is {factor}; give at least 1")
    return grid_with(grid.faces, grid.columns * np.int32(factor), grid.rows * np.int32(factor))


def parents(fine: Patches, coarse: Grid) -> IntArray:
    """The coarse patch that each fine one lies in, (N fine,).

    Parameters
    ----------
    fine : Patches
        From `refined`.
    coarse : Grid
        Of what they were refined from.
    """
    u, v = _middles(fine)
    return locate(coarse, fine.face, u, v, fine.side < 0)


def means(values: FloatArray, fine: Patches, coarse: Patches) -> FloatArray:
    """Area-weighted means over the coarse patches, (N coarse, C), of values on the fine ones, (N fine, C)."""
    parent = parents(fine, coarse.grid)
    weighted = values * fine.area[:, None]
    sums = np.stack([np.bincount(parent, column, len(coarse)) for column in weighted.T], axis=1)
    return sums / np.bincount(parent, fine.area, len(coarse))[:, None]


def _middles(patches: Patches) -> tuple[FloatArray, FloatArray]:
    """Coordinates (u, v) of a point inside each patch, as `locate` reads them, (N,) each."""
    grid, face = patches.grid, patches.face
    first = np.where(patches.side > 0, grid.front[face], grid.back[face])
    cell = np.arange(len(patches)) - first
    columns, rows = grid.columns[face].astype(np.int64), grid.rows[face].astype(np.int64)
    row, column = np.divmod(cell, columns)
    u, v = (column + 0.5) / columns, (row + 0.5) / rows
    triangle = ~grid.faces.quad[face]
    u[triangle], v[triangle] = _triangle_middles(cell[triangle], columns[triangle])
    return u, v


def _triangle_middles(cell: IntArray, columns: IntArray) -> tuple[FloatArray, FloatArray]:
    """Centroids of small triangles: row j holds 2 (columns - j) - 1 of them, upright and turned in turn."""
    # The row is the largest j with j (2 columns - j) <= cell.
    row = np.floor(columns - np.sqrt(np.maximum(columns.astype(np.float64) ** 2 - cell, 0.0))).astype(np.int64)
    row -= row * (2 * columns - row) > cell
    row += (row + 1) * (2 * columns - row - 1) <= cell
    place = cell - row * (2 * columns - row)
    third = (1 + place % 2) / 3.0
    return (place // 2 + third) / columns, (row + third) / columns
