"""Exact exchange areas of convex polygons with nothing in between, by contour integrals.

Stokes' theorem, applied to both areas of G = A_i F_ij = ∬ cos θ cos θ' / (π r²) dA dA', leaves a double contour
integral over the polygons' edges, with u and v their unit directions (E. M. Sparrow, J. Heat Transfer 85 (1963) 81,
doi:10.1115/1.3686058):

    2π G = ∮∮ ln r dp · dq = Σ_edges (u · v) ∬ ln r ds dt                                               Eq. (15)

It is exact on polygons that touch, where integrals over areas diverge. Far apart its edges cancel, and other ways,
which keep their digits there, take over: see `exchange_kernels`.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import ParameterError
from ..parallel import blocks, ordered_map
from .exchange_kernels import ALL, LATER, SAME, apart_rows
from .frames import prepare
from .near_kernels import near_rows

FloatArray = NDArray[np.float64]

BLOCK_PAIRS = 1 << 14  # pairs in one task: a few milliseconds


def exchange_area(polygon_a: ArrayLike, polygon_b: ArrayLike) -> float:
    """Exchange area A_a F_ab = A_b F_ba of two convex polygons with nothing in between, m².

    Parameters
    ----------
    polygon_a, polygon_b : array_like (3, 3) or (4, 3)
        Corners of a triangle or planar convex quad, counter-clockwise seen from the side that sends and receives, m.

    Returns
    -------
    float
        Zero if either is behind the other.

    Raises
    ------
    GeometryError
        Corners that are not finite; a quad that is bent or not convex.

    Examples
    --------
    >>> floor = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
    >>> ceiling = [[0, 0, 1], [0, 1, 1], [1, 1, 1], [1, 0, 1]]
    >>> round(exchange_area(floor, ceiling), 12)
    0.199824895698
    """
    return float(exchange_areas(np.asarray(polygon_a)[None], np.asarray(polygon_b)[None], threads=1)[0])


def exchange_areas(polygons_a: ArrayLike, polygons_b: ArrayLike, *, threads: int | None = None) -> FloatArray:
    """Exchange areas of pairs of convex polygons with nothing in between, pair by pair.

    Parameters
    ----------
    polygons_a, polygons_b : array_like (n, 3, 3) or (n, 4, 3)
        Corners, counter-clockwise seen from the front, m. In (n, 4, 3) a triangle repeats its third corner.
    threads : int, optional

    Returns
    -------
    ndarray (n,)
        A_a F_ab, m².

    Raises
    ------
    GeometryError
        Corners that are not finite, quads that are bent or not convex, with their number.
    ParameterError
        Different numbers of polygons.
    """
    a, a_frames = prepare(polygons_a, "polygons_a")
    b, b_frames = prepare(polygons_b, "polygons_b")
    if len(a) != len(b):
        raise ParameterError(f"there are {len(a)} polygons_a and {len(b)} polygons_b; give as many of either")
    out = np.zeros((len(a), 1))
    _fill(a, a_frames, b, b_frames, SAME, out, blocks(len(a), BLOCK_PAIRS), threads)
    return out[:, 0]


def exchange_area_matrix(
    polygons_a: ArrayLike, polygons_b: ArrayLike | None = None, *, threads: int | None = None
) -> FloatArray:
    """Exchange areas of every polygon with every other, nothing being in between.

    Parameters
    ----------
    polygons_a : array_like (n, 3, 3) or (n, 4, 3)
        Corners, counter-clockwise seen from the front, m. In (n, 4, 3) a triangle repeats its third corner.
    polygons_b : array_like (m, 3, 3) or (m, 4, 3), optional
        `polygons_a` by default.
    threads : int, optional
        The result has the same bits for any number of threads.

    Returns
    -------
    ndarray (n, m)
        A_a F_ab, m². Symmetric, and computed once per pair, where `polygons_b` is left out.

    Raises
    ------
    GeometryError
        Corners that are not finite, quads that are bent or not convex, with their number.
    """
    a, a_frames = prepare(polygons_a, "polygons_a")
    if polygons_b is not None:
        b, b_frames = prepare(polygons_b, "polygons_b")
        out = np.zeros((len(a), len(b)))
        rows = blocks(len(a), math.ceil(BLOCK_PAIRS / max(1, len(b))))
        _fill(a, a_frames, b, b_frames, ALL, out, rows, threads)
        return out
    out = np.zeros((len(a), len(a)))
    rows = blocks(len(a), math.ceil(BLOCK_PAIRS / max(1, len(a))))
    _fill(a, a_frames, a, a_frames, LATER, out, rows, threads)
    for begin, end in rows:
        out[begin:end, :begin] = out[:begin, begin:end].T
        square = out[begin:end, begin:end]
        square += square.T.copy()  # the diagonal is zero: nothing flat sees itself
    return out


def _fill(
    a: FloatArray,
    a_frames: FloatArray,
    b: FloatArray,
    b_frames: FloatArray,
    columns: int,
    out: FloatArray,
    rows: list[tuple[int, int]],
    threads: int | None,
) -> None:
    """Compute blocks of rows on threads, each into its own part of `out`."""

    def work(block: tuple[int, int]) -> None:
        if apart_rows(a, a_frames, b, b_frames, *block, columns, out):  # else there is no need for the other kernel
            near_rows(a, a_frames, b, b_frames, *block, columns, out)

    for _ in ordered_map(work, rows, threads):
        pass
