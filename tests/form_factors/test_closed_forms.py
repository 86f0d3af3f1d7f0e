"""Closed forms: the catalogue's printed formulas in 50 digits, integrals done another way, closure, and limits."""

from __future__ import annotations

import functools
import itertools
import math

import mpmath
import numpy as np
import pytest
from mpmath import mpf

from radiosity.errors import ParameterError
from radiosity.form_factors import closed_forms as cf

LENGTHS = (1e-6, 1e-3, 0.1, 1.0, 30.0, 1e5)


@pytest.fixture(autouse=True)
def _many_digits():
    with mpmath.workdps(60):
        yield


legendre = functools.cache(np.polynomial.legendre.leggauss)


def gauss(low, high, points=40):
    x, w = legendre(points)
    return low + 0.5 * (high - low) * (x + 1), 0.5 * (high - low) * w


def printed_c11(a, b, c):
    """Howell C-11 as printed."""
    x, y = mpf(a) / mpf(c), mpf(b) / mpf(c)
    p, q = mpmath.sqrt(1 + y**2), mpmath.sqrt(1 + x**2)
    logs = mpmath.log(mpmath.sqrt((1 + x**2) * (1 + y**2) / (1 + x**2 + y**2)))
    angles = x * p * mpmath.atan(x / p) + y * q * mpmath.atan(y / q) - x * mpmath.atan(x) - y * mpmath.atan(y)
    return 2 / (mpmath.pi * x * y) * (logs + angles)


def printed_c14(w, h, length):
    """Howell C-14 as printed."""
    w, h = mpf(w) / mpf(length), mpf(h) / mpf(length)
    w2, h2 = w**2, h**2
    r = mpmath.sqrt(w2 + h2)
    product = (1 + w2) * (1 + h2) / (1 + w2 + h2)
    product *= (w2 * (1 + w2 + h2) / ((1 + w2) * (w2 + h2))) ** w2
    product *= (h2 * (1 + h2 + w2) / ((1 + h2) * (h2 + w2))) ** h2
    angles = w * mpmath.atan(1 / w) + h * mpmath.atan(1 / h) - r * mpmath.atan(1 / r)
    return (angles + mpmath.log(product) / 4) / (mpmath.pi * w)


def printed_offset(term, first, second):
    """Howell C-13 and C-15 as printed: sixteen terms with alternating signs."""
    (x, y), (xi, eta) = first, second
    total = mpf(0)
    for i, j, k, m in itertools.product((0, 1), repeat=4):
        total += (-1) ** (i + j + k + m) * term(mpf(x[i]), mpf(y[j]), mpf(xi[k]), mpf(eta[m]))
    return total / (2 * mpmath.pi * (mpf(x[1]) - mpf(x[0])) * (mpf(y[1]) - mpf(y[0])))


def printed_c13(x, y, xi, eta, z):
    def term(x, y, xi, eta):
        p, q = mpmath.sqrt((x - xi) ** 2 + mpf(z) ** 2), mpmath.sqrt((y - eta) ** 2 + mpf(z) ** 2)
        angles = (y - eta) * p * mpmath.atan((y - eta) / p) + (x - xi) * q * mpmath.atan((x - xi) / q)
        return angles - mpf(z) ** 2 / 2 * mpmath.log((x - xi) ** 2 + (y - eta) ** 2 + mpf(z) ** 2)

    return printed_offset(term, (x, y), (xi, eta))


def printed_c15(x, y, eta, xi):
    def term(x, y, xi, eta):
        p2, v = x**2 + xi**2, y - eta
        if p2 == 0:
            return v**2 * mpmath.log(v**2) / 4 if v else mpf(0)
        k = v / mpmath.sqrt(p2)
        return v * mpmath.sqrt(p2) * mpmath.atan(k) - p2 * (1 - k**2) * mpmath.log(p2 * (1 + k**2)) / 4

    return printed_offset(term, (x, y), (xi, eta))


@pytest.mark.parametrize(("a", "b"), list(itertools.product(LENGTHS, LENGTHS)))
def test_parallel_rectangles_keep_their_digits_at_every_ratio(a, b):
    assert cf.parallel_rectangles(a, b, 1.0) == pytest.approx(float(printed_c11(a, b, 1.0)), rel=1e-14)


