"""Exact exchange areas: known values, an independent twin in 30 digits, and what must hold for any polygons."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from radiosity.errors import GeometryError, ParameterError
from radiosity.form_factors import closed_forms as cf
from radiosity.form_factors.contour import exchange_area, exchange_area_matrix, exchange_areas
from radiosity.form_factors.polygon_kernels import MAX_CORNERS, clip_to_front
from tests.form_factors import exact_pairs
from tests.truths import FOLDER

FLOOR = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], dtype=float)


def ceiling(height):
    """The unit square over FLOOR, facing down."""
    return FLOOR[::-1] + [0, 0, height]


def rectangle(origin, first, second):
    """Corners of the rectangle spanned by two edges; its front is where first × second points."""
    origin, first, second = (np.array(v, dtype=float) for v in (origin, first, second))
    return np.array([origin, origin + first, origin + first + second, origin + second])


def box_faces(size=(1.0, 1.0, 1.0)):
    """Inward-facing faces of a box with one corner at the origin."""
    x, y, z = np.diag(size)
    low = [rectangle((0, 0, 0), a, b) for a, b in ((x, y), (y, z), (z, x))]
    high = [face[::-1] + shift for face, shift in zip(low, (z, x, y), strict=True)]
    return np.array(low + high)


def cells(face, columns, rows):
    """A quad cut into columns × rows cells of equal steps."""
    u, v = np.linspace(0, 1, columns + 1)[:, None, None], np.linspace(0, 1, rows + 1)[:, None]
    a, b, c, d = face
    grid = (1 - u) * (1 - v) * a + u * (1 - v) * b + u * v * c + (1 - u) * v * d
    return np.stack([grid[:-1, :-1], grid[1:, :-1], grid[1:, 1:], grid[:-1, 1:]], axis=2).reshape(-1, 4, 3)


def areas(polygons):
    return 0.5 * np.linalg.norm(np.cross(polygons[:, 2] - polygons[:, 0], polygons[:, -1] - polygons[:, 1]), axis=1)


def turned(seed):
    """A rotation that is parallel to no axis."""
    q, _ = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    return q * np.linalg.det(q)


# Known values


def test_parallel_unit_squares():
    assert exchange_area(FLOOR, ceiling(1)) == pytest.approx(0.199824895698387, abs=1e-14)


def test_perpendicular_unit_squares_with_a_common_edge():
    wall = rectangle((0, 0, 0), (0, 1, 0), (0, 0, 1))
    assert exchange_area(FLOOR, wall) == pytest.approx(0.200043776075403, abs=1e-14)


@pytest.mark.parametrize("height", [1e-9, 1e-6, 1e-3, 0.1, 1.0, 3.0, 10.0, 1e3, 1e6])
def test_opposed_rectangles_at_every_distance(height):
    sides = (1.0, 0.3)
    floor = rectangle((0, 0, 0), (sides[0], 0, 0), (0, sides[1], 0))
    factor = exchange_area(floor, floor[::-1] + [0, 0, height]) / (sides[0] * sides[1])
    assert factor == pytest.approx(cf.parallel_rectangles(*sides, height), rel=2e-10, abs=0)
    assert factor == pytest.approx(cf.parallel_rectangles(*sides, height), abs=1e-12)


@pytest.mark.parametrize(("width", "height", "length"), [(1, 2, 1), (0.01, 1, 1), (4, 3, 4), (1, 1e-4, 3), (1, 1, 1e3)])
def test_rectangles_with_a_common_edge(width, height, length):
    floor = rectangle((0, 0, 0), (width, 0, 0), (0, length, 0))
    wall = rectangle((0, 0, 0), (0, length, 0), (0, 0, height))
    true = cf.perpendicular_rectangles(width, height, length)
    assert exchange_area(floor, wall) / (width * length) == pytest.approx(true, rel=1e-11)


@pytest.mark.parametrize(
    "place",
    [
        ((0, 1), (0, 1), (1, 2), (0, 1), 1),
        ((0, 2), (0, 1), (0.5, 1.5), (2, 3), 0.5),
        ((0, 1), (0, 1), (0.25, 0.75), (-1, 2), 0.01),  # edges that cross in projection
        ((0, 1), (0, 1), (0.5, 1.5), (0, 1), 1e-5),
        ((0, 0.1), (0, 0.1), (5, 5.2), (3, 3.4), 2),
    ],
)
def test_offset_rectangles_in_parallel_planes(place):
    x, y, xi, eta, distance = place
    a = rectangle((x[0], y[0], 0), (x[1] - x[0], 0, 0), (0, y[1] - y[0], 0))
    b = rectangle((xi[0], eta[0], distance), (0, eta[1] - eta[0], 0), (xi[1] - xi[0], 0, 0))
    true = cf.parallel_rectangles_offset(*place)
    rotation = turned(1)
    for a_, b_ in ((a, b), (a @ rotation.T, b @ rotation.T)):
        assert exchange_area(a_, b_) / areas(a[None])[0] == pytest.approx(true, rel=1e-9, abs=0)


@pytest.mark.parametrize(
    "place",
    [
        ((1, 2), (0, 1), (0, 1), (1, 2)),
        ((0, 1), (0, 1), (0.5, 1.5), (0, 1)),  # edges that overlap in part
        ((0, 1), (0, 1), (0.25, 0.75), (0, 1)),  # one edge inside the other
        ((0, 1), (0, 1), (1, 2), (0, 1)),  # one common corner
        ((0, 1), (0, 1), (-3, 4), (0, 5)),
        ((0.2, 0.4), (0.2, 0.4), (3, 3.2), (1, 1.5)),
    ],
)
def test_offset_rectangles_in_perpendicular_planes(place):
    x, y, eta, xi = place
    a = rectangle((x[0], y[0], 0), (x[1] - x[0], 0, 0), (0, y[1] - y[0], 0))
    b = rectangle((0, eta[0], xi[0]), (0, eta[1] - eta[0], 0), (0, 0, xi[1] - xi[0]))
    true = cf.perpendicular_rectangles_offset(*place)
    rotation = turned(2)
    for a_, b_ in ((a, b), (a @ rotation.T, b @ rotation.T)):
        assert exchange_area(a_, b_) / areas(a[None])[0] == pytest.approx(true, rel=1e-9, abs=0)


def test_triangles_by_quadrature_of_lamberts_formula():
    """Values of a Gauss rule of 40 × 40 points over the formula for elements, by other software."""
    floor = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], dtype=float)
    assert exchange_area(floor, floor[::-1] + [0, 0, 1]) / 0.5 == pytest.approx(0.11504922814961, abs=1e-12)
    aside = np.array([[2, 0, 0], [3, 0, 0], [2, 1, 0]], dtype=float)
    wall = np.array([[0, 0, 0.5], [0, 1, 0.5], [0, 0, 1.5]])
    assert exchange_area(aside, wall) / 0.5 == pytest.approx(0.00788507629407, abs=1e-12)
    end = np.array([[0, 0, 0], [1, 0, 0], [0.5, math.sqrt(0.75), 0]])
    end_area = math.sqrt(3) / 4
    assert exchange_area(end, end[::-1] + [0, 0, 1]) / end_area == pytest.approx(0.10560582898040, abs=1e-12)


def test_tetrahedron():
    corners = np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]], dtype=float)
    faces = corners[[[2, 1, 0], [1, 3, 0], [3, 2, 0], [2, 3, 1]]]
    inward = np.cross(faces[:, 1] - faces[:, 0], faces[:, 2] - faces[:, 0])
    assert (np.einsum("fx,fx->f", inward, faces[:, 0]) < 0).all()
    factors = exchange_area_matrix(faces) / areas(faces)[:, None]
    assert factors == pytest.approx((1 - np.eye(4)) / 3, abs=1e-13)


# The twin in 30 digits


def triangle_pairs():
    """Pairs that are hard in one way each: (what, a, b)."""
    random = np.random.default_rng(11)

    def triangle():
        return random.normal(size=(3, 3))

    a, b = np.array([[0, 0, 0], [1, 0, 0], [0.3, 1, 0]]), np.array([[0.2, 0.1, 1], [0.4, 1.2, 1.1], [1.1, 0.3, 0.9]])
    yield "apart", a, b
    yield "sharing an edge", a, np.array([[1, 0, 0], [0, 0, 0], [0.3, -0.2, 0.8]])
    yield "sharing a corner", a, np.array([[0, 0, 0], [-1, 0.5, 0.3], [-0.2, -0.4, 1.0]])
    yield "a corner on an edge", a, np.array([[0.4, 0, 0], [0.1, -1, 0.5], [0.9, -0.3, 0.8]])
    yield "edges 1e-3 apart, askew", a, np.array([[1, 0.01, 1e-3], [0, -0.01, 1e-3], [0.5, -0.4, 0.6]])
    yield "edges 1e-7 apart, askew", a, np.array([[1, 1e-8, 1e-7], [0, -3e-8, 1e-7], [0.5, -0.4, 0.6]])
    yield "nearly parallel edges that touch", a, np.array([[1.2, 1e-5, 0], [0, 0, 0], [0.5, -0.4, 0.6]])
    yield "through each other", a, np.array([[0.3, 0.2, -0.5], [0.5, 0.6, 0.7], [0.1, 0.8, 0.4]])
    yield "a sliver", np.array([[0, 0, 0], [1, 0, 0], [0.5, 1e-4, 0]]), b
    yield "tiny, on a huge one", a * 1e-5 + [0.3, 0.3, 0], np.array([[0.3, 0.3, 0], [0.3, 0.9, 0.4], [0.3, -1, 0.9]])
    turn = turned(3)
    yield "plates 1e-3 apart, turned", a, (a[::-1] - [0.4, 0.3, 0]) @ turn_in_plane(0.5).T + [0.45, 0.35, 1e-3]
    yield "random", triangle() @ turn, triangle() @ turn + [0.5, 0, 0]


def turn_in_plane(angle):
    return np.array([[math.cos(angle), -math.sin(angle), 0], [math.sin(angle), math.cos(angle), 0], [0, 0, 1]])


@pytest.mark.parametrize(
    ("what", "a", "b"), list(triangle_pairs()), ids=lambda part: part if isinstance(part, str) else ""
)
def test_triangles_against_the_twin(what, a, b):
    tolerance = 3e-10 if what.startswith(("a sliver", "tiny")) else 3e-11
    for b_ in (b, b[::-1]):  # one of the two faces a
        true = exact_pairs.exchange_area(a, b_)
        smaller = areas(np.array([a, b_])).min()
        assert exchange_area(a, b_) / smaller == pytest.approx(true / smaller, abs=tolerance), what


@pytest.mark.parametrize("angle", [0.3, math.pi / 4])
def test_squares_at_distance_0_001_turned_against_each_other(angle):
    """Eight pairs of edges cross 0.001 apart; where they cross, the integrand turns sharply."""
    above = (FLOOR[::-1] - 0.5) @ turn_in_plane(angle).T * [1, 1, 0] + [0.5, 0.5, 1e-3]
    assert exchange_area(FLOOR, above) == pytest.approx(exact_pairs.exchange_area(FLOOR, above), abs=1e-11)


@pytest.mark.parametrize("distance", [3.0, 10.0, 100.0, 1e4, 1e6])
def test_far_triangles_relative(distance):
    a = np.array([[0, 0, 0], [1, 0, 0], [0.3, 1, 0]])
    b = np.array([[0.2, 0.1, 1], [0.4, 1.2, 1.1], [1.1, 0.3, 0.9]]) + np.array([0.6, 0.0, 0.8]) * distance
    assert exchange_area(a, b) == pytest.approx(exact_pairs.exchange_area(a, b), rel=2e-9, abs=0)


@pytest.mark.parametrize("size", [1e-2, 1e-4, 1e-7])
@pytest.mark.parametrize("height", [1e-3, 0.1, 1.0])
def test_a_tiny_square_under_a_huge_one_relative(size, height):
    place = ((0.3, 0.3 + size), (0.6, 0.6 + size), (0.0, 1.0), (0.0, 1.0), height)
    tiny = rectangle((0.3, 0.6, 0), (size, 0, 0), (0, size, 0))
    spanned = np.diff(place[0])[0] * np.diff(place[1])[0]  # 0.3 + size is rounded
    true = cf.parallel_rectangles_offset(*place) * spanned
    assert exchange_area(tiny, ceiling(height)) == pytest.approx(true, rel=1e-8, abs=0)


@pytest.mark.parametrize("size", [1e-2, 1e-4, 1e-6])
def test_a_tiny_wall_on_a_huge_floor_relative(size):
    """Edges along each other, one a millionth of the other: closed forms for parallel edges would lose the tiny one."""
    place = ((0, size), (0.4, 0.4 + size), (0, 1), (0, 1))
    wall = rectangle((0.4, 0, 0), (0, 0, size), (size, 0, 0))  # its foot lies on an edge of the floor
    true = cf.perpendicular_rectangles_offset(*place) * size * np.diff(place[1])[0]
    assert exchange_area(wall, FLOOR) == pytest.approx(true, rel=1e-8, abs=0)


# What holds for any polygons


def wild_pairs(seed, count):
    """Quads and triangles of many sizes in many places, some in each other's way."""
    random = np.random.default_rng(seed)
    turn = np.sort(random.uniform(0, 2 * np.pi, (2, count, 4)), axis=2)
    flat = np.stack([np.cos(turn), 0.6 * np.sin(turn), np.zeros_like(turn)], axis=-1)
    flat[:, ::3, 3] = flat[:, ::3, 2]  # every third is a triangle
    spin = np.linalg.qr(random.normal(size=(2, count, 3, 3)))[0]
    spin *= np.linalg.det(spin)[..., None, None]
    size = 10.0 ** random.uniform(-3, 0.5, (2, count, 1, 1))
    return size * flat @ np.swapaxes(spin, -1, -2) + random.normal(size=(2, count, 1, 3))


