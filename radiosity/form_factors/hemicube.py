"""Form factors by hemicubes: the scene as seen from points of a patch, on the five faces of half a cube.

Cohen & Greenberg (1985, doi 10.1145/325334.325171); Cohen & Wallace (1993), §4.3.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from ..compiled import kernel
from ..errors import ParameterError
from ..face_points import patch_point
from ..patches import Patches
from ..rays import MISS, Tracer
from .assembly import RowBlock, RowMaker

FloatArray = NDArray[np.float64]

BATCH = 1 << 16  # pixels at a time


@dataclass(frozen=True)
class Hemicube:
    """Form factors by hemicubes.

    From each sample point of a patch the item buffer says which patch is seen through the middle of each pixel of a
    half cube; the pixel's delta form factor goes to that patch. Delta form factors are exact integrals over the
    pixel, so they add up to 1 and rows close. What is wrong is aliasing (a patch smaller than a
    pixel is seen or missed as a whole) and, with few sample points, that the patch is not seen from all of itself.

    Parameters
    ----------
    resolution : int
        Pixels along an edge of the top face, even; side faces are half as high. 3 × resolution² rays a point.
    samples : int
        Points per patch, the middles of as many cells of equal area; one stands in its middle.
    """

    replicates: ClassVar[int] = 1
    resolution: int = 64
    samples: int = 1

    def __post_init__(self) -> None:
        if self.resolution < 2 or self.resolution % 2:
            raise ParameterError(f"resolution is {self.resolution}; give an even number of pixels, at least 2")
        if self.samples < 1:
            raise ParameterError(f"samples is {self.samples}; give at least 1")

    @property
    def rays(self) -> int:
        """Rays per patch."""
        return 3 * self.resolution**2 * self.samples

    def rows(self, patches: Patches, tracer: Tracer, replicate: int = 0) -> RowMaker:  # noqa: ARG002  there is but one
        """What makes the rows."""
        return _Hemicubes(self, patches, tracer)


class _Hemicubes:
    """Look out of the patches begin … end, and add up the delta form factors of what is seen."""

    divisor = 1.0
    exact_columns: NDArray[np.bool_] | None = None

    def __init__(self, method: Hemicube, patches: Patches, tracer: Tracer) -> None:
        self.patches, self.tracer = patches, tracer
        self.directions, self.weights = pixels(method.resolution)
        self.points = sample_points(method.samples)
        self.rows_at_once = max(1, BATCH // method.rays)
        self.most = method.rays

    def __call__(self, span: tuple[int, int]) -> RowBlock:
        begin, end = span
        patches, grid, table = self.patches, self.patches.grid, self.tracer.table
        rays = (end - begin) * len(self.points) * len(self.weights)
        origins, directions = np.empty((rays, 3), dtype=np.float32), np.empty((rays, 3), dtype=np.float32)
        place = table, patches.face, patches.side, grid.front, grid.back
        hemicube_rays(*place, begin, end, self.points, self.directions, origins, directions)
        item_buffer = self.tracer.run(origins, directions)
        each = self.weights / len(self.points)
        return RowBlock(begin, *sum_weights(item_buffer, each, end - begin, len(patches)))


def _top_integral(x: FloatArray, y: FloatArray) -> FloatArray:
    """∬ dx dy / π (1 + x² + y²)² from 0, Eq. (11): from an element to a parallel rectangle above its corner."""
    p, q = np.sqrt(1.0 + x * x), np.sqrt(1.0 + y * y)
    return (x / p * np.arctan(y / p) + y / q * np.arctan(x / q)) / (2.0 * np.pi)


def _side_integral(x: FloatArray, z: FloatArray) -> FloatArray:
    """∬ z dx dz / π (1 + x² + z²)², an antiderivative, Eq. (12): the element sees the rectangle edge on."""
    q = np.sqrt(1.0 + z * z)
    return -np.arctan(x / q) / (2.0 * np.pi * q)


def delta_form_factors(resolution: int) -> tuple[FloatArray, FloatArray]:
    """Exact delta form factors of the pixels of the top face (R, R) and of one side face (R, R/2).

    Cohen & Wallace (1993), Eq. (4.28) give the integrand times the pixel's area; here it is integrated over
    each pixel in closed form. Top and four sides add up to 1.

    >>> top, side = delta_form_factors(8)
    >>> float(round(top.sum() + 4 * side.sum(), 15))
    1.0
    """
    edge = np.linspace(-1.0, 1.0, resolution + 1)
    height = np.linspace(0.0, 1.0, resolution // 2 + 1)
    top = _top_integral(edge[:, None], edge[None, :])
    side = _side_integral(edge[:, None], height[None, :])
    return tuple(np.diff(np.diff(corner, axis=0), axis=1) for corner in (top, side))  # type: ignore[return-value]


def pixels(resolution: int) -> tuple[FloatArray, FloatArray]:
    """Directions (P, 3) through the middles of all pixels, z along the normal, and their delta form factors (P,).

    Top face first, then the sides at +x, +y, -x, -y; P = 3 × resolution².
    """
    top, side = delta_form_factors(resolution)
    middle = (np.arange(resolution) + 0.5) * 2.0 / resolution - 1.0
    height = middle[resolution // 2 :]
    x, y = (part.ravel() for part in np.meshgrid(middle, middle, indexing="ij"))
    along, up = (part.ravel() for part in np.meshgrid(middle, height, indexing="ij"))
    faces = [np.stack([x, y, np.ones_like(x)], axis=1)]
    one = np.ones_like(along)
    for sign in (1.0, -1.0):
        faces.append(np.stack([sign * one, sign * along, up], axis=1))
        faces.append(np.stack([-sign * along, sign * one, up], axis=1))
    return np.concatenate(faces), np.concatenate([top.ravel(), *[side.ravel()] * 4])


def sample_points(samples: int) -> FloatArray:
    """Middles of `samples` cells of equal area that tile the unit square in nearly equal rows, (samples, 2)."""
    row_count = max(1, round(samples**0.5))
    points = []
    top = 0
    for row in range(row_count):
        here = (samples * (row + 1)) // row_count - top
        height = (top + 0.5 * here) / samples
        points += [((k + 0.5) / here, height) for k in range(here)]
        top += here
    return np.array(points)


@kernel
def hemicube_rays(table, face, side, front, back, begin, end, points, pixel_directions, origins, directions):  # type: ignore[no-untyped-def]
    """Fill origins and directions of the hemicubes of patches begin … end: points × pixels rays each."""
    point = np.empty(3)
    q = 0
    for i in range(begin, end):
        f = face[i]
        up = np.float64(side[i])
        cell = i - (front[f] if up > 0 else back[f])
        n0, n1, n2 = up * table.normal[f, 0], up * table.normal[f, 1], up * table.normal[f, 2]
        t0, t1, t2 = table.tangent[f, 0], table.tangent[f, 1], table.tangent[f, 2]
        b0, b1, b2 = n1 * t2 - n2 * t1, n2 * t0 - n0 * t2, n0 * t1 - n1 * t0
        for k in range(points.shape[0]):
            s, t = points[k, 0], points[k, 1]
            if points.shape[0] == 1 and not table.quad[f]:
                s, t = 4.0 / 9.0, 0.5  # the centroid in the square's coordinates
            patch_point(table, f, cell, up, s, t, point)
            for p in range(pixel_directions.shape[0]):
                x, y, z = pixel_directions[p, 0], pixel_directions[p, 1], pixel_directions[p, 2]
                origins[q, 0], origins[q, 1], origins[q, 2] = point[0], point[1], point[2]
                directions[q, 0] = x * t0 + y * b0 + z * n0
                directions[q, 1] = x * t1 + y * b1 + z * n1
                directions[q, 2] = x * t2 + y * b2 + z * n2
                q += 1


@kernel
def sum_weights(hits, weights, rows, count):  # type: ignore[no-untyped-def]
    """Item buffers to row lengths, sorted columns, summed weights, and the weights to sky and backs."""
    pixels_each = weights.shape[0]
    rays = hits.shape[0] // rows
    lengths = np.empty(rows, dtype=np.int64)
    indices = np.empty(min(hits.shape[0], rows * count), dtype=np.int32)
    sums = np.empty(indices.shape[0])
    to_sky, to_backs = np.zeros(rows), np.zeros(rows)
    total = np.zeros(count)
    seen = np.zeros(count, dtype=np.bool_)
    filled = 0
    for k in range(rows):
        begin = filled
        for r in range(rays):
            j = hits[k * rays + r]
            w = weights[r % pixels_each]
            if j >= 0:
                if not seen[j]:
                    seen[j] = True
                    indices[filled] = j
                    filled += 1
                total[j] += w
            elif j == MISS:
                to_sky[k] += w
            else:
                to_backs[k] += w
        columns = indices[begin:filled]
        columns.sort()
        for p in range(begin, filled):
            j = indices[p]
            sums[p] = total[j]
            total[j] = 0.0
            seen[j] = False
        lengths[k] = filled - begin
    return lengths, indices[:filled].copy(), sums[:filled].copy(), to_sky, to_backs
