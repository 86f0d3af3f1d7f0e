"""All faces of a scene as one mesh, joined where corners are equal bit by bit."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ..contacts.shells import weld
from ..faces import SLIVER, crossed_quads
from ..geometry import longest_edges, quad_vector_areas, triangle_vector_areas, unit
from ..scene import Scene

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Mesh:
    """The F faces of a scene, as they are given.

    Attributes
    ----------
    scene : Scene
    corners : ndarray (F, 4, 3)
        m; a triangle repeats its first corner.
    quad : ndarray of bool (F,)
    surface, face : ndarray of int (F,)
        Index of the surface, and of the face in it.
    two_sided : ndarray of bool (F,)
    """

    scene: Scene
    corners: FloatArray
    quad: BoolArray
    surface: IntArray
    face: IntArray
    two_sided: BoolArray

    @classmethod
    def of(cls, scene: Scene) -> Mesh:
        """All faces of a scene."""
        corners, quad, surface, face = [], [], [], []
        for k, part in enumerate(scene.surfaces):
            padded = (
                part.faces
                if part.faces.shape[1] == 4
                else np.column_stack([part.faces, -np.ones_like(part.faces[:, 0])])
            )
            is_quad = padded[:, 3] >= 0
            corners.append(part.vertices[np.where(padded < 0, padded[:, :1], padded)])
            quad.append(is_quad)
            surface.append(np.full(len(padded), k))
            face.append(np.arange(len(padded)))
        owner = np.concatenate(surface)
        two_sided = np.array([part.material.two_sided for part in scene.surfaces])[owner]
        return cls(scene, np.concatenate(corners), np.concatenate(quad), owner, np.concatenate(face), two_sided)

    def __len__(self) -> int:
        """Number of faces F."""
        return len(self.quad)

    @cached_property
    def size(self) -> float:
        """Diagonal of the box around everything, m."""
        return float(np.linalg.norm(np.ptp(self.corners.reshape(-1, 3), axis=0)))

    @cached_property
    def vector_area(self) -> FloatArray:
        """Area times normal (F, 3), m²."""
        quads = quad_vector_areas(self.corners)
        return np.where(self.quad[:, None], quads, triangle_vector_areas(self.corners[:, :3]))

    @cached_property
    def area(self) -> FloatArray:
        """m² (F,)."""
        return np.asarray(np.linalg.norm(self.vector_area, axis=1))

    @cached_property
    def normal(self) -> FloatArray:
        """Unit normals (F, 3)."""
        return unit(self.vector_area)

    @cached_property
    def longest(self) -> FloatArray:
        """Longest edge of each face, m (F,)."""
        return longest_edges(self.corners)

    @cached_property
    def flat(self) -> BoolArray:
        """Faces without area, which a solve leaves out (F,)."""
        halves = self.corners[:, [[0, 1, 2], [0, 2, 3]]].reshape(-1, 3, 3)
        solid = np.linalg.norm(triangle_vector_areas(halves), axis=1).reshape(-1, 2).max(axis=1)
        return np.asarray(solid <= SLIVER * self.longest**2)

    @cached_property
    def crossed(self) -> BoolArray:
        """Quads whose edges cross over (F,)."""
        result = np.zeros(len(self), dtype=bool)
        quads = np.flatnonzero(self.quad & ~self.flat)
        result[quads] = crossed_quads(self.corners[quads])
        return result

    @cached_property
    def centroid(self) -> FloatArray:
        """Mean of the corners of each face (F, 3), m."""
        weight = np.where(self.quad[:, None], 0.25, [1 / 3, 1 / 3, 1 / 3, 0.0])
        return np.einsum("fk,fkx->fx", weight, self.corners)

    @cached_property
    def vertex(self) -> IntArray:
        """Number of the vertex at each corner (F, 4), the same for corners that are equal bit by bit."""
        return weld(self.corners)

    @cached_property
    def edges(self) -> Edges:
        """Edges of the faces that have area."""
        return Edges.of(self)

    def names(self, faces: IntArray) -> tuple[str, ...]:
        """Surfaces of faces, those with the most of them first."""
        count = np.bincount(self.surface[faces], minlength=len(self.scene.surfaces))
        order = np.argsort(-count, kind="stable")
        return tuple(self.scene.surfaces[k].name for k in order[: np.count_nonzero(count)])


@dataclass(frozen=True, eq=False)
class Edges:
    """The edges of a mesh: K directed ones, in groups that share both ends.

    Attributes
    ----------
    face : ndarray of int (K,)
        Face of each.
    begin, end : ndarray (K, 3)
        m.
    start, stop : ndarray of int (K,)
        Numbers of the two vertices.
    first, count : ndarray of int (G,)
        Where each group starts, and how many are in it.
    corners : ndarray of int (F, 4)
        Vertices of each face, sorted.
    """

    face: IntArray
    begin: FloatArray
    end: FloatArray
    start: IntArray
    stop: IntArray
    first: IntArray
    count: IntArray
    corners: IntArray

    @classmethod
    def of(cls, mesh: Mesh) -> Edges:
        """Edges of a mesh, without those of faces that have no area."""
        start, stop = mesh.vertex.ravel(), np.roll(mesh.vertex, -1, axis=1).ravel()
        real = np.flatnonzero((start != stop) & np.repeat(~mesh.flat, 4))
        key = np.minimum(start, stop)[real] * (int(mesh.vertex.max()) + 1) + np.maximum(start, stop)[real]
        order = np.argsort(key, kind="stable")
        edge, key = real[order], key[order]
        first = np.flatnonzero(np.diff(key, prepend=-1) != 0)
        corners = mesh.corners.reshape(-1, 3)
        following = np.where(edge % 4 == 3, edge - 3, edge + 1)
        return cls(
            edge // 4, corners[edge], corners[following], start[edge], stop[edge], first,
            np.diff(first, append=len(edge)), np.sort(mesh.vertex, axis=1),
        )  # fmt: skip

    @property
    def middle(self) -> FloatArray:
        """(K, 3), m."""
        return 0.5 * (self.begin + self.end)

    @cached_property
    def pairs(self) -> IntArray:
        """First edge of each group of exactly two (P,); the other follows it. Not those of doubled faces."""
        pairs = self.first[self.count == 2]
        same = (self.start[pairs] == self.start[pairs + 1]) & self.equal(self.face[pairs], self.face[pairs + 1])
        return pairs[~same]

    def equal(self, one: IntArray, other: IntArray) -> BoolArray:
        """Which faces have the same corners."""
        return np.asarray((self.corners[one] == self.corners[other]).all(axis=1))

    @cached_property
    def alike(self) -> BoolArray:
        """Which of the pairs run in the same direction, so that their faces look to different sides (P,)."""
        return np.asarray(self.start[self.pairs] == self.start[self.pairs + 1])

    @cached_property
    def free(self) -> IntArray:
        """Edges that no other face has."""
        return self.first[self.count == 1]

    @cached_property
    def crowded(self) -> IntArray:
        """First edges of groups of three and more."""
        return self.first[self.count >= 3]
