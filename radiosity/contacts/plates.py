"""Plates: the flat convex faces that take part in contacts, as `radiosity.faces` makes them."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..errors import GeometryWarning
from ..faces import source_faces
from ..geometry import quad_vector_areas, triangle_vector_areas, unit
from ..scene import Scene, Surface
from .shells import weld

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

FLAT = 1e-6  # of the scene's diagonal: quads whose corners leave their plane by more are halved


@dataclass(frozen=True, eq=False)
class Plates:
    """P flat convex faces.

    Attributes
    ----------
    corners : ndarray (P, 4, 3)
        m; a triangle repeats its third corner.
    surface : ndarray of int (P,)
        Index of the scene's surface.
    normal : ndarray (P, 3)
    area : ndarray (P,)
        m².
    missing : ndarray of bool (P,)
        Bottoms that a body lacks: they cover, but are not there to be cut.
    """

    corners: FloatArray
    surface: IntArray
    normal: FloatArray
    area: FloatArray
    missing: NDArray[np.bool_]


def rows_to_cut(surface: Surface, touched: IntArray) -> IntArray:
    """Faces of a surface that are touched, and their neighbours in one plane: halves of one quad stay together.

    Parameters
    ----------
    surface : Surface
    touched : ndarray of int
        Its faces that take part in a contact.
    """
    corners = surface.vertices[np.where(surface.faces < 0, surface.faces[:, :1], surface.faces)]
    vertex = weld(corners)
    marked = np.zeros(vertex.max() + 1, dtype=bool)
    marked[vertex[touched]] = True
    near = np.flatnonzero(marked[vertex].sum(axis=1) >= 2)
    cells = np.rint(unit(triangle_vector_areas(corners[near, :3])) * 100).astype(np.int64) @ [1 << 20, 1 << 10, 1]
    alike = np.isin(cells, cells[np.isin(near, touched)])
    return near[alike]


def plates_of(scene: Scene, rows: dict[int, IntArray], size: float) -> Plates:
    """Plates of some faces of some surfaces.

    Parameters
    ----------
    scene : Scene
    rows : dict
        Surface → its faces.
    size : float
        Diagonal of the scene, m.
    """
    parts = [replace(scene.surfaces[k], faces=scene.surfaces[k].faces[rows[k]]) for k in rows]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", GeometryWarning)  # faces without area: said when the scene is subdivided
        faces = source_faces(Scene(parts, sky=scene.sky))
    corners = faces.corners
    lift = np.abs(np.einsum("fkx,fx->fk", corners - corners.mean(axis=1, keepdims=True), faces.normal)).max(axis=1)
    bent = faces.quad & (lift > FLAT * size)
    halves = corners[bent][:, [[0, 1, 2, 2], [0, 2, 3, 3]]].reshape(-1, 4, 3)
    owner = np.array(list(rows))[faces.surface]
    return make_plates(
        np.concatenate([corners[~bent], halves]), np.concatenate([owner[~bent], np.repeat(owner[bent], 2)])
    )


def make_plates(corners: FloatArray, surface: IntArray, missing: bool = False) -> Plates:
    """Plates of corners (P, 4, 3) that are flat and convex."""
    vector_area = quad_vector_areas(corners)
    area = np.linalg.norm(vector_area, axis=1)
    return Plates(corners, surface, unit(vector_area), area, np.full(len(area), missing))


def joined(parts: Sequence[Plates]) -> Plates:
    """All plates, one part after the other."""
    names = ("corners", "surface", "normal", "area", "missing")
    return Plates(*(np.concatenate([getattr(part, name) for part in parts]) for name in names))
