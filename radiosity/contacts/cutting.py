"""The work on one scene, once its plates are known: verdicts on their pairs, and the cuts that follow."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..coplanar import DEPTH, coplanar_pairs
from ..geometry import quad_vector_areas, triangle_vector_areas, unit
from ..scene import Scene
from .pieces import pieces_left
from .plates import Plates
from .report import Contact
from .rules import Kind, judge
from .standing import standing

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

MANY_PLANES = 200  # of one surface: then its whole area says how large it is
WHOLE = 1.0 - 1e-9  # of a plate's area: it is covered


class Cutting:
    """Verdicts on all pairs of plates of a scene.

    Parameters
    ----------
    scene : Scene
    plates : Plates
    corners, surface : ndarray (T, 3, 3), (T,)
        All triangles of the scene and their surfaces.
    stands : ndarray of bool (T,)
        Which are of bodies that lack bottoms and stand on something.
    size : float
        Diagonal of the scene, m.

    Attributes
    ----------
    closed : bool
        Whether the scene lets no light escape.
    turned : set of int
        Surfaces that become two-sided.
    """

    def __init__(
        self,
        scene: Scene,
        plates: Plates,
        corners: FloatArray,
        surface: IntArray,
        stands: NDArray[np.bool_],
        size: float,
    ) -> None:
        self.scene, self.plates, self.size = scene, plates, size
        self.pairs = coplanar_pairs(plates.corners, plates.surface + len(scene.surfaces) * plates.missing)
        belongs, self.closed = standing(plates, corners, surface, stands, size)
        two_sided = np.array([s.material.two_sided for s in scene.surfaces])[plates.surface]
        extent = _extents(plates, corners, surface, size)
        self.verdicts = judge(self.pairs, plates, belongs, extent, two_sided, size)
        area = np.linalg.norm(triangle_vector_areas(corners), axis=1)
        whole: FloatArray = np.bincount(surface, area, minlength=len(scene.surfaces))  # type: ignore[assignment]
        self.turned = self._turn(whole)
        sides = np.concatenate([self.pairs.first, self.pairs.second])
        self._order = np.argsort(sides, kind="stable") % max(len(self.pairs.area), 1)
        self._doubled = np.unique(plates.surface[self.pairs.first[self.verdicts.kind == Kind.DOUBLE.value]])
        self._divided = np.zeros(len(plates.area), dtype=bool)
        self._starts = np.concatenate([[0], np.cumsum(np.bincount(sides, minlength=len(plates.area)))])

    def _turn(self, whole: FloatArray) -> set[int]:
        """One-sided surfaces that have every face once a side; where only some faces have, their pairs are unclear."""
        kind, cut = self.verdicts.kind, self.verdicts.cut
        turned = kind == Kind.TURNED.value
        owner = self.plates.surface[self.pairs.first]
        all_of_it = 2 * np.bincount(owner[turned], self.pairs.area[turned], minlength=len(whole)) >= WHOLE * whole
        kind[turned & ~all_of_it[owner]] = Kind.UNCLEAR.value
        chosen = np.flatnonzero(turned & all_of_it[owner])
        cut[chosen, 1] = True
        return set(owner[chosen].tolist())

    def cut(self, k: int) -> tuple[FloatArray | None, float]:
        """Corners (n, 4, 3) of what is left of a surface's plates, None if they stay; and the area lost, m²."""
        members = np.flatnonzero((self.plates.surface == k) & ~self.plates.missing).tolist()
        before = self.plates.corners[members]
        parts = [self._pieces(p) for p in members]
        if all(len(part) == 1 and np.array_equal(part[0], old) for part, old in zip(parts, before, strict=True)):
            return None, 0.0
        corners = np.concatenate(parts)
        area = self.plates.area[members].sum()
        lost = float(area - np.linalg.norm(quad_vector_areas(corners), axis=1).sum())
        return corners, lost if lost > 1e-12 * area else 0.0

    def _pieces(self, p: int) -> FloatArray:
        """What is left of a plate, (n, 4, 3)."""
        plates, pairs = self.plates, self.pairs
        here = self._order[self._starts[p] : self._starts[p + 1]]
        place = (pairs.second[here] == p).astype(np.int64)
        other = np.where(place == 1, pairs.first[here], pairs.second[here])
        cut = self.verdicts.cut[here, place]
        divide = self.verdicts.divide[here, place] & ~cut
        if self._covered(plates.area[p], other[cut], pairs.area[here[cut]]):
            return np.zeros((0, 4, 3))
        if not (cut.any() or divide.any()):
            return plates.corners[p][None]
        shapes = plates.corners
        left = pieces_left(
            shapes[p], plates.normal[p], list(shapes[other[cut]]), list(shapes[other[divide]]), self.size
        )
        self._divided[p] = divide.any() and len(left) > 1
        return left

    def _covered(self, area: float, covers: IntArray, shared: FloatArray) -> bool:
        """Whether a plate is covered whole, by one other or by those of one surface that do not lie in each other."""
        if shared.max(initial=0.0) >= WHOLE * area:
            return True
        owner = self.plates.surface[covers]
        apart = ~self.plates.missing[covers] & ~np.isin(owner, self._doubled)
        return bool(np.bincount(owner[apart], shared[apart]).max(initial=0.0) >= WHOLE * area)

    def contacts(self) -> tuple[Contact, ...]:
        """What was found, by surfaces and rule, largest first; to be asked after the cuts."""
        names = self.scene.surface_names
        both = np.column_stack([self.pairs.first, self.pairs.second])
        columns = np.column_stack([1 - self.verdicts.covering, self.verdicts.covering])
        parts = (self.plates.surface[both], self.verdicts.cut, self.verdicts.divide & self._divided[both])
        keys = np.column_stack([self.verdicts.kind, *(np.take_along_axis(part, columns, axis=1) for part in parts)])
        kinds, place = np.unique(keys, axis=0, return_inverse=True)
        areas = np.bincount(place.reshape(-1), self.pairs.area, minlength=len(kinds)).tolist()
        found = []
        for (kind, a, b, *marks), area in zip(kinds.tolist(), areas, strict=True):
            if kind == Kind.NONE.value or (kind != Kind.UNCLEAR.value and not any(marks)):
                continue
            cut = tuple(names[k] for k, mark in zip((a, b), marks[:2], strict=True) if mark)
            divided = tuple(names[k] for k, mark in zip((a, b), marks[2:], strict=True) if mark)
            found.append(Contact(Kind(kind), names[a], names[b], area, cut, divided))
        return tuple(sorted(found, key=lambda contact: (-contact.area, contact.first, contact.second)))


def _extents(plates: Plates, corners: FloatArray, surface: IntArray, size: float) -> FloatArray:
    """Area of each plate's surface in the plate's plane and facing as it does, m²; all of it if it has many planes."""
    result = np.zeros(len(plates.area))
    for k in np.unique(plates.surface):
        members = np.flatnonzero(plates.surface == k)
        own = corners[surface == k]
        vector_area = triangle_vector_areas(own)
        area, normal = np.linalg.norm(vector_area, axis=1), unit(vector_area)
        middle = own.mean(axis=1)
        offset = np.einsum("px,px->p", plates.normal[members], plates.corners[members, 0])
        key = np.round(np.column_stack([plates.normal[members], offset / size]) * 1e4)
        _, first, plane = np.unique(key, axis=0, return_index=True, return_inverse=True)
        if len(first) > MANY_PLANES:
            result[members] = area.sum()
            continue
        for number, p in enumerate(members[first]):
            near = np.abs((middle - plates.corners[p, 0]) @ plates.normal[p]) < DEPTH * size
            alike = normal @ plates.normal[p] > 1.0 - 1e-6
            result[members[plane.reshape(-1) == number]] = area[near & alike].sum()
    return result
