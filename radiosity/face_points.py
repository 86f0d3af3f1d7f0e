"""Points on faces in unit coordinates: the point of a cell, the cell of a hit, and how far off its face a ray begins.

The only place that knows how a ray's origin is kept clear of rounding: points on a patch are pulled a hair inside it
and lifted off its plane by `OFFSET`.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .compiled import kernel
from .geometry import quad_jacobians, unit
from .patches import Grid

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int32]

OFFSET = 1e-5  # lift of an origin off its patch, in diagonals of the scene
INSET = 1e-5  # pull of a sample point inside its patch, in patch widths


class FaceTable(NamedTuple):
    """Source faces and their grids as the kernels read them, in unit coordinates.

    A face spans ``origin + a along + b across``: corners 0, 1 and the last one, (F, 3) each. A quad's third corner
    stands at (a, b) = (1, 1) + skew, (F, 2), plus fold, (F, 3): how far a bent quad leaves its plane.
    normal and tangent (F, 3); density (F, 3): area density of a quad at (0, 0) and its slopes along u and v; the
    rest (F,) as in `Grid`.
    """

    origin: FloatArray
    along: FloatArray
    across: FloatArray
    skew: FloatArray
    fold: FloatArray
    normal: FloatArray
    tangent: FloatArray
    density: FloatArray
    quad: NDArray[np.bool_]
    columns: IntArray
    rows: IntArray
    front: IntArray
    back: IntArray


def face_table(grid: Grid, corners: FloatArray) -> FaceTable:
    """The faces of a grid, their corners (F, 4, 3) in unit coordinates, as the kernels read them."""
    faces = grid.faces
    density = quad_jacobians(corners, faces.normal)
    slopes = density[:, [1, 3]] - density[:, :1]
    slopes[np.abs(slopes) < 1e-12 * density[:, :1]] = 0.0  # a parallelogram but for rounding
    origin = corners[:, 0]
    along = corners[:, 1] - origin
    across = corners[:, 3] - origin
    skew = _skew(along, across, corners[:, 2] - origin)
    skew[~faces.quad] = 0.0
    fold = corners[:, 2] - origin - (1.0 + skew[:, :1]) * along - (1.0 + skew[:, 1:]) * across
    fold[~faces.quad] = 0.0
    table = FaceTable(
        origin=origin,
        along=along,
        across=across,
        skew=skew,
        fold=fold,
        normal=faces.normal,
        tangent=unit(along),
        density=np.concatenate([density[:, :1], slopes], axis=1),
        quad=faces.quad,
        columns=grid.columns,
        rows=grid.rows,
        front=grid.front,
        back=grid.back,
    )
    # One memory order for all scenes, or kernels would be compiled anew for another.
    return FaceTable(*(np.ascontiguousarray(part) for part in table))  # type: ignore[arg-type]


def whole_faces(table: FaceTable) -> FaceTable:
    """The same faces as if none were cut, for points on all of an emitter."""
    one_cell = np.ones(len(table.quad), dtype=np.int32)
    return table._replace(columns=one_cell, rows=one_cell)


def _skew(along: FloatArray, across: FloatArray, opposite: FloatArray) -> FloatArray:
    """(g, h) of the projection ``opposite = (1 + g) along + (1 + h) across`` to the plane of the two, (F, 2)."""
    rest = opposite - along - across
    aa, ab, bb = (np.einsum("fx,fx->f", p, q) for p, q in ((along, along), (along, across), (across, across)))
    ra, rb = np.einsum("fx,fx->f", rest, along), np.einsum("fx,fx->f", rest, across)
    determinant = aa * bb - ab * ab
    safe = np.where(determinant > 0, determinant, 1.0)
    skew = np.stack([ra * bb - rb * ab, rb * aa - ra * ab], axis=1) / safe[:, None]
    skew[np.abs(skew) < 1e-12] = 0.0  # a parallelogram but for rounding
    return skew


def to_affine(table: FaceTable, face: IntArray, second_half: NDArray[np.bool_]) -> FloatArray:
    """How Embree's coordinates on triangles (T,) of these faces become those of the faces' affine frames.

    (T, 6), as `affine` reads them: a = 0 + 1 u + 0 v and b = 0 + 0 u + 1 v, but on the second half of a quad.
    """
    to = np.tile([0.0, 1.0, 0.0, 0.0, 0.0, 1.0], (len(face), 1))
    g, h = table.skew[face[second_half]].T
    to[second_half] = np.stack([1.0 + g, -(1.0 + g), -g, 1.0 + h, -h, -(1.0 + h)], axis=1)
    return to


@kernel(inline="always")
def affine(to, u, v):  # type: ignore[no-untyped-def]
    """Coordinates of a point in its face's affine frame, from Embree's coordinates on a triangle: see `to_affine`.

    Sums, not a question: which half of a quad is met is a coin toss to the processor's branch predictor.
    """
    return to[0] + to[1] * u + to[2] * v, to[3] + to[4] * u + to[5] * v


@kernel(inline="always")
def lifted(table, f, a, b, side, out):  # type: ignore[no-untyped-def]
    """Write to out[:3] the point of face f at affine coordinates (a, b), lifted off it to one side."""
    fold = 0.0
    if table.quad[f]:  # on the second of the two triangles that rays meet
        fold = max(0.0, (a + b - 1.0) / (1.0 + table.skew[f, 0] + table.skew[f, 1]))
    for x in range(3):
        point = table.origin[f, x] + a * table.along[f, x] + b * table.across[f, x] + fold * table.fold[f, x]
        out[x] = point + side * OFFSET * table.normal[f, x]


@kernel
def cell_at(table, f, a, b):  # type: ignore[no-untyped-def]
    """Cell of face f at coordinates (a, b) in its affine frame."""
    columns, rows = table.columns[f], table.rows[f]
    if table.quad[f]:
        g, h = table.skew[f, 0], table.skew[f, 1]
        if g != 0.0 or h != 0.0:  # invert a = u + g u v, b = v + h u v
            middle = 1.0 + h * a - g * b
            b = 2.0 * b / (middle + np.sqrt(max(0.0, middle * middle + 4.0 * g * b)))
            a = a / (1.0 + g * b)
        column = min(max(int(a * columns), 0), columns - 1)
        row = min(max(int(b * rows), 0), rows - 1)
        return row * columns + column
    row = min(max(int(b * columns), 0), columns - 1)
    column = min(max(int(a * columns), 0), columns - 1 - row)
    turned = (a * columns - column) + (b * columns - row) > 1.0 and column < columns - 1 - row
    return row * (2 * columns - row) + 2 * column + turned


@kernel(inline="always")
def _linear_density(s, begin, slope):  # type: ignore[no-untyped-def]
    """Where the integral of begin + slope x over [0, x] has reached the share s of that over [0, 1]."""
    if slope == 0.0:
        return s
    total = begin + 0.5 * slope
    return 2.0 * s * total / (begin + np.sqrt(max(0.0, begin * begin + 2.0 * slope * s * total)))


@kernel
def patch_point(table, f, cell, side, s, t, out):  # type: ignore[no-untyped-def]
    """Write to out[:3] the point of a cell at (s, t), lifted off the face; uniform in area for uniform (s, t).

    Parameters
    ----------
    table : FaceTable
    f, cell : int
        Face, and number of the cell on one side of it.
    side : float
        1 or -1: which way to lift.
    s, t : float
        In [0, 1).
    out : ndarray (≥ 3,)
    """
    columns, rows = table.columns[f], table.rows[f]
    s = INSET + (1.0 - 2.0 * INSET) * s
    t = INSET + (1.0 - 2.0 * INSET) * t
    if table.quad[f]:
        row = cell // columns
        column = cell - row * columns
        along, across = table.density[f, 1] / columns, table.density[f, 2] / rows
        begin = table.density[f, 0] + along * column + across * row
        s = _linear_density(s, begin + 0.5 * across, along)
        t = _linear_density(t, begin + along * s, across)
        u, v = (column + s) / columns, (row + t) / rows
        g, h = table.skew[f, 0], table.skew[f, 1]
        a, b = u + g * u * v, v + h * u * v
    else:
        row = columns - np.int64(np.ceil(np.sqrt(np.float64(columns * columns - cell))))
        place = cell - row * (2 * columns - row)
        root = np.sqrt(s)
        a, b = root * (1.0 - t), root * t  # uniform on the unit triangle (Turk 1990)
        if place & 1:
            a, b = 1.0 - a, 1.0 - b
        a, b = ((place >> 1) + a) / columns, (row + b) / columns
    lifted(table, f, a, b, side, out)


@kernel
def patch_points(table, f, cell, side, s, t, out):  # type: ignore[no-untyped-def]
    """Write `patch_point` of all (s[r], t[r]) to out[r], (n, 3) float32: the same points, many at a time.

    What the points of a cell share is computed once, and the loops are short enough for the compiler to run eight at
    once.
    """
    flat = table.fold[f, 0] == 0.0 and table.fold[f, 1] == 0.0 and table.fold[f, 2] == 0.0
    if table.quad[f] and not (flat and table.skew[f, 0] == 0.0 and table.skew[f, 1] == 0.0):
        _bilinear_points(table, f, cell, side, s, t, out)
    else:
        _affine_points(table, f, cell, side, s, t, out)


@kernel
def _bilinear_points(table, f, cell, side, s, t, out):  # type: ignore[no-untyped-def]
    """`patch_points` of a cell of a quad that is no parallelogram."""
    n = s.shape[0]
    a, b, fold = np.empty(n), np.empty(n), np.empty(n)
    columns, rows = table.columns[f], table.rows[f]
    row = cell // columns
    column = cell - row * columns
    along, across = table.density[f, 1] / columns, table.density[f, 2] / rows
    corner = table.density[f, 0] + along * column + across * row
    begin = corner + 0.5 * across
    g, h = table.skew[f, 0], table.skew[f, 1]
    over, per_column, per_row = 1.0 / (1.0 + g + h), 1.0 / columns, 1.0 / rows
    for r in range(n):  # as in patch_point: `_linear_density` with slopes of zero has no special case
        x, y = INSET + (1.0 - 2.0 * INSET) * s[r], INSET + (1.0 - 2.0 * INSET) * t[r]
        total = begin + 0.5 * along
        x = 2.0 * x * total / (begin + np.sqrt(begin * begin + 2.0 * along * x * total))
        start = corner + along * x
        total = start + 0.5 * across
        y = 2.0 * y * total / (start + np.sqrt(start * start + 2.0 * across * y * total))
        u, v = (column + x) * per_column, (row + y) * per_row
        a[r], b[r] = u + g * u * v, v + h * u * v
        beyond = (a[r] + b[r] - 1.0) * over
        fold[r] = beyond if beyond > 0.0 else 0.0
    for x in range(3):
        origin = table.origin[f, x] + side * OFFSET * table.normal[f, x]
        to_a, to_b, to_fold = table.along[f, x], table.across[f, x], table.fold[f, x]
        for r in range(n):
            out[r, x] = origin + a[r] * to_a + b[r] * to_b + fold[r] * to_fold


@kernel
def _affine_points(table, f, cell, side, s, t, out):  # type: ignore[no-untyped-def]
    """`patch_points` of a cell of a parallelogram or a triangle: one corner and two edges serve all its points."""
    n = s.shape[0]
    columns, rows = table.columns[f], table.rows[f]
    turn = 1.0
    if table.quad[f]:
        row = cell // columns
        column = cell - row * columns
    else:
        row = columns - np.int64(np.ceil(np.sqrt(np.float64(columns * columns - cell))))
        place = cell - row * (2 * columns - row)
        column = place >> 1
        if place & 1:  # an upside-down triangle hangs from its far corner
            turn = -1.0
            column, row = column + 1, row + 1
    for x in range(3):
        corner = table.origin[f, x] + column / columns * table.along[f, x] + row / rows * table.across[f, x]
        corner += side * OFFSET * table.normal[f, x]
        along, across = turn * table.along[f, x] / columns, turn * table.across[f, x] / rows
        if table.quad[f]:
            for r in range(n):
                a = INSET + (1.0 - 2.0 * INSET) * s[r]
                b = INSET + (1.0 - 2.0 * INSET) * t[r]
                out[r, x] = corner + a * along + b * across
        else:
            for r in range(n):
                root = np.sqrt(INSET + (1.0 - 2.0 * INSET) * s[r])
                b = root * (INSET + (1.0 - 2.0 * INSET) * t[r])
                out[r, x] = corner + (root - b) * along + b * across