@pytest.mark.parametrize(("width", "height"), list(itertools.product(LENGTHS, LENGTHS)))
def test_perpendicular_rectangles_keep_their_digits_at_every_ratio(width, height):
    factor = cf.perpendicular_rectangles(width, height, 1.0)
    assert factor == pytest.approx(float(printed_c14(width, height, 1.0)), rel=1e-14)


@pytest.mark.parametrize(
    ("sides", "factor"),
    [((1, 1, 1), 0.199824895698387), ((2, 1, 1), 0.28587538485071), ((10, 10, 1), 0.82699452239726)],
)
def test_parallel_rectangles_against_published_values(sides, factor):
    assert cf.parallel_rectangles(*sides) == pytest.approx(factor, abs=5e-15)


@pytest.mark.parametrize(
    ("sides", "factor"),
    [((1, 1, 1), 0.200043776075403), ((1, 2, 1), 0.23285260279536), ((4, 3, 4), 0.17931680315063)],
)
def test_perpendicular_rectangles_against_published_values(sides, factor):
    assert cf.perpendicular_rectangles(*sides) == pytest.approx(factor, abs=5e-15)


PARALLEL = [  # x, y, xi, eta, distance
    ((0, 1), (0, 1), (0, 1), (0, 1), 1.0),
    ((0, 1), (0, 1), (1, 2), (0, 1), 1.0),
    ((0, 2), (0, 1), (0.5, 1.5), (2, 3), 0.5),
    ((0, 0.1), (0, 0.1), (5, 5.2), (3, 3.4), 2.0),
    ((0, 1), (0, 1), (0, 1), (0, 1), 1e-3),
    ((0, 1), (0, 1), (0.2, 0.2 + 1e-6), (-0.3, -0.3 + 3e-6), 0.1),  # tiny and near
    ((-4, 5), (-5, 5), (0, 1e-3), (0, 1e-3), 0.01),
    ((-4, 5), (-5, 5), (0, 1e-3), (0, 1e-3), 1e-5),  # tiny, close under a huge one
    ((0, 1e-4), (0, 1e-4), (300, 300 + 1e-4), (0, 1e-4), 50.0),  # far
    ((0, 1), (0, 2), (1e4, 1e4 + 1), (0, 1), 1e4),
]


@pytest.mark.parametrize("place", PARALLEL)
def test_offset_parallel_rectangles_near_far_tiny_and_huge(place):
    assert cf.parallel_rectangles_offset(*place) == pytest.approx(float(printed_c13(*place)), rel=3e-13)


PERPENDICULAR = [  # x, y, eta, xi
    ((0, 1), (0, 1), (0, 1), (0, 1)),
    ((1, 2), (0, 1), (0, 1), (1, 2)),
    ((0.5, 1.5), (0, 1), (2, 4), (0.25, 1)),
    ((0, 4), (0, 4), (0, 4), (0, 2)),
    ((0, 1), (0, 1), (1, 2), (0, 1)),  # touching at a corner
    ((0.2, 0.4), (0.2, 0.4), (3, 3.2), (1, 1.5)),
    ((0.5, 0.5 + 1e-6), (0.1, 0.1 + 1e-6), (0, 1), (0, 1)),  # tiny and near
    ((0, 5), (0, 5), (2, 2 + 1e-5), (0.3, 0.3 + 1e-5)),
    ((200, 200.1), (0, 0.1), (0, 0.1), (100, 100.2)),  # far
    ((0, 1e-6), (0, 1e-6), (-0.4, 0.6), (0, 1)),  # tiny, touching a huge one
    ((0, 1), (0, 1), (0.3, 0.3 + 1e-5), (1e-7, 1e-5)),
]


@pytest.mark.parametrize("place", PERPENDICULAR)
def test_offset_perpendicular_rectangles_near_far_tiny_and_huge(place):
    assert cf.perpendicular_rectangles_offset(*place) == pytest.approx(float(printed_c15(*place)), rel=3e-13)


