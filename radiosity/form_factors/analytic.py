"""Exact form factors of scenes in which nothing hides anything: convex rooms, plates that face each other."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from ..errors import FormFactorError, MemoryLimitError, OccludedSceneError
from ..faces import Faces
from ..parallel import blocks
from ..patches import Patches
from ..progress import Progress, quiet
from ..rays import Tracer
from .assembly import RowBlock, Rows, stack_rows
from .contour import exchange_area_matrix

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]

ON_PLANE = 1e-6  # of the scene's size: what stands out less lies in the plane; float32 coordinates are off by 1e-7
ROW_SUM_TOLERANCE = 1e-6  # rows that pass 1 by more are of surfaces that overlap
BLOCK_ROWS = 256


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
        From `estimate`, naming the two faces.

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

    def estimate(
        self,
        patches: Patches,
        tracer: Tracer | None = None,  # noqa: ARG002  # estimators are called alike; this one sends no rays
        dtype: type[np.float32] | type[np.float64] = np.float64,
        threads: int | None = None,
        progress: Progress = quiet,
    ) -> list[Rows]:
        """One matrix, in a list.

        Raises
        ------
        OccludedSceneError
            Two faces of which one may hide something, or shows the other its back.
        FormFactorError
            Surfaces that overlap: a row adds up to more than 1.
        MemoryLimitError
            More patches than the machine's memory has room for.
        """
        check_unoccluded(patches.grid.faces, patches.surface_names)
        count = len(patches)
        _check_memory(count)
        exchange = exchange_area_matrix(patches.corners, threads=threads)

        def told(done: int) -> None:
            progress("form factors", done, count)

        made = (_row_block(exchange, patches.area, block) for block in blocks(count, BLOCK_ROWS))
        return [stack_rows(made, count, int(np.count_nonzero(exchange)), 1.0, dtype, told)]


def _row_block(exchange: FloatArray, area: FloatArray, block: tuple[int, int]) -> RowBlock:
    begin, end = block
    factors = exchange[begin:end] / area[begin:end, None]
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


def _check_memory(count: int) -> None:
    """Refuse exchange areas, dense and as rows, that would not fit into the machine."""
    needed = 20 * count**2
    if not hasattr(os, "sysconf"):
        return
    available = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    if needed > 0.8 * available:
        raise MemoryLimitError(
            f"exact factors of {count} patches take {needed / 1e9:.1f} GB, and this machine has {available / 1e9:.1f}: "
            "take fewer patches, or MonteCarlo()"
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