def test_reciprocity_to_the_last_bit():
    a, b = wild_pairs(1, 4000)
    there, back = exchange_areas(a, b), exchange_areas(b, a)
    assert (there == back).all()
    assert (there >= 0).all()
    assert 500 < np.count_nonzero(there) < 3000
    assert (there <= np.minimum(areas(a), areas(b)) * (1 + 1e-12)).all()


@given(st.integers(-100, 100))
def test_scaling_by_powers_of_two_to_the_last_bit(power):
    a, b = wild_pairs(2, 200)
    assert (exchange_areas(np.ldexp(a, power), np.ldexp(b, power)) == np.ldexp(exchange_areas(a, b), 2 * power)).all()


def test_rigid_motion_changes_nothing():
    a, b = wild_pairs(3, 2000)
    before = exchange_areas(a, b)
    smaller = np.minimum(areas(a), areas(b))
    for seed in range(3):
        rotation = turned(seed)
        after = exchange_areas(a @ rotation.T + [3, -1, 2], b @ rotation.T + [3, -1, 2])
        assert np.abs(after - before).max() < 1e-12
        assert (np.abs(after - before) / smaller).max() < 1e-9


def test_pieces_add_up_to_the_whole():
    """Cut one polygon of each pair: the way a pair is computed changes, the sum must not."""
    a, b = wild_pairs(4, 1500)
    whole = exchange_areas(a, b)
    middle = a.mean(axis=1)
    parts = np.zeros(len(a))
    for k in range(4):
        corner, after = a[:, k], a[:, (k + 1) % 4]
        triangle = np.stack([corner, after, middle, middle], axis=1)
        solid = areas(triangle) > 1e-12 * areas(a)
        parts[solid] += exchange_areas(triangle[solid], b[solid])
    smaller = np.minimum(areas(a), areas(b))
    assert (np.abs(parts - whole) / smaller).max() < 3e-9
    seen = whole > 1e-6 * smaller
    assert seen.sum() > 200
    assert (np.abs(parts / np.where(seen, whole, 1) - 1)[seen]).max() < 1e-6