def test_offset_rectangles_obey_reciprocity():
    for x, y, xi, eta, z in PARALLEL:
        there = cf.parallel_rectangles_offset(x, y, xi, eta, z) * (x[1] - x[0]) * (y[1] - y[0])
        back = cf.parallel_rectangles_offset(xi, eta, x, y, z) * (xi[1] - xi[0]) * (eta[1] - eta[0])
        assert there == pytest.approx(back, rel=1e-12)
    for x, y, eta, xi in PERPENDICULAR:
        there = cf.perpendicular_rectangles_offset(x, y, eta, xi) * (x[1] - x[0]) * (y[1] - y[0])
        back = cf.perpendicular_rectangles_offset(xi, eta, y, x) * (xi[1] - xi[0]) * (eta[1] - eta[0])
        assert there == pytest.approx(back, rel=1e-12)


@pytest.mark.parametrize(("a", "b", "c"), [(1, 1, 1), (3, 0.2, 1), (1, 1, 1e-3), (1e-3, 1, 4)])
def test_walls_of_a_box_close(a, b, c):
    floor_to_ceiling = cf.parallel_rectangles(a, b, c)
    walls = 2 * cf.perpendicular_rectangles(a, c, b) + 2 * cf.perpendicular_rectangles(b, c, a)
    assert floor_to_ceiling + walls == pytest.approx(1.0, abs=1e-14)


def rectangle_by_quadrature(element, normal, low, high, plane, facing):
    """∬ cos θ cos θ' / π r² over a rectangle normal to axis `plane`, by a Gauss rule."""
    axes = [k for k in range(3) if k != plane]
    (u, wu), (v, wv) = (gauss(low[k], high[k]) for k in range(2))
    points = np.zeros((len(u), len(v), 3))
    points[..., axes[0]], points[..., axes[1]], points[..., plane] = u[:, None], v, facing[plane]
    ray = points - element
    r2 = (ray**2).sum(axis=-1)
    towards = np.zeros(3)
    towards[plane] = -math.copysign(1.0, facing[plane] - element[plane])
    return wu @ ((ray @ normal) * -(ray @ towards) / (math.pi * r2**2)) @ wv


@pytest.mark.parametrize(("a", "b", "c"), [(1, 1, 1), (2, 0.3, 1), (0.5, 0.5, 2), (2, 3, 1)])
def test_elements_to_rectangles_by_quadrature(a, b, c):
    origin = np.zeros(3)
    above = rectangle_by_quadrature(origin, np.array([0, 0, 1.0]), (0, 0), (a, b), 2, (0, 0, c))
    assert cf.element_to_parallel_rectangle(a, b, c) == pytest.approx(above, rel=1e-10)
    ahead = rectangle_by_quadrature(origin, np.array([0, 0, 1.0]), (0, 0), (b, a), 0, (c, 0, 0))
    assert cf.element_to_perpendicular_rectangle(a, b, c) == pytest.approx(ahead, rel=1e-10)


def test_elements_to_rectangles_against_published_values():
    assert cf.element_to_parallel_rectangle(1, 1, 1) == pytest.approx(0.13853160599489, abs=5e-15)
    assert cf.element_to_perpendicular_rectangle(1, 1, 1) == pytest.approx(0.055734197002554, abs=5e-15)


def test_elements_to_rectangles_at_their_limits():
    assert cf.element_to_parallel_rectangle(1e9, 1e9, 1.0) == pytest.approx(0.25, abs=1e-9)
    assert cf.element_to_parallel_rectangle(1e-9, 1e-9, 1.0) == pytest.approx(1e-18 / math.pi, rel=1e-14)
    assert cf.element_to_perpendicular_rectangle(1e9, 1e9, 1.0) == pytest.approx(0.25, abs=1e-9)
    assert cf.element_to_perpendicular_rectangle(1.0, 1e9, 0.0) == pytest.approx(0.25, abs=1e-9)
    low = cf.element_to_perpendicular_rectangle(1e-6, 1.0, 1.0)  # height² × (1/2 + π/4) / 4π, to first order
    assert low == pytest.approx(1e-12 * (0.5 + math.pi / 4) / (4 * math.pi), rel=1e-9)


