"""Faces that lie in each other: floors under boxes, doubled walls. What is covered so sees nothing and loses light."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .geometry import triangle_vector_areas, unit
from .polygons import signed_area
from .scene import FloatArray, IntArray, Scene

TILT = 1e-4  # radians within which faces count as parallel
DEPTH = 1e-6  # of the scene's size, within which parallel faces count as one plane: what rays cannot tell apart
TOUCH = 1e-9  # of the scene's size: boxes that overlap by less only touch
MOST_PAIRS, MOST_WORK = 100_000, 10_000_000  # per plane, so that reading a file stays a matter of seconds
SLIGHT = 1e-3  # share of the smaller surface's area below which an overlap is rounding


@dataclass(frozen=True)
class Overlap:
    """Two surfaces that lie in each other.

    Attributes
    ----------
    first, second : int
        Indices of the surfaces; equal where faces of one surface lie in each other.
    area : float
        m² that they share.
    """

    first: int
    second: int
    area: float


def overlaps(scene: Scene) -> list[Overlap]:
    """Find surfaces whose faces lie in the same plane and cover each other.

    Within a surface, only equal triangles are found (faces doubled to be seen from both sides). Where many
    thousands of triangles of several surfaces lie in one plane, the search ends early and areas are lower bounds.

    Parameters
    ----------
    scene : Scene

    Returns
    -------
    list of Overlap
        Largest first.
    """
    corners, surface = _triangles(scene)
    corners = corners - corners.reshape(-1, 3).mean(axis=0)
    size = float(np.abs(corners).max()) or 1.0
    corners = corners / size
    areas = triangle_vector_areas(corners)
    normal = unit(areas)
    upright = np.where(np.abs(normal) > 1e-3, normal, 0.0)
    sign = np.sign(np.take_along_axis(upright, np.argmax(upright != 0, axis=1)[:, None], axis=1))
    normal = normal * np.where(sign == 0, 1.0, sign)  # opposite faces share a plane
    offset = np.einsum("nx,nx->n", normal, corners.mean(axis=1))
    pairs = np.concatenate([_doubled(corners, surface), _candidates(normal, offset, corners, surface)])
    shared = np.array([_common_area(corners[i], corners[j], normal[i]) for i, j in pairs.tolist()], dtype=np.float64)
    whole: FloatArray = np.zeros(len(scene.surfaces))
    np.add.at(whole, surface, np.linalg.norm(areas, axis=1))
    return _by_surface(surface[pairs], shared, whole, size**2)


def _triangles(scene: Scene) -> tuple[FloatArray, IntArray]:
    """All faces as triangles (T, 3, 3), and the surface of each."""
    corners, surface = [], []
    for k, part in enumerate(scene.surfaces):
        faces = part.faces[:, :3]
        if part.faces.shape[1] == 4:
            faces = np.concatenate([faces, part.faces[part.faces[:, 3] >= 0][:, [0, 2, 3]]])
        corners.append(part.vertices[faces])
        surface.append(np.full(len(faces), k))
    return np.concatenate(corners), np.concatenate(surface)


def _doubled(corners: FloatArray, surface: IntArray) -> IntArray:
    """Pairs of equal triangles of one surface, whichever way round."""
    group = _hash(corners).sum(axis=1, dtype=np.uint64) + surface.astype(np.uint64)  # a sum knows no order
    order = np.argsort(group, kind="stable")
    same = np.flatnonzero(group[order][1:] == group[order][:-1])
    return np.column_stack([order[same], order[same + 1]])


def _candidates(normal: FloatArray, offset: FloatArray, corners: FloatArray, surface: IntArray) -> IntArray:
    """Pairs (P, 2) of triangles of different surfaces, in one plane, whose boxes overlap.

    Planes are found by rounding, twice, with the second grid shifted by half a cell, so that no two near planes
    are parted by an edge of both.
    """
    key = np.column_stack([normal / (4 * TILT), offset / (4 * DEPTH)])
    found: list[tuple[int, int]] = []
    if surface[0] == surface[-1]:  # there is but one
        return np.zeros((0, 2), dtype=np.int64)
    for shift in (0.0, 0.5):
        group = _hash(np.floor(key + shift))
        order = np.lexsort((surface, group))
        ordered = group[order]
        mixed = (ordered[1:] == ordered[:-1]) & (np.diff(surface[order]) != 0)
        for plane in np.unique(ordered[1:][mixed]):  # planes of several surfaces: few, even in large meshes
            start, end = np.searchsorted(ordered, plane), np.searchsorted(ordered, plane, side="right")
            found += _box_pairs(order[start:end], corners, surface)
    return np.unique(np.array(found, dtype=np.int64).reshape(-1, 2), axis=0)


def _box_pairs(members: NDArray[np.int64], corners: FloatArray, surface: IntArray) -> list[tuple[int, int]]:
    """Pairs of triangles of different surfaces whose boxes overlap in more than a touch, by a sweep along an axis."""
    extent = np.ptp(corners[members].reshape(-1, 3), axis=0)
    axis, flat = int(np.argmax(extent)), extent < 1e-5  # flat: the plane's own axis, where it is upright
    members = members[np.argsort(corners[members, :, axis].min(axis=1), kind="stable")]
    members = members[_near_others(corners[members], surface[members], ~flat)]
    low, high = corners[members].min(axis=1), corners[members].max(axis=1)
    pairs: list[tuple[int, int]] = []
    work = 0
    for i in range(len(members)):
        rest = slice(i + 1, int(np.searchsorted(low[:, axis], high[i, axis])))
        apart = ((low[rest] >= high[i] - TOUCH) | (high[rest] <= low[i] + TOUCH)) & ~flat
        near = members[rest][~apart.any(axis=1) & (surface[members[rest]] != surface[members[i]])]
        pairs += [(min(int(members[i]), int(j)), max(int(members[i]), int(j))) for j in near]
        work += len(low[rest])
        if work > MOST_WORK or len(pairs) > MOST_PAIRS:
            break
    return pairs


def _near_others(corners: FloatArray, surface: IntArray, axes: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Which triangles overlap the box of any other surface; of a floor under a box, most do not."""
    surfaces = np.unique(surface)
    if len(surfaces) > 32:  # the table below would be larger than what it saves
        return np.ones(len(corners), dtype=bool)
    low, high = corners.min(axis=1)[:, axes], corners.max(axis=1)[:, axes]
    near = np.zeros(len(corners), dtype=bool)
    for k in surfaces:
        own = surface == k
        inside = (low < high[own].max(axis=0) - TOUCH) & (high > low[own].min(axis=0) + TOUCH)
        near |= ~own & inside.all(axis=1)
    return near