def test_what_is_behind_or_in_the_plane_exchanges_nothing():
    below = ceiling(-1)
    assert exchange_area(FLOOR, below) == 0.0
    assert exchange_area(FLOOR, FLOOR + [0, 0, 1]) == 0.0  # above, but facing away
    assert exchange_area(FLOOR, FLOOR) == 0.0
    assert exchange_area(FLOOR, FLOOR[::-1]) == 0.0  # the other side of the same plate
    assert exchange_area(FLOOR, FLOOR + [1, 0, 0]) == 0.0
    turn = turned(5)
    wall = cells(FLOOR, 8, 8) @ turn.T + [10, 20, 30]
    assert not exchange_area_matrix(wall).any(), "rounding tilts no patch of a wall against another"


def test_polygons_that_reach_behind_each_other_are_cut():
    upright = rectangle((0.5, 0, -1), (0, 1, 0), (0, 0, 3))  # through the middle of the floor, from below it
    assert exchange_area(FLOOR, upright) == pytest.approx(0.5 * cf.perpendicular_rectangles(0.5, 2, 1), rel=1e-12)
    crossing = rectangle((0, -1, -1), (0, 3, 0), (0, 0, 3))
    seen = rectangle((0, -1, 0), (0, 3, 0), (0, 0, 2))
    assert exchange_area(FLOOR, crossing) == pytest.approx(exchange_area(FLOOR, seen), rel=1e-12)
    roof = np.array([[-1, -1, -0.5], [-1, 2, -0.5], [2, 2, 1], [2, -1, 1]])
    line = rectangle((0, -1, 0), (0, 3, 0), (2, 0, 1))[[0, 1, 2, 3]]
    assert exchange_area(FLOOR, roof) == pytest.approx(exchange_area(FLOOR, line), rel=1e-11)


