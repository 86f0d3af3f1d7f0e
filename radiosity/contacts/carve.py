"""A flat face without what covers it, in convex pieces: the plane is swept from left to right.

As in `radiosity.trapezoids`, cuts parallel to one axis give trapezoids, which divide into even patches. Here, what is
cut away may touch or cross the outline and itself, and its corners may be rounded: edges are split where they cross,
corners that nearly coincide become one, and pieces thinner than rounding are left out.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ..polygons import signed_area

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

Point = tuple[float, float]
Edge = tuple[Point, Point]

OUTLINE, CUT, DIVIDE = 0, 1, 2  # families of edges
NOTHING, PLAIN, COVERED = 0, 1, 2  # what lies between two edges


def carve(
    outline: FloatArray, cuts: Sequence[FloatArray], divides: Sequence[FloatArray], thin: float
) -> tuple[FloatArray, FloatArray]:
    """Cut some polygons out of another one, and divide the rest along the border of more of them.

    Parameters
    ----------
    outline : ndarray (n, 2)
        Counter-clockwise; edges must not cross.
    cuts, divides : sequences of ndarray (m, 2)
        Simple polygons in either sense of rotation, wherever they lie.
    thin : float
        Corners nearer than a tenth of this are one, and pieces thinner than this are left out.

    Returns
    -------
    plain, covered : ndarray (P, 4, 2)
        Trapezoids outside and inside of `divides`, counter-clockwise; a triangle repeats its third corner. Corners of
        the given polygons come back bit by bit.

    References
    ----------
    M. de Berg et al., Computational Geometry (2008), chapter 6 (trapezoidal maps) and section 2.3 (overlays).
    """
    families = [[outline], list(cuts), list(divides)]
    best: tuple[float, FloatArray, NDArray[np.int64]] | None = None
    for swap in (False, True):
        turned = [[_turned(polygon) if swap else polygon for polygon in family] for family in families]
        pieces, kinds = _sweep(turned, thin)
        if swap:
            pieces = np.array([_turned(piece) for piece in pieces]).reshape(-1, 4, 2)
        if best is None or _roundness(pieces) > best[0]:
            best = _roundness(pieces), pieces, kinds
    assert best is not None
    _, pieces, kinds = best
    return pieces[kinds == PLAIN], pieces[kinds == COVERED]


def _turned(polygon: FloatArray) -> FloatArray:
    """Exchange x and y, and the sense of rotation with them."""
    if len(polygon) == 4 and (polygon[2] == polygon[3]).all():
        return polygon[[2, 1, 0, 0], ::-1]
    return polygon[::-1, ::-1]


def _sweep(families: list[list[FloatArray]], thin: float) -> tuple[FloatArray, IntArray]:
    """Trapezoids (P, 4, 2) with sides along y, and the kind of each (P,)."""
    edges, family = _edges(families, 0.1 * thin)
    rising = np.where(edges[:, 0, 0] < edges[:, 1, 0], 1, -1)
    edges = np.where((rising > 0)[:, None, None], edges, edges[:, ::-1])
    pieces: list[FloatArray] = []
    kinds: list[int] = []
    since: dict[tuple[int, int, int], float] = {}

    def end(strip: tuple[int, int, int], right: float) -> None:
        piece = _trapezoid(edges, strip, since.pop(strip), right, thin)
        if piece is not None:
            pieces.append(piece)
            kinds.append(strip[2])

    stops = _stops(edges, 0.1 * thin)
    for left, right in pairwise(stops.tolist()):
        strips = _strips(edges, family, rising, left, right, thin)
        for strip in sorted(since.keys() - strips):
            end(strip, left)
        for strip in strips - since.keys():
            since[strip] = left
    for strip in sorted(since):
        end(strip, float(stops[-1]))
    return np.array(pieces).reshape(-1, 4, 2), np.array(kinds, dtype=np.int64)


def _edges(families: list[list[FloatArray]], near: float) -> tuple[FloatArray, IntArray]:
    """Edges (E, 2, 2) that are not upright, and their families (E,): of each family, those of the union's border."""
    points = snapped(np.concatenate([polygon for family in families for polygon in family]), near)
    edges: list[Edge] = []
    owners: list[int] = []
    place = 0
    for number, family in enumerate(families):
        count: Counter[Edge] = Counter()
        for polygon in family:
            loop = points[place : place + len(polygon)]
            place += len(polygon)
            corners: list[Point] = [(x, y) for x, y in (loop if signed_area(loop) >= 0 else loop[::-1]).tolist()]
            count.update(pair for pair in zip(corners, corners[1:] + corners[:1], strict=True) if pair[0] != pair[1])
        left = [edge for edge, times in count.items() for _ in range(times - count[edge[1], edge[0]])]
        border = [edge for edge in _straightened(left, near) if edge[0][0] != edge[1][0]]
        edges += border
        owners += [number] * len(border)
    return np.array(edges, dtype=np.float64).reshape(-1, 2, 2), np.array(owners, dtype=np.int64)


def _straightened(edges: list[Edge], near: float) -> list[Edge]:
    """Edges of which each that goes straight on into one other has become one with it."""
    begins, ends = Counter(a for a, _ in edges), Counter(b for _, b in edges)
    after = {a: (a, b) for a, b in edges}
    removed: set[Edge] = set()
    result = []
    straight = {
        (a, b)
        for a, b in edges
        if begins[b] == ends[b] == 1 and _straight(a, b, after[b][1], near) and after[b][1] != a
    }
    into = {after[b] for _, b in straight}
    for edge in edges:
        if edge in into or edge in removed:
            continue
        end = edge
        while end in straight:
            end = after[end[1]]
            removed.add(end)
        result.append((edge[0], end[1]))
    return result


