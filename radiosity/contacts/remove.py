"""`remove_contacts`: a scene in which no patch lies half under something."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ..coplanar import CoplanarPairs, coplanar_pairs
from ..geometry import quad_vector_areas
from ..overlaps import scene_triangles
from ..scene import Scene, Surface
from .cutting import Cutting
from .plates import joined, make_plates, plates_of, rows_to_cut
from .report import ContactReport
from .rims import Bottoms, missing_bottoms
from .shells import open_vertices, weld

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

STANDS = 0.999  # share of a missing bottom that must lie on something


def remove_contacts(scene: Scene) -> tuple[Scene, ContactReport]:
    """Cut away what lies in something else: the floor under a box and the bottom of the box, the ceiling above a lamp.

    What is covered sees nothing and lights nothing. Left in place, it darkens the patches that it is a part of, and
    where rays cannot tell which of two faces is in front, light goes astray. `radiosity.contacts.rules` has the rules.

    Parameters
    ----------
    scene : Scene

    Returns
    -------
    scene : Scene
        The same one if there is nothing to do. Surfaces keep their names and order; those that are covered whole are
        left out. Faces that are cut become trapezoids. A scene found closed is declared closed.
    report : ContactReport

    Notes
    -----
    Faces nearer than 1e-5 of the scene's diagonal lie in each other: rays start that far off their patch. A body
    without a bottom counts as closed where it stands.

    Examples
    --------
    >>> from radiosity.scene import Material
    >>> square = [[0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0]]
    >>> floor = Surface("floor", square, [[0, 1, 2, 3]], Material(0.5))
    >>> rug = Surface("rug", [[0, 0, 0], [1, 0, 0], [1, 2, 0], [0, 2, 0]], [[0, 1, 2, 3]], Material(0.1))
    >>> cut, report = remove_contacts(Scene([floor, rug]))
    >>> print(report)
    'rug' lies in the plane of 'floor' over 2 m² and is taken to lie on top: cut out of 'floor'
    >>> report.removed
    {'floor': 2.0}
    """
    corners, surface, face = scene_triangles(scene)
    low, high = ([end(corners[..., x]) for x in range(3)] for end in (np.min, np.max))
    size = float(np.linalg.norm(np.subtract(high, low)))
    bottoms = _lacking_bottoms(scene, corners, surface, size)
    pairs = _all_pairs(corners, surface, bottoms)
    stands = _standing(bottoms, pairs, len(corners))
    real = np.append(np.ones(len(corners), dtype=bool), stands)[pairs.second]
    touched = np.unique(np.concatenate([pairs.first[real], pairs.second[real]]))
    touched = touched[touched < len(corners)]
    if not len(touched):
        return scene, ContactReport()
    rows = {
        int(k): rows_to_cut(scene.surfaces[k], np.unique(face[touched[surface[touched] == k]]))
        for k in np.unique(surface[touched])
    }
    lacking = make_plates(bottoms.corners[stands], bottoms.surface[stands], missing=True)
    plates = joined([plates_of(scene, rows, size), lacking])
    on_something = np.isin(bottoms.body_of, bottoms.body[stands])
    return _assembled(scene, rows, Cutting(scene, plates, corners, surface, on_something, size))


def _lacking_bottoms(scene: Scene, corners: FloatArray, surface: IntArray, size: float) -> Bottoms:
    """Bottoms that bodies lack. Surfaces without a border take no part, which spares large meshes."""
    torn = np.zeros(len(scene.surfaces), dtype=bool)
    for k, part in enumerate(scene.surfaces):
        halves = part.faces[:, :3]
        if part.faces.shape[1] == 4:
            halves = np.concatenate([halves, part.faces[part.faces[:, 3] >= 0][:, [0, 2, 3]]])
        torn[k] = open_vertices(halves).any()
    if torn.any():  # or so it seems: files have vertices several times, for shading
        members = np.flatnonzero(torn[surface])
        vertex = weld(corners[members], surface[members])
        torn[:] = False
        torn[surface[members[open_vertices(vertex)[vertex].any(axis=1)]]] = True
    keep = torn[surface]
    found = missing_bottoms(corners[keep], surface[keep], size)
    body_of = np.full(len(corners), -1)
    body_of[keep] = found.body_of
    return found._replace(body_of=body_of)


def _all_pairs(corners: FloatArray, surface: IntArray, bottoms: Bottoms) -> CoplanarPairs:
    """Pairs of triangles, missing bottoms counted after the triangles of the scene."""
    if not len(bottoms.body):
        return coplanar_pairs(corners, surface)
    every = np.concatenate([corners[:, [0, 1, 2, 2]], bottoms.corners])
    return coplanar_pairs(every, np.concatenate([surface, surface.max() + 1 + bottoms.body]))


def _standing(bottoms: Bottoms, pairs: CoplanarPairs, count: int) -> BoolArray:
    """Which bottoms are of bodies whose every bottom lies on something else."""
    on = np.flatnonzero((pairs.second >= count) & (pairs.first < count) & ~pairs.alike)
    bottom = pairs.second[on] - count
    other = bottoms.body_of[pairs.first[on]] != bottoms.body[bottom]
    carried = np.bincount(bottom[other], pairs.area[on[other]], minlength=len(bottoms.body))
    loose = carried < STANDS * np.linalg.norm(quad_vector_areas(bottoms.corners), axis=1)
    return ~np.isin(bottoms.body, bottoms.body[loose])


def _assembled(scene: Scene, rows: dict[int, IntArray], work: Cutting) -> tuple[Scene, ContactReport]:
    """The scene with its cut surfaces, and what was done."""
    surfaces: list[Surface] = []
    removed: dict[str, float] = {}
    for k, surface in enumerate(scene.surfaces):
        corners, lost = work.cut(k) if k in rows else (None, 0.0)
        if lost > 0:
            removed[surface.name] = lost
        if corners is not None:
            rest = np.delete(surface.faces, rows[k], axis=0)
            if not len(rest) and not len(corners):
                continue
            material = surface.material.replace(two_sided=True) if k in work.turned else surface.material
            surface = replace(_with_faces(surface, rest, corners), material=material)
        surfaces.append(surface)
    kept = {surface.name for surface in surfaces}
    report = ContactReport(work.contacts(), removed, tuple(n for n in scene.surface_names if n not in kept))
    if not report.mended or not surfaces:
        return scene, report
    closed = True if scene.closed is None and work.closed else scene.closed
    return replace(scene, surfaces=tuple(surfaces), closed=closed), report


def _with_faces(surface: Surface, rest: IntArray, corners: FloatArray) -> Surface:
    """A surface of some of its own faces, and of new ones given by their corners (n, 4, 3)."""
    used, places = np.unique(rest[rest >= 0], return_inverse=True)
    kept = np.full((len(rest), 4), -1)
    kept[:, : rest.shape[1]][rest >= 0] = places
    points, index = np.unique(corners.reshape(-1, 3), axis=0, return_inverse=True)
    new = len(used) + index.reshape(-1, 4)
    new[new[:, 2] == new[:, 3], 3] = -1
    faces = np.concatenate([kept, new])
    vertices = np.concatenate([surface.vertices[used], points])
    return replace(surface, vertices=vertices, faces=faces if (faces[:, 3] >= 0).any() else faces[:, :3])
