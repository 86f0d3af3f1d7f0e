"""Patches: the pieces of constant light that a scene's faces are cut into."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .errors import GeometryWarning, ParameterError
from .faces import Faces, encloses, source_faces
from .geometry import quad_centroids, quad_jacobians
from .parallel import blocks
from .scene import Scene

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

CENTROIDS = 1 << 16  # found at a time: what comes in between takes ten times their memory
COUNT_SEARCH = 64  # sizes tried around the one that bisection finds


@dataclass(frozen=True, eq=False)
class Grid:
    """How each source face is cut, and where its patches stand in the list.

    A quad is cut into `columns` × `rows` cells of equal steps in its bilinear coordinates, numbered row by row; a
    triangle into `columns`² similar triangles. Patches of one side of one face are numbered without a gap.

    Attributes
    ----------
    faces : Faces
        F source faces.
    columns, rows : ndarray of int32 (F,)
        Steps along the first and the last edge. Equal for triangles.
    front, back : ndarray of int32 (F,)
        First patch of each side; `back` is -1 where the back is black.
    """

    faces: Faces
    columns: NDArray[np.int32]
    rows: NDArray[np.int32]
    front: NDArray[np.int32]
    back: NDArray[np.int32]

    @property
    def cells(self) -> IntArray:
        """Number of patches on one side of each face, (F,)."""
        return self.columns.astype(np.int64) * self.rows

    @property
    def patch_count(self) -> int:
        """Number of patches N, on both sides where both are cut."""
        return int(self.cells @ self.faces.sides)


@dataclass(frozen=True, eq=False)
class Patches:
    """N patches with their light and materials.

    Attributes
    ----------
    vertices : ndarray (V, 3)
        Metres; each source face has its own.
    faces : ndarray of int32 (N, 4)
        Corners, counter-clockwise seen from the lit side; -1 in the last column pads a triangle.
    area : ndarray (N,)
        m².
    normal : ndarray (N, 3)
        Unit normal.
    surface : ndarray of int32 (N,)
        Index in `surface_names`.
    reflectance, absorptance : ndarray (N, C)
    emission : ndarray (N, C)
        Exitance, W/m².
    sky : ndarray (C,)
        Radiance of the surroundings, W/(m² sr).
    face : ndarray of int32 (N,)
        Source face of each patch.
    side : ndarray of int8 (N,)
        1 on the front of its face, -1 on the back of a two-sided one.
    grid : Grid
        Which cell of which face each patch is.
    closed : bool
        Whether no light can escape, as declared or found.
    surface_names : tuple of str
    name : str
    """

    vertices: FloatArray
    faces: NDArray[np.int32]
    area: FloatArray
    normal: FloatArray
    surface: NDArray[np.int32]
    reflectance: FloatArray
    absorptance: FloatArray
    emission: FloatArray
    sky: FloatArray
    face: NDArray[np.int32]
    side: NDArray[np.int8]
    grid: Grid
    closed: bool
    surface_names: tuple[str, ...]
    name: str

    def __repr__(self) -> str:
        return f"<Patches of {self.name!r}: {len(self):,} on {len(self.surface_names)} surfaces>"

    def __len__(self) -> int:
        """Number of patches N."""
        return len(self.area)

    @property
    def channels(self) -> int:
        """Number of channels C."""
        return self.emission.shape[1]

    @property
    def corners(self) -> FloatArray:
        """Corner points (N, 4, 3), m; a triangle repeats its third corner."""
        return self.vertices[np.where(self.faces < 0, self.faces[:, [0, 1, 2, 2]], self.faces)]

    @cached_property
    def centroid(self) -> FloatArray:
        """Centres of area (N, 3), m, found when they are first asked for."""
        found = np.empty((len(self), 3))
        for begin, end in blocks(len(self), CENTROIDS):
            faces = self.faces[begin:end]
            quad = faces[:, 3] >= 0
            turned = np.where(quad[:, None], faces[:, [0, 3, 2, 1]], faces[:, [0, 2, 1, 3]])
            faces = np.where(self.side[begin:end, None] < 0, turned, faces)  # both sides of a face have the same bits
            found[begin:end][quad] = quad_centroids(self.vertices[faces[quad]])
            found[begin:end][~quad] = self.vertices[faces[~quad, :3]].mean(axis=1)
        return found


def subdivide(scene: Scene, patch_count: int | None = None, patch_size: float | None = None) -> Patches:
    """Cut the faces of a scene into patches.

    Parameters
    ----------
    scene : Scene
    patch_count : int, optional
        About how many patches in all, as square as the faces allow.
    patch_size : float, optional
        Longest edge that a patch may have, m.

    Returns
    -------
    Patches
        With neither count nor size, one for each side of each source face.

    Raises
    ------
    ParameterError
        If both are given, or one is not positive.

    Warns
    -----
    GeometryWarning
        If the scene has more faces than `patch_count`: they are then kept as they are.

    Examples
    --------
    >>> import radiosity as rad
    >>> len(rad.subdivide(rad.scenes.furnace(), patch_count=600))
    600
    """
    return cut(scene, grid_of(source_faces(scene), patch_count, patch_size))


def grid_of(faces: Faces, patch_count: int | None = None, patch_size: float | None = None) -> Grid:
    """How `subdivide` cuts faces."""
    columns, rows = _steps(faces, patch_count, patch_size)
    return grid_with(faces, columns, rows)


def grid_with(faces: Faces, columns: IntArray, rows: IntArray) -> Grid:
    """The grid of so many columns and rows on each face (F,), sides numbered one after the other."""
    sides = faces.sides
    cells = columns.astype(np.int64) * rows
    front = np.cumsum(cells * sides) - cells * sides
    back = np.where(faces.two_sided, front + cells, -1)
    return Grid(faces, *(array.astype(np.int32) for array in (columns, rows, front, back)))


def _steps(faces: Faces, patch_count: int | None, patch_size: float | None) -> tuple[IntArray, IntArray]:
    """Steps along both edges of each face, (F,) each."""
    if patch_count is not None and patch_size is not None:
        raise ParameterError("give patch_count or patch_size, not both")
    if patch_count is not None:
        if patch_count < 1:
            raise ParameterError(f"patch_count is {patch_count}; give at least 1")
        sides = int(faces.sides.sum())
        if sides > patch_count:
            warnings.warn(
                f"the scene has {sides} faces (two-sided ones count twice), more than patch_count {patch_count}: "
                "they are kept as they are",
                GeometryWarning,
                stacklevel=4,
            )
        if sides >= patch_count:
            return np.ones(len(faces), dtype=np.int64), np.ones(len(faces), dtype=np.int64)
        return _steps_for_count(faces, patch_count)
    if patch_size is not None:
        if not (np.isfinite(patch_size) and patch_size > 0):
            raise ParameterError(f"patch_size is {patch_size} m; give a positive length")
        along, across = _edge_lengths(faces, np.max)
        return _ceil_steps(along, patch_size), _ceil_steps(across, patch_size)
    return np.ones(len(faces), dtype=np.int64), np.ones(len(faces), dtype=np.int64)


def _ceil_steps(lengths: FloatArray, size: float) -> IntArray:
    steps = np.ceil(lengths / size * (1 - 1e-12))  # a face of exactly k sizes is cut into k
    if steps.max() ** 2 >= np.iinfo(np.int32).max:
        raise ParameterError(f"patch_size {size} m would cut an edge of {lengths.max():g} m into {steps.max():g} steps")
    return np.maximum(1, steps).astype(np.int64)


def _edge_lengths(faces: Faces, combine: Callable[..., Any] = np.mean) -> tuple[FloatArray, FloatArray]:
    """Lengths along and across each face, of its two opposite edges combined; triangles: longest edge, twice."""
    edges = np.linalg.norm(np.roll(faces.corners, -1, axis=1) - faces.corners, axis=2)
    along = combine(edges[:, [0, 2]], axis=1)
    across = combine(edges[:, [1, 3]], axis=1)
    longest = edges.max(axis=1)
    return np.where(faces.quad, along, longest), np.where(faces.quad, across, longest)


def edges_to_cut(faces: Faces) -> tuple[FloatArray, FloatArray]:
    """Lengths along and across each face that steps of one size go into, (F,) each, m."""
    along, across = _edge_lengths(faces)
    side = np.sqrt(faces.area)  # a triangle of area A cut into n² has patches of (√A / n)²
    return np.where(faces.quad, along, side), np.where(faces.quad, across, side)


def _steps_for_count(faces: Faces, patch_count: int) -> tuple[IntArray, IntArray]:
    """Steps that give patches of about equal area, as near to the count as whole steps allow."""
    along, across = edges_to_cut(faces)
    sides = faces.sides

    def steps(size: float) -> tuple[IntArray, IntArray]:
        return tuple(np.maximum(1, np.rint(length / size)).astype(np.int64) for length in (along, across))  # type: ignore[return-value]

    def count(size: float) -> int:
        columns, rows = steps(size)
        return int((columns * rows * sides).sum())

    ideal = np.sqrt((faces.area * sides).sum() / patch_count)
    low, high = ideal / 64, ideal * 2
    while high / low > 1.001:
        middle = np.sqrt(low * high)
        low, high = (middle, high) if count(middle) > patch_count else (low, middle)
    tried = high * np.geomspace(0.8, 1.25, COUNT_SEARCH)
    return steps(min(tried, key=lambda size: (abs(count(size) - patch_count), size)))


def cut(scene: Scene, grid: Grid) -> Patches:
    """Make the patches of all faces."""
    faces = grid.faces
    vertices, corner, area, face, side = _shapes(grid)
    surface = faces.surface[face]
    normal = faces.normal[face]
    np.negative(normal, out=normal, where=side[:, None] < 0)
    return Patches(
        vertices=vertices,
        faces=corner,
        area=area,
        normal=normal,
        surface=surface,
        **{name: _by_patch(scene, name, surface) for name in ("reflectance", "absorptance", "emission")},
        sky=scene.sky,
        face=face,
        side=side,
        grid=grid,
        closed=encloses(faces) if scene.closed is None else scene.closed,
        surface_names=scene.surface_names,
        name=scene.name,
    )


def _shapes(
    grid: Grid,
) -> tuple[FloatArray, NDArray[np.int32], FloatArray, NDArray[np.int32], NDArray[np.int8]]:
    """Vertices (V, 3), corners (N, 4), area, face and side (N,) each: faces of equal steps are cut at once."""
    faces, cells = grid.faces, grid.cells
    count = grid.patch_count
    columns, rows = grid.columns.astype(np.int64), grid.rows.astype(np.int64)
    points = np.where(faces.quad, (columns + 1) * (rows + 1), (columns + 1) * (columns + 2) // 2)
    first_point = np.cumsum(points) - points
    vertices, corner, area = np.empty((int(points.sum()), 3)), np.empty((count, 4), dtype=np.int32), np.empty(count)
    face, side = np.empty(count, dtype=np.int32), np.ones(count, dtype=np.int8)
    kinds, kind = np.unique(np.stack([faces.quad, grid.columns, grid.rows]), axis=1, return_inverse=True)
    for k, (quad, *steps) in enumerate(kinds.T.tolist()):
        members = np.flatnonzero(kind.ravel() == k)
        cut_vertices, cut_corner, cut_area = (_cut_quads if quad else _cut_triangles)(faces, members, *steps)
        vertices[first_point[members][:, None] + np.arange(cut_vertices.shape[1])] = cut_vertices
        index = grid.front[members][:, None] + np.arange(cells[members[0]])
        corner[index] = np.where(cut_corner < 0, -1, cut_corner + first_point[members][:, None, None])
        area[index], face[index] = cut_area, members[:, None]
        lit = members[faces.two_sided[members]]
        front, back = (base[lit][:, None] + np.arange(cells[members[0]]) for base in (grid.front, grid.back))
        corner[back] = corner[front][..., [0, 3, 2, 1] if quad else [0, 2, 1, 3]]
        area[back], face[back], side[back] = area[front], lit[:, None], -1
    return vertices, corner, area, face, side


def _by_patch(scene: Scene, what: str, surface: NDArray[np.int32]) -> FloatArray:
    """A property of the materials, (N, C); most patches emit nothing, and zeros that nobody writes take no memory."""
    channels = scene.channels
    of_surface = np.stack([np.broadcast_to(getattr(s.material, what), channels) for s in scene.surfaces])
    some: BoolArray = np.any(of_surface != 0.0, axis=1)
    if some.all():
        return np.asarray(of_surface[surface])
    of_patch = np.zeros((len(surface), channels))
    these = np.flatnonzero(some[surface])
    of_patch[these] = of_surface[surface[these]]
    return of_patch


def _cut_quads(faces: Faces, members: IntArray, columns: int, rows: int) -> tuple[FloatArray, IntArray, FloatArray]:
    """Vertices (m, P, 3), corners (1, cells, 4) counted from each face's first vertex, and areas (m, cells)."""
    quads = faces.corners[members]
    v, u = np.meshgrid(np.linspace(0, 1, rows + 1), np.linspace(0, 1, columns + 1), indexing="ij")
    weights = np.stack([(1 - u) * (1 - v), u * (1 - v), u * v, (1 - u) * v], axis=-1).reshape(-1, 4)
    row, column = np.divmod(np.arange(columns * rows), columns)
    first = row * (columns + 1) + column
    corner = np.stack([first, first + 1, first + columns + 2, first + columns + 1], axis=1)
    density = quad_jacobians(quads, faces.normal[members])
    u_mid, v_mid = (column + 0.5) / columns, (row + 0.5) / rows
    middle = np.stack([1 - u_mid - v_mid, u_mid, v_mid], axis=0)  # the density is linear in (u, v)
    area = density[:, [0, 1, 3]] @ middle / (columns * rows)
    return np.einsum("pk,mkx->mpx", weights, quads), corner[None], area