def disk_by_quadrature(element, normal, radius):
    """∬ cos θ cos θ' / π r² over a disk about the origin of the plane z = 0."""
    (s, ws), turn = gauss(0, radius, 60), 2 * math.pi * np.arange(400) / 400
    points = np.stack([s[:, None] * np.cos(turn), s[:, None] * np.sin(turn), np.zeros((60, 400))], axis=-1)
    ray = points - element
    r2 = (ray**2).sum(axis=-1)
    kernel = (ray @ normal) * abs(element[2]) / (math.pi * r2**2)
    return float((ws * s) @ kernel.sum(axis=1)) * 2 * math.pi / 400


@pytest.mark.parametrize(("radius", "height", "offset"), [(1, 1, 0), (1, 0.7, 0.4), (2, 1, 3), (0.5, 2, 5)])
def test_elements_to_disks_by_quadrature(radius, height, offset):
    element = np.array([offset, 0.0, height])
    parallel = disk_by_quadrature(element, np.array([0, 0, -1.0]), radius)
    assert cf.element_to_parallel_disk(radius, height, offset) == pytest.approx(parallel, rel=1e-9)
    if offset >= radius:
        upright = disk_by_quadrature(element, np.array([-1.0, 0, 0]), radius)
        assert cf.element_to_perpendicular_disk(radius, height, offset) == pytest.approx(upright, rel=1e-9)


def sphere_by_quadrature(sine, angle):
    """∫ cos θ / π over the directions of a cap of given angular radius that are above the horizon."""
    cap = math.asin(sine)
    (polar, weight), (turn, turn_weight) = gauss(0, cap, 400), gauss(0, math.pi, 400)
    up = np.cos(polar)[:, None] * math.cos(angle) + np.sin(polar)[:, None] * math.sin(angle) * np.cos(turn)
    return 2 * float((weight * np.sin(polar)) @ np.maximum(up, 0) @ turn_weight) / math.pi


@pytest.mark.parametrize("angle", [0.0, 0.5, 1.2, 1.4, math.pi / 2, 1.7, 2.0])
@pytest.mark.parametrize("sine", [0.1, 0.5, 0.95])
def test_element_to_sphere_with_the_horizon_across_it(sine, angle):
    factor = cf.element_to_sphere(radius=sine, distance=1.0, angle=angle)
    assert factor == pytest.approx(sphere_by_quadrature(sine, angle), abs=3e-6)


def test_element_to_sphere_has_no_step_where_the_horizon_meets_it():
    for sine in (0.1, 0.7):
        for edge in (math.acos(sine), math.acos(-sine)):
            below, above = (cf.element_to_sphere(sine, 1.0, edge + d) for d in (-1e-9, 1e-9))
            assert below == pytest.approx(above, abs=3e-9)
            assert min(below, above) >= 0.0
    assert cf.element_to_sphere(0.5, 1.0, math.pi) == 0.0


@pytest.mark.parametrize(("first", "second", "distance"), [(1, 1, 1), (1, 2, 1), (2, 1, 1), (0.5, 0.5, 2), (3, 1, 0.2)])
def test_coaxial_disks_are_means_over_elements(first, second, distance):
    ends = [0.0, min(first, second), first]
    mean = 0.0
    for low, high in itertools.pairwise(ends):
        rings, weight = gauss(low, high, 200)
        mean += weight @ (2 * rings / first**2 * [cf.element_to_parallel_disk(second, distance, r) for r in rings])
    assert cf.coaxial_disks(first, second, distance) == pytest.approx(mean, rel=1e-9)
    there = first**2 * cf.coaxial_disks(first, second, distance)
    assert there == pytest.approx(second**2 * cf.coaxial_disks(second, first, distance), rel=1e-14)


def test_coaxial_disks_against_published_values_and_limits():
    assert cf.coaxial_disks(1, 1, 1) == pytest.approx(0.38196601125011, abs=5e-15)
    assert cf.coaxial_disks(1, 1, 0.1) == pytest.approx(0.9048750780275, abs=5e-14)
    assert cf.coaxial_disks(1e-6, 1e-6, 1.0) == pytest.approx(1e-12, rel=1e-11)
    assert cf.coaxial_disks(1e-6, 1e6, 1.0) == pytest.approx(1.0, abs=2e-12)


