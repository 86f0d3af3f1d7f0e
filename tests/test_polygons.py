"""Polygons are cut into triangles of exactly their area, on their own corners."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from radiosity.errors import GeometryError
from radiosity.polygons import cross, signed_area, triangulate


def star(rng, count, centre=(0.0, 0.0), radius=1.0):
    """A star-shaped polygon, mostly concave."""
    angle = 2 * np.pi * (np.arange(count) + 0.8 * rng.random(count)) / count
    reach = radius * rng.uniform(0.2, 1.0, count)
    return np.asarray(centre) + reach[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])


def check(outline, holes):
    points, triangles = triangulate(outline, holes)
    areas = 0.5 * cross(*np.moveaxis(points[triangles], 1, 0))
    expected = abs(signed_area(np.asarray(outline))) - sum(abs(signed_area(np.asarray(h))) for h in holes)
    assert (areas > 0).all()
    assert np.isclose(areas.sum(), expected, rtol=1e-12)
    assert len(triangles) == len(points) + 2 * len(holes) - 2
    edges = np.sort(np.concatenate([triangles[:, [k, (k + 1) % 3]] for k in range(3)]), axis=1)
    edges, uses = np.unique(edges, axis=0, return_counts=True)
    assert uses.max() <= 2
    starts = np.cumsum([0, len(outline), *map(len, holes)])
    border = {tuple(sorted((a + k, a + (k + 1) % (b - a)))) for a, b in pairwise(starts) for k in range(b - a)}
    assert {tuple(edge) for edge in edges[uses == 1].tolist()} == border  # neighbours still meet edge to edge


@given(st.integers(0, 10_000), st.integers(3, 40), st.booleans())
def test_concave_polygon_keeps_its_area_and_its_border(seed, count, reverse):
    outline = star(np.random.default_rng(seed), count)
    check(outline[::-1] if reverse else outline, [])


@given(st.integers(0, 10_000), st.integers(1, 9))
def test_holes_are_left_out_exactly(seed, count):
    rng = np.random.default_rng(seed)
    places = rng.permutation(9)[:count]
    holes = [star(rng, int(rng.integers(3, 9)), (p % 3 - 1.0, p // 3 - 1.0), 0.45) for p in places]
    check([[-2, -2], [2, -2], [2, 2], [-2, 2]], holes)


def test_grid_of_square_holes_with_corners_in_line():
    """Corners that lie on common lines are where bridges and ears go wrong."""
    holes = [np.add([[0, 0], [1, 0], [1, 1], [0, 1]], [2 * i + 1, 2 * j + 1]) for i in range(4) for j in range(4)]
    check([[0, 0], [9, 0], [9, 9], [0, 9]], holes)


def test_corner_in_the_middle_of_an_edge_stays():
    check([[0, 0], [1, 0], [2, 0], [2, 1], [2, 2], [0, 2]], [])


def test_delaunay_flips_avoid_slivers():
    """A thin fan from one corner of a regular polygon would have far smaller angles."""
    angle = np.linspace(0, 2 * np.pi, 12, endpoint=False)
    points, triangles = triangulate(np.column_stack([np.cos(angle), 1.5 * np.sin(angle)]))
    corners = points[triangles]
    area = 0.5 * cross(*np.moveaxis(corners, 1, 0))
    longest = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2).max(axis=1)
    assert (area / longest**2).min() > 0.04


@pytest.mark.parametrize(
    ("outline", "holes"),
    [
        ([[0, 0], [1, 1], [1, 0], [0, 1]], []),  # crosses itself
        ([[0, 0], [1, 0], [2, 0]], []),  # flat
        ([[0, 0], [1, 0]], []),
        ([[0, 0], [1, 0], [np.nan, 1]], []),
        ([[0, 0], [4, 0], [4, 4], [0, 4]], [[[3, 3], [5, 3], [5, 5], [3, 5]]]),  # hole crosses the outline
    ],
)
def test_what_is_no_polygon_is_refused(outline, holes):
    with pytest.raises(GeometryError):
        check(outline, holes)