def _cut_triangles(
    faces: Faces, members: IntArray, columns: int, _rows: int
) -> tuple[FloatArray, IntArray, FloatArray]:
    """As `_cut_quads`, for triangles: row j holds upright and turned triangles in turn."""
    triangles = faces.corners[members, :3]
    j, i = np.nonzero(np.tri(columns + 1, dtype=bool)[::-1])
    b, c = i / columns, j / columns
    weights = np.stack([1 - b - c, b, c], axis=1)
    row, place = np.divmod(np.arange(columns * (2 * columns)), 2 * columns)
    inside = place < 2 * (columns - row) - 1
    row, place = row[inside], place[inside]
    turned = place % 2
    start = row * (columns + 1) - row * (row - 1) // 2  # vertices before this row
    above = start + columns + 1 - row
    step = place // 2
    upright = np.stack([start + step, start + step + 1, above + step], axis=1)
    down = np.stack([start + step + 1, above + step + 1, above + step], axis=1)
    corner = np.where(turned[:, None] == 1, down, upright)
    corner = np.concatenate([corner, np.full((len(corner), 1), -1)], axis=1)
    area = np.repeat(faces.area[members][:, None] / columns**2, columns**2, axis=1)
    return np.einsum("pk,mkx->mpx", weights, triangles), corner[None], area


