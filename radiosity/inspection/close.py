"""Faces in one place, and faces so near to each other that rays cannot tell them apart."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from ..coplanar import DEPTH, CoplanarPairs, coplanar_pairs
from ..finding import MOST_PLACES, Finding, Severity
from ..geometry import longest_edges, triangle_vector_areas, unit
from ..overlaps import SLIGHT, scene_triangles
from .mesh import Mesh

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

TOUCH = 2e-7  # of the diagonal: nearer faces touch, as far as the float32 of mesh files can say
TOUCH_LAMP = 1e-9  # the same where one of them is a lamp, which would lose its light: as `form_factors.gaps` has it
CUT = "cut what is covered away (rad.remove_contacts, rad.read_scene(…, contacts='cut')), or leave a gap"

# Kind, severity, what two surfaces do, and what to do about it.
SAME, TOUCHING, GAP, LAMP_GAP, BACKS = range(5)
WORDS = {
    SAME: ("coincident surfaces", Severity.WARNING, "lie in one place and face the same way", CUT),
    TOUCHING: ("touching surfaces", Severity.WARNING, "lie in one place and face opposite ways", CUT),
    GAP: (
        "narrow gap",
        Severity.WARNING,
        "face each other across a gap that rays cannot resolve",
        "widen it or close it; where nothing else stands in the way, rad.Analytic() is exact",
    ),
    LAMP_GAP: (
        "narrow gap",
        Severity.ERROR,
        "face each other, one of them a lamp, across a gap that rays cannot resolve",
        "widen it or close it; where nothing else stands in the way, rad.Analytic() is exact",
    ),
    BACKS: (
        "thin wall",
        Severity.WARNING,
        "lie back to back, nearer than rays can tell apart",
        "leave a gap of more than 1e-5 of the scene's diagonal, or make one two-sided face of them",
    ),
}


def coincident(mesh: Mesh) -> Iterator[Finding]:
    """Pairs of surfaces that lie in one plane and cover each other, largest area first."""
    corners, surface, face = scene_triangles(mesh.scene)
    pairs = coplanar_pairs(corners, surface)
    one_quad = (surface[pairs.first] == surface[pairs.second]) & (face[pairs.first] == face[pairs.second])
    pairs = CoplanarPairs(*(part[~one_quad] for part in pairs))
    if not len(pairs.area):
        return
    gap = gaps(corners, pairs)
    materials = [part.material for part in mesh.scene.surfaces]
    two_sided = np.array([material.two_sided for material in materials])[surface]
    lamp = np.array([bool(material.emission.any()) for material in materials])[surface]
    kind = _kinds(pairs, gap / mesh.size, two_sided, lamp)
    whole = np.bincount(surface, np.linalg.norm(triangle_vector_areas(corners), axis=1))
    owners = np.sort(surface[np.column_stack([pairs.first, pairs.second])], axis=1)
    groups, place = np.unique(np.column_stack([owners, kind]), axis=0, return_inverse=True)
    place = place.reshape(-1)
    area = np.bincount(place, pairs.area)
    for g in np.argsort(-area, kind="stable").tolist():
        a, b, k = groups[g].tolist()
        if area[g] > SLIGHT * min(whole[a], whole[b]):
            members = np.flatnonzero(place == g)
            both = np.concatenate([pairs.first[members], pairs.second[members]])
            count = len(np.unique(np.column_stack([surface[both], face[both]]), axis=0))
            order = members[np.argsort(-pairs.area[members], kind="stable")][:MOST_PLACES]
            places = _middles(corners, pairs, order)
            width = float(np.abs(gap[members]).max())
            yield _found(mesh, (a, b, k), count, float(area[g]), width, places)


def _kinds(pairs: CoplanarPairs, gap: FloatArray, two_sided: BoolArray, lamp: BoolArray) -> IntArray:
    """How the faces of each pair lie to each other (P,), from the gaps between them in diagonals."""
    first_sees = (gap > 0) | two_sided[pairs.first]
    second_sees = ((gap > 0) ^ pairs.alike) | two_sided[pairs.second]
    lit = lamp[pairs.first] | lamp[pairs.second]
    apart = np.abs(gap) > np.where(lit, TOUCH_LAMP, TOUCH)
    kind = np.where(pairs.alike, SAME, np.where(apart, BACKS, TOUCHING))
    return np.where(apart & first_sees & second_sees, np.where(lit, LAMP_GAP, GAP), kind)


def gaps(corners: FloatArray, pairs: CoplanarPairs) -> FloatArray:
    """How far the second triangle of each pair stands before the first, m (P,)."""
    normal = unit(triangle_vector_areas(corners[pairs.first]))
    away = corners[pairs.second].mean(axis=1) - corners[pairs.first, 0]
    return np.asarray((away * normal).sum(axis=1))


def _middles(corners: FloatArray, pairs: CoplanarPairs, members: IntArray) -> FloatArray:
    """Middle of the smaller triangle of some pairs, m."""
    one, other = corners[pairs.first[members]], corners[pairs.second[members]]
    smaller = np.asarray(longest_edges(one) < longest_edges(other))
    return np.where(smaller.reshape(-1, 1), one.mean(axis=1), other.mean(axis=1))


def _found(
    mesh: Mesh, group: tuple[int, int, int], count: int, area: float, width: float, places: FloatArray
) -> Finding:
    a, b, k = group
    kind, severity, what, remedy = WORDS[k]
    surfaces = mesh.scene.surfaces
    owners: tuple[str, ...] = (surfaces[a].name,) if a == b else (surfaces[a].name, surfaces[b].name)
    who = f"faces of {owners[0]!r}" if a == b else f"{owners[0]!r} and {owners[1]!r}"
    size = (
        f", {width:.2g} m wide, {width / mesh.size:.1g} of the scene (rays resolve {DEPTH:g})"
        if k in (GAP, LAMP_GAP)
        else ""
    )
    return Finding(kind, severity, owners, count, f"{who} {what}{size}, over {area:.3g} m²", remedy, places)
