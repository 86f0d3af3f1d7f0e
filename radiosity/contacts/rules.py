"""What is cut where two faces lie in each other.

A face shows one material on each side, so of two faces in one plane only one stays there, and it is the one with which
what can be seen is right:

- **Touch.** They face each other, as a floor and the bottom of a box. Nothing sees what is between them. If one is the
  skin of a closed body, nothing looks out of the body either: both are cut if both are one-sided, and the body closes
  the hole. If one is two-sided, the other side of the carrier may be seen, say that of a table top from below: the
  body is cut, and the carrier is only divided, so that no patch lies half under. If the body is open, as a crate
  without a lid, its bottom is seen from above: it stays, and the carrier is cut.
- **Footprint.** A body without a bottom stands on a face: as if it had one.
- **Flush.** They face the same way, as a lamp drawn in the plane of a ceiling. Which of them light sees is not said
  anywhere; the smaller surface is taken to lie on top, and the larger is cut. A two-sided sheet on a larger face
  counts as flush whichever way it faces.
- **Double.** Equal faces that face the same way: the first counts. A surface that has each of its faces once a side
  becomes two-sided.
- **Unclear.** One-sided faces back to back, as the walls of two rooms without thickness: each is seen from its side,
  but rays cannot tell them apart. Nothing is cut; only a gap helps.
"""

from __future__ import annotations

from enum import Enum
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..coplanar import DEPTH, CoplanarPairs
from .plates import Plates
from .standing import Standing

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

ALIKE = 1e-6  # relative: areas nearer than this are equal


class Kind(Enum):
    """How two faces lie in each other."""

    NONE, TOUCH, FOOTPRINT, FLUSH, DOUBLE, TURNED, UNCLEAR = range(7)


class Verdicts(NamedTuple):
    """What becomes of P pairs of plates.

    Attributes
    ----------
    kind : ndarray of int (P,)
        Value of the `Kind`.
    cut, divide : ndarray of bool (P, 2)
        Which of both is cut by the other, or divided along its border.
    covering : ndarray of int (P,)
        Place, 0 or 1, of the one that covers, or stands on the other.
    """

    kind: IntArray
    cut: BoolArray
    divide: BoolArray
    covering: IntArray

    def settle(
        self, which: BoolArray, kind: Kind, sure: BoolArray | None = None
    ) -> tuple[IntArray, IntArray, IntArray]:
        """Give a kind to those that have none yet; return their places, and the columns of the carrier and the other.

        Where just one of a pair is `sure` (P, 2) to be the covering one, it is.
        """
        k = np.flatnonzero(which & (self.kind == Kind.UNCLEAR.value))
        self.kind[k] = kind.value
        if sure is not None:
            self.covering[k] = np.where(sure[k].all(axis=1), self.covering[k], np.argmax(sure[k], axis=1))
        return k, 1 - self.covering[k], self.covering[k]


def judge(
    pairs: CoplanarPairs, plates: Plates, belongs: Standing, extent: FloatArray, two_sided: BoolArray, size: float
) -> Verdicts:
    """Apply the rules.

    Parameters
    ----------
    pairs : CoplanarPairs
        Of plates.
    plates : Plates
    belongs : Standing
    extent : ndarray (P,)
        Area of each plate's surface in its plane, m²: which is the smaller.
    two_sided : ndarray of bool (P,)
    size : float
        Diagonal of the scene, m.
    """
    both = np.column_stack([pairs.first, pairs.second])
    missing, sides = plates.missing[both], two_sided[both]
    solid = belongs.solid[both] & ~_holds(both, plates, belongs, size)
    same_size: BoolArray = np.ptp(extent[both], axis=1) <= ALIKE * extent[both].max(axis=1)
    one_surface = plates.surface[pairs.first] == plates.surface[pairs.second]
    equal = pairs.area >= (1.0 - ALIKE) * plates.area[both].max(axis=1)
    found = _undecided(plates.surface[both], extent[both], same_size)

    lacking = missing[:, 0] | missing[:, 1]
    found.settle(missing.all(axis=1) | (lacking & pairs.alike), Kind.NONE)
    k, carrier, _ = found.settle(lacking, Kind.FOOTPRINT, missing)
    _cut_carrier(found, k, carrier, sides)
    k, carrier, body = found.settle(~pairs.alike & solid.any(axis=1), Kind.TOUCH, solid)
    _cut_carrier(found, k, carrier, sides)
    found.cut[k, body] = True
    backed = belongs.backed[both]
    k, carrier, crate = found.settle(~pairs.alike & backed.any(axis=1), Kind.TOUCH, backed)
    found.cut[k, carrier] = found.divide[k, crate] = True
    found.settle(~pairs.alike & one_surface & equal & ~sides[:, 0], Kind.TURNED)
    k, second, _ = found.settle((equal & one_surface) | (pairs.alike & same_size), Kind.DOUBLE)
    found.cut[k, second] = True
    on_top = np.take_along_axis(sides, found.covering[:, None], axis=1)[:, 0]
    k, larger, _ = found.settle(pairs.alike | on_top, Kind.FLUSH)
    found.cut[k, larger] = True
    return found


def _undecided(surface: IntArray, extent: FloatArray, same_size: BoolArray) -> Verdicts:
    """Nothing settled yet; of two surfaces (P, 2) the smaller covers, of equal ones the first."""
    covering = np.where(same_size, surface[:, 1] < surface[:, 0], extent[:, 1] < extent[:, 0]).astype(np.int64)
    cut, divide = np.zeros((2, len(surface), 2), dtype=bool)
    return Verdicts(np.full(len(surface), Kind.UNCLEAR.value), cut, divide, covering)


def _cut_carrier(found: Verdicts, k: IntArray, carrier: IntArray, two_sided: BoolArray) -> None:
    """Cut what carries a closed body; where another side may be seen, only divide it."""
    seen = two_sided[k].any(axis=1)
    found.cut[k, carrier], found.divide[k, carrier] = ~seen, seen


def _holds(both: IntArray, plates: Plates, belongs: Standing, size: float) -> BoolArray:
    """Whether each of a pair (P, 2) is the skin around a room that the other is a wall of, rather than a body in it."""
    result = np.zeros(both.shape, dtype=bool)
    for k in (0, 1):
        skin, wall = both[:, k], both[:, 1 - k]
        near = DEPTH * size
        within = (belongs.low[wall] >= belongs.low[skin] - near) & (belongs.high[wall] <= belongs.high[skin] + near)
        normal = plates.normal[wall]
        start = np.einsum("nx,nx->n", normal, plates.corners[wall, 0])
        reach = np.maximum(normal * belongs.low[wall], normal * belongs.high[wall]).sum(axis=1) - start
        result[:, k] = within.all(axis=1) & (reach > 10 * near)
    return result
