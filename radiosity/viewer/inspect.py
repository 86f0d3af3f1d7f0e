"""What a picked patch sees: its form factors, its hemicube unfolded, its values; and the operator as a picture."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from .. import display
from ..form_factors.hemicube import hemicube_rays, pixels, sample_points
from ..form_factors.levels import TwoLevelFactors
from ..rays import BACK, Tracer
from .palette import GATHERING, SHOOTING

if TYPE_CHECKING:
    from ..patches import Patches
    from ..solution import Solution
    from ..transport import TransportOperator
    from .state import Series

FloatArray = NDArray[np.float64]
ByteArray = NDArray[np.uint8]

TOP = (0.0, 1.0, -0.1)  # up, and on level faces to the back
MOST_PIXELS = 400  # along the sides of the operator as a picture
DECADES = 3  # of the false-colour scales below the largest number
ON_THE_EDGE = 1e-9  # share of a triangle by which a point may miss it: between two halves there is no gap
NOTHING = (38, 43, 51)  # sky and void
BLACK_BACK = (0, 0, 0)
UNSEEN = (24, 27, 32)  # patches that a row of form factors does not reach


def patch_on_ray(patches: Patches, origin: FloatArray, direction: FloatArray) -> int:
    """First patch that a ray meets from its front; -1 if none.

    Faces seen from behind do not stop the ray, as they are not drawn either.

    Parameters
    ----------
    patches : Patches
    origin, direction : ndarray (3,)
        m.
    """
    corners = patches.corners
    nearest, found = np.inf, -1
    for second, third in ((1, 2), (2, 3)):  # a triangle's second half is flat and is never met
        a, b, c = corners[:, 0], corners[:, second], corners[:, third]
        normal = np.cross(b - a, c - a)
        towards = normal @ direction
        front = towards < 0.0
        with np.errstate(divide="ignore", invalid="ignore"):
            distance = np.einsum("nx,nx->n", normal, a - origin) / towards
            point = origin + distance[:, None] * direction
            inside = front & (distance > 0.0)
            slack = -ON_THE_EDGE * np.einsum("nx,nx->n", normal, normal)
            for p, q in ((a, b), (b, c), (c, a)):
                inside &= np.einsum("nx,nx->n", np.cross(q - p, point - p), normal) >= slack
        if inside.any():
            hit = int(np.argmin(np.where(inside, distance, np.inf)))
            if distance[hit] < nearest:
                nearest, found = float(distance[hit]), hit
    return found


@dataclass(frozen=True, eq=False)
class HemicubeView:
    """What a patch sees from its middle through half a cube.

    Attributes
    ----------
    items : ndarray of int32 (3 resolution²,)
        Patch behind each pixel, or `MISS` or `BACK`; top face first, then the sides at +x, +y, -x, -y.
    resolution : int
    turns : int
        Quarter turns to the left that bring what lies above to the top of the picture.
    """

    items: NDArray[np.int32]
    resolution: int
    turns: int = 0

    @classmethod
    def of(cls, patches: Patches, patch: int, resolution: int = 192, tracer: Tracer | None = None) -> HemicubeView:
        """The item buffer of one patch, as `Hemicube` has it."""
        tracer = tracer or Tracer(patches.grid)
        directions, _ = pixels(resolution)
        rays = len(directions)
        origins, towards = np.zeros((rays, 3), dtype=np.float32), np.zeros((rays, 3), dtype=np.float32)
        place = (patches.face, patches.side, patches.grid.front, patches.grid.back)
        hemicube_rays(tracer.table, *place, patch, patch + 1, sample_points(1), directions, origins, towards)
        return cls(tracer.run(origins, towards), resolution, _turns(tracer, patches, patch))

    def row(self, count: int) -> FloatArray:
        """Form factors from the patch to `count` patches: the delta form factors of the pixels that show each, (N,)."""
        _, weights = pixels(self.resolution)
        seen = self.items >= 0
        return np.bincount(self.items[seen], weights=weights[seen], minlength=count).astype(np.float64)

    def cross(self) -> NDArray[np.int32]:
        """The five faces unfolded, (2 R, 2 R), as seen by somebody who stands on the patch; corners are `OUTSIDE`.

        The top face is in the middle, and what lies above in the room as far as possible at the top.
        """
        R, half = self.resolution, self.resolution // 2
        top = self.items[: R * R].reshape(R, R)
        side = self.items[R * R :].reshape(4, R, half)
        unfolded = np.full((2 * R, 2 * R), OUTSIDE, dtype=np.int32)
        middle = slice(half, half + R)
        unfolded[middle, middle] = top.T[::-1]
        unfolded[middle, half + R :] = side[0][::-1, ::-1]  # +x: y rises with the first index
        unfolded[:half, middle] = side[1].T[:, ::-1]  # +y: x falls
        unfolded[middle, :half] = side[2]  # -x: y falls
        unfolded[half + R :, middle] = side[3].T[::-1]  # -y: x rises
        return np.rot90(unfolded[:, ::-1], self.turns)  # seen along the normal, x points to the left

    def picture(self, colours: ByteArray) -> ByteArray:
        """The cross in the colours (N, 3) of the patches, (2 R, 2 R, 3)."""
        palette = np.concatenate([colours, np.array([UNSEEN, BLACK_BACK, NOTHING], dtype=np.uint8)])
        return palette[self.cross()]  # OUTSIDE, BACK and MISS count from the end


def _turns(tracer: Tracer, patches: Patches, patch: int) -> int:
    """Quarter turns to the left by which the frame of a hemicube stands upright."""
    tangent = tracer.table.tangent[patches.face[patch]]
    across = np.cross(patches.normal[patch], tangent)
    return int(np.argmax([side @ np.array(TOP) for side in (across, -tangent, -across, tangent)]))


OUTSIDE = BACK - 1  # pixels of the unfolded picture that belong to no face


def factor_colours(row: FloatArray) -> tuple[ByteArray, float, float]:
    """Form factors of a row as colours on a logarithmic scale: (N, 3), and the ends of the scale."""
    largest = float(row.max(initial=0.0))
    high = display.round_up(largest) if largest > 0.0 else 1.0
    low = high / 10.0**DECADES
    colours = display.false_colour(row, low, high, logarithmic=True)
    colours[row <= 0.0] = UNSEEN
    return colours, low, high


def factor_sum(solution: Solution, patch: int) -> str:
    """Where everything that leaves a patch goes, by the row that the solver used."""
    factors = solution.factors
    row = factors.row(patch)
    seen = float(row.sum())
    parts = [f"its row of F: {np.count_nonzero(row)} entries, Σ = {seen:.4f}"]
    for name, share in (("sky", factors.to_sky[patch]), ("backs", factors.to_backs[patch])):
        if share > 0.0:
            parts.append(f"{name} {share:.4f}")
    total = seen + float(factors.to_sky[patch] + factors.to_backs[patch])
    return " + ".join(parts) + (f" = {total:.4f}" if len(parts) > 1 else "")


def patch_lines(
    solution: Solution, series: Series, order: int, patch: int, other: int = -1, seen: tuple[float, float] | None = None
) -> list[str]:
    """What there is to read about a patch, and about its exchange with another.

    Parameters
    ----------
    solution : Solution
    series : Series
    order, patch, other : int
        Bounce, picked patch, and a second one or -1.
    seen : (float, float), optional
        Form factors to the other patch and back by hemicubes, which see finer than a solver's sampled rows.
    """
    patches = solution.patches
    name = patches.surface_names[patches.surface[patch]]
    lines = [
        f"patch {patch} of {name}, {1e4 * patches.area[patch]:.3g} cm²",
        f"bounce {order}: B = {numbers(series.orders[order, patch])} W/m²",
        f"up to {order}: B = {numbers(series.sums[order, patch])} W/m²",
    ]
    if other < 0:
        return [*lines, factor_sum(solution, patch)]
    areas = 1e4 * patches.area[[patch, other]]
    solved = float(solution.factors.row(patch)[other]), float(solution.factors.row(other)[patch])
    there, back = seen or solved
    lines += [
        f"to patch {other} of {patches.surface_names[patches.surface[other]]}: F = {there:.3g}, back {back:.3g}",
        f"A F = {areas[0] * there:.3g} and {areas[1] * back:.3g} cm²: equal but for sampling",
    ]
    if seen:
        lines.append(f"(by hemicubes; in the solver's F {solved[0]:.3g} and {solved[1]:.3g})")
    return lines


def numbers(values: NDArray[Any]) -> str:
    """Channels to three digits; grey light once.

    >>> numbers(np.array([1.0, 0.25, 0.1])), numbers(np.array([2.0, 2.0, 2.0]))
    ('1 / 0.25 / 0.1', '2')
    """
    shown = values[:1] if np.all(values == values[0]) else values
    return " / ".join(f"{float(value):.3g}" for value in shown)


def _pixels(surface: NDArray[Any], most: int) -> tuple[NDArray[np.int64], int]:
    """Pixel of each patch in the order of surfaces, and how many there are."""
    count = len(surface)
    side = min(count, most)
    rank = np.zeros(count, dtype=np.int64)
    rank[np.argsort(surface, kind="stable")] = np.arange(count)
    return rank * side // count, side


@dataclass(frozen=True, eq=False)
class MatrixView:
    """The transport operator as a picture, patches in the order of their surfaces.

    Attributes
    ----------
    means : ndarray (M, M)
        Mean of the entries that fall on each pixel: row receives from column.
    place : ndarray of int (N,)
        Pixel of each patch, along either side.
    borders : tuple of (str, float)
        Name of each surface and where it ends, in shares of the side.
    """

    means: FloatArray
    place: NDArray[np.int64]
    borders: tuple[tuple[str, float], ...]

    @classmethod
    def of_operator(
        cls, T: TransportOperator, channel: int, surface: NDArray[Any], names: tuple[str, ...]
    ) -> MatrixView:
        """T of one channel; of factors on two levels, which have no matrix of their own, as well."""
        if not isinstance(T.factors, TwoLevelFactors):
            return cls.of(T.matrix(channel), surface, names)
        place, side = _pixels(surface, MOST_PIXELS)
        ones, reflectance = np.ones(len(place)), T.reflectance[:, channel]
        which, ends = np.argsort(place, kind="stable"), np.append(0, np.cumsum(np.bincount(place, minlength=side)))
        receive = csr_array((reflectance[which], which, ends), shape=(side, len(place)))
        send = csr_array((ones, place, np.arange(len(place) + 1)), shape=(len(place), side))
        return cls._of_sums(T.factors.between(receive, send), place, surface, names)

    @classmethod
    def of(
        cls, matrix: csr_array, surface: NDArray[Any], names: tuple[str, ...], most: int = MOST_PIXELS
    ) -> MatrixView:
        """Gather the entries of an N × N matrix into at most `most` pixels along each side."""
        place, side = _pixels(surface, most)
        rows = np.repeat(place, np.diff(matrix.indptr))
        sums = np.bincount(rows * side + place[matrix.indices], weights=matrix.data, minlength=side * side)
        return cls._of_sums(sums.astype(np.float64, copy=False).reshape(side, side), place, surface, names)

    @classmethod
    def _of_sums(
        cls, sums: FloatArray, place: NDArray[np.int64], surface: NDArray[Any], names: tuple[str, ...]
    ) -> MatrixView:
        share = np.bincount(place, minlength=len(sums)).astype(np.float64)
        means, count = sums / np.outer(share, share), len(place)
        ends = np.cumsum(np.bincount(surface, minlength=len(names))) / count
        return cls(means, place, tuple(zip(names, ends.tolist(), strict=True)))

    def picture(self, patch: int = -1, *, row: int = -1, column: int = -1) -> ByteArray:
        """Logarithmic false colour, (M, M, 3); row and column of a patch lit up, or a row and a column alone."""
        row, column = max(row, patch), max(column, patch)
        colours, _, _ = factor_colours(self.means.ravel())
        image = colours.reshape(*self.means.shape, 3)
        thick = len(image) // 200  # to either side, so that a small picture shows it
        if row >= 0:
            _light_up(image[max(0, self.place[row] - thick) : self.place[row] + thick + 1], GATHERING)
        if column >= 0:
            _light_up(image[:, max(0, self.place[column] - thick) : self.place[column] + thick + 1], SHOOTING)
        return image


def _light_up(line: ByteArray, colour: str) -> None:
    """Lay a colour over pixels, which stay to be told apart."""
    glow = np.array([int(colour[i : i + 2], 16) for i in (1, 3, 5)])
    line[:] = (line.astype(np.int64) + 3 * glow) // 4
