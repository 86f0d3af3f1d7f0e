"""What a spot check tells of form factors on two levels, against their true error."""

from dataclasses import replace

import numpy as np
import pytest

import radiosity as rad
from radiosity.certificate import sampling
from radiosity.form_factors import spot_check
from radiosity.form_factors.spot_check import evenly_chosen
from radiosity.rays import Tracer
from tests.truths import relative_error

ROUGH = {"rays": 64, "group_rays": 256, "group": 5}
SEEDS = range(4)


def reference(patches):
    T = rad.TransportOperator(rad.form_factors(patches, rad.MonteCarlo(4096, 99)), patches)
    return rad.Neumann(rtol=1e-6).solve(T, patches.emission, patches.sky).radiosity


def told_and_true(patches, true):
    """What the certificate says of each seed, and what is so, (seeds,) each."""
    told, wrong = [], []
    for seed in SEEDS:
        T = rad.TransportOperator(rad.form_factors(patches, rad.TwoLevel(**ROUGH, seed=seed)), patches)
        light = rad.Neumann(rtol=1e-6).solve(T, patches.emission, patches.sky).radiosity
        told.append(rad.certify(T, patches.emission, light, patches.sky).sampling)
        wrong.append(relative_error(patches, light - patches.emission, true - patches.emission))
    return np.array(told), np.array(wrong)


def rms(values):
    return np.sqrt(np.mean(np.square(values)))


@pytest.fixture(scope="module")
def cluttered():
    patches = rad.subdivide(rad.scenes.cluttered_room(8), patch_count=4000)
    return patches, reference(patches)


@pytest.fixture(scope="module")
def white(cluttered):
    patches = replace(cluttered[0], reflectance=np.full_like(cluttered[0].reflectance, 0.98))
    return patches, reference(patches)


def test_the_error_told_is_the_true_one(cluttered):
    told, true = told_and_true(*cluttered)
    assert true.min() > 0.008
    assert 0.75 < rms(told) / rms(true) < 1.33
    assert 0.5 < min(told / true) < max(told / true) < 2.0


def test_one_row_would_tell_its_own_error(cluttered, monkeypatch):
    """Negative control: two independent rows are what keeps their noise out."""
    patches, true = cluttered
    monkeypatch.setattr(spot_check, "LIGHT_RAYS", 2)
    monkeypatch.setattr(spot_check, "RAYS", 16)
    noisy, wrong = told_and_true(patches, true)
    monkeypatch.setattr(spot_check, "REPLICATES", (1 << 20, 1 << 20))
    same, _ = told_and_true(patches, true)
    assert 0.6 < rms(noisy) / rms(wrong) < 1.6
    assert rms(same) > 2.0 * rms(wrong)


def test_the_error_told_in_a_white_room(white):
    """Little is wrong in a row, much after fifty bounces: the balance of energy tells."""
    told, true = told_and_true(*white)
    assert 0.7 < rms(told) / rms(true) < 1.4


def test_rows_alone_do_not_tell_what_bounces_multiply(white, monkeypatch):
    """Negative control: without the balance of energy."""
    monkeypatch.setattr(sampling, "_sums", lambda density, _, label: np.zeros((label.max() + 1, density.shape[1])))
    told, true = told_and_true(*white)
    assert rms(told) < 0.6 * rms(true)


def test_rows_that_are_all_right_but_too_bright(cluttered):
    """5 % more light in every row of what is spread: both terms see it."""
    patches, true = cluttered
    factors = rad.form_factors(patches, rad.TwoLevel(**ROUGH))
    factors.levels.exchange.data *= np.float32(0.95)
    T = rad.TransportOperator(factors, patches)
    light = rad.Neumann(rtol=1e-6).solve(T, patches.emission).radiosity
    told = rad.certify(T, patches.emission, light).sampling
    wrong = relative_error(patches, light - patches.emission, true - patches.emission)
    assert 0.6 < told / wrong < 1.6


def test_under_a_sky():
    """What the sky brings is part of what arrives."""
    patches = rad.subdivide(rad.scenes.open_rug(), patch_count=3000)
    told, true = told_and_true(patches, reference(patches))
    assert 0.6 < rms(told) / rms(true) < 1.6


def test_rows_are_whole_and_the_same_for_any_number_of_threads():
    patches = rad.subdivide(rad.scenes.cornell_box(), patch_count=2000)
    one, two, other = (
        spot_check.spot_check(patches, Tracer(patches.grid), seed, threads)
        for seed, threads in ((0, 1), (0, 3), (1, 1))
    )
    light = np.ones((len(patches), 1))
    assert one.arriving(light, np.ones(1)) == pytest.approx(np.ones((2, len(one.patch), 1)), abs=1e-5)
    assert one.arriving(light, np.zeros(1)).min() < 0.7  # near the open front
    for a, b in zip(one.rows, two.rows, strict=True):
        assert a.data.tobytes() == b.data.tobytes() and a.indices.tobytes() == b.indices.tobytes()
    assert one.rows[0].data.tobytes() != other.rows[0].data.tobytes()
    assert one.rows[0].data.tobytes() != one.rows[1].data.tobytes()


def test_spots_stand_for_equal_areas():
    area = np.r_[np.full(1000, 1.0), np.full(10, 100.0)]
    spots = evenly_chosen(area, 200)
    assert np.sum(spots < 1000) == 100  # half of the area
    assert (np.bincount(spots)[1000:] == 10).all()
