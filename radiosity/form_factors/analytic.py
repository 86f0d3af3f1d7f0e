"""Exact form factors of scenes in which nothing hides anything: convex rooms, plates that face each other."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from ..errors import FormFactorError, OccludedSceneError
from ..faces import Faces
from ..parallel import blocks
from ..patches import Patches
from ..rays import Tracer
from .assembly import RowBlock, RowMaker
from .contour import exchange_area_matrix

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]

ON_PLANE = 1e-6  # of the scene's size: what stands out less lies in the plane; float32 coordinates are off by 1e-7
ROW_SUM_TOLERANCE = 1e-6  # rows that pass 1 by more are of surfaces that overlap
MOST_ROWS = 256  # at once
PAIRS = 1 << 18  # at once: a sixth of a second


@dataclass(frozen=True)
class Analytic:
    """Exact form factors by contour integrals, for scenes in which no surface hides another.

    Every pair of patches is computed, so time and memory grow with the square of their number. Reciprocity holds to
    the last digit of the exchange areas, rows of a closed scene add up to 1 within about 1e-11 (1e-7 as float32).

    A scene is taken if every two of its faces either see each other whole or cannot see each other, not even from
    behind. So a closed convex room is taken, parts of one, and plates that face each other. The test is strict: it also
    refuses the few scenes in which what stands behind a face is hidden from it by others.

    Raises
    ------
    OccludedSceneError
        From `form_factors`, naming the two faces.

    References
    ----------
    E. M. Sparrow, J. Heat Transfer 85 (1963) 81, doi:10.1115/1.3686058.

    Examples
    --------
    >>> import radiosity as rad
    >>> F = rad.form_factors(rad.subdivide(rad.scenes.furnace()), Analytic(), dtype=np.float64)
    >>> F.row(0).round(6)
    array([0.      , 0.199825, 0.200044, 0.200044, 0.200044, 0.200044])
    """

    rays: ClassVar[int] = 0
    replicates: ClassVar[int] = 1
    exact: ClassVar[bool] = True

    def rows(self, patches: Patches, tracer: Tracer | None = None, replicate: int = 0) -> RowMaker:  # noqa: ARG002
        """What makes the rows; it sends no rays, and there is but one estimate.

        Raises
        ------
        OccludedSceneError
            Two faces of which one may hide something, or shows the other its back.
        """
        check_unoccluded(patches.grid.faces, patches.surface_names)
        return ExactRows(patches)


class ExactRows:
    """Exchange areas of the patches begin … end with all others, over their own areas.

    A pair is computed in the same order, the lower number first, from either side: G is symmetric to the last digit.
    Rows by themselves take each pair twice, once from each side; `at_once` computes all pairs, once, and keeps them.
    """

    divisor = 1.0
    exact_columns: BoolArray | None = None

    def __init__(self, patches: Patches) -> None:
        self.area, self.corners = patches.area, patches.corners
        self.most = len(patches)
        self.rows_at_once = max(1, min(MOST_ROWS, PAIRS // len(patches)))
        self.exchange: FloatArray | None = None

    def at_once(self, threads: int | None = None) -> ExactRows:
        """Compute all pairs now, on threads: half the work, for 8 bytes a pair."""
        self.exchange = exchange_area_matrix(self.corners, threads=threads)
        return self

    def __call__(self, span: tuple[int, int]) -> RowBlock:
        """Make rows.

        Raises
        ------
        FormFactorError
            Surfaces that overlap: a row adds up to more than 1.
        """
        begin, end = span
        exchange = self._exchange(begin, end) if self.exchange is None else self.exchange[begin:end]
        factors = exchange / self.area[begin:end, None]
        sums = factors.sum(axis=1)
        worst = int(np.argmax(sums))
        if sums[worst] > 1.0 + ROW_SUM_TOLERANCE:
            raise FormFactorError(
                f"form factors of patch {begin + worst} add up to {sums[worst]:.7g}: it faces surfaces that overlap or "
                "touch it; leave out the doubles"
            )
        row, column = np.nonzero(factors)
        lengths = np.bincount(row, minlength=end - begin)
        to_sky = np.maximum(0.0, 1.0 - sums)  # below zero by rounding only
        return RowBlock(begin, lengths, column.astype(np.int32), factors[row, column], to_sky, np.zeros(end - begin))

    def _exchange(self, begin: int, end: int) -> FloatArray:
        """Rows begin … end of the exchange areas."""
        before, here, after = self.corners[:begin], self.corners[begin:end], self.corners[end:]
        return np.hstack(
            [
                exchange_area_matrix(before, here, threads=1).T,
                exchange_area_matrix(here, threads=1),
                exchange_area_matrix(here, after, threads=1),
            ]
        )


def check_unoccluded(faces: Faces, surface_names: tuple[str, ...]) -> None:
    """Refuse faces among which one may hide something from another, or show it a black back.

    Every face must lie on one side of every other's plane. Two one-sided faces must both be in front of each other, or
    both behind; a two-sided face must be in front of the one-sided ones, and have faces on one of its sides only. Then
    no straight line between two faces that see each other crosses a third.

    Raises
    ------
    OccludedSceneError
        The first two faces that break this, by number and surface.
    """
    front, behind = _sides(faces)

    def refuse(bad: BoolArray, what: str) -> None:
        if bad.any():
            i, j = (_named(faces, surface_names, int(k)) for k in np.argwhere(bad)[0])
            raise OccludedSceneError(
                f"{j} {what} {i}, so that something may be hidden. Analytic() is for convex rooms and plates that face "
                f"each other ({int(bad.sum())} pairs of faces here are not): take MonteCarlo() or Hemicube()"
            )

    refuse(~front & ~behind, "reaches through the plane of")
    one_sided = ~faces.two_sided
    both = one_sided[:, None] & one_sided
    agree = (front & front.T) | (behind & behind.T)
    refuse(both & front & behind.T & ~agree, "shows its back to")
    refuse((one_sided[:, None] & ~one_sided) & ~front, "is two-sided and behind")
    divides = faces.two_sided & (~behind).any(axis=1) & (~front).any(axis=1)
    refuse(divides[:, None] & ~front, "is on one side, and others on the other side, of")


def _sides(faces: Faces) -> tuple[BoolArray, BoolArray]:
    """Whether all of face j is in front of face i's plane or in it, and whether behind or in it, (F, F) each."""
    size = float(np.ptp(faces.bounds, axis=0).max())
    corners = faces.corners.reshape(-1, 3)
    front, behind = (np.zeros((len(faces), len(faces)), dtype=bool) for _ in range(2))
    for begin, end in blocks(len(faces), max(1, (1 << 21) // len(corners))):
        normal = faces.normal[begin:end]
        offset = np.einsum("fx,fx->f", faces.corners[begin:end, 0], normal)
        heights = (normal @ corners.T - offset[:, None]).reshape(end - begin, len(faces), 4)
        front[begin:end] = heights.min(axis=2) >= -ON_PLANE * size
        behind[begin:end] = heights.max(axis=2) <= ON_PLANE * size
    return front, behind


def _named(faces: Faces, surface_names: tuple[str, ...], face: int) -> str:
    return f"face {face} of surface {surface_names[faces.surface[face]]!r}"
