"""Trapezoids tile what is left of a polygon."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from radiosity.errors import GeometryError
from radiosity.polygons import signed_area
from radiosity.trapezoids import trapezoids

SQUARE = np.array([[0, 0], [10, 0], [10, 10], [0, 10]], dtype=float)


def inside(points, loops):
    """Which points lie in the first loop and in none of the others (crossing numbers)."""
    crossings = np.zeros(len(points), dtype=int)
    for loop in loops:
        for (x0, y0), (x1, y1) in zip(loop, np.roll(loop, -1, axis=0), strict=True):
            spans = (y0 > points[:, 1]) != (y1 > points[:, 1])
            with np.errstate(divide="ignore", invalid="ignore"):
                crossings += spans & (points[:, 0] < x0 + (points[:, 1] - y0) / (y1 - y0) * (x1 - x0))
    return crossings % 2 == 1


@given(st.integers(0, 2**32 - 1), st.integers(0, 4))
def test_every_point_lies_in_one_piece_or_in_a_hole(seed, count):
    rng = np.random.default_rng(seed)
    places = rng.permutation([(2.5, 2.5), (7.5, 2.5), (2.5, 7.5), (7.5, 7.5)])[:count]
    holes = []
    for centre in places:
        corners = int(rng.integers(3, 7))
        angle = np.sort(rng.uniform(0, 2 * np.pi / corners, corners) + 2 * np.pi * np.arange(corners) / corners)
        holes.append(centre + 2.0 * np.stack([np.cos(angle), np.sin(angle)], axis=1))
    pieces = trapezoids(SQUARE, holes)
    assert all(signed_area(piece) > 0 for piece in pieces)
    left = 100 - sum(signed_area(hole) for hole in holes)
    assert sum(signed_area(piece) for piece in pieces) == pytest.approx(left, rel=1e-12)
    points = rng.uniform(0, 10, (500, 2))
    covered = sum(inside(points, [piece]).astype(int) for piece in pieces)
    assert (covered == inside(points, [SQUARE, *holes])).all()


def test_a_floor_of_long_strips_is_cut_the_better_way():
    flat = SQUARE * [1, 0.1]
    hole = np.array([[4.8, 0.4], [5.2, 0.4], [5.2, 0.6], [4.8, 0.6]])
    pieces = trapezoids(flat, [hole])
    assert len(pieces) == 4
    assert max(np.ptp(piece[:, 0]) for piece in pieces) < 5, "cut across, not along"


def test_holes_that_cross_the_outline_are_refused():
    with pytest.raises(GeometryError, match="touch or cross"):
        trapezoids(SQUARE, [SQUARE + 5])
