"""Plane polygons, concave or with holes, cut into triangles that use their own corners and no others.

Because no corner is added, neighbours that share an edge of the polygon still share it whole, and the mesh stays
watertight.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .errors import GeometryError

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]


def cross(a: FloatArray, b: FloatArray, c: FloatArray) -> FloatArray:
    """Twice the signed area of triangles a, b, c (…, 2); positive where counter-clockwise."""
    return (b[..., 0] - a[..., 0]) * (c[..., 1] - a[..., 1]) - (b[..., 1] - a[..., 1]) * (c[..., 0] - a[..., 0])


def signed_area(loop: FloatArray) -> float:
    """Area of a closed polygon (n, 2), positive where counter-clockwise (the shoelace formula)."""
    x, y = (loop - loop[0]).T
    return float(0.5 * np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))


def triangulate(outline: ArrayLike, holes: Sequence[ArrayLike] = ()) -> tuple[FloatArray, IntArray]:
    """Cut a polygon with holes into Delaunay triangles without adding corners.

    Holes are joined to the outline by bridges, ears are clipped, and edges inside are flipped until no corner lies in
    the circle of a neighbouring triangle, which avoids slivers where the corners allow it.

    Parameters
    ----------
    outline : array_like (n, 2)
        Corners in either sense of rotation; no edge may cross another.
    holes : sequence of array_like (m, 2)
        Inside the outline, apart from it and from each other.

    Returns
    -------
    points : ndarray (P, 2)
        The corners, outline first, then the holes in their order; unchanged.
    triangles : ndarray of int64 (T, 3)
        Counter-clockwise; T = P + 2 × holes - 2.

    Raises
    ------
    GeometryError
        Fewer than three corners, or loops that cross or touch, so that no ear or bridge is found.

    References
    ----------
    G. H. Meisters, "Polygons have ears", American Mathematical Monthly 82 (1975), doi:10.1080/00029890.1975.11993898;
    C. L. Lawson, "Software for C1 surface interpolation", Mathematical Software III (1977), 161-194, for the flips.

    Examples
    --------
    >>> square = [[0, 0], [3, 0], [3, 3], [0, 3]]
    >>> points, triangles = triangulate(square, [[[1, 1], [2, 1], [2, 2], [1, 2]]])
    >>> len(triangles)
    8
    """
    loops = [_checked_loop(loop) for loop in (outline, *holes)]
    points = np.concatenate(loops)
    starts = np.cumsum([0] + [len(loop) for loop in loops])
    indices = [list(range(a, b)) for a, b in pairwise(starts)]
    for k, loop in enumerate(loops):
        if (signed_area(loop) < 0) == (k == 0):  # outline counter-clockwise, holes clockwise
            indices[k].reverse()
    ring = _join_holes(points, indices[0], indices[1:])
    triangles = _clip_ears(points, ring)
    return points, _flip_to_delaunay(points, triangles)


def _checked_loop(loop: ArrayLike) -> FloatArray:
    array = np.array(loop, dtype=np.float64)
    if array.ndim != 2 or array.shape[1] != 2 or len(array) < 3 or not np.isfinite(array).all():
        raise GeometryError(f"a polygon's corners have shape {array.shape}; give at least 3 finite ones, (n, 2)")
    return array


def _join_holes(points: FloatArray, ring: list[int], holes: list[list[int]]) -> list[int]:
    """One ring around everything: each hole hangs on a bridge that is walked in both directions."""
    waiting = sorted(holes, key=lambda hole: -points[hole, 0].max())
    while waiting:
        hole = waiting.pop(0)
        loops = [ring, hole, *waiting]
        edges = np.array([pair for loop in loops for pair in zip(loop, loop[1:] + loop[:1], strict=True)])
        place, turn = _bridge(points, ring, hole, edges)
        around = hole[turn:] + hole[:turn]
        ring = ring[: place + 1] + around + [around[0]] + ring[place:]
    return ring


def _bridge(points: FloatArray, ring: list[int], hole: list[int], edges: IntArray) -> tuple[int, int]:
    """Places in ring and hole of the shortest straight bridge from the hole's rightmost corner that crosses nothing."""
    turn = int(np.argmax(points[hole, 0]))
    start = hole[turn]
    order = np.argsort(np.linalg.norm(points[ring] - points[start], axis=1), kind="stable")
    for place in order:
        end = ring[place]
        if _sees(points, ring, int(place), start) and not _crosses(points, start, end, edges):
            return int(place), turn
    raise GeometryError("a hole of a polygon touches or crosses its outline or another hole; keep them apart")