def locate(grid: Grid, face: NDArray[np.integer], u: FloatArray, v: FloatArray, back: NDArray[np.bool_]) -> IntArray:
    """The patch that holds a point of a face: arithmetic, no search.

    The readable twin of the kernel in `radiosity.face_points`.

    Parameters
    ----------
    grid : Grid
    face : ndarray of int (n,)
    u, v : ndarray (n,)
        Bilinear coordinates on a quad; barycentric ones, of the second and third corner, on a triangle.
    back : ndarray of bool (n,)
        Whether the point is seen from behind.

    Returns
    -------
    ndarray of int (n,)
        -1 on a black back.
    """
    first = np.where(back, grid.back[face], grid.front[face]).astype(np.int64)
    columns, rows = grid.columns[face].astype(np.int64), grid.rows[face].astype(np.int64)
    column = np.clip(np.floor(u * columns).astype(np.int64), 0, columns - 1)
    row = np.clip(np.floor(v * rows).astype(np.int64), 0, rows - 1)
    row_of_triangle = np.minimum(row, columns - 1)
    column_of_triangle = np.minimum(column, columns - 1 - row_of_triangle)
    turned = (u * columns - column_of_triangle) + (v * columns - row_of_triangle) > 1.0
    turned &= column_of_triangle < columns - 1 - row_of_triangle
    in_triangle = row_of_triangle * (2 * columns - row_of_triangle) + 2 * column_of_triangle + turned
    cell = np.where(grid.faces.quad[face], row * columns + column, in_triangle)
    return np.where(first < 0, -1, first + cell)