@pytest.mark.parametrize(("sphere", "disk", "distance"), [(0.5, 1, 1), (1, 3, 1), (0.1, 0.2, 4)])
def test_sphere_and_disk_are_means_over_elements(sphere, disk, distance):
    rings, weight = gauss(0, disk, 100)
    seen = [cf.element_to_sphere(sphere, math.hypot(r, distance), math.atan2(r, distance)) for r in rings]
    mean = weight @ (2 * rings / disk**2 * seen)
    assert cf.coaxial_disk_to_sphere(disk, sphere, distance) == pytest.approx(mean, rel=1e-6)
    back = mean * math.pi * disk**2 / (4 * math.pi * sphere**2)
    assert cf.sphere_to_coaxial_disk(disk, distance) == pytest.approx(back, rel=1e-6)


def test_sphere_factors_are_solid_angles():
    assert cf.sphere_to_coaxial_disk(1, 1) == pytest.approx((1 - math.sqrt(0.5)) / 2, abs=1e-16)
    assert cf.sphere_to_coaxial_disk(1e9, 1) == pytest.approx(0.5, abs=1e-9)
    assert cf.sphere_to_coaxial_disk(1e-9, 1) == pytest.approx(1e-18 / 4, rel=1e-14)
    assert cf.sphere_to_rectangle(1, 1, 1) == pytest.approx(1 / 24, abs=1e-16)
    assert cf.sphere_to_rectangle(2, 1, 1) == pytest.approx(0.054488222893878, abs=5e-15)
    (u, wu), (v, wv) = gauss(0, 3), gauss(0, 0.5)
    solid_angle = wu @ (1 / (u[:, None] ** 2 + v**2 + 1) ** 1.5) @ wv
    assert cf.sphere_to_rectangle(3, 0.5, 1) == pytest.approx(solid_angle / (4 * math.pi), rel=1e-12)


def test_concentric_spheres_close_and_obey_reciprocity():
    for inner in (1e-6, 0.3, 0.999999):
        there, back, itself, *_ = cf.concentric_spheres(inner, 1.0)
        assert back + itself == pytest.approx(1.0, abs=1e-15)
        assert inner**2 * there == pytest.approx(back, rel=1e-15)


def coaxial_by_quadrature(inner, outer, length):
    """Factors from outer to inner and to itself: along the axis in closed form, around it by a Gauss rule."""

    def along(d2):
        d, z = np.sqrt(d2), length
        return z * (z / (2 * d2 * (d2 + z * z)) + np.arctan(z / d) / (2 * d**3)) + 0.5 / (d2 + z * z) - 0.5 / d2

    edge = math.acos(inner / outer)
    turn, weight = gauss(0, edge, 200)
    d2 = inner**2 + outer**2 - 2 * inner * outer * np.cos(turn)
    cosines = (outer * np.cos(turn) - inner) * (outer - inner * np.cos(turn))
    to_inner = 4 * inner * float(weight @ (cosines * along(d2))) / (math.pi * length)
    turn, weight = gauss(0, 2 * edge, 200)
    d2 = 2 * outer**2 * (1 - np.cos(turn))
    cosines = (outer * (1 - np.cos(turn))) ** 2
    return to_inner, 4 * outer * float(weight @ (cosines * along(d2))) / (math.pi * length)


@pytest.mark.parametrize(("inner", "outer", "length"), [(1, 2, 1), (1, 2, 5), (0.3, 0.9, 2), (1, 1.1, 0.5)])
def test_coaxial_cylinders_by_quadrature(inner, outer, length):
    factors = cf.coaxial_cylinders(inner, outer, length)
    to_inner, itself = coaxial_by_quadrature(inner, outer, length)
    assert factors.outer_to_inner == pytest.approx(to_inner, rel=1e-9)
    assert factors.outer_to_itself == pytest.approx(itself, rel=1e-9)
    assert factors.inner_to_outer * inner == pytest.approx(factors.outer_to_inner * outer, rel=1e-15)
    assert factors.inner_to_outer + factors.inner_to_ends == pytest.approx(1.0, abs=1e-15)