def test_box_rows_close():
    for size in ((1, 1, 1), (4, 3, 2.5), (1, 1, 1e-3)):
        faces = box_faces(size)
        sums = exchange_area_matrix(faces).sum(axis=1) / areas(faces)
        assert sums == pytest.approx(np.ones(6), abs=1e-13)


def test_subdivided_box_in_a_corner_of_nowhere_closes():
    """Turned, far from the origin, with patches of very different sizes that touch along uneven edges."""
    faces = box_faces((2, 1, 3))
    cut = [cells(f, *steps) for f, steps in zip(faces, ((3, 5), (7, 2), (1, 1), (4, 4), (2, 9), (1, 6)), strict=True)]
    patches = np.concatenate(cut) @ turned(6).T + [100, -200, 50]
    sums = exchange_area_matrix(patches).sum(axis=1) / areas(patches)
    assert np.abs(sums - 1).max() < 1e-10


def sphere(subdivisions):
    """Inward-facing triangles of an octahedron cut finer and blown up, (8 × 4^subdivisions, 3, 3)."""
    signs = np.array([[x, y, z] for x in (1, -1) for y in (1, -1) for z in (1, -1)], dtype=float)
    triangles = np.array([np.diag(s)[:: -int(np.prod(s))] for s in signs])
    for _ in range(subdivisions):
        a, b, c = np.moveaxis(triangles, 1, 0)
        ab, bc, ca = a + b, b + c, c + a
        ab, bc, ca = (m / np.linalg.norm(m, axis=1, keepdims=True) for m in (ab, bc, ca))
        triangles = np.concatenate([np.stack(t, axis=1) for t in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))])
    return triangles


