"""Random walks agree with other software's answers, within the errors that they state themselves."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import radiosity as rad
from radiosity.errors import ParameterError
from radiosity.face_points import OFFSET
from radiosity.path_tracer import PathTracer, kernels, walks
from radiosity.rays import Tracer
from radiosity.transport import TransportOperator
from tests.test_patches import soup
from tests.truths import load, relative_error


@pytest.fixture(scope="module")
def cornell():
    return load("cornell")


@pytest.fixture(scope="module")
def open_rug():
    return load("openrug")


def surprise(light, expected, order, stated=0.0):
    """Actual over stated error (area-weighted L2): 1 if the standard errors are honest and the answers are the same."""
    weight = light.area[:, None]
    actual = (weight * (light.orders[order] - expected[order]) ** 2).sum()
    return float(np.sqrt(actual / (weight * (light.standard_error[order] ** 2 + stated**2)).sum()))


def mean(runs):
    """The mean of independent runs."""
    orders = np.mean([light.orders for light in runs], axis=0)
    error = np.sqrt(np.sum([light.standard_error**2 for light in runs], axis=0)) / len(runs)
    return replace(runs[0], orders=orders, standard_error=error)


def surprise_in(light, truth, order, kind):
    return surprise(light, truth.data[f"B_{kind}"], order, truth.data[f"stderr_{kind}"][order])


def power_deviation(light, truth, order, kind):
    """(found - true) / standard error of the power of the whole scene, (C,)."""
    area = truth.patches.area
    difference = area @ (light.orders[order] - truth.data[f"B_{kind}"][order])
    return difference / np.sqrt(area**2 @ light.standard_error[order] ** 2)


def test_the_furnace_by_order():
    """Every walk finds the same, whatever it meets: ρ^k E, to the last bit where ρ is a power of two."""
    patches = rad.subdivide(rad.scenes.furnace(reflectance=[0.5, 0.25, 1.0]), patch_count=54)
    for transport in ("patches", "continuous"):
        light = PathTracer(4, transport=transport, bounces=6).solve(patches)
        expected = np.array([0.5, 0.25, 1.0]) ** np.arange(7)[:, None]
        assert (light.orders == expected[:, None, :]).all()
        assert (light.standard_error == 0).all()
        assert light.statistics["rays/leaked"] == 0


@pytest.mark.parametrize("transport", ["patches", "continuous"])
def test_cornell_patch_by_patch(cornell, transport):
    """The error is as large as stated against the answer meant, and larger against the other one.

    Order 1 is the same in both; at order 2 a walk that forgot where it hit would be off by the discretisation error.
    """
    meant, other = ("disc", "cont") if transport == "patches" else ("cont", "disc")
    method = PathTracer(1024, next_event=True, transport=transport, bounces=3)
    runs = [replace(method, seed=seed).solve(cornell.patches) for seed in range(3)]
    together = mean(runs)
    for order in (1, 2, 3):
        surprises = [surprise_in(light, cornell, order, meant) for light in runs]
        assert np.sqrt(np.mean(np.square(surprises))) == pytest.approx(1.0, abs=0.15)
        assert np.abs(power_deviation(together, cornell, order, meant)).max() < 3.5
    assert surprise_in(together, cornell, 2, other) > 1.3


@pytest.mark.parametrize("transport", ["patches", "continuous"])
def test_cornell_without_looking_at_the_lamp(cornell, transport):
    """Few walks find the lamp: large errors, as stated."""
    light = PathTracer(1024, seed=3, transport=transport, bounces=6).solve(cornell.patches)
    kind = "disc" if transport == "patches" else "cont"
    for order in range(1, 7):
        assert surprise_in(light, cornell, order, kind) == pytest.approx(1.0, abs=0.2)
        assert np.abs(power_deviation(light, cornell, order, kind)).max() < 3.5
    assert light.expected_error[1] == pytest.approx(relative_error_of(light, cornell, 1, kind), rel=0.15)


@pytest.mark.parametrize("transport", ["patches", "continuous"])
def test_light_from_the_sky(open_rug, transport):
    """Sky light arrives with order 1."""
    kind = "disc" if transport == "patches" else "cont"
    light = PathTracer(2048, seed=1, transport=transport, bounces=3).solve(open_rug.patches)
    for order in (1, 2):
        assert surprise_in(light, open_rug, order, kind) == pytest.approx(1.0, abs=0.1)
        assert np.abs(power_deviation(light, open_rug, order, kind)).max() < 3.5


def relative_error_of(light, truth, order, kind="disc"):
    return relative_error(truth.patches, light.orders[order], truth.data[f"B_{kind}"][order])


def test_errors_fall_with_the_root_of_the_paths(cornell):
    """Fitted slope of log error over log paths, the orders 1 and 2 of four seeds each."""
    counts = [16, 32, 64, 128, 256]
    for next_event in (True, False):
        squares = np.zeros((len(counts), 2))
        for row, paths in zip(squares, counts, strict=True):
            for seed in range(4):
                light = PathTracer(paths, seed, next_event, bounces=2).solve(cornell.patches)
                row += [relative_error_of(light, cornell, order) ** 2 for order in (1, 2)]
        slopes = np.polyfit(np.log(counts), 0.5 * np.log(squares), 1)[0]
        assert slopes == pytest.approx([-0.5, -0.5], abs=0.05)


def test_looking_at_a_small_lamp_pays(cornell):
    """The same paths, a variance at least 100 times smaller at order 1; the answers agree."""
    plain, looking = (PathTracer(512, 5, next_event, bounces=2).solve(cornell.patches) for next_event in (False, True))
    assert looking.expected_error[1] < 0.1 * plain.expected_error[1]
    assert looking.expected_error[2] < 0.3 * plain.expected_error[2]
    difference = cornell.patches.area @ (plain.orders - looking.orders)[1:].transpose(1, 0, 2).reshape(-1, 6)
    squares = (plain.standard_error**2 + looking.standard_error**2)[1:].transpose(1, 0, 2).reshape(-1, 6)
    assert np.abs(difference / np.sqrt(cornell.patches.area**2 @ squares)).max() < 4


def test_looking_is_harmless_where_everything_shines():
    """Without weights, points of a touching wall would have an infinite variance."""
    patches = rad.subdivide(rad.scenes.furnace(reflectance=0.5), patch_count=54)
    light = PathTracer(1024, next_event=True, bounces=3).solve(patches)
    assert light.expected_error[1:].max() < 0.03
    z = ((light.orders - 0.5 ** np.arange(4)[:, None, None]) / light.standard_error.clip(1e-300))[1:]
    assert np.mean(z**2) == pytest.approx(1.0, abs=0.35)
    assert np.abs(z).max() < 5


def test_two_sided_soup_agrees_with_form_factors():
    """Triangles and quads of any shape, both sides lit; the walks never see the operator assembled here."""
    patches = rad.subdivide(soup(3), patch_count=60)
    patches = replace(patches, sky=np.array([1.0, 0.0, 0.5]))
    assert (patches.side < 0).any() and (patches.faces[:, 3] < 0).any()
    factors = rad.form_factors(patches, rad.MonteCarlo(rays=1 << 15), dtype=np.float64)
    expected = TransportOperator(factors, patches).orders(patches.emission, patches.sky, 3)
    for next_event in (False, True):
        runs = [PathTracer(2048, seed, next_event, bounces=3).solve(patches) for seed in range(6)]
        for order in (1, 2, 3):
            surprises = [surprise(light, expected, order) for light in runs]
            assert np.sqrt(np.mean(np.square(surprises))) == pytest.approx(1.0, abs=0.15)


def test_the_tail_makes_the_sum_whole():
    """In a furnace the sum of all orders is E / (1 - ρ); the first orders keep their bits."""
    patches = rad.subdivide(rad.scenes.furnace(reflectance=[0.5, 0.8]), patch_count=54)
    cut, whole = (PathTracer(512, bounces=2, tail=tail).solve(patches) for tail in (False, True))
    assert (cut.orders == whole.orders).all()
    assert cut.radiosity == pytest.approx(np.broadcast_to([1.75, 2.44], (54, 2)), rel=1e-12)
    z = (whole.radiosity - [2.0, 5.0]) / whole.radiosity_error
    assert np.mean(z**2, axis=0) == pytest.approx([1.0, 1.0], abs=0.5)
    assert np.abs(z.mean(axis=0)).max() < 4 / np.sqrt(54)


def test_the_error_of_the_sum_counts_that_orders_go_together(cornell):
    """A walk that meets the lamp early meets it late less often: not the errors of independent orders."""
    light = PathTracer(512, seed=2, next_event=True, bounces=8, tail=True).solve(cornell.patches)
    weight = light.area[:, None]
    actual = (weight * (light.radiosity - cornell.data["total_disc"]) ** 2).sum()
    stated = (weight * (light.radiosity_error**2 + cornell.data["total_stderr_disc"] ** 2)).sum()
    assert np.sqrt(actual / stated) == pytest.approx(1.0, abs=0.12)


@pytest.mark.parametrize("transport", ["patches", "continuous"])
def test_the_same_bits_for_any_threads_and_batches(monkeypatch, cornell, transport):
    method = PathTracer(48, seed=9, next_event=True, transport=transport, bounces=4, tail=True)
    one = method.solve(cornell.patches, threads=1)
    others = [method.solve(cornell.patches, threads=2)]
    for batch in (7, 1000):
        monkeypatch.setattr("radiosity.path_tracer.walks.BATCH", batch)
        monkeypatch.setattr("radiosity.path_tracer.tracer.BATCH", batch)
        others.append(method.solve(cornell.patches, threads=2))
    for other in others:
        for name in ("orders", "standard_error", "radiosity", "radiosity_error"):
            assert (getattr(one, name) == getattr(other, name)).all()
    another = replace(method, seed=10).solve(cornell.patches)
    assert (another.orders[1:] != one.orders[1:]).any(axis=(1, 2)).all()


def test_a_closed_room_under_a_sky_stays_dark():
    scene = rad.scenes.furnace(emission=0.0)
    patches = replace(rad.subdivide(scene, patch_count=54), sky=np.array([1.0]))
    assert patches.closed
    assert (PathTracer(64).solve(patches).orders == 0).all()


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"paths": 1}, "paths is 1"),
        ({"bounces": 0}, "bounces is 0"),
        ({"transport": "smooth"}, "'smooth'"),
        ({"seed": -1}, "seed is -1"),
    ],
)
def test_what_cannot_be_walked_is_named(wrong, message):
    with pytest.raises(ParameterError, match=message):
        PathTracer(**wrong)


def test_hit_points_are_where_the_rays_end():
    """On triangles, skewed quads and both sides of faces; lifted off the side that was met."""
    patches = rad.subdivide(soup(4), patch_count=500)
    tracer = Tracer(patches.grid)
    rng = np.random.default_rng(3)
    origins = rng.uniform(-0.6, 0.6, (50_000, 3)).astype(np.float32)
    directions = rng.normal(size=(50_000, 3)).astype(np.float32)
    patch, points = tracer.hits(origins, directions)
    assert (patch == tracer.run(origins, directions)).all()
    assert (points[patch < 0] == 0).all()
    hit = patch >= 0
    assert hit.sum() > 500 and (patches.side[patch[hit]] < 0).any()
    normal, centre = patches.normal[patch[hit]], tracer.to_unit(patches.centroid[patch[hit]])
    height = np.einsum("nx,nx->n", points[hit] - centre, normal)
    assert height == pytest.approx(np.full(hit.sum(), OFFSET), rel=1e-3)
    on_face, along = points[hit] - OFFSET * normal - origins[hit], directions[hit].astype(float)
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    beside = np.linalg.norm(np.cross(on_face, along), axis=1)
    cosine = np.abs(np.einsum("nx,nx->n", along, normal))
    assert (np.einsum("nx,nx->n", on_face, along) > 0).all()
    assert (beside * cosine).max() < 3e-5  # the pull inside the face, and float32


def no_cosine(ground, walks, order, origins, directions):
    """Rays uniform over the hemisphere, made from the cosine-distributed ones."""
    kernels.cosine_rays(ground, walks, order, origins, directions)
    normal = ground.table.normal[ground.face[walks.patch]] * ground.side[walks.patch][:, None]
    z = np.einsum("nx,nx->n", directions, normal)
    flat = directions - z[:, None] * normal
    height = 1 - (1 - z**2)  # sin² θ is uniform: as cos θ, it makes the solid angle uniform
    length = np.sqrt(1 - height**2) / np.linalg.norm(flat, axis=1)
    directions[:] = flat * length[:, None] + height[:, None] * normal


def count_twice(ground, *rest):
    """Hits on an emitter count in full, although shadow rays have found it."""
    kernels.meet(ground._replace(density=np.zeros_like(ground.density)), *rest)


def see_through(ground, walks, _, emitter, share, found):
    """Shadow rays reach their emitter whatever they met."""
    kernels.add_seen(ground, walks, emitter[emitter >= 0], emitter, share, found)


@pytest.mark.parametrize(
    ("kernel", "broken"), [("cosine_rays", no_cosine), ("meet", count_twice), ("add_seen", see_through)]
)
def test_a_broken_walk_is_noticed(monkeypatch, cornell, kernel, broken):
    monkeypatch.setattr(walks, kernel, broken)
    light = PathTracer(1024, seed=7, next_event=True, bounces=1).solve(cornell.patches)
    assert np.abs(power_deviation(light, cornell, 1, "disc")).max() > 6
    assert surprise_in(light, cornell, 1, "disc") > 1.5
