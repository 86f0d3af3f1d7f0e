"""Form factors from points to polygons: closed forms, closed boxes, the horizon, and means over areas."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from radiosity.errors import GeometryError, ParameterError
from radiosity.form_factors import closed_forms as cf
from radiosity.form_factors.contour import exchange_area
from radiosity.form_factors.point_to_polygon import point_to_polygons
from radiosity.form_factors.polygon_kernels import lambert

UP = [0.0, 0.0, 1.0]
CEILING = np.array([[0, 0, 1], [0, 1, 1], [1, 1, 1], [1, 0, 1]], dtype=float)  # faces down
BOX = np.array(  # inside of the cube from -1 to 1
    [
        [[-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1]],
        [[-1, -1, 1], [-1, 1, 1], [1, 1, 1], [1, -1, 1]],
        [[-1, -1, -1], [-1, -1, 1], [1, -1, 1], [1, -1, -1]],
        [[-1, 1, -1], [1, 1, -1], [1, 1, 1], [-1, 1, 1]],
        [[-1, -1, -1], [-1, 1, -1], [-1, 1, 1], [-1, -1, 1]],
        [[1, -1, -1], [1, -1, 1], [1, 1, 1], [1, 1, -1]],
    ],
    dtype=float,
)


def factor(point, normal, polygon):
    return float(point_to_polygons([point], [normal], [polygon])[0, 0])


@pytest.mark.parametrize(
    ("a", "b", "c"), [(1, 1, 1), (2, 0.3, 1), (1, 1, 1e-6), (1e-6, 1, 1), (1, 1, 1e6), (1e3, 1e-3, 1)]
)
def test_parallel_rectangle_over_its_corner(a, b, c):
    polygon = CEILING * [a, b, c]
    assert factor([0, 0, 0], UP, polygon) == pytest.approx(cf.element_to_parallel_rectangle(a, b, c), rel=1e-11, abs=0)


@pytest.mark.parametrize(
    ("height", "width", "distance"), [(1, 1, 1), (3, 4, 2), (0.1, 1, 1), (1, 1, 1e-6), (1, 1, 1e4)]
)
def test_upright_rectangle(height, width, distance):
    wall = np.array([[0, 0, 0], [0, width, 0], [0, width, height], [0, 0, height]], dtype=float)
    true = cf.element_to_perpendicular_rectangle(height, width, distance)
    assert factor([distance, 0, 0], UP, wall) == pytest.approx(true, rel=1e-11, abs=0)


def test_a_low_wall_nearby_keeps_sixteen_places_if_not_sixteen_digits():
    wall = np.array([[0, 0, 0], [0, 1, 0], [0, 1, 1e-4], [0, 0, 1e-4]], dtype=float)
    true = cf.element_to_perpendicular_rectangle(1e-4, 1, 1)
    assert factor([1, 0, 0], UP, wall) == pytest.approx(true, rel=0, abs=1e-16)


def test_upright_rectangle_is_cut_at_the_horizon():
    wall = np.array([[0, 0, -3], [0, 1, -3], [0, 1, 2], [0, 0, 2]], dtype=float)
    assert factor([1, 0, 0], UP, wall) == pytest.approx(cf.element_to_perpendicular_rectangle(2, 1, 1), rel=1e-13)
    with_corner_below = np.array([[0, 0, -1], [0, 2, 1], [0, 0, 1]], dtype=float)
    seen = np.array([[0, 0, 0], [0, 1, 0], [0, 2, 1], [0, 0, 1]], dtype=float)
    assert factor([1, 0, 0], UP, with_corner_below) == pytest.approx(factor([1, 0, 0], UP, seen), rel=1e-13)


def test_without_the_horizon_it_would_be_wrong():
    """A negative control: what is below the horizon counts negative in Lambert's sum."""
    wall = np.array([[0, 0, -3], [0, 1, -3], [0, 1, 2], [0, 0, 2]], dtype=float)
    uncut = lambert(1.0, 0.0, 0.0, np.array(UP), wall, 4) / (2 * math.pi)
    assert abs(uncut - cf.element_to_perpendicular_rectangle(2, 1, 1)) > 0.05


inside = st.floats(-0.999, 0.999)


@given(st.tuples(inside, inside, inside), st.tuples(inside, inside, inside).filter(lambda n: np.linalg.norm(n) > 0.1))
def test_a_box_fills_all_directions(point, normal):
    factors = point_to_polygons([point], [normal], BOX)
    assert (factors >= 0).all()
    assert factors.sum() == pytest.approx(1.0, abs=1e-13)


def test_irradiance_over_a_box_of_one_radiosity_is_that_radiosity():
    """10⁻⁹ from walls and edges too."""
    near = 1 - 1e-9
    points = np.array([[0, 0, -near], [near, 0, -near], [near, near, -near], [0.3, -near, 0.2]])
    factors = point_to_polygons(points, [UP, UP, [-1, -1, 1], [0.1, 1, -0.2]], BOX)
    assert factors.sum(axis=1) == pytest.approx(np.ones(4), abs=1e-12)


