"""Carved polygons: every point lies in the one piece that it belongs to."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from radiosity.contacts.carve import carve
from radiosity.polygons import signed_area

SQUARE = np.array([[0, 0], [10, 0], [10, 10], [0, 10]], dtype=float)
BOX = np.array([[1, 1], [2, 1], [2, 2], [1, 2]], dtype=float)
THIN = 1e-7


def inside(points, loop):
    """Which points lie in a polygon (crossing numbers)."""
    crossings = np.zeros(len(points), dtype=int)
    for (x0, y0), (x1, y1) in zip(loop, np.roll(loop, -1, axis=0), strict=True):
        with np.errstate(divide="ignore", invalid="ignore"):
            before = points[:, 0] < x0 + (points[:, 1] - y0) / (y1 - y0) * (x1 - x0)
        crossings += ((y0 > points[:, 1]) != (y1 > points[:, 1])) & before
    return crossings % 2 == 1


def star(rng):
    """A polygon, convex or not, somewhere on the square or across its border."""
    corners = int(rng.integers(4, 9))
    angle = 2 * np.pi * (np.arange(corners) + rng.uniform(0, 1, corners)) / corners  # no gap of half a turn: simple
    radius = rng.uniform(0.2, 3.0, corners)
    return rng.uniform(0, 10, 2) + (radius * [np.cos(angle), np.sin(angle)]).T


def any_of(points, polygons):
    return count_of(points, polygons) > 0


def count_of(points, pieces):
    return sum((inside(points, piece).astype(int) for piece in pieces), np.zeros(len(points), dtype=int))


@given(st.integers(0, 2**32 - 1), st.integers(0, 5), st.integers(0, 4))
def test_every_point_lies_in_the_piece_it_belongs_to(seed, cut_count, divide_count):
    rng = np.random.default_rng(seed)
    cuts, divides = [star(rng) for _ in range(cut_count)], [star(rng) for _ in range(divide_count)]
    angle = rng.uniform(0, 2 * np.pi)
    turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    plain, covered = carve(SQUARE @ turn, [c @ turn for c in cuts], [d @ turn for d in divides], THIN)
    for piece in (*plain, *covered):
        assert signed_area(piece) > 0
    points = rng.uniform(0, 10, (500, 2))
    away, under = any_of(points, cuts), any_of(points, divides)
    assert (count_of(points @ turn, plain) == (~away & ~under)).all()
    assert (count_of(points @ turn, covered) == (~away & under)).all()


def total(pieces):
    return sum(signed_area(piece) for piece in pieces)


@pytest.mark.parametrize(
    ("cuts", "left"),
    [
        ([BOX], 99.0),
        ([BOX, BOX + 0.5], 98.25),  # crossing each other
        ([BOX - 1.5], 99.75),  # crossing a corner
        ([BOX, BOX + [1, 0]], 98.0),  # side by side
        ([BOX, BOX], 99.0),  # one on the other
        ([BOX - [1, 1]], 99.0),  # in the corner, along two edges
        ([BOX[[0, 1, 2]], BOX[[2, 3, 0]]], 99.0),  # two halves
        ([BOX[::-1]], 99.0),  # the other way round
        ([SQUARE], 0.0),
        ([BOX + 20], 100.0),
    ],
)
def test_areas_are_exact(cuts, left):
    plain, covered = carve(SQUARE, cuts, [], THIN)
    assert len(covered) == 0
    assert total(plain) == pytest.approx(left, rel=1e-14)
    plain, covered = carve(SQUARE, [], cuts, THIN)
    assert total(plain) == pytest.approx(left, rel=1e-14)
    assert total(covered) == pytest.approx(100 - left, rel=1e-14)


def test_a_division_inside_a_cut_is_cut():
    plain, covered = carve(SQUARE, [BOX], [BOX + 0.5], THIN)
    assert (total(plain), total(covered)) == (pytest.approx(98.25), pytest.approx(0.75))


@pytest.mark.parametrize("noise", [0.0, 1e-12, 5e-9])
def test_rounded_corners_leave_no_slivers(noise):
    """Two rows of boxes along an edge, whose corners should coincide but are rounded: no piece comes between them."""
    rng = np.random.default_rng(3)
    cuts = [BOX + [i, j - 1] + noise * rng.uniform(-1, 1, (4, 2)) for i in range(4) for j in range(2)]
    plain, _ = carve(SQUARE, cuts, [], THIN)
    assert total(plain) == pytest.approx(100 - 8, abs=1e-6)
    assert len(plain) <= (3 if noise == 0.0 else 6)
    assert min(np.ptp(piece, axis=0).min() for piece in plain) > 0.9


def test_corners_come_back_bit_by_bit():
    rng = np.random.default_rng(4)
    hole = BOX + rng.uniform(0, 1, (4, 2))
    plain, _ = carve(SQUARE, [hole], [], THIN)
    corners = {tuple(corner) for corner in plain.reshape(-1, 2).tolist()}
    assert {tuple(corner) for corner in (*SQUARE.tolist(), *hole.tolist())} <= corners


def test_many_small_covers_are_one_large_one():
    """A thousand triangles under a square: the pieces are those around the square."""
    n = 24
    x, y = (a.ravel() for a in np.meshgrid(np.arange(n), np.arange(n), indexing="ij"))
    halves = np.array([[[0, 0], [1, 0], [1, 1]], [[0, 0], [1, 1], [0, 1]]], dtype=float)
    cuts = (2 + 6 / n * (np.stack([x, y], axis=1)[:, None, None] + halves)).reshape(-1, 3, 2)
    plain, _ = carve(SQUARE, list(cuts), [], THIN)
    assert len(plain) == 4
    assert total(plain) == pytest.approx(64, rel=1e-12)