def _sees(points: FloatArray, ring: list[int], place: int, target: int) -> bool:
    """Whether the target lies within the ring's inner angle at that place (a corner may occur twice in a ring)."""
    before, here, after = (points[ring[(place + k) % len(ring)]] for k in (-1, 0, 1))
    left_of_next = cross(here, after, points[target]) > 0
    left_of_last = cross(before, here, points[target]) > 0
    convex = cross(before, here, after) >= 0
    return bool(left_of_next and left_of_last) if convex else bool(left_of_next or left_of_last)


def _crosses(points: FloatArray, start: int, end: int, edges: IntArray) -> bool:
    """Whether segment start-end meets any edge that has neither as a corner, even in a touch."""
    other = edges[~np.isin(edges, (start, end)).any(axis=1)]
    p, q, a, b = points[start], points[end], points[other[:, 0]], points[other[:, 1]]
    apart = (np.sign(cross(p, q, a)) * np.sign(cross(p, q, b)) > 0) | (
        np.sign(cross(a, b, p)) * np.sign(cross(a, b, q)) > 0
    )
    outside = (np.maximum(a, b) < np.minimum(p, q)).any(axis=1) | (np.minimum(a, b) > np.maximum(p, q)).any(axis=1)
    return not bool(np.all(apart | outside))


def _clip_ears(points: FloatArray, ring: list[int]) -> IntArray:
    ring = list(ring)
    triangles: list[tuple[int, int, int]] = []
    place = 0
    failures = 0
    while len(ring) > 3:
        place %= len(ring)
        corner = (ring[place - 1], ring[place], ring[(place + 1) % len(ring)])
        if _is_ear(points, ring, corner):
            triangles.append(corner)
            del ring[place]
            failures = 0
        else:
            place += 1
            failures += 1
            if failures > len(ring):
                raise GeometryError(
                    f"a polygon crosses or touches itself near {points[corner[1]].tolist()}; mend it or split it"
                )
    if cross(*(points[i] for i in ring)) <= 0:
        raise GeometryError(
            f"a polygon is flat or crosses itself near {points[ring[0]].tolist()}; mend or leave it out"
        )
    triangles.append((ring[0], ring[1], ring[2]))
    return np.array(triangles, dtype=np.int64)


def _is_ear(points: FloatArray, ring: list[int], corner: tuple[int, int, int]) -> bool:
    """Whether a corner can be cut off: it is convex, and no other corner lies in or on its triangle."""
    a, b, c = (points[i] for i in corner)
    if not cross(a, b, c) > 0:
        return False
    others = points[[i for i in ring if i not in corner]]
    others = others[~(others[:, None] == (a, b, c)).all(axis=2).any(axis=1)]  # the far side of a bridge
    inside = (cross(a, b, others) >= 0) & (cross(b, c, others) >= 0) & (cross(c, a, others) >= 0)
    return not bool(inside.any())


def _flip_to_delaunay(points: FloatArray, triangles: IntArray) -> IntArray:
    """Lawson's flips of inner edges; edges of the polygon have one triangle and stay."""
    result = [tuple(int(i) for i in t) for t in triangles]
    owner = {(t[k], t[(k + 1) % 3]): n for n, t in enumerate(result) for k in range(3)}
    waiting = [edge for edge in owner if edge[0] < edge[1]]
    for _ in range(len(result) ** 2 + 16):  # enough for any triangulation; ends ties of rounding too
        if not waiting:
            break
        a, b = waiting.pop()
        one, two = owner.get((a, b)), owner.get((b, a))
        if one is None or two is None:
            continue
        c = next(i for i in result[one] if i not in (a, b))
        d = next(i for i in result[two] if i not in (a, b))
        if not _should_flip(points[[a, b, c, d]]):
            continue
        result[one], result[two] = (a, d, c), (d, b, c)
        del owner[a, b], owner[b, a]
        owner |= {(a, d): one, (d, c): one, (c, a): one, (d, b): two, (b, c): two, (c, d): two}
        waiting += [(a, d), (d, b), (b, c), (c, a)]
    return np.array(result, dtype=np.int64)


def _should_flip(corners: FloatArray) -> bool:
    """Whether d lies in the circle through a, b, c and the quad a, d, b, c is convex."""
    a, b, c, d = corners
    scale = np.ptp(corners, axis=0).max() ** 2
    if cross(a, d, c) <= 1e-12 * scale or cross(d, b, c) <= 1e-12 * scale:
        return False
    rows = corners[:3] - d
    circle = np.linalg.det(np.column_stack([rows, (rows**2).sum(axis=1)]))
    return bool(circle > 1e-12 * scale**2)
