"""Convex faces that lie in each other: in one plane, with area in common. Found among millions, and clipped exactly.

Faces count as lying in one plane where they are nearer to each other than `DEPTH`. Rays start that far off their
patch, so of two nearer faces neither sees the other.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .geometry import longest_edges, quad_vector_areas, unit

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

DEPTH = 1e-5  # of the diagonal of all faces; the same as `radiosity.face_points.OFFSET`
TILT = 0.03  # radians: small faces with rounded corners may be turned as much
TOUCH = 1e-6  # of the diagonal: common strips that are thinner are rounding
LARGE, SINGLED_OUT = 1e-4, 1000  # faces of this area, in diagonals², and so many: compared with their owner's too
CHUNK = 1 << 20  # pairs at a time

# Cells in which faces of one plane are looked for: far larger than rounding moves normals and offsets.
NORMAL_CELL, OFFSET_CELL, OFFSET_CELLS = 0.01, 4e-3, 1 << 10
SHIFTS = (0.37, 0.83)  # two grids, so that no two alike faces are parted by a border of both
UPWARD = np.array([0.3141, 0.8467, 0.4294])  # in no plane of a usual scene: opposite normals become one
SIGNATURE = np.array([0.7548776662, 0.5698402910, 0.8191725134])  # of no special direction either


class CoplanarPairs(NamedTuple):
    """P pairs of faces that share area: `first` < `second` (P,), `area` (P,) m², and whether they face `alike` (P,)."""

    first: IntArray
    second: IntArray
    area: FloatArray
    alike: NDArray[np.bool_]


def coplanar_pairs(corners: FloatArray, owner: NDArray[np.integer]) -> CoplanarPairs:
    """Find faces that cover each other.

    Large faces are compared with all others, small ones with those of other owners and of opposite sense. Small faces
    of one owner that face alike are found where they are equal: a mesh of a million triangles has no time for more.

    Parameters
    ----------
    corners : ndarray (n, k, 3)
        Flat convex faces, m; repeated corners are fine.
    owner : ndarray of int (n,)
        Surface of each face, from 0 on.

    Returns
    -------
    CoplanarPairs
        In the order of (first, second). Strips thinner than `TOUCH` do not count.
    """
    low, high = (np.array([end(corners[..., x]) for x in range(3)]) for end in (np.min, np.max))
    size = float(np.linalg.norm(high - low)) or 1.0
    scaled = (corners - 0.5 * (low + high)) / size
    vector_area = _vector_areas(scaled)
    area = np.sqrt(np.einsum("nx,nx->n", vector_area, vector_area))
    normal = vector_area / np.where(area > 0, area, 1.0)[:, None]
    label = 2 * owner.astype(np.int64) + (normal @ UPWARD > 0)
    large = np.flatnonzero(area > LARGE)
    large = large[np.argsort(-area[large], kind="stable")[:SINGLED_OUT]]
    label[large] = label.max() + 1 + np.arange(len(large))
    pairs = np.concatenate([_equal_faces(scaled, label), _candidates(scaled, normal, label)])
    pairs = np.unique(np.sort(pairs[(area[pairs] > 0).all(axis=1)], axis=1), axis=0)
    return _shared(scaled, normal, area, pairs, size)


def _vector_areas(corners: FloatArray) -> FloatArray:
    """Area times normal of faces (n, 3, 3) or (n, 4, 3), one component at a time: fast."""
    if corners.shape[1] == 4:
        return quad_vector_areas(corners)
    a, b = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    turn = ((1, 2), (2, 0), (0, 1))
    return 0.5 * np.stack([a[:, i] * b[:, j] - a[:, j] * b[:, i] for i, j in turn], axis=1)


def _equal_faces(corners: FloatArray, label: IntArray) -> IntArray:
    """Pairs (P, 2) of one label with the same middle: equal faces, and a few chance ones."""
    signature = sum(corners[:, k] @ SIGNATURE for k in range(corners.shape[1]))
    order = np.argsort(signature)
    near = np.flatnonzero(np.diff(signature[order]) < 1e-13)
    pairs = np.column_stack([order[near], order[near + 1]])
    return pairs[label[pairs[:, 0]] == label[pairs[:, 1]]]


def _candidates(corners: FloatArray, normal: FloatArray, label: IntArray) -> IntArray:
    """Pairs (P, 2) of different labels in about one plane whose boxes overlap."""
    upward = normal * np.where(normal @ UPWARD < 0, -1.0, 1.0)[:, None]
    offset = np.einsum("nx,nx->n", upward, corners[:, 0])
    found = [np.zeros((0, 2), dtype=np.int64)]
    for shift in SHIFTS:
        cells = ((upward + 1.0) / NORMAL_CELL + shift).astype(np.int64)
        plane = (((cells[:, 0] << 8) + cells[:, 1]) << 8) + cells[:, 2]
        plane = plane * OFFSET_CELLS + ((offset + 1.0) / OFFSET_CELL + shift).astype(np.int64)
        members, starts = _mixed_planes(plane, label)
        if len(members):
            found.append(_near_pairs(members, starts, corners, upward, label))
    return np.concatenate(found)


def _mixed_planes(plane: IntArray, label: IntArray) -> tuple[IntArray, NDArray[np.bool_]]:
    """Faces of planes that hold several labels, sorted by (plane, label), and where a new plane starts."""
    order = np.lexsort((label, plane))
    sorted_plane, sorted_label = plane[order], label[order]
    starts = np.ones(len(order), dtype=bool)
    starts[1:] = sorted_plane[1:] != sorted_plane[:-1]
    place = np.cumsum(starts) - 1
    first = np.flatnonzero(starts)
    last = np.append(first[1:], len(order)) - 1
    mixed = (sorted_label[first] != sorted_label[last])[place]
    return order[mixed], starts[mixed]


def _near_pairs(
    members: IntArray, starts: NDArray[np.bool_], corners: FloatArray, normal: FloatArray, label: IntArray
) -> IntArray:
    """Pairs of different labels of one plane whose boxes, flattened along the plane's steepest axis, overlap."""
    plane = np.cumsum(starts) - 1
    steepest = np.argmax(np.abs(normal[members[starts]]), axis=1)[plane]
    axes = np.array([[1, 2], [0, 2], [0, 1]])[steepest]
    shape = corners[members]
    flat = np.stack([np.take_along_axis(shape[:, k], axes, axis=1) for k in range(shape.shape[1])], axis=1)
    low, high = flat.min(axis=1), flat.max(axis=1)
    # First whole labels against each other: of a floor under a box, most faces are far from it.
    change = starts.copy()
    change[1:] |= label[members][1:] != label[members][:-1]
    run = np.cumsum(change) - 1
    first = np.flatnonzero(change)
    run_low, run_high = np.minimum.reduceat(low, first), np.maximum.reduceat(high, first)
    near_low, near_high = np.full_like(run_low, np.inf), np.full_like(run_high, -np.inf)
    for a, b in _box_pairs(run_low, run_high, plane[first], np.arange(len(first))):
        for one, other in ((a, b), (b, a)):
            np.minimum.at(near_low, one, run_low[other])
            np.maximum.at(near_high, one, run_high[other])
    keep = np.flatnonzero((high > near_low[run] + TOUCH).all(axis=1) & (low < near_high[run] - TOUCH).all(axis=1))
    pairs = [np.zeros((0, 2), dtype=np.int64)]
    pairs += [np.column_stack([a, b]) for a, b in _box_pairs(low[keep], high[keep], plane[keep], label[members[keep]])]
    return members[keep[np.concatenate(pairs)]]


