"""Walls, boxes, spheres and cut floors from which the built-in scenes are put together.

Built-in scenes are in metres with y up (as in glTF files): x to the right, z towards the viewer.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..scene import Material, Surface
from ..trapezoids import trapezoids

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
Mesh = tuple[FloatArray, IntArray]
Range = tuple[Sequence[float], Sequence[float]]

WALLS = {
    "floor": (1, 0, +1),
    "ceiling": (1, 1, -1),
    "back_wall": (2, 0, +1),
    "front_wall": (2, 1, -1),
    "left_wall": (0, 0, +1),
    "right_wall": (0, 1, -1),
}
"""Of each wall of a room: the axis it is perpendicular to, at which end it is, and the sign of its inward normal."""


def paint(name: str, reflectance: ArrayLike, radiance: ArrayLike = 0.0, two_sided: bool = False) -> Material:
    """A material by its reflectance (C,) and the radiance (C,) it emits, W/(m² sr); its exitance is π times that."""
    emission = np.pi * np.asarray(radiance, dtype=np.float64)
    return Material(np.asarray(reflectance, dtype=np.float64), emission=emission, two_sided=two_sided, name=name)


def panel(low: ArrayLike, high: ArrayLike, facing: int, holes: Iterable[Range] = ()) -> Mesh:
    """An upright rectangle, less rectangular holes: the cells of a grid through the holes' edges.

    Coordinates are taken over unchanged, so that neighbours that name the same numbers share their edges exactly.

    Parameters
    ----------
    low, high : array_like (3,)
        Opposite corners, m; equal in the one coordinate that the rectangle is perpendicular to.
    facing : {+1, -1}
        Sign of the normal along that axis.
    holes : iterable of (low, high)
        In the same plane; their coordinate along the axis is not looked at.

    Returns
    -------
    vertices : ndarray (V, 3)
    faces : ndarray of int64 (M, 4)
    """
    low, high = np.asarray(low, dtype=np.float64), np.asarray(high, dtype=np.float64)
    axis = int(np.flatnonzero(low == high)[0])
    b, c = (axis + 1) % 3, (axis + 2) % 3
    boxes = [(np.asarray(lo, dtype=np.float64), np.asarray(hi, dtype=np.float64)) for lo, hi in holes]
    cuts_b = np.unique([low[b], high[b], *(box[k][b] for box in boxes for k in (0, 1))])
    cuts_c = np.unique([low[c], high[c], *(box[k][c] for box in boxes for k in (0, 1))])
    grid = np.empty((cuts_b.size, cuts_c.size, 3))
    grid[..., axis] = low[axis]
    grid[..., b], grid[..., c] = cuts_b[:, None], cuts_c[None, :]
    keep = np.ones((cuts_b.size - 1, cuts_c.size - 1), dtype=bool)
    for lo, hi in boxes:
        in_b = (cuts_b[:-1] >= lo[b]) & (cuts_b[1:] <= hi[b])
        in_c = (cuts_c[:-1] >= lo[c]) & (cuts_c[1:] <= hi[c])
        keep &= ~(in_b[:, None] & in_c[None, :])
    i, j = np.nonzero(keep)
    corners = np.stack([i * cuts_c.size + j, (i + 1) * cuts_c.size + j, (i + 1) * cuts_c.size + j + 1], axis=1)
    faces = np.column_stack([corners, i * cuts_c.size + j + 1])
    return grid.reshape(-1, 3), faces if facing > 0 else faces[:, ::-1]


def wall(name: str, low: ArrayLike, high: ArrayLike, holes: Iterable[Range] = ()) -> Mesh:
    """One wall of the room between two opposite corners, facing inwards; `name` is a key of `WALLS`."""
    axis, end, facing = WALLS[name]
    low, high = np.array(low, dtype=np.float64), np.array(high, dtype=np.float64)
    level = (low, high)[end][axis]
    low[axis] = high[axis] = level
    return panel(low, high, facing, holes)


def room(
    low: ArrayLike,
    high: ArrayLike,
    materials: Material | Mapping[str, Material],
    holes: Mapping[str, Sequence[Range]] | None = None,
    leave_out: Sequence[str] = (),
) -> list[Surface]:
    """The walls of an upright room as surfaces that face inwards.

    Parameters
    ----------
    low, high : array_like (3,)
        Opposite corners, m.
    materials : Material or mapping
        One for all, or by the name of the wall with ``"walls"`` for those not named.
    holes : mapping, optional
        Holes by the name of the wall, as `panel` takes them.
    leave_out : sequence of str
        Walls not wanted.
    """
    surfaces = []
    for name in WALLS:
        if name not in leave_out:
            material = materials if isinstance(materials, Material) else materials.get(name) or materials["walls"]
            surfaces.append(Surface(name, *wall(name, low, high, (holes or {}).get(name, ())), material))
    return surfaces


def block(footprint: ArrayLike, bottom: float, top: float, closed: bool) -> Mesh:
    """A prism over a convex quadrilateral, facing outwards.

    Parameters
    ----------
    footprint : array_like (4, 2)
        Corners (x, z) of the prism, m, in either sense of rotation.
    bottom, top : float
        Heights, m.
    closed : bool
        Whether it has a bottom; one that stands on a floor needs none.
    """
    corners = np.asarray(footprint, dtype=np.float64)
    edges = np.roll(corners, -1, axis=0) - corners
    if np.sum(corners[:, 0] * edges[:, 1] - corners[:, 1] * edges[:, 0]) < 0:
        corners = corners[::-1]
    x, z = corners.T
    vertices = np.concatenate([np.column_stack([x, np.full(4, h), z]) for h in (bottom, top)])
    faces = [[7, 6, 5, 4]] + [[k, k + 4, (k + 1) % 4 + 4, (k + 1) % 4] for k in range(4)]
    return vertices, np.array(faces + ([[0, 1, 2, 3]] if closed else []), dtype=np.int64)


def floor_around(outline: ArrayLike, footprints: Sequence[ArrayLike], height: float = 0.0) -> Mesh:
    """A floor, facing up, without the parts that stand under something.

    Covered parts of a floor see nothing and darken the patches they belong to, so they are cut away. What is left
    is cut into trapezoids, which divide into even patches.

    Parameters
    ----------
    outline : array_like (n, 2)
        Corners (x, z) of the floor, m.
    footprints : sequence of array_like (m, 2)
        Corners (x, z) of what stands on it.
    height : float
        y of the floor, m.
    """
    pieces = trapezoids(outline, footprints)
    x, z = pieces.reshape(-1, 2).T
    corner = 4 * np.arange(len(pieces))[:, None]
    triangle = (pieces[:, 2] == pieces[:, 3]).all(axis=1)
    faces = corner + np.where(triangle[:, None], [2, 1, 0, 3], [3, 2, 1, 0])
    faces[triangle, 3] = -1
    return np.column_stack([x, np.full(len(x), height), z]), faces


def frame(low: ArrayLike, high: ArrayLike, facing: int, hole: Range) -> Mesh:
    """An upright rectangle around a rectangular hole, as four trapezoids from its corners to the hole's.

    However small the hole, no face becomes a thin strip, as the cells of `panel` would.
    """
    outer, outer_faces = panel(low, high, facing)
    inner, inner_faces = panel(*hole, facing)
    a, b = outer_faces[0], inner_faces[0] + 4
    return np.concatenate([outer, inner]), np.column_stack([a, np.roll(a, -1), np.roll(b, -1), b])


def sphere(centre: ArrayLike, radius: float, subdivisions: int, facing: int) -> Mesh:
    """A sphere of 20 × 4^subdivisions triangles: an icosahedron whose edges are halved again and again.

    Parameters
    ----------
    centre : array_like (3,)
        m.
    radius : float
        m; all corners lie on the sphere, so that the mesh is a little smaller than it.
    subdivisions : int
    facing : {+1, -1}
        +1: fronts outside, -1: fronts inside.

    Returns
    -------
    vertices : ndarray (V, 3)
    faces : ndarray of int64 (M, 3)
    """
    golden = (1 + 5**0.5) / 2
    ring = np.array([[s * 1.0, t * golden] for s in (1, -1) for t in (1, -1)])
    vertices = np.concatenate([np.roll(np.column_stack([np.zeros(4), ring]), k, axis=1) for k in range(3)])
    gaps = np.linalg.norm(vertices[:, None] - vertices, axis=2)
    near = [set(np.flatnonzero((row > 0) & (row < 2.1)).tolist()) for row in gaps]
    faces = np.array([[i, j, k] for i in range(12) for j in near[i] for k in near[i] & near[j] if i < j < k])
    corners = vertices[faces]
    inward = np.einsum("nx,nx->n", np.cross(corners[:, 1], corners[:, 2]), corners[:, 0]) < 0
    faces[inward] = faces[inward][:, ::-1]
    for _ in range(subdivisions):
        vertices, faces = _halved(vertices, faces)
    vertices = np.asarray(centre) + radius * vertices / np.linalg.norm(vertices, axis=1, keepdims=True)
    return vertices, faces if facing > 0 else faces[:, ::-1]


def _halved(vertices: FloatArray, faces: IntArray) -> Mesh:
    """Each triangle as four, with the middles of its edges on the unit sphere."""
    vertices = vertices / np.linalg.norm(vertices, axis=1, keepdims=True)
    edges = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    edges, places = np.unique(edges, axis=0, return_inverse=True)
    ab, bc, ca = (len(vertices) + places.reshape(3, -1)).astype(np.int64)
    a, b, c = faces.T
    quarters = [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)]
    return np.concatenate([vertices, vertices[edges].mean(axis=1)]), np.stack(quarters).transpose(2, 0, 1).reshape(
        -1, 3
    )
