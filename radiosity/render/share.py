"""Pixels share what they gather with neighbours that see the same surface.

Each pixel sends few rays. Sixteen neighbours send sixteen different parts of one low-discrepancy set, so that the mean
over any square of 4 × 4 pixels is that over the whole set (interleaved sampling: Keller & Heidrich 2001,
doi:10.1007/978-3-7091-6242-2_25). Means over 16 × 16 and 64 × 64 pixels are taken of those, one after the other, as in
the à-trous wavelet filter (Dammertz et al. 2010, doi:10.2312/EGGH/HPG10/067-075), as far as there is more noise to
lose by them than detail: light changes over the distance to what is seen, of which the harmonic mean counts (Ward,
Rubinstein & Clear 1988, doi:10.1145/54852.378490). Direct light is not shared, so that shadows stay sharp.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from ..compiled import kernel
from ..parallel import blocks, ordered_map
from .kernels import FloatArray, Pieces, alike

TILE = 4  # pixels along a side that share one set of directions
LEVELS = 3  # scales: 4, 16 and 64 pixels
REACH = TILE // 2  # strides that a pixel looks for neighbours; those at the end count half
MOMENTS = 3  # beside irradiance, means over the rays of 1 / distance, light / distance, light²
GAIN = 0.25  # how far wider means reach; see `_reach2`
DARK = 0.4  # what the distance to dark things counts, beside that to bright ones
STIFF = 0.1  # strides²: how unwilling the fitted line is to lean where neighbours are few
LEAN = 0.5  # most that it may lean from the mean of the neighbours to the pixel
TINY = 1e-30
ROWS = 8  # of the picture at a time


@kernel
def part_of(pixel, width):  # type: ignore[no-untyped-def]
    """Which of TILE² parts of a set of directions a pixel uses."""
    return (pixel // width % TILE) * TILE + pixel % width % TILE


def share(
    pieces: Pieces,
    gathered: FloatArray,
    rays: FloatArray,
    width: int,
    threads: int | None = None,
    tell: Callable[[int, int], None] | None = None,
) -> FloatArray:
    """Irradiance (P, C) of the pieces of a picture, of all scales.

    Parameters
    ----------
    pieces : Pieces
        Of all pixels of the picture.
    gathered : ndarray (P, C + MOMENTS)
        Means over the rays of each piece.
    rays : ndarray (P,)
        How many they are.
    width : int
        Pixels a row.
    threads : int, optional
    tell : callable, optional
        Told how many rows are done of how many, counting all scales.
    """
    spans = blocks((len(pieces.begin) - 1) // width, ROWS)
    value, weight = gathered, rays
    for level in range(LEVELS):
        out = np.empty_like(value), np.empty_like(weight)
        rows = partial(_share_rows, pieces, value, weight, TILE**level, width, *out)
        for span, _ in zip(spans, ordered_map(rows, spans, threads), strict=True):
            if tell is not None:
                tell(level * spans[-1][1] + span[1], LEVELS * spans[-1][1])
        value, weight = out
    return value[:, :-MOMENTS]


@kernel
def _share_rows(pieces, value, weight, stride, width, out_value, out_weight, rows):  # type: ignore[no-untyped-def]
    """Values (P, C + MOMENTS) and weights (P,) of the rows begin … end, each from its neighbours `stride` pixels apart.

    The new value is that at the pixel of a straight line fitted through the neighbours: where they lie all around, it
    is their mean; at the edge of a surface, where they lie to one side, it follows the light into the corner.
    Neighbours at the end of the reach count half in either direction, so that in the open all parts of a tile count
    the same.
    """
    begin, point, normal = pieces.begin, pieces.point, pieces.normal
    height = (begin.shape[0] - 1) // width
    columns = value.shape[1]
    channels = columns - MOMENTS
    fit = np.empty((3, columns))
    for pixel in range(rows[0] * width, rows[1] * width):
        for p in range(begin[pixel], begin[pixel + 1]):
            fit[:] = 0.0
            reach2 = _reach2(value[p], weight[p], channels)
            w = wx = wy = wxx = wxy = wyy = 0.0
            for dy in range(-REACH, REACH + 1):
                v = pixel // width + dy * stride
                if v < 0 or v >= height:
                    continue
                for dx in range(-REACH, REACH + 1):
                    u = pixel % width + dx * stride
                    if u < 0 or u >= width:
                        continue
                    edge = (0.5 if abs(dx) == REACH else 1.0) * (0.5 if abs(dy) == REACH else 1.0)
                    for q in range(begin[v * width + u], begin[v * width + u + 1]):
                        k = edge * weight[q] * alike(normal[p], point[p], normal[q], point[q])
                        if stride > 1 and k > 0.0:
                            limit = min(reach2, _reach2(value[q], weight[q], channels))
                            k *= max(0.0, 1.0 - _distance2(point[p], point[q]) / limit) ** 2
                        if k > 0.0:
                            w, wx, wy = w + k, wx + k * dx, wy + k * dy
                            wxx, wxy, wyy = wxx + k * dx * dx, wxy + k * dx * dy, wyy + k * dy * dy
                            for c in range(columns):
                                fit[0, c] += k * value[q, c]
                                fit[1, c] += k * value[q, c] * dx
                                fit[2, c] += k * value[q, c] * dy
            out_weight[p] = w
            _line_at_centre(fit, w, wx / w, wy / w, wxx / w, wxy / w, wyy / w, out_value[p])


@kernel
def _line_at_centre(fit, w, mx, my, mxx, mxy, myy, out):  # type: ignore[no-untyped-def]
    """Write to out (columns,) the value at (0, 0) of the lines that fit best.

    fit (3, columns): sums Σ k v, Σ k v x and Σ k v y of the values v at (x, y), of weights k; w their sum, and the rest
    the means of x, y, x², xy, y².
    """
    cxx, cxy, cyy = mxx - mx * mx + STIFF, mxy - mx * my, myy - my * my + STIFF
    determinant = cxx * cyy - cxy * cxy
    along_x, along_y = (cyy * mx - cxy * my) / determinant, (cxx * my - cxy * mx) / determinant
    for c in range(fit.shape[1]):
        mean = fit[0, c] / w
        lean = along_x * (fit[1, c] / w - mx * mean) + along_y * (fit[2, c] / w - my * mean)
        out[c] = mean - min(max(lean, -LEAN * mean), LEAN * mean)


@kernel
def _distance2(p, q):  # type: ignore[no-untyped-def]
    return (p[0] - q[0]) ** 2 + (p[1] - q[1]) ** 2 + (p[2] - q[2]) ** 2


@kernel
def _reach2(value, weight, channels):  # type: ignore[no-untyped-def]
    """Square of the distance up to which a mean over neighbours loses more noise than detail.

    Detail: over a distance r irradiance changes by about r / R of itself, R being the harmonic mean distance of the
    light that is seen, or a multiple of that of all that is seen, if that is less. A straight line through it is off
    by the square of that. Noise: from the spread of the radiosity that rays met. They break even where r² = R² ×
    noise.
    """
    light = 0.0
    for c in range(channels):
        light += value[c]
    if light <= 0.0:
        return np.inf
    closeness = max(DARK * value[channels], value[channels + 1] / light)
    noise = np.sqrt(max(0.0, value[channels + 2] / (light * light) - 1.0) / weight)
    return TINY + GAIN * noise / (TINY + closeness * closeness)
