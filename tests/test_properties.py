"""What holds for every scene, on hundreds of rooms that nobody chose: energy, reciprocity, superposition, symmetries.

Rooms are boxes of any proportions, open or closed, whose walls have any paint and light. Each property is held against
`FEW` of them every time, and against `MANY` with ``-m long``; they are the same in every run (see conftest.py).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import radiosity as rad

CUBE = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=float)
WALLS = np.array([[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]])[:, ::-1]
FEW, MANY = 25, 250
# With 64 rays, the correction of a row is larger now and then than the five standard errors that conserved() guesses.
pytestmark = pytest.mark.filterwarnings(r"ignore:conserved\(\) corrects")
RAYS = rad.MonteCarlo(rays=64, sampling="random", light_rays=0)

lengths = st.floats(0.2, 5.0)
shares = st.one_of(st.just(0.0), st.floats(1e-3, 0.99))
light = st.one_of(st.just(0.0), st.floats(1e-3, 1e3))


@st.composite
def rooms(draw, holes=True):
    """A box whose walls have two channels of paint and light; perhaps without a wall, under a sky."""
    size = np.array([draw(lengths) for _ in range(3)])
    missing = draw(st.integers(0, 6)) if holes else 6
    surfaces = []
    for k, face in enumerate(WALLS):
        paint, shine = [draw(shares) for _ in range(2)], [draw(light) for _ in range(2)]
        if k != missing:
            material = rad.Material(paint, emission=shine)
            surfaces.append(rad.Surface(f"wall {k}", CUBE * size, face[None], material))
    sky = [draw(light) for _ in range(2)] if missing < 6 else 0.0
    return rad.Scene(surfaces, sky=sky, closed=missing == 6)


def solved(patches, factors):
    """Radiosity, to the last digits."""
    T = rad.TransportOperator(factors, patches)
    return rad.Direct().solve(T, patches.emission, sky=patches.sky).radiosity


def by_rays(scene, estimator=RAYS):
    patches = rad.subdivide(scene)
    return patches, rad.form_factors(patches, estimator, dtype=np.float64)


def exact(scene):
    patches = rad.subdivide(scene)
    return patches, rad.form_factors(patches, rad.Analytic(), dtype=np.float64)


def energy(scene):
    """What is emitted and comes from the sky is absorbed or leaves, with factors that close and are reciprocal."""
    patches, factors = by_rays(scene)
    factors = factors.conserved()
    B = solved(patches, factors)
    area, to_sky = patches.area[:, None], factors.to_sky[:, None]
    from_sky = np.pi * to_sky * patches.sky
    H = factors.gather(B) + from_sky
    given_ = (area * (patches.emission + from_sky)).sum(axis=0)
    taken = (area * (patches.absorptance * H + to_sky * B)).sum(axis=0)
    assert taken == pytest.approx(given_, rel=1e-11, abs=1e-300)


def reciprocity(scene):
    """A_i F_ij = A_j F_ji: of exact factors, and of conserved sampled ones; rows close."""
    patches, factors = exact(scene)
    for found in (factors, rad.form_factors(patches, RAYS, dtype=np.float64).conserved()):
        G = patches.area[:, None] * found.matrix.toarray()
        assert np.abs(G - G.T).max() <= 1e-12 * G.max()
        total = found.matrix.sum(axis=1) + found.to_sky + found.to_backs
        assert total == pytest.approx(np.ones(len(patches)), abs=1e-12)


def superposition(scene, weight, power, seed):
    """Light of two lamps is the sum of their lights; a lamp 2^k times as bright gives exactly 2^k times the light."""
    patches, factors = by_rays(scene)
    one, other = np.random.default_rng(seed).uniform(0, 1, (2, *patches.emission.shape))
    T = rad.TransportOperator(factors, patches)

    def orders(emission):
        return T.orders(emission, count=4)

    both = orders(one + weight * other)
    apart = orders(one) + weight * orders(other)
    assert both == pytest.approx(apart, rel=1e-12, abs=1e-15 * apart.max())
    assert np.array_equal(orders(2.0**power * one), 2.0**power * orders(one))


def scale_by_powers_of_two_changes_no_bit(scene, power):
    patches, factors = by_rays(scene)
    scaled = [replace(s, vertices=s.vertices * 2.0**power) for s in scene.surfaces]
    larger, same = by_rays(replace(scene, surfaces=scaled))
    assert np.array_equal(larger.area, patches.area * 4.0**power)
    for name in ("data", "indices", "indptr"):
        assert np.array_equal(getattr(factors.matrix, name), getattr(same.matrix, name))
    assert np.array_equal(factors.to_sky, same.to_sky)
    assert np.array_equal(solved(patches, factors), solved(larger, same))


def rigid_motion_changes_nothing(scene, seed):
    """Exact factors to rounding; rays start alike, and only those at an edge meet another wall."""
    rng = np.random.default_rng(seed)
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    turn[:, 0] *= np.linalg.det(turn)
    shift = rng.normal(size=3) * 10.0
    moved = replace(scene, surfaces=[replace(s, vertices=s.vertices @ turn.T + shift) for s in scene.surfaces])
    (patches, factors), (_, again) = exact(scene), exact(moved)
    assert again.matrix.toarray() == pytest.approx(factors.matrix.toarray(), abs=1e-9)
    (_, factors), (_, again) = by_rays(scene), by_rays(moved)
    other_wall = np.abs(again.matrix.toarray() - factors.matrix.toarray()).sum() / 2
    assert other_wall <= 0.001 * len(patches)


def order_of_surfaces_is_chance(scene, order):
    """Other rays for each wall, but the same expectation: within six standard errors of the binomial."""
    order = [k for k in order if k < len(scene.surfaces)]
    patches, factors = by_rays(scene)
    _, again = by_rays(replace(scene, surfaces=[scene.surfaces[k] for k in order]))
    F, other = factors.matrix.toarray(), np.zeros((len(patches),) * 2)
    other[np.ix_(order, order)] = again.matrix.toarray()
    _, truth = exact(scene)
    p = truth.matrix.toarray()
    error = np.sqrt(2 * p * (1 - p) / RAYS.rays) + 1.0 / RAYS.rays
    assert (np.abs(F - other) < 6 * error).all()
    assert (np.abs(F - p) < 6 * error).all()


def monotone_in_paint_and_light(scene, seed):
    """Nothing grows darker where a wall is painted brighter or a lamp turned up."""
    patches, factors = by_rays(scene)
    rng = np.random.default_rng(seed)
    some = rng.random(patches.emission.shape) < 0.3
    reflectance = np.where(some, np.minimum(0.995, patches.reflectance * 1.1 + 0.01), patches.reflectance)
    brighter = replace(patches, reflectance=reflectance, absorptance=1.0 - reflectance)
    shining = replace(patches, emission=np.where(some, patches.emission * 1.5 + 1.0, patches.emission))
    before = solved(patches, factors)
    for changed in (brighter, shining):
        after = solved(changed, factors)
        assert (after >= before * (1 - 1e-12)).all()
    assert (after[some] > before[some]).all()


def light_is_at_least_what_is_emitted(scene):
    """0 ≤ E ≤ B, and no order is negative; B is no more than the brightest source allows."""
    patches, factors = by_rays(scene)
    T = rad.TransportOperator(factors, patches)
    orders = T.orders(patches.emission, sky=patches.sky, count=6)
    B = solved(patches, factors)
    assert (orders >= 0).all()
    assert (patches.emission <= B).all()
    assert (orders.sum(axis=0) * (1 - 1e-12) <= B).all()
    source = patches.emission + patches.reflectance * np.pi * factors.to_sky[:, None] * patches.sky
    most = source.max(axis=0) / (1.0 - patches.reflectance.max(axis=0))
    assert (most * (1 + 1e-12) >= B).all()


PROPERTIES = {
    energy: (rooms(),),
    reciprocity: (rooms(),),
    superposition: (
        rooms(),
        st.floats(1e-3, 1e3),
        st.integers(-40, 40),
        st.integers(0, 2**32 - 1),
    ),
    scale_by_powers_of_two_changes_no_bit: (
        rooms(),
        st.integers(-30, 30),
    ),
    rigid_motion_changes_nothing: (
        rooms(),
        st.integers(0, 2**32 - 1),
    ),
    order_of_surfaces_is_chance: (
        rooms(),
        st.permutations(range(6)),
    ),
    monotone_in_paint_and_light: (
        rooms(),
        st.integers(0, 2**32 - 1),
    ),
    light_is_at_least_what_is_emitted: (rooms(),),
}


def hold(function, examples):
    """Hold a property against rooms that hypothesis draws."""
    settings(max_examples=examples)(given(*PROPERTIES[function])(function))()


@pytest.mark.parametrize("function", PROPERTIES, ids=lambda function: function.__name__)
def test_property(function):
    hold(function, FEW)


@pytest.mark.long
@pytest.mark.parametrize("function", PROPERTIES, ids=lambda function: function.__name__)
def test_property_on_many_rooms(function):
    hold(function, MANY)
