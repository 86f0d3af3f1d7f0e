"""Surfaces that lie in each other: floors under boxes, doubled walls. What is covered so sees nothing and loses light.

`radiosity.contacts` mends most of what is found here.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .coplanar import coplanar_pairs
from .geometry import triangle_vector_areas
from .scene import FloatArray, IntArray, Scene

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

    Nearer than 1e-5 of the scene's diagonal counts as one plane: rays do not tell such faces apart. Within a surface,
    faces of opposite sense are compared, equal ones of one sense, and the largest.

    Parameters
    ----------
    scene : Scene

    Returns
    -------
    list of Overlap
        Largest first, without those that are slight.
    """
    corners, surface, _ = scene_triangles(scene)
    pairs = coplanar_pairs(corners, surface)
    if not len(pairs.area):
        return []
    whole = np.bincount(surface, np.linalg.norm(triangle_vector_areas(corners), axis=1))
    owners = np.sort(surface[np.column_stack([pairs.first, pairs.second])], axis=1)
    kinds, place = np.unique(owners, axis=0, return_inverse=True)
    sums = np.bincount(place.reshape(-1), pairs.area)
    found = [
        Overlap(int(a), int(b), float(area))
        for (a, b), area in zip(kinds, sums, strict=True)
        if area > SLIGHT * min(whole[a], whole[b])
    ]
    return sorted(found, key=lambda overlap: -overlap.area)


def scene_triangles(scene: Scene) -> tuple[FloatArray, IntArray, IntArray]:
    """All faces as triangles (T, 3, 3), with the surface (T,) of each and its face (T,) there."""
    corners, surface, face = [], [], []
    for k, part in enumerate(scene.surfaces):
        rows = np.arange(len(part.faces))
        triangles = part.faces[:, :3]
        if part.faces.shape[1] == 4:
            quads = np.flatnonzero(part.faces[:, 3] >= 0)
            first, second = _halves(part.vertices, part.faces[quads])
            triangles = triangles.copy()
            triangles[quads] = first
            triangles, rows = np.concatenate([triangles, second]), np.concatenate([rows, quads])
        corners.append(part.vertices[triangles])
        surface.append(np.full(len(rows), k))
        face.append(rows)
    return np.concatenate(corners), np.concatenate(surface), np.concatenate(face)


def _halves(vertices: FloatArray, quads: IntArray) -> tuple[IntArray, IntArray]:
    """Quads (n, 4) as two triangles each (n, 3), cut along a diagonal that stays inside."""
    a, b, c, d = (vertices[quads[:, k]] for k in range(4))
    outside = np.einsum("nx,nx->n", np.cross(b - a, c - a), np.cross(c - a, d - a)) < 0
    turned = np.where(outside[:, None], np.roll(quads, -1, axis=1), quads)
    return turned[:, :3], turned[:, [0, 2, 3]]