def test_faceted_sphere_closes():
    """2048 facets: every one sees every other, and touches a dozen."""
    facets = sphere(4)
    assert len(facets) == 2048
    exchange = exchange_area_matrix(facets)
    sums = exchange.sum(axis=1) / areas(facets[:, [0, 1, 2, 2]])
    assert np.abs(sums - 1).max() < 1e-9
    assert np.count_nonzero(exchange) == 2048 * 2047


def test_empty_box_against_its_exact_factors():
    """600 quads whose factors are closed forms (Howell's catalogue) by other software."""
    with np.load(FOLDER / "empty_box.npz") as truth:
        quads, true, area = truth["vertices"][truth["quads"]], truth["F"], truth["area"]
    factors = exchange_area_matrix(quads) / area[:, None]
    assert np.abs(factors - true).max() < 1e-12
    assert ((factors == 0) == (true == 0)).all()
    assert np.abs(factors / np.where(true > 0, true, 1) - 1)[true > 0].max() < 1e-9
    assert np.abs(factors.sum(axis=1) - 1).max() < 1e-11


# Calling


def test_same_bits_for_any_threads_and_any_call():
    patches = np.concatenate([cells(face, 5, 4) for face in box_faces((2, 1, 3))])
    exchange = exchange_area_matrix(patches, threads=1)
    assert (exchange == exchange_area_matrix(patches, threads=3)).all()
    assert (exchange == exchange_area_matrix(patches, patches, threads=2)).all()
    assert (exchange == exchange.T).all()
    i, j = np.divmod(np.arange(len(patches) ** 2), len(patches))
    assert (exchange.ravel() == exchange_areas(patches[i], patches[j])).all()


def test_triangles_padded_or_not():
    triangles = sphere(1)
    assert (exchange_area_matrix(triangles) == exchange_area_matrix(triangles[:, [0, 1, 2, 2]])).all()


def test_no_polygons():
    none = np.zeros((0, 4, 3))
    assert exchange_areas(none, none).shape == (0,)
    assert exchange_area_matrix(none).shape == (0, 0)
    assert exchange_area_matrix(FLOOR[None], none).shape == (1, 0)


def test_a_polygon_without_area_exchanges_nothing():
    assert exchange_area(FLOOR, [[0, 0, 1], [1, 1, 1], [0, 0, 1], [1, 1, 1]]) == 0.0