def _straight(a: Point, b: Point, c: Point, near: float) -> bool:
    """Whether b lies between a and c, and by less than `near` off the line through them."""
    (x, y), (u, v) = (c[0] - a[0], c[1] - a[1]), (b[0] - a[0], b[1] - a[1])
    length = math.hypot(x, y)
    return abs(x * v - y * u) <= near * length and 0 < x * u + y * v < length**2


def snapped(points: FloatArray, near: float) -> FloatArray:
    """Points (n, 2) with coordinates that are nearer than `near` made equal: to that of the first point of each lot."""
    result = points.copy()
    for axis in (0, 1):
        order = np.argsort(points[:, axis], kind="stable")
        lot = np.concatenate([[0], np.cumsum(np.diff(points[order, axis]) > near)])
        first = np.full(lot[-1] + 1, len(points))
        np.minimum.at(first, lot, order)
        result[order, axis] = points[first[lot], axis]
    return result


def _stops(edges: FloatArray, near: float) -> FloatArray:
    """Places along x where edges begin, end or cross."""
    ends = np.unique(edges[:, :, 0])
    one, other = _side_by_side(edges)
    low = np.maximum(edges[one, 0, 0], edges[other, 0, 0])
    high = np.minimum(edges[one, 1, 0], edges[other, 1, 0])
    before = _heights(edges[one], low) - _heights(edges[other], low)
    after = _heights(edges[one], high) - _heights(edges[other], high)
    crossing = (before * after < 0) & (np.minimum(np.abs(before), np.abs(after)) > near)
    share = before[crossing] / (before[crossing] - after[crossing])
    found = np.unique(low[crossing] + share * (high[crossing] - low[crossing]))
    place = np.searchsorted(ends, found)
    gap = np.minimum(found - ends[np.maximum(place - 1, 0)], ends[np.minimum(place, len(ends) - 1)] - found)
    found = found[gap > near]
    return np.sort(np.concatenate([ends, found[np.diff(found, prepend=-np.inf) > near]]))


def _side_by_side(edges: FloatArray) -> tuple[IntArray, IntArray]:
    """Pairs of edges whose boxes overlap."""
    low, high = edges.min(axis=1), edges.max(axis=1)
    found = []
    for begin in range(0, len(edges), 256):
        rows = slice(begin, begin + 256)
        near = (low[rows, None] <= high).all(axis=2) & (high[rows, None] >= low).all(axis=2)
        near &= (low[rows, None, 0] < high[:, 0]) & (high[rows, None, 0] > low[:, 0])
        found.append(np.argwhere(near) + [begin, 0])
    pairs: IntArray = np.concatenate(found) if found else np.zeros((0, 2), dtype=np.int64)
    pairs = pairs[pairs[:, 0] < pairs[:, 1]]
    return pairs[:, 0], pairs[:, 1]


def _heights(edges: FloatArray, x: FloatArray) -> FloatArray:
    """Heights of edges (n, 2, 2) at x (n,), exact at their ends."""
    (x0, y0), (x1, y1) = edges[:, 0].T, edges[:, 1].T
    inner = y0 + (x - x0) / (x1 - x0) * (y1 - y0)
    return np.where(x == x0, y0, np.where(x == x1, y1, inner))


def _strips(
    edges: FloatArray, family: IntArray, rising: IntArray, left: float, right: float, thin: float
) -> set[tuple[int, int, int]]:
    """(edge below, edge above, kind) of all that lies between two stops."""
    across = np.flatnonzero((edges[:, 0, 0] <= left) & (edges[:, 1, 0] >= right))
    middle = np.full(len(across), 0.5 * (left + right))
    height = _heights(edges[across], middle)
    order = np.lexsort((across, height))
    across, height = across[order], height[order]
    # Edges that nearly coincide count as one, by the name of the first given: the outline's, if it is among them.
    starts = np.flatnonzero(np.diff(height, prepend=-np.inf) > 0.1 * thin)
    lot = np.repeat(np.arange(len(starts)), np.diff(starts, append=len(across)))
    winding = np.zeros((len(starts), 3), dtype=np.int64)
    np.add.at(winding, (lot, family[across]), rising[across])
    inside = np.cumsum(winding, axis=0) > 0
    kind = np.where(inside[:, OUTLINE] & ~inside[:, CUT], np.where(inside[:, DIVIDE], COVERED, PLAIN), NOTHING)
    name = np.minimum.reduceat(across, starts) if len(starts) else across
    change = np.flatnonzero(np.diff(kind, prepend=NOTHING) != 0)
    return {(int(name[a]), int(name[b]), int(kind[a])) for a, b in pairwise(change.tolist()) if kind[a] != NOTHING}


def _trapezoid(
    edges: FloatArray, strip: tuple[int, int, int], left: float, right: float, thin: float
) -> FloatArray | None:
    """The piece between two edges and two stops; None if it is thinner than rounding."""
    (ya, yb), (yd, yc) = (_heights(edges[[k, k]], np.array([left, right])) for k in strip[:2])
    if right - left < thin or max(yd - ya, yc - yb) < thin:
        return None
    corners = [(left, ya), (right, yb)]
    corners += [(right, yc)] if yc - yb > 0.1 * thin else []
    corners += [(left, yd)] if yd - ya > 0.1 * thin else []
    return np.array([*corners, corners[-1]][:4])


def _roundness(pieces: FloatArray) -> float:
    """Mean over the area of 16 × area / perimeter², 1 for a square."""
    perimeter = np.linalg.norm(np.roll(pieces, -1, axis=1) - pieces, axis=2).sum(axis=1)
    area = np.array([signed_area(piece) for piece in pieces])
    return float(np.sum(16 * area**2 / perimeter**2) / max(np.sum(area), 1e-300))
