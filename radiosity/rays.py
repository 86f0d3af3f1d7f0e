"""Rays: Embree behind one small class, and what a ray has met told as a patch.

Embree works in float32. Three rules keep its answers right at any scale: the scene is moved to the origin and scaled
to a unit diagonal in float64 before it is rounded; origins stand a hair inside their patch and off its plane
(`radiosity.face_points`); and Embree's robust mode makes neighbouring triangles watertight.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .compiled import kernel
from .face_points import INSET, affine, cell_at, face_table, lifted, to_affine
from .faces import Faces
from .patches import Grid

Float32Array = NDArray[np.float32]
FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int32]

MISS, BACK = -1, -2  # what a ray met when it met no patch: nothing, a black back


class Tracer:
    """First hits of rays among the source faces, as patches.

    Parameters
    ----------
    grid : Grid
        Faces and how they are cut (``patches.grid``).
    shown : ndarray of bool (F,), optional
        Which faces rays meet; they go through the others. By default all.

    Attributes
    ----------
    table : FaceTable
        The faces in unit coordinates, for kernels that make origins with `patch_point`.
    centre : ndarray (3,)
        Middle of the scene, m.
    scale : float
        Unit coordinates per metre: 1 / diagonal.

    Notes
    -----
    Rays meet the source faces, not the patches: fewer triangles, no T-junctions between differently cut
    neighbours, and the patch follows from (face, u, v) by arithmetic.
    """

    def __init__(self, grid: Grid, shown: NDArray[np.bool_] | None = None) -> None:
        bounds = grid.faces.bounds
        diagonal = float(np.linalg.norm(bounds[1] - bounds[0]))
        self.centre: FloatArray = bounds.mean(axis=0)
        self.scale = 1.0 / diagonal
        corners = (grid.faces.corners - self.centre) * self.scale
        self.table = face_table(grid, corners)
        self._scene, self._triangle_face, second = _embree_scene(grid.faces, corners, shown)
        self._to_affine = to_affine(self.table, self._triangle_face, second)
        self._whole = bool((grid.cells == 1).all())

    def run(self, origins: Float32Array, directions: Float32Array) -> IntArray:
        """Trace rays to the first face each meets.

        Parameters
        ----------
        origins, directions : ndarray of float32 (n, 3), contiguous
            In unit coordinates; directions need not have length one.

        Returns
        -------
        ndarray of int32 (n,)
            The patch met, or `MISS`, or `BACK`.
        """
        # Embree reads garbage from arrays of another type or shape, without a word.
        assert origins.dtype == directions.dtype == np.float32 and origins.shape == directions.shape
        out = np.empty(len(origins), dtype=np.int32)
        if self._whole:
            triangle = self._scene.run(origins, directions)
            u = v = np.empty(0, dtype=np.float32)
        else:
            hits = self._scene.run(origins, directions, output=True)
            triangle, u, v = hits["primID"], hits["u"], hits["v"]
        _find_patches(triangle, u, v, directions, self._triangle_face, self._to_affine, self.table, self._whole, out)
        return out

    def hits(self, origins: Float32Array, directions: Float32Array) -> tuple[IntArray, FloatArray]:
        """As `run`, with the points that the rays met.

        Returns
        -------
        patch : ndarray of int32 (n,)
            The patch met, or `MISS`, or `BACK`.
        points : ndarray (n, 3)
            Unit coordinates, pulled inside the face and lifted off to the side that was met: good origins for rays that
            go on from there. Zero where no patch was met.
        """
        assert origins.dtype == directions.dtype == np.float32 and origins.shape == directions.shape
        found = self._scene.run(origins, directions, output=True)
        hit = found["primID"], found["u"], found["v"]
        patch, points = np.empty(len(origins), dtype=np.int32), np.zeros(origins.shape)
        triangles = self._triangle_face, self._to_affine
        _find_patches(*hit, directions, *triangles, self.table, False, patch)
        _find_points(*hit, directions, *triangles, self.table, patch, points)
        return patch, points

    def to_unit(self, points: FloatArray) -> FloatArray:
        """Points in metres to unit coordinates, (…, 3)."""
        return (points - self.centre) * self.scale


def _embree_scene(faces: Faces, corners: FloatArray, shown: NDArray[np.bool_] | None):  # type: ignore[no-untyped-def]
    """Embree's scene, the face of each of its triangles, and which are the second half of a quad."""
    from embreex.mesh_construction import TriangleMesh
    from embreex.rtcore_scene import EmbreeScene

    first = np.where(faces.quad[:, None], [0, 1, 3], [0, 1, 2])
    quads = np.flatnonzero(faces.quad)
    face = np.concatenate([np.arange(len(faces)), quads]).astype(np.int32)
    corner = np.concatenate([first, np.broadcast_to([2, 3, 1], (len(quads), 3))])
    second = np.zeros(len(face), dtype=np.bool_)
    second[len(faces) :] = True
    order = np.argsort(face, kind="stable")  # both halves of a quad side by side
    if shown is not None:
        order = order[shown[face[order]]]
    triangles = (4 * face[order, None] + corner[order]).astype(np.int32)
    scene = EmbreeScene(robust=True)
    TriangleMesh(scene, np.ascontiguousarray(corners.reshape(-1, 3), dtype=np.float32), triangles)
    scene.run(np.zeros((1, 3), np.float32), np.ones((1, 3), np.float32))  # the first ray builds the tree
    return scene, face[order], second[order]


@kernel
def _find_patches(triangle, u, v, directions, triangle_face, to, table, whole, out):  # type: ignore[no-untyped-def]
    """Patches from Embree's triangles; the fast twin of `radiosity.patches.locate`."""
    for r in range(triangle.shape[0]):
        t = triangle[r]
        if t < 0:
            out[r] = MISS
            continue
        f = triangle_face[t]
        n = table.normal[f]
        towards = directions[r, 0] * n[0] + directions[r, 1] * n[1] + directions[r, 2] * n[2]
        first = table.front[f] if towards < 0.0 else table.back[f]
        if first < 0:
            out[r] = BACK
        elif whole:
            out[r] = first
        else:
            a, b = affine(to[t], np.float64(u[r]), np.float64(v[r]))
            out[r] = first + cell_at(table, f, a, b)


@kernel
def _find_points(triangle, u, v, directions, triangle_face, to, table, patch, points):  # type: ignore[no-untyped-def]
    """Points met, pulled inside their faces and lifted off them; rays that met no patch are left alone."""
    for r in range(triangle.shape[0]):
        if patch[r] < 0:
            continue
        t = triangle[r]
        f = triangle_face[t]
        n = table.normal[f]
        towards = directions[r, 0] * n[0] + directions[r, 1] * n[1] + directions[r, 2] * n[2]
        a, b = affine(to[t], np.float64(u[r]), np.float64(v[r]))
        middle_a, middle_b = 1.0 / 3.0, 1.0 / 3.0
        if table.quad[f]:
            middle_a, middle_b = 0.5 + 0.25 * table.skew[f, 0], 0.5 + 0.25 * table.skew[f, 1]
        a, b = a + 2.0 * INSET * (middle_a - a), b + 2.0 * INSET * (middle_b - b)
        lifted(table, f, a, b, 1.0 if towards < 0.0 else -1.0, points[r])
