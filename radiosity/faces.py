"""Source faces: the planar triangles and convex quads of a scene, which rays meet and patches divide.

Files cut flat quads into triangles. Putting the pairs together again halves the triangles' number, gives
square patches instead of slanted ones, and lets a hit find its patch by arithmetic.
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .errors import GeometryError, GeometryWarning
from .geometry import (
    longest_edges,
    quad_bends,
    quad_jacobians,
    quad_vector_areas,
    triangle_vector_areas,
    unit,
)
from .scene import Scene, Surface

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

FLAT = np.deg2rad(0.1)  # a quad bent by less counts as planar
SQUARE = 0.2  # least ratio of a quad's area densities: flatter corners make sliver patches
SLIVER = 1e-14  # area over longest edge squared, below which a face has no normal


@dataclass(frozen=True, eq=False)
class Faces:
    """Source faces of a scene, in the order of its surfaces.

    Attributes
    ----------
    corners : ndarray (F, 4, 3)
        Metres, counter-clockwise from the front. A triangle repeats its third corner.
    quad : ndarray of bool (F,)
    surface : ndarray of int32 (F,)
        Index of the scene's surface.
    two_sided : ndarray of bool (F,)
    normal : ndarray (F, 3)
    area : ndarray (F,)
        m².
    """

    corners: FloatArray
    quad: NDArray[np.bool_]
    surface: NDArray[np.int32]
    two_sided: NDArray[np.bool_]
    normal: FloatArray
    area: FloatArray

    def __len__(self) -> int:
        """Number of faces F."""
        return len(self.area)

    @property
    def sides(self) -> NDArray[np.int64]:
        """How many sides of each face have patches: 2 where it is two-sided, else 1, (F,)."""
        return 1 + self.two_sided.astype(np.int64)

    @property
    def bounds(self) -> FloatArray:
        """Lowest and highest corner of the box around the faces, (2, 3)."""
        return np.stack([self.corners.min(axis=(0, 1)), self.corners.max(axis=(0, 1))])


def source_faces(scene: Scene) -> Faces:
    """Planar faces of a scene: flat pairs of triangles become quads, bent or concave quads triangles.

    Parameters
    ----------
    scene : Scene

    Returns
    -------
    Faces

    Raises
    ------
    GeometryError
        A quad that crosses itself; a surface of zero area.

    Warns
    -----
    GeometryWarning
        Faces of zero area, which are left out.
    """
    corners, quad, surface = [], [], []
    for index, part in enumerate(scene.surfaces):
        part_corners, part_quad = _faces_of(part)
        corners.append(part_corners)
        quad.append(part_quad)
        surface.append(np.full(len(part_quad), index, dtype=np.int32))
    all_corners, all_quad = np.concatenate(corners), np.concatenate(quad)
    owner = np.concatenate(surface)
    vector_area = np.where(all_quad[:, None], quad_vector_areas(all_corners), triangle_vector_areas(all_corners[:, :3]))
    two_sided = np.array([s.material.two_sided for s in scene.surfaces])[owner]
    area = np.linalg.norm(vector_area, axis=1)
    return Faces(all_corners, all_quad, owner, two_sided, unit(vector_area), area)


def _faces_of(surface: Surface) -> tuple[FloatArray, NDArray[np.bool_]]:
    """Corners (F, 4, 3) and which are quads (F,) of one surface, in the order of its faces."""
    padded = surface.faces
    if padded.shape[1] == 3:
        padded = np.concatenate([padded, np.full((len(padded), 1), -1)], axis=1)
    given_quads = np.flatnonzero(padded[:, 3] >= 0)
    quads = surface.vertices[padded[given_quads]]
    good = _planar_convex(quads)
    if len(quads) == len(padded) and good.all():
        return quads, good
    halves, halves_face = _split(surface, quads[~good], given_quads[~good])
    given_triangles = np.flatnonzero(padded[:, 3] < 0)
    triangles = surface.vertices[padded[given_triangles, :3]]
    solid = _has_area(triangles)
    lost = np.concatenate([given_triangles[~solid], np.setdiff1d(given_quads[~good], halves_face)])
    if lost.size:
        shown = ", ".join(map(str, lost[:5])) + (" …" if len(lost) > 5 else "")
        warnings.warn(
            f"surface {surface.name!r}: {len(lost)} of {len(padded)} faces have no area and are left out ({shown})",
            GeometryWarning,
            stacklevel=4,
        )
    paired, paired_face, single, single_face = _pair(triangles[solid], given_triangles[solid])
    corners = np.concatenate([quads[good], paired, _as_quads(single), _as_quads(halves)])
    if not len(corners):
        raise GeometryError(f"surface {surface.name!r}: all {len(padded)} faces have no area; leave the surface out")
    is_quad = np.zeros(len(corners), dtype=bool)
    is_quad[: good.sum() + len(paired)] = True
    order = np.argsort(np.concatenate([given_quads[good], paired_face, single_face, halves_face]), kind="stable")
    return corners[order], is_quad[order]


def _as_quads(triangles: FloatArray) -> FloatArray:
    return triangles[:, [0, 1, 2, 2]]


def _has_area(triangles: FloatArray) -> NDArray[np.bool_]:
    area = np.linalg.norm(triangle_vector_areas(triangles), axis=1)
    return area > SLIVER * longest_edges(triangles) ** 2


def _planar_convex(quads: FloatArray) -> NDArray[np.bool_]:
    """Quads that bilinear coordinates divide into sound patches, (n,)."""
    density = quad_jacobians(quads, unit(quad_vector_areas(quads)))
    convex = density.min(axis=1, initial=np.inf) > SQUARE * density.max(axis=1, initial=0.0)
    return convex & (quad_bends(quads) <= FLAT)


def _split(surface: Surface, quads: FloatArray, face: IntArray) -> tuple[FloatArray, IntArray]:
    """Two triangles for each quad, cut along the diagonal that stays inside it."""
    if not len(quads):
        return np.empty((0, 3, 3)), np.empty(0, dtype=np.int64)
    cuts, smallest, crosses = _both_cuts(quads)
    crossed = np.flatnonzero(crosses)
    if crossed.size:
        raise GeometryError(
            f"surface {surface.name!r}: the edges of quad {face[crossed[0]]} cross over "
            f"({crossed.size} such faces); reorder its vertices or cut it into triangles"
        )
    diagonal = np.linalg.norm(quads[:, [0, 1]] - quads[:, [2, 3]], axis=2)
    shorter = diagonal[:, 1] < diagonal[:, 0] * (1 - 1e-9)
    both = (smallest > 0).all(axis=1)
    cut = np.where(both, shorter, smallest[:, 1] > smallest[:, 0]).astype(int)
    triangles = cuts[np.arange(len(quads)), cut].reshape(-1, 3, 3)
    solid = _has_area(triangles)  # a quad with two equal corners is a triangle
    return triangles[solid], np.repeat(face, 2)[solid]


def _both_cuts(quads: FloatArray) -> tuple[FloatArray, FloatArray, NDArray[np.bool_]]:
    """Quads cut either way, and whether their edges cross over.

    Returns triangles (n, cut, half, corner, 3); for each cut the smaller half's area, negative where the diagonal runs
    outside, (n, cut); and which quads cross over (n,).
    """
    normals = unit(quad_vector_areas(quads))
    cuts = quads[:, [[[0, 1, 2], [0, 2, 3]], [[1, 2, 3], [1, 3, 0]]]]
    halves = triangle_vector_areas(cuts.reshape(-1, 3, 3)).reshape(-1, 2, 2, 3)
    facing = np.einsum("nchx,nx->nch", halves, normals)
    smallest = facing.min(axis=2)
    tolerance = SLIVER * longest_edges(quads) ** 2
    areas = np.linalg.norm(halves, axis=3)
    cancelled = (facing.sum(axis=2).max(axis=1) <= tolerance) & (areas.max(axis=(1, 2)) > tolerance)
    return cuts, smallest, (smallest.max(axis=1) < -tolerance) | cancelled


def crossed_quads(quads: FloatArray) -> NDArray[np.bool_]:
    """Which of quads (n, 4, 3) have edges that cross over, so that they enclose no one area, (n,)."""
    return _both_cuts(quads)[2] & ~_planar_convex(quads) if len(quads) else np.zeros(0, dtype=bool)


def _pair(triangles: FloatArray, face: IntArray) -> tuple[FloatArray, IntArray, FloatArray, IntArray]:
    """Pair flat neighbours into quads, the most rectangular ones first.

    Returns quads (Q, 4, 3) and the number of each one's first triangle, then the triangles left over.
    """
    first, second, quads = _candidates(triangles)
    ranked = np.lexsort((first, np.round(_skewness(quads), 6)))
    free = np.ones(len(triangles), dtype=bool)
    chosen = []
    for k, a, b in zip(ranked.tolist(), first[ranked].tolist(), second[ranked].tolist(), strict=True):
        if free[a] and free[b]:
            free[a] = free[b] = False
            chosen.append(k)
    chosen.sort()
    return quads[chosen], face[first[chosen]], triangles[free], face[free]


def _candidates(triangles: FloatArray) -> tuple[IntArray, IntArray, FloatArray]:
    """Pairs of triangles (first < second) that share an edge and make a planar convex quad, and that quad."""
    none = np.empty(0, dtype=np.int64)
    if len(triangles) < 2:
        return none, none, np.empty((0, 4, 3))
    _, vertex = np.unique(triangles.reshape(-1, 3), axis=0, return_inverse=True)
    vertex = vertex.reshape(-1, 3)
    begin, end = vertex.ravel(), np.roll(vertex, -1, axis=1).ravel()  # edge 3 t + k runs from corner k to k + 1
    low, high = np.minimum(begin, end), np.maximum(begin, end)
    order = np.lexsort((high, low))
    same = (low[order][1:] == low[order][:-1]) & (high[order][1:] == high[order][:-1])
    crowded = np.zeros(len(order), dtype=bool)  # edges of three and more triangles are left alone
    crowded[1:-1] = same[1:] & same[:-1]
    near = np.flatnonzero(same & ~crowded[1:] & ~crowded[:-1])
    a, b = np.sort(np.stack([order[near], order[near + 1]]), axis=0)
    opposite = begin[a] == end[b]  # neighbours of one orientation run their edge in opposite directions
    a, b = a[opposite], b[opposite]
    corner_a, corner_b = a % 3, b % 3
    quads = np.stack(
        [
            triangles[a // 3, (corner_a + 2) % 3],
            triangles[a // 3, corner_a],
            triangles[b // 3, (corner_b + 2) % 3],
            triangles[a // 3, (corner_a + 1) % 3],
        ],
        axis=1,
    )
    good = _planar_convex(quads)
    return a[good] // 3, b[good] // 3, quads[good]


def _skewness(quads: FloatArray) -> FloatArray:
    """Sum of |cos| of the corner angles: 0 for a rectangle, (n,)."""
    edges = unit(np.roll(quads, -1, axis=1) - quads)
    return np.abs(np.einsum("nkx,nkx->nk", edges, np.roll(edges, 1, axis=1))).sum(axis=1)


def encloses(faces: Faces) -> bool:
    """Whether no light can escape: inward-facing shells without a hole, and all else inside them.

    A shell is a set of faces joined by shared corners, each edge of which is run once in either direction.
    Meshes with T-junctions are not recognised (False); declare those with ``Scene(closed=True)``.
    """
    points = faces.corners
    shell, watertight = vertex_shells(faces)
    middle = faces.bounds.mean(axis=0)
    volume = faces.area * np.einsum("fx,fx->f", faces.corners[:, 0] - middle, faces.normal)
    outer = int(np.argmax([np.ptp(points[shell == s], axis=(0, 1)).max() for s in range(shell.max() + 1)]))
    inside = points[shell == outer]
    contained = (points >= inside.min(axis=(0, 1))).all() and (points <= inside.max(axis=(0, 1))).all()
    return bool(watertight[outer] and volume[shell == outer].sum() < 0 and contained)


def vertex_shells(faces: Faces) -> tuple[IntArray, NDArray[np.bool_]]:
    """Shell of each face (F,), joined by shared corners, and whether each shell is without a hole (S,)."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    used = np.where(faces.quad[:, None], np.arange(4), [0, 1, 2, 0])
    points = np.take_along_axis(faces.corners, used[:, :, None], axis=1)
    _, vertex = np.unique(points.reshape(-1, 3), axis=0, return_inverse=True)
    vertex = vertex.reshape(-1, 4)
    begin, end = vertex.ravel(), np.roll(vertex, -1, axis=1).ravel()
    count = int(vertex.max()) + 1
    _, group = connected_components(coo_array((np.ones(len(begin)), (begin, end)), shape=(count, count)))
    real = begin != end
    forward = coo_array((np.ones(real.sum()), (begin[real], end[real])), shape=(count, count)).tocsr()
    unmatched = abs(forward - forward.T).tocoo()
    watertight = np.ones(group.max() + 1, dtype=bool)
    watertight[group[unmatched.coords[0][unmatched.data > 0]]] = False
    return group[vertex[:, 0]], watertight