def _box_pairs(
    low: FloatArray, high: FloatArray, key: IntArray, label: IntArray
) -> Iterator[tuple[IntArray, IntArray]]:
    """Boxes (n, 2) of one key and different labels that overlap: a sweep along one axis, in rows along the other."""
    if len(low) < 2:
        return
    item, row = _rows(low[:, 1], high[:, 1], key)
    order = np.lexsort((low[item, 0], row))
    item, row = item[order], row[order]
    begin = low[:, 0].min()
    width = 1.1 * (high[:, 0].max() - begin) + 1e-300
    place = row + (low[item, 0] - begin) / width  # sorted: whole part the row, the rest how far along
    partners = np.searchsorted(place, row + (high[item, 0] - begin) / width, side="right")
    partners = np.maximum(partners - np.arange(len(item)) - 1, 0)
    total = np.cumsum(partners)
    if not total[-1]:
        return
    cuts = np.searchsorted(total, np.arange(0, int(total[-1]), CHUNK), side="right")
    for start, end in zip(cuts, np.append(cuts[1:], len(item)), strict=True):
        number = partners[start:end]
        here = np.repeat(np.arange(start, end), number)
        step = np.arange(len(here)) - np.repeat(np.cumsum(number) - number, number)
        a, b = item[here], item[here + 1 + step]
        apart = (low[a] >= high[b] - TOUCH) | (low[b] >= high[a] - TOUCH)
        keep = ~apart.any(axis=1) & (label[a] != label[b])
        yield a[keep], b[keep]


