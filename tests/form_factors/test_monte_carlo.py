"""Monte Carlo factors: unbiased, closed, converging at their rate, and the same bits for the same seed."""

from __future__ import annotations

import sys

import numpy as np
import pytest

import radiosity as rad
from radiosity.errors import ParameterError
from radiosity.form_factors import monte_carlo
from tests.truths import load


def slope(counts, errors):
    """Exponent of error over count, fitted through all."""
    return np.polyfit(np.log(counts), np.log(errors), 1)[0]


def plain(*args, **kwargs):
    """Counts alone: emitters are not looked at apart."""
    return rad.MonteCarlo(*args, **kwargs, light_rays=0)


def errors_of_empty_box(sampling, counts, seeds):
    """Relative Frobenius error of F, root mean square over seeds, for each count."""
    _, patches, data = load("empty_box")
    true = data["F"]
    found = []
    for rays in counts:
        squares = [
            np.sum((rad.form_factors(patches, plain(rays, seed, sampling)).matrix.toarray() - true) ** 2)
            for seed in seeds
        ]
        found.append(np.sqrt(np.mean(squares) / np.sum(true**2)))
    return found


def test_random_rays_converge_as_one_over_root_rays():
    counts = [64, 256, 1024, 4096]
    assert slope(counts, errors_of_empty_box("random", counts, range(3))) == pytest.approx(-0.5, abs=0.05)


def test_sobol_rays_converge_faster():
    counts = [256, 1024, 4096, 16384]
    errors = errors_of_empty_box("sobol", counts, [0])
    assert -0.9 < slope(counts, errors) <= -0.6
    assert errors[2] < 0.07, "random rays: 0.10"


@pytest.mark.parametrize("sampling", ["random", "sobol"])
def test_standard_errors_are_what_the_errors_are(sampling):
    """Squared errors of all exact factors add up to the squared standard errors, and their mean is no bias."""
    _, patches, data = load("empty_box")
    factors = rad.form_factors(patches, plain(16 * 256, 7, sampling, replicates=16), dtype=np.float64)
    true = data["F"]
    error = factors.matrix.toarray() - true
    assert np.sum(error**2) == pytest.approx(np.sum(factors.standard_error.data**2), rel=0.05)
    wall = np.unique(data["group"], return_inverse=True)[1]
    to_wall = np.eye(wall.max() + 1)[wall]  # sums over a wall: thousands of hits each, so normal
    runs = np.array([run.matrix @ to_wall for run in factors.replicates])
    spread = runs.std(axis=0, ddof=1) / 4
    seen = spread > 0
    z = (runs.mean(axis=0) - true @ to_wall)[seen] / spread[seen]
    assert abs(z.mean()) < 0.15
    assert z.std() == pytest.approx(np.sqrt(15 / 13), rel=0.1), "Student's t with 15 degrees of freedom"


def test_the_binomial_standard_error_is_right():
    _, patches, data = load("empty_box")
    factors = rad.form_factors(patches, rad.MonteCarlo(4096, 3, "random"), dtype=np.float64)
    error = factors.matrix.toarray() - data["F"]
    assert np.sum(error**2) == pytest.approx(np.sum(factors.standard_error.data**2), rel=0.02)
    assert rad.form_factors(patches, rad.MonteCarlo(64)).standard_error is None, "one Sobol run holds no estimate"


@pytest.mark.parametrize("method", [rad.MonteCarlo(128, 5), rad.MonteCarlo(100, 5, "random"), rad.Hemicube(16, 2)])
def test_same_seed_same_bits_for_any_threads_and_batches(method, monkeypatch):
    patches = rad.subdivide(rad.scenes.cornell_box(), patch_count=700)
    first = rad.form_factors(patches, method, threads=1)
    for threads, batch in ((1, 300), (2, 1 << 16), (2, 5_000), (4, 1_000)):
        monkeypatch.setattr(sys.modules[type(method).__module__], "BATCH", batch)
        again = rad.form_factors(patches, method, threads=threads)
        assert (again.matrix.indptr == first.matrix.indptr).all()
        assert (again.matrix.indices == first.matrix.indices).all()
        assert (again.matrix.data == first.matrix.data).all()
        assert (again.to_sky == first.to_sky).all() and (again.to_backs == first.to_backs).all()


def test_another_seed_is_another_estimate():
    patches = rad.subdivide(rad.scenes.cornell_box(), patch_count=300)
    first, second = (rad.form_factors(patches, rad.MonteCarlo(64, seed)) for seed in (0, 1))
    assert abs(first.matrix - second.matrix).max() > 0