def test_long_coaxial_cylinders_tend_to_infinite_ones():
    for long, endless in zip(cf.coaxial_cylinders(1, 2, 1e6), cf.coaxial_cylinders(1, 2), strict=True):
        assert long == pytest.approx(endless, abs=3e-6)
    thin = cf.coaxial_cylinders(1e-9, 1.0, 2.0)
    assert thin.outer_to_itself == pytest.approx(cf.cylinder_interior(1.0, 2.0).wall_to_itself, abs=1e-8)


@pytest.mark.parametrize("height", [1e-8, 0.1, 1.0, 2.0, 4.0, 1e8])
def test_cylinder_closes_and_obeys_reciprocity(height):
    factors = cf.cylinder_interior(1.0, height)
    assert factors.wall_to_itself + 2 * factors.wall_to_base == pytest.approx(1.0, abs=1e-15)
    assert factors.base_to_base + factors.base_to_wall == pytest.approx(1.0, abs=1e-15)
    assert factors.base_to_wall == pytest.approx(2 * height * factors.wall_to_base, rel=1e-14)
    assert factors.base_to_base == pytest.approx(cf.coaxial_disks(1.0, 1.0, height), rel=1e-13)
    assert min(factors) > 0.0


def test_cone_is_the_limit_of_itself():
    assert cf.cone_interior(1, 1) == pytest.approx((1 - math.sqrt(0.5), math.sqrt(0.5)), abs=1e-15)
    assert cf.cone_interior(1, 1e-9).side_to_itself == pytest.approx(0.5e-18, rel=1e-14)  # nearly flat
    for height in (0.3, 5.0):
        side_to_itself, side_to_base = cf.cone_interior(2.0, height)
        area = math.pi * 2 * math.hypot(2, height)
        assert area * side_to_base == pytest.approx(math.pi * 4, rel=1e-15)  # all of the base's light
        assert side_to_itself + side_to_base == pytest.approx(1.0, abs=1e-15)


def test_pieces_of_a_sphere():
    assert cf.sphere_interior(math.pi, 1.0) == pytest.approx(0.25, abs=1e-16)
    for angle in (0.1, math.pi / 2, 2.5):
        side_to_itself, side_to_base = cf.spherical_cap_interior(angle)
        cap = 2 * math.pi * (1 - math.cos(angle))
        assert side_to_itself == pytest.approx(cf.sphere_interior(cap, 1.0), rel=1e-13)
        assert cap * side_to_base == pytest.approx(math.pi * math.sin(angle) ** 2, rel=1e-13)


def long_rectangles_by_strips(first, second):
    """Crossed strings, as sums of distances."""
    (a, b), (c, d) = (tuple(map(np.array, s)) for s in (first, second))
    crossed, beside = math.dist(a, d) + math.dist(b, c), math.dist(a, c) + math.dist(b, d)
    return abs(crossed - beside) / (2 * math.dist(a, b))


def test_strips_against_strings_and_each_other():
    assert cf.parallel_strips(1, 1) == pytest.approx(math.sqrt(2) - 1, abs=1e-15)
    assert cf.parallel_strips(1, 1e9) == pytest.approx(0.5e-9, rel=1e-9)
    opposed = cf.crossed_strings(((0, 0), (3, 0)), ((0, 2), (3, 2)))
    assert opposed == pytest.approx(cf.parallel_strips(3, 2), rel=1e-14)
    upright = cf.crossed_strings(((0, 0), (3, 0)), ((0, 0), (0, 2)))
    assert upright == pytest.approx(cf.perpendicular_strips(3, 2), rel=1e-14)
    for angle in (0.0, 1e-8, 1.0, math.pi / 2, math.pi - 1e-8):
        wedge = cf.crossed_strings(((0, 0), (1, 0)), ((0, 0), (math.cos(angle), math.sin(angle))))
        assert cf.strips_in_a_wedge(angle) == pytest.approx(wedge, rel=1e-7, abs=1e-16)
    skew = ((0.2, 0.1), (2, -0.3)), ((1, 1), (3, 4))
    assert cf.crossed_strings(*skew) == pytest.approx(long_rectangles_by_strips(*skew), rel=1e-13)
    assert cf.crossed_strings(((0, 0), (1, 0)), ((1e6, 1e6), (1e6 + 1, 1e6))) == pytest.approx(
        1e12 / (2 * (2e12) ** 1.5), rel=2e-6
    )