def _rows(low: FloatArray, high: FloatArray, key: IntArray) -> tuple[IntArray, IntArray]:
    """Items of each row of each key, and numbers of the rows: as many rows as leave a few items in each.

    An item that reaches over several rows stands in all of them.
    """
    keys, place, count = np.unique(key, return_inverse=True, return_counts=True)
    bottom, top = np.full(len(keys), np.inf), np.full(len(keys), -np.inf)
    np.minimum.at(bottom, place, low)
    np.maximum.at(top, place, high)
    mean = np.bincount(place, high - low) / count
    step = np.maximum(np.maximum((top - bottom) / np.sqrt(count), mean), 1e-300)
    from_row = ((low - bottom[place]) / step[place]).astype(np.int64)
    to_row = ((high - bottom[place]) / step[place]).astype(np.int64)
    repeats = to_row - from_row + 1
    item = np.repeat(np.arange(len(low)), repeats)
    before = np.cumsum(repeats) - repeats
    rows = from_row[item] + np.arange(len(item)) - before[item]
    rows_of_key = ((top - bottom) / step).astype(np.int64) + 1
    return item, rows + (np.cumsum(rows_of_key) - rows_of_key)[place[item]]


def _shared(corners: FloatArray, normal: FloatArray, area: FloatArray, pairs: IntArray, size: float) -> CoplanarPairs:
    """Those candidates that lie in one plane and share more than a strip, with the area that they share."""
    results = [(pairs[:0, 0], pairs[:0, 1], np.zeros(0), np.zeros(0, dtype=bool))]
    for begin in range(0, len(pairs), CHUNK // 16):
        chunk = pairs[begin : begin + CHUNK // 16]
        length = np.stack([longest_edges(corners[side]) for side in chunk.T], axis=1)
        height = area[chunk] / length  # the higher face knows the plane better
        swap = height[:, 1] > height[:, 0]
        base, other = np.where(swap, chunk[:, 1], chunk[:, 0]), np.where(swap, chunk[:, 0], chunk[:, 1])
        cosine = np.einsum("nx,nx->n", normal[base], normal[other])
        gap = np.einsum("nkx,nx->nk", corners[other] - corners[base][:, :1], normal[base])
        flat = (np.abs(gap).max(axis=1) < DEPTH) & (np.abs(cosine) > np.cos(TILT))
        base, other, chunk, cosine = base[flat], other[flat], chunk[flat], cosine[flat]
        common = common_shapes(corners[base], corners[other], normal[base])
        shared = areas(common)
        much = shared > TOUCH * np.ptp(common, axis=1).max(axis=1, initial=0.0)
        results.append((chunk[much, 0], chunk[much, 1], shared[much] * size**2, cosine[much] > 0))
    return CoplanarPairs(*(np.concatenate(part) for part in zip(*results, strict=True)))


def common_shapes(one: FloatArray, other: FloatArray, normal: FloatArray) -> FloatArray:
    """What convex faces (n, k, 3) of one plane have in common, pair by pair: (n, 2 k, 2), in the plane of the first.

    The second is cut along one edge of the first after the other (I. E. Sutherland, G. W. Hodgman, 1974,
    doi:10.1145/360767.360802). Where corners are lacking, one is repeated.
    """
    u = unit(one[:, 1] - one[:, 0])
    frame = np.stack([u, np.cross(normal, u)], axis=2)
    knife = (one - one[:, :1]) @ frame
    shape = (other - one[:, :1]) @ frame
    for k in range(knife.shape[1]):
        start = knife[:, k]
        edge = knife[:, (k + 1) % knife.shape[1]] - start
        depth = edge[:, :1] * (shape[..., 1] - start[:, 1:]) - edge[:, 1:] * (shape[..., 0] - start[:, :1])
        shape = _cut(shape, depth)
    return shape


def areas(shapes: FloatArray) -> FloatArray:
    """Areas (n,) of polygons (n, k, 2)."""
    x, y = np.moveaxis(shapes - shapes[:, :1], 2, 0)
    return np.abs(0.5 * (x * np.roll(y, -1, axis=1) - np.roll(x, -1, axis=1) * y).sum(axis=1))


def _cut(shape: FloatArray, depth: FloatArray) -> FloatArray:
    """The parts (n, k + 1, 2) of convex polygons (n, k, 2) where depth (n, k) ≥ 0; what is lacking repeats a corner."""
    after, depth_after = np.roll(shape, -1, axis=1), np.roll(depth, -1, axis=1)
    inside = depth >= 0
    crossing = inside != (depth_after >= 0)
    share = depth / np.where(crossing, depth - depth_after, 1.0)
    count, sides = inside.shape
    corner = np.stack([shape, shape + share[..., None] * (after - shape)], axis=2).reshape(count, 2 * sides, 2)
    valid = np.stack([inside, crossing], axis=2).reshape(count, 2 * sides)
    number = valid.sum(axis=1)
    order = np.argsort(~valid, axis=1, kind="stable")
    place = np.minimum(np.arange(sides + 1), np.maximum(number - 1, 0)[:, None])
    kept = np.take_along_axis(corner, np.take_along_axis(order, place, axis=1)[..., None], axis=1)
    return np.where((number > 0)[:, None, None], kept, 0.0)
