"""The bound holds, whatever computed the light, and is not much larger than the error."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from radiosity.errors import SolverError
from radiosity.form_factors.factors import FormFactors
from radiosity.form_factors.on_demand import RowsOnDemand
from radiosity.solvers import ConjugateGradient, Direct, GaussSeidel, Neumann, bound
from radiosity.solvers.bound import error_bound
from radiosity.transport import TransportOperator
from tests.systems import chain_of_rooms, closed_box, exchange_to_factors, random_exchange

ROUNDING = 1e-13  # of the truth, which elimination gives to about 1e-15 √N


def random_factors(rng, kind, largest):
    """Closed, open, rooms in a row, or raw rows without symmetry; 2 … `largest` patches."""
    count = int(2 + (largest - 2) * rng.random() ** 2)
    seed = int(rng.integers(1 << 30))
    if kind == "raw":
        F = rng.random((count, count)) * (rng.random((count, count)) < 0.5) + 1e-3 * np.eye(count)
        return FormFactors.from_matrix(F / F.sum(axis=1, keepdims=True), rng.random(count) + 0.1)
    if kind == "rooms":
        return chain_of_rooms(int(rng.integers(2, 5)), max(2, count // 4), 10.0 ** rng.uniform(-8, 0), seed)
    sky = rng.random() * 10.0 ** rng.uniform(-8, 0) if kind == "open" else 0.0
    return exchange_to_factors(random_exchange(count, seed, density=rng.random()), sky)


def random_system(rng, kind, largest=200):
    """Absorptances log-uniform in 1e-12 … 1, one for all or mixed; some lamps."""
    factors = random_factors(rng, kind, largest)
    shape = len(factors), int(rng.integers(1, 4))
    least = 10.0 ** rng.uniform(-12, 0)
    alpha = least ** rng.random(shape) if rng.random() < 0.5 else np.full(shape, least)
    E = rng.random(shape) * (rng.random(shape) < rng.random())
    E[0] = 1.0
    return TransportOperator(factors, absorptance=alpha), E


def approximate(rng, T, E, true, how):
    """Light as different ways would leave it, unfinished."""
    if how == "bounces":
        return Neumann(maxiter=12).solve(T, E).radiosity
    if how == "gathered":
        return GaussSeidel(maxiter=3).solve(T, E).radiosity
    if how == "noise":
        return true * (1.0 + rng.normal(size=true.shape) * 10.0 ** rng.uniform(-12, -1))
    return ConjugateGradient(rtol=1e-6).solve(T, E).radiosity


def ratio_of_bound(T, E, light, true):
    """Bound over error; None where the error is rounding. Fails where the bound does not hold anywhere."""
    found = error_bound(T, E, light, E)
    error = np.abs(light - true)
    assert np.all(error <= found.bound + ROUNDING * np.abs(true)), (T.shape, np.max(error / found.bound))
    size, whole = (np.sqrt(np.sum(T.area[:, None] * x**2)) for x in (error, true - E))
    if size <= 1e-12 * whole:
        return None
    assert found.relative >= size / whole * (1.0 - 1e-9)
    return found.relative * whole / size


def ratios(count, seed):
    rng = np.random.default_rng(seed)
    kinds, ways = ("closed", "open", "rooms", "raw"), ("bounces", "gathered", "noise", "conjugate")
    found = []
    for k in range(count):
        kind, how = kinds[k % 4], ways[k // 4 % 4]
        T, E = random_system(rng, kind)
        true = Direct().solve(T, E).radiosity
        light = approximate(rng, T, E, true, "bounces" if kind == "raw" and how == "conjugate" else how)
        found.append(ratio_of_bound(T, E, light, true))
    return np.array([r for r in found if r is not None])


@pytest.mark.slow
def test_never_under_and_sharp():
    found = ratios(112, seed=0)
    assert len(found) > 80
    assert np.median(found) <= 1.05 and np.quantile(found, 0.95) <= 2.0 and found.min() >= 1.0 - 1e-9


@pytest.mark.long
def test_never_under_and_sharp_on_many():
    found = ratios(2400, seed=1)
    assert len(found) > 2000
    assert np.median(found) <= 1.05 and np.quantile(found, 0.95) <= 2.0 and found.min() >= 1.0 - 1e-9


@pytest.mark.parametrize("kind", ["closed", "open", "rooms", "raw"])
def test_holds_without_elimination(monkeypatch, kind):
    """As for large systems: conjugate gradients where symmetric, GMRES where not."""
    monkeypatch.setattr(bound, "SMALL", 0)
    rng, found = np.random.default_rng(2), []
    for how in ("bounces", "gathered", "noise") * 6:
        T, E = random_system(rng, kind)
        true = Direct().solve(T, E).radiosity
        found.append(ratio_of_bound(T, E, approximate(rng, T, E, true, how), true))
    assert np.median([r for r in found if r is not None]) <= 2.0


@pytest.mark.parametrize("solver", [Neumann(rtol=1e-6), ConjugateGradient(rtol=1e-6), GaussSeidel(rtol=1e-3)])
def test_converged_light_is_bounded_tightly(solver):
    T, E = closed_box(300, seed=3, reflectance=(0.1, 0.8)), np.random.default_rng(0).random((300, 3))
    true = Direct().solve(T, E).radiosity
    assert 1.0 <= ratio_of_bound(T, E, solver.solve(T, E).radiosity, true) <= 1.3


def test_a_dark_lossless_enclosure_beside_a_lit_one():
    G = np.zeros((30, 30))
    G[:18, :18], G[18:, 18:] = random_exchange(18, seed=4), random_exchange(12, seed=5)
    T = TransportOperator(exchange_to_factors(G), reflectance=np.where(np.arange(30) < 18, 0.95, 1.0))
    E = np.where(np.arange(30) < 18, 1.0, 0.0)[:, None]
    light = Neumann(rtol=1e-3).solve(T, E).radiosity
    found = error_bound(T, E, light, E)
    assert np.all(np.isfinite(found.bound))
    assert_array_equal(found.bound[18:], 0.0)
    assert ratio_of_bound(T, E, light, Direct().solve(T, E).radiosity) < 1.1


def test_no_bound_where_light_would_grow():
    grow = FormFactors.from_matrix([[0.0, 1.0 + 5e-7], [1.0, 0.0]], area=[1.0, 1.0], to_sky=[0.0, 0.0])
    T, E = TransportOperator(grow, absorptance=1e-9), np.ones((2, 1))
    found = error_bound(T, E, 1e6 * E, E)
    assert np.all(np.isinf(found.bound)) and np.isinf(found.relative)


def test_black_and_unlit_have_no_error():
    for T, E in (
        (closed_box(20, seed=6, absorptance=1.0), np.random.default_rng(0).random((20, 1))),
        (closed_box(20, seed=6, absorptance=0.3), np.zeros((20, 1))),
    ):
        found = error_bound(T, E, E, E)
        assert found.bound.max() < 1e-14


def test_rows_on_demand_are_refused():
    rows = RowsOnDemand.of(lambda i: np.eye(2)[1 - i], area=[1.0, 1.0])
    T, E = TransportOperator(rows, reflectance=0.5), np.ones((2, 1))
    with pytest.raises(SolverError, match="stored form factors"):
        error_bound(T, E, E, E)


def test_control_the_plain_residual_norm_does_not_bound():
    """Negative control: the residual itself under-estimates by 1/α, and ‖r‖/α over-estimates a good solver."""
    T, E = TransportOperator(chain_of_rooms(2, 40, 1e-3), absorptance=1e-6), np.zeros((80, 1))
    E[:3] = 1.0
    true = Direct().solve(T, E).radiosity
    light = Neumann(maxiter=12).solve(T, E).radiosity
    residual = T.residual(light, E)
    assert np.abs(residual).max() < 1e-3 * np.abs(true - light).max()
    good = ConjugateGradient(rtol=1e-6).solve(T, E).radiosity
    assert T.norm(T.residual(good, E))[0] / 1e-6 > 100.0 * T.norm(good - true)[0]
    assert ratio_of_bound(T, E, light, true) < 1.5
