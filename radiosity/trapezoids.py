"""Plane polygons with holes, cut into trapezoids: well-shaped ground for patches.

A triangulation that adds no corners has long, thin triangles wherever a hole stands far from the outline, and their
patches are as thin. Cuts parallel to one axis give trapezoids instead. They add corners on edges, which rays do
not mind as long as those edges are straight.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .errors import GeometryError
from .polygons import signed_area

FloatArray = NDArray[np.float64]


def trapezoids(outline: ArrayLike, holes: Sequence[ArrayLike] = ()) -> FloatArray:
    """Cut a polygon with holes into trapezoids with two sides along y, or along x where that is better.

    Parameters
    ----------
    outline : array_like (n, 2)
        Corners in either sense of rotation.
    holes : sequence of array_like (m, 2)
        Inside the outline, apart from it and from each other.

    Returns
    -------
    ndarray (T, 4, 2)
        Counter-clockwise; a triangle repeats its third corner.

    Raises
    ------
    GeometryError
        Holes that cross the outline or each other: the areas do not add up.

    References
    ----------
    M. de Berg et al., Computational Geometry (2008), chapter 6: trapezoidal maps.

    Examples
    --------
    >>> square = [[0, 0], [3, 0], [3, 3], [0, 3]]
    >>> len(trapezoids(square, [[[1, 1], [2, 1], [2, 2], [1, 2]]]))
    4
    """
    loops = [np.array(loop, dtype=np.float64) for loop in (outline, *holes)]
    along_y = _sweep(loops)
    along_x = np.array([_mirrored(piece) for piece in _sweep([loop[:, ::-1] for loop in loops])])
    best = max((along_y, along_x), key=_roundness)
    area = sum(signed_area(trapezoid) for trapezoid in best)
    true = abs(signed_area(loops[0])) - sum(abs(signed_area(loop)) for loop in loops[1:])
    if not abs(area - true) <= 1e-9 * abs(true):
        raise GeometryError(
            f"a polygon and its holes leave an area of {true:g}, but its pieces have {area:g}: they touch or cross"
        )
    return best


def _mirrored(piece: FloatArray) -> FloatArray:
    """Exchange x and y, and turn the sense of rotation with them."""
    if (piece[2] == piece[3]).all():
        return piece[[2, 1, 0, 0], ::-1]
    return piece[::-1, ::-1]


def _sweep(loops: list[FloatArray]) -> FloatArray:
    """Trapezoids between pairs of edges, from left to right; both of a pair go on past corners that touch neither."""
    edges = np.concatenate([np.stack([loop, np.roll(loop, -1, axis=0)], axis=1) for loop in loops])
    edges = edges[edges[:, 0, 0] != edges[:, 1, 0]]
    edges = np.where((edges[:, 0, 0] < edges[:, 1, 0])[:, None, None], edges, edges[:, ::-1])
    stops = np.unique(edges[:, :, 0])
    found: list[FloatArray] = []
    open_since: dict[tuple[int, int], float] = {}
    for left, right in pairwise(stops.tolist()):
        across = np.flatnonzero((edges[:, 0, 0] <= left) & (edges[:, 1, 0] >= right))
        middle = [_height(edges[k], 0.5 * (left + right)) for k in across]
        order = across[np.argsort(middle)].tolist()
        pairs = set(zip(order[::2], order[1::2], strict=True))
        for pair in sorted(open_since.keys() - pairs):
            found.append(_trapezoid(edges, pair, open_since.pop(pair), left))
        for pair in pairs - open_since.keys():
            open_since[pair] = left
    found += [_trapezoid(edges, pair, start, float(stops[-1])) for pair, start in sorted(open_since.items())]
    return np.array(found)


def _height(edge: FloatArray, x: float) -> float:
    """Height of an edge at x, exact at its ends."""
    (x0, y0), (x1, y1) = edge
    if x == x1:
        return float(y1)
    return float(y0 + (x - x0) / (x1 - x0) * (y1 - y0))


def _trapezoid(edges: FloatArray, pair: tuple[int, int], left: float, right: float) -> FloatArray:
    low, high = (edges[k] for k in pair)
    corners = [(left, _height(low, left)), (right, _height(low, right))]
    corners += [(right, _height(high, right)), (left, _height(high, left))]
    distinct = [corner for k, corner in enumerate(corners) if corner != corners[k - 1]]
    return np.array([*distinct, distinct[-1]][:4])


def _roundness(pieces: FloatArray) -> float:
    """Mean over the area of 16 × area / perimeter², 1 for a square."""
    perimeter = np.linalg.norm(np.roll(pieces, -1, axis=1) - pieces, axis=2).sum(axis=1)
    area = np.array([signed_area(piece) for piece in pieces])
    return float(np.sum(16 * area**2 / perimeter**2) / np.sum(area))