def test_strips_are_the_limit_of_long_rectangles():
    assert cf.parallel_rectangles(1e7, 1, 1) == pytest.approx(cf.parallel_strips(1, 1), rel=3e-7)
    assert cf.perpendicular_rectangles(1, 2, 1e7) == pytest.approx(cf.perpendicular_strips(1, 2), rel=3e-7)


def test_triangular_duct_closes():
    assert cf.long_triangular_duct(3, 4, 5) == pytest.approx(1 / 3, abs=1e-16)
    assert cf.long_triangular_duct(3, 4, 5) + cf.long_triangular_duct(3, 5, 4) == pytest.approx(1.0, abs=1e-15)
    assert cf.long_triangular_duct(1, 1e-9, 1) == pytest.approx(0.5e-9, rel=1e-6)


def test_long_cylinders():
    assert cf.parallel_cylinders(1, 0) == pytest.approx(0.5 - 1 / math.pi, abs=1e-15)
    assert cf.parallel_cylinders(1, 1e6) == pytest.approx(1 / (math.pi * (1e6 + 2)), rel=1e-9)
    # Lines that meet both, over all that meet one, which leave it in two directions: offsets at each slope.
    slope, weight = gauss(0, math.asin(2 / 5), 400)
    both = np.clip(2 - 5 * np.sin(slope), 0, 2)
    assert cf.parallel_cylinders(1, 3) == pytest.approx(2 * float(weight @ both) / (4 * math.pi), rel=1e-12)
    assert cf.cylinder_to_strip(1, -1e9, 1e9) == pytest.approx(0.5, abs=1e-9)
    assert cf.cylinder_to_strip(2, 1, 3) == pytest.approx((math.atan(1.5) - math.atan(0.5)) / (2 * math.pi), rel=1e-14)


@pytest.mark.parametrize(
    ("call", "says"),
    [
        (lambda: cf.parallel_rectangles(1, -1, 1), "b is -1"),
        (lambda: cf.perpendicular_rectangles(1, 1, math.nan), "length is nan"),
        (lambda: cf.parallel_rectangles_offset((0, 1), (1, 0), (0, 1), (0, 1), 1), "y runs from 1 to 0"),
        (lambda: cf.perpendicular_rectangles_offset((-1, 1), (0, 1), (0, 1), (0, 1)), "x is -1"),
        (lambda: cf.element_to_perpendicular_disk(2, 1, 1), "horizon"),
        (lambda: cf.element_to_sphere(2, 1), "stay out"),
        (lambda: cf.element_to_sphere(1, 2, 4), "outside 0"),
        (lambda: cf.coaxial_disk_to_sphere(1, 2, 1), "meets the disk"),
        (lambda: cf.concentric_spheres(2, 1), "not less than"),
        (lambda: cf.coaxial_cylinders(1, 2, 0), "length is 0"),
        (lambda: cf.sphere_interior(13, 1), "more than"),
        (lambda: cf.spherical_cap_interior(0), "outside 0"),
        (lambda: cf.crossed_strings(((0, 0), (0, 0)), ((0, 1), (1, 1))), "width"),
        (lambda: cf.strips_in_a_wedge(-1), "outside 0"),
        (lambda: cf.long_triangular_duct(1, 1, 3), "no triangle"),
        (lambda: cf.parallel_cylinders(1, -1), "gap"),
        (lambda: cf.cylinder_to_strip(1, 2, 1), "lower one first"),
    ],
)
def test_lengths_that_mean_nothing_are_refused(call, says):
    with pytest.raises(ParameterError, match=says):
        call()