def test_every_ray_is_accounted_for():
    patches = rad.subdivide(rad.scenes.cornell_box(), patch_count=700)
    factors = rad.form_factors(patches, plain(256), dtype=np.float64)
    assert (factors.closure_defect == 0.0).all()
    assert 0.0 < factors.to_sky.mean() < 0.5, "the box is open at the front"
    assert factors.statistics["rays/traced"] == 256 * len(patches)
    on_patches = round(float(factors.matrix.sum()) * 256)
    found = on_patches + factors.statistics["rays/to sky"] + factors.statistics["rays/to backs"]
    assert found == factors.statistics["rays/traced"]


def test_replicates_are_independent_and_their_mean_is_the_estimate():
    patches = rad.subdivide(rad.scenes.furnace(), patch_count=150)
    factors = rad.form_factors(patches, rad.MonteCarlo(256, replicates=4), dtype=np.float64)
    runs = [run.matrix.toarray() for run in factors.replicates]
    assert len(runs) == 4
    assert factors.matrix.toarray() == pytest.approx(np.mean(runs, axis=0), abs=1e-15)
    noise = [(run - np.mean(runs, axis=0)).ravel() for run in runs]
    correlation = np.corrcoef(noise)[np.triu_indices(4, 1)]
    assert correlation == pytest.approx(np.full(6, -1 / 3), abs=0.1), "what a common mean leaves, and no more"


@pytest.mark.parametrize(
    ("kwargs", "message"),
    [
        ({"rays": 0}, "rays is 0"),
        ({"rays": 10, "replicates": 3}, "multiple"),
        ({"replicates": 0}, "replicates is 0"),
        ({"seed": -1}, "seed is -1"),
        ({"seed": 0.5}, "seed is 0.5"),
        ({"sampling": "halton"}, "'halton'"),
    ],
)
def test_parameters_that_make_no_estimate(kwargs, message):
    with pytest.raises(ParameterError, match=message):
        rad.MonteCarlo(**kwargs)


def test_directions_are_malleys_method():
    """The kernel's polynomials beside sine and cosine, quarter turns included."""
    rng = np.random.default_rng(0)
    s, t = rng.random(10_000), np.concatenate([np.arange(16) / 16, rng.random(9_984)])
    frame = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    tangent, normal = frame[0], frame[1]
    found = np.empty((10_000, 3))
    for up in (1.0, -1.0):
        monte_carlo.cosine_directions(tangent, normal, up, s, t, found)
        x, y, z = np.sqrt(s) * np.cos(2 * np.pi * t), np.sqrt(s) * np.sin(2 * np.pi * t), np.sqrt(1 - s)
        across = np.cross(up * normal, tangent)
        true = np.outer(x, tangent) + np.outer(y, across) + np.outer(z, up * normal)
        assert found == pytest.approx(true, abs=4e-8)


def test_a_wrong_cosine_is_seen():
    """Negative control: directions uniform over the hemisphere instead of cosine-distributed."""
    _, patches, data = load("empty_box")
    method = rad.MonteCarlo(4096)
    block = monte_carlo.MonteCarloRows(method, patches, monte_carlo.Tracer(patches.grid), 0)
    right = one_row(block, patches, lambda z: z)
    wrong = one_row(block, patches, np.square)  # z uniform instead of z² uniform
    true = data["F"][0]
    assert np.linalg.norm(right - true) < 0.05 * np.linalg.norm(true)
    assert np.linalg.norm(wrong - true) > 0.15 * np.linalg.norm(true)


def one_row(block, patches, bend):
    """Row 0 with the cosine of every direction passed through `bend`."""
    grid, rays = patches.grid, block.rays
    places = monte_carlo.Places(block.tracer.table, patches.face, patches.side, grid.front, grid.back)
    origins, directions = monte_carlo.cosine_rays(places, np.arange(1), rays, block.points, block.run)
    normal = patches.normal[0]
    z = directions @ normal
    flat = directions - z[:, None] * normal
    bent = bend(z)
    scale = np.sqrt((1 - bent**2) / np.maximum(1 - z**2, 1e-12))
    hits = block.tracer.run(origins, (flat * scale[:, None] + bent[:, None] * normal).astype(np.float32))
    return np.bincount(hits[hits >= 0], minlength=len(patches)) / rays
