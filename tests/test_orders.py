"""The whole pipeline by order of the Neumann series, against closed forms and other software."""

from __future__ import annotations

import numpy as np
import pytest

import radiosity as rad
from tests.truths import load, relative_error

ESTIMATORS = [rad.MonteCarlo(rays=256), rad.MonteCarlo(rays=100, sampling="random"), rad.Hemicube(resolution=32)]


@pytest.mark.parametrize("estimator", ESTIMATORS, ids=lambda e: type(e).__name__)
@pytest.mark.parametrize("reflectance", [0.2, 0.5, 0.9])
def test_furnace_by_order(estimator, reflectance):
    """In a closed box of one material order k is ρ^k E at every patch, and all of them E / (1 - ρ)."""
    patches = rad.subdivide(rad.scenes.furnace(reflectance=reflectance, emission=2.0), patch_count=300)
    factors = rad.form_factors(patches, estimator, dtype=np.float64)
    T = rad.TransportOperator(factors, patches)
    orders = T.orders(patches.emission, count=12)
    for k, term in enumerate(orders):
        assert term == pytest.approx(np.full_like(term, 2.0 * reflectance**k), rel=1e-12)
    result = rad.Neumann(rtol=1e-13, maxiter=2000).solve(T, patches.emission)
    assert result.radiosity == pytest.approx(np.full_like(result.radiosity, 2.0 / (1 - reflectance)), rel=1e-12)


def errors_by_order(name, estimator):
    """Relative L2 of orders 1 … 6 against the discrete truth, per cent."""
    _, patches, data = load(name)
    T = rad.TransportOperator(rad.form_factors(patches, estimator), patches)
    orders = T.orders(patches.emission, sky=patches.sky, count=6)
    return [100 * relative_error(patches, orders[k], data["B_disc"][k]) for k in range(1, 7)]


@pytest.mark.parametrize("seed", range(3))
def test_open_rug_by_order(seed):
    """A white floor and a red wall under a sky; the sky's light arrives with order 1."""
    errors = errors_by_order("openrug", rad.MonteCarlo(4096, seed))
    assert max(errors) < 0.5, errors


@pytest.mark.parametrize("seed", range(3))
def test_cornell_box_by_order(seed):
    errors = errors_by_order("cornell", rad.MonteCarlo(4096, seed, light_rays=0))
    assert errors[0] < 6 and errors[1] < 2 and max(errors[2:]) < 1, errors
    assert errors[0] > 1, "plain rays cannot be this good at direct light: something compares with itself"


def test_cornell_box_within_its_standard_errors():
    """Orders 1 … 6 of sixteen independent estimates scatter about the truth as their spread says."""
    _, patches, data = load("cornell")
    estimates = []
    for seed in range(16):
        T = rad.TransportOperator(rad.form_factors(patches, rad.MonteCarlo(512, 100 + seed)), patches)
        estimates.append(T.orders(patches.emission, count=6)[1:])
    mean = np.mean(estimates, axis=0)
    error = np.hypot(np.std(estimates, axis=0, ddof=1) / 4, data["stderr_disc"][1:7])
    true = data["B_disc"][1:7]
    lit = (true > 1e-3 * true.max(axis=(1, 2), keepdims=True)) & (error > 0)
    z = (mean - true)[lit] / error[lit]
    assert np.median(np.abs(z)) < 1.2, "0.69 for a t-distribution of 15 degrees, if there is no bias"
    assert np.mean(np.abs(z) > 4) < 0.02
    power = np.einsum("n,knc->kc", patches.area, mean) / np.einsum("n,knc->kc", patches.area, true)
    assert power == pytest.approx(np.ones_like(power), abs=0.01)


def test_hemicubes_of_the_cornell_box_have_their_own_error():
    """Four points: 3 % at every order, aliasing that more orders do not average out."""
    errors = errors_by_order("cornell", rad.Hemicube(64, samples=4))
    assert max(errors) < 5 and min(errors) > 0.5, errors


def test_empty_box_by_order():
    """With the exact factors of the closed form, orders agree to rounding; with rays, to their noise."""
    _, patches, data = load("empty_box")
    exact = rad.FormFactors.from_matrix(data["F"], patches.area)
    orders = rad.TransportOperator(exact, patches).orders(patches.emission, count=12)
    assert relative_error(patches, orders, data["B_disc"]) < 1e-12
    errors = errors_by_order("empty_box", rad.MonteCarlo(4096))
    assert max(errors[2:]) < 1, errors


def test_a_lost_pi_is_seen():
    """Negative control: a sky of radiance L brings π L, not L."""
    _, patches, data = load("openrug")
    T = rad.TransportOperator(rad.form_factors(patches, rad.MonteCarlo(1024)), patches)
    right = T.orders(patches.emission, sky=patches.sky, count=1)[1]
    wrong = T.orders(patches.emission, sky=patches.sky / np.pi, count=1)[1]
    assert relative_error(patches, right, data["B_disc"][1]) < 0.005
    assert relative_error(patches, wrong, data["B_disc"][1]) > 0.5