def test_quads_bent_by_rounding_or_by_a_tenth_of_a_degree_are_taken():
    bent = ceiling(1.0)
    bent[0, 2] += 0.5 * math.radians(0.1) * math.sqrt(2)
    assert exchange_area(FLOOR, bent) == pytest.approx(exchange_area(FLOOR, ceiling(1.0)), rel=2e-3)


def test_a_bent_quad_in_the_plane_of_another_is_cut_into_six_corners():
    """Its corners lie on either side in turn, as those of a wall's patches do where files hold rounded numbers."""
    bend, out = 2e-4, np.zeros((MAX_CORNERS, 3))
    saddle = FLOOR + bend * np.array([[0, 0, 1], [0, 0, -1], [0, 0, 1], [0, 0, -1]])
    heights = saddle[:, 2] + bend / 2
    assert clip_to_front(saddle, 4, heights, 1e-12, out) == MAX_CORNERS
    assert 0 <= exchange_area(FLOOR * 3 - [1, 1, 0], saddle - [0, 0, bend / 2]) < bend
    assert 0 <= exchange_area(FLOOR * 3 - [1, 1, 0], saddle[::-1] + [0, 0, bend / 2]) < 1.0


@pytest.mark.parametrize(
    ("polygon", "says"),
    [
        ([[0, 0, 0], [1, 0, 0], [1, np.nan, 0], [0, 1, 0]], "polygon 1 are not finite"),
        ([[0, 0, 0], [1, 0, 0], [1, 1, 0.1], [0, 1, 0]], "polygon 1 is not a planar convex quad"),
        ([[0, 0, 0], [1, 0, 0], [0.2, 0.2, 0], [0, 1, 0]], "polygon 1 is not a planar convex quad"),
    ],
)
def test_corners_that_are_no_polygon_are_refused(polygon, says):
    with pytest.raises(GeometryError, match=says):
        exchange_area_matrix([FLOOR, polygon])


def test_shapes_that_do_not_fit_are_refused():
    with pytest.raises(GeometryError, match=r"polygons_b have shape \(1, 5, 3\)"):
        exchange_areas(FLOOR[None], np.zeros((1, 5, 3)))
    with pytest.raises(ParameterError, match="1 polygons_a and 2 polygons_b"):
        exchange_areas(FLOOR[None], np.stack([FLOOR, FLOOR]))


# Negative controls: the simpler ways, which these tests would notice


def logs_by_gauss(p, q, points):
    """Double contour integral with one plain Gauss rule per edge, nothing split and nothing in closed form."""
    x, w = np.polynomial.legendre.leggauss(points)
    x, w = 0.5 * (x + 1), 0.5 * w
    total = 0.0
    for a, b in zip(p, np.roll(p, -1, axis=0), strict=True):
        for c, d in zip(q, np.roll(q, -1, axis=0), strict=True):
            from_a, from_c = a + x[:, None] * (b - a), c + x[:, None] * (d - c)
            distance = np.linalg.norm(from_a[:, None] - from_c, axis=2)
            total += (b - a) @ (d - c) * (w @ np.log(distance) @ w)
    return total / (2 * math.pi)


def test_unsplit_edges_would_be_noticed():
    true = exchange_area(FLOOR, ceiling(1.0))
    assert logs_by_gauss(FLOOR, ceiling(1.0), 12) == pytest.approx(true, abs=1e-9), "the control works where it may"
    near = exchange_area(FLOOR, ceiling(1e-3))
    assert abs(logs_by_gauss(FLOOR, ceiling(1e-3), 12) - near) > 1e-4


def test_contours_alone_would_lose_far_pairs():
    """Edges of far polygons cancel: why areas are integrated there."""
    far = ceiling(1e5)
    assert exchange_area(FLOOR, far) == pytest.approx(1e-10 / math.pi, rel=1e-9)
    assert abs(logs_by_gauss(FLOOR, far, 6) * math.pi * 1e10 - 1) > 1e-7


def test_integrals_over_areas_would_fail_on_polygons_that_touch():
    x, w = np.polynomial.legendre.leggauss(8)
    x, w = 0.5 * (x + 1), 0.5 * w
    u, z, v = x[:, None, None], x[:, None], x - x[:, None, None, None]
    weight = w[:, None, None, None] * w[:, None, None] * w[:, None] * w
    by_areas = (weight * u * z / (math.pi * (u**2 + z**2 + v**2) ** 2)).sum()
    assert abs(by_areas - 0.200043776075403) > 1e-3