def _hash(rows: FloatArray) -> NDArray[np.uint64]:
    """Numbers for rows (…, n), equal for equal ones: much faster to compare than the rows."""
    drawn: NDArray[np.uint64] = np.random.default_rng(0).integers(0, 2**63, (rows.shape[-1],), dtype=np.uint64)
    odd = drawn | np.uint64(1)
    result = np.zeros(rows.shape[:-1], dtype=np.uint64)
    for k in range(rows.shape[-1]):
        bits = (rows[..., k] + 0.0).view(np.uint64)  # + 0.0: no negative zeros
        bits = (bits ^ (bits >> np.uint64(32))) * odd[k]
        result += bits ^ (bits >> np.uint64(29))
    return result


def _common_area(one: FloatArray, other: FloatArray, normal: FloatArray) -> float:
    """Area that two triangles of one plane share (I. E. Sutherland, G. W. Hodgman, 1974, doi:10.1145/360767.360802)."""
    u = unit(one[1] - one[0])
    frame = np.stack([u, np.cross(normal, u)], axis=1)
    origin = one[0]
    clip, shape = (one - origin) @ frame, (other - origin) @ frame
    if signed_area(clip) < 0:
        clip = clip[::-1]
    for k in range(3):
        if len(shape) == 0:
            return 0.0
        start, edge = clip[k], clip[(k + 1) % 3] - clip[k]
        depth = edge[0] * (shape[:, 1] - start[1]) - edge[1] * (shape[:, 0] - start[0])
        shape = _cut(shape, depth)
    return abs(signed_area(shape)) if len(shape) > 2 else 0.0


def _cut(shape: FloatArray, depth: FloatArray) -> FloatArray:
    """The part of a convex polygon (n, 2) where depth (n,) ≥ 0."""
    result = []
    for k in range(len(shape)):
        here, after = depth[k], depth[(k + 1) % len(shape)]
        if here >= 0:
            result.append(shape[k])
        if (here >= 0) != (after >= 0):
            result.append(shape[k] + here / (here - after) * (shape[(k + 1) % len(shape)] - shape[k]))
    return np.array(result).reshape(-1, 2)


def _by_surface(surface: IntArray, shared: FloatArray, whole: FloatArray, unit_area: float) -> list[Overlap]:
    """Sums per pair of surfaces, without those that are rounding."""
    if not len(shared):
        return []
    pairs, place = np.unique(np.sort(surface, axis=1), axis=0, return_inverse=True)
    sums = np.bincount(place.reshape(-1), shared)
    found = [
        Overlap(int(a), int(b), float(area * unit_area))
        for (a, b), area in zip(pairs, sums, strict=True)
        if area > SLIGHT * min(whole[a], whole[b])
    ]
    return sorted(found, key=lambda overlap: -overlap.area)