def test_behind_facing_away_and_in_the_plane():
    assert factor([0.5, 0.5, 2], [0, 0, -1], CEILING) == 0.0  # its back
    assert factor([0.5, 0.5, 0], [0, 0, -1], CEILING) == 0.0  # below the horizon
    assert factor([2, 2, 1], UP, CEILING) == 0.0  # in its plane
    assert factor([0.5, 0.5, 1], [0, 0, -1], CEILING) == 0.0  # on it
    assert factor([0.5, 0.5, 1 - 1e-9], UP, CEILING) == pytest.approx(1.0, abs=1e-8)  # close under it


@pytest.mark.parametrize("distance", [10.0, 29.0, 31.0, 1e3, 1e6])
def test_far_polygons_relative(distance):
    """Through the change of method at thirty radii; the square's fourfold corner keeps its digits at any distance."""
    square = (CEILING - [0.5, 0.5, 1]) * 2 * math.sqrt(0.5) + [0, 0, distance]
    true = 4 * cf.element_to_parallel_rectangle(math.sqrt(0.5), math.sqrt(0.5), distance)
    assert factor([0, 0, 0], UP, square) == pytest.approx(true, rel=1e-12, abs=0)
    assert factor([0, 0, 0], [1, 0, 1], square) == pytest.approx(true / math.sqrt(2), rel=1e-12, abs=0)


def test_mean_over_an_area_is_its_exchange():
    a = np.array([[0, 0, 0], [1, 0, 0], [0.8, 1, 0], [0, 0.7, 0]])
    b = np.array([[2, 0, -0.5], [2, 1, 0.2], [1.5, 0.5, 2]])
    b = b if exchange_area(a, b) > 0 else b[::-1]
    x, w = np.polynomial.legendre.leggauss(24)
    u, v = np.meshgrid(0.5 * (x + 1), 0.5 * (x + 1), indexing="ij")
    weight = np.outer(w, w) / 4
    corners = (1 - u) * (1 - v), u * (1 - v), u * v, (1 - u) * v
    points = sum(c[..., None] * corner for c, corner in zip(corners, a, strict=True))
    du = (1 - v)[..., None] * (a[1] - a[0]) + v[..., None] * (a[2] - a[3])
    dv = (1 - u)[..., None] * (a[3] - a[0]) + u[..., None] * (a[2] - a[1])
    density = np.cross(du, dv)[..., 2]
    factors = point_to_polygons(points.reshape(-1, 3), np.tile(UP, (points[..., 0].size, 1)), b[None])
    assert b[:, 2].min() < 0, "part of it is below the horizon of all points"
    mean = float((weight * density).ravel() @ factors[:, 0])
    assert mean == pytest.approx(exchange_area(a, b), rel=1e-9)


def test_scale_turn_and_threads():
    random = np.random.default_rng(0)
    points, normals = random.uniform(-0.9, 0.9, (50, 3)), random.normal(size=(50, 3))
    factors = point_to_polygons(points, normals, BOX, threads=1)
    assert (factors == point_to_polygons(points, normals, BOX, threads=3)).all()
    assert (factors == point_to_polygons(points * 2.0**-40, normals, BOX * 2.0**-40)).all()
    turn, _ = np.linalg.qr(random.normal(size=(3, 3)))
    turn *= np.linalg.det(turn)
    turned = point_to_polygons(points @ turn.T + 5, normals @ turn.T, BOX @ turn.T + 5)
    assert turned == pytest.approx(factors, abs=1e-13)


def test_triangles_and_quads():
    halves = point_to_polygons([[0.2, 0.3, 0]], [UP], CEILING[[[0, 1, 2], [0, 2, 3]]])
    assert halves.sum() == pytest.approx(factor([0.2, 0.3, 0], UP, CEILING), abs=1e-15)
    assert point_to_polygons(np.zeros((0, 3)), np.zeros((0, 3)), [CEILING]).shape == (0, 1)


@pytest.mark.parametrize(
    ("points", "normals", "polygons", "kind", "says"),
    [
        ([[0, 0, 0]], [[0, 0, 0]], [CEILING], ParameterError, "normal 0 is zero"),
        ([[0, 0, np.inf]], [UP], [CEILING], ParameterError, "number 0 is not finite"),
        ([0, 0, 0], [UP], [CEILING], ParameterError, r"points have shape \(3,\)"),
        ([[0, 0, 0]], [UP, UP], [CEILING], ParameterError, "1 points and 2 normals"),
        ([[0, 0, 0]], [UP], [CEILING * np.nan], GeometryError, "polygon 0 are not finite"),
    ],
)
def test_what_is_no_point_or_polygon_is_refused(points, normals, polygons, kind, says):
    with pytest.raises(kind, match=says):
        point_to_polygons(points, normals, polygons)
