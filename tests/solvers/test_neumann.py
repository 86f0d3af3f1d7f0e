"""The series: each order by itself, its end, and what it says when it has none."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from radiosity.errors import SolverError
from radiosity.form_factors.factors import FormFactors
from radiosity.solvers import Neumann
from radiosity.transport import TransportOperator
from tests.systems import closed_box, facing_walls


@pytest.mark.parametrize("reflectance", [0.2, 0.5, 0.9])
def test_furnace_by_order(reflectance):
    """Uniform emission in a closed box: order k is ρ^k E, the total E / (1 - ρ)."""
    factors = closed_box(30, seed=0, absorptance=0.5).factors
    T = TransportOperator(factors, reflectance=reflectance)
    for step in Neumann(rtol=1e-13).iterate(T, np.full((30, 1), 7.0)):
        assert_allclose(step.term, 7.0 * reflectance**step.order, rtol=1e-12)
        assert_allclose(step.power, 7.0 * reflectance**step.order * T.area.sum(), rtol=1e-12)
        assert_allclose(step.residual, 7.0 * reflectance ** (step.order + 1), rtol=1e-11)
    assert_allclose(step.radiosity, 7.0 / (1.0 - reflectance), rtol=1e-11)


def test_partial_sums_and_orders():
    T, E = closed_box(20, seed=1, reflectance=(0.1, 0.9)), np.random.default_rng(0).random((20, 3))
    steps = list(Neumann(rtol=1e-8).iterate(T, E))
    result = Neumann(rtol=1e-8).solve(T, E)
    assert_array_equal(result.orders, [step.term for step in steps])
    assert_array_equal(result.radiosity, steps[-1].radiosity)
    assert_array_equal(result.history, [step.residual for step in steps])
    assert_allclose(result.orders.sum(axis=0), result.radiosity, rtol=1e-14)
    assert_allclose(result.orders, T.orders(E, count=len(steps) - 1), rtol=0, atol=0)
    assert result.converged and result.status.startswith("converged")
    assert result.statistics["solver/products"] == len(steps)


def test_residual_is_that_of_the_equation():
    T, E = closed_box(20, seed=2, reflectance=(0.1, 0.9), sky=0.2), np.random.default_rng(0).random((20, 3))
    for step in Neumann(maxiter=6).iterate(T, E, sky=[1.0, 2.0, 3.0]):
        from_equation = T.norm(T.residual(step.radiosity, T.source(E, [1.0, 2.0, 3.0])))
        assert_allclose(step.residual, from_equation, rtol=1e-10)


def test_sky_alone_lights_order_one():
    T = facing_walls(0.2, reflectance=[0.5, 0.8])
    result = Neumann(rtol=1e-12).solve(T, np.zeros((2, 1)), sky=[1.0])
    assert_array_equal(result.orders[0], 0.0)
    assert_array_equal(result.orders[1], T.from_sky([1.0]))


def test_a_first_guess_is_used():
    T, E = closed_box(20, seed=3, reflectance=(0.1, 0.9)), np.random.default_rng(0).random((20, 3))
    exact = Neumann(rtol=1e-14).solve(T, E).radiosity
    cold = Neumann(rtol=1e-8).solve(T, E)
    warm = Neumann(rtol=1e-8).solve(T, E, x0=exact * (1 + 1e-5))
    assert len(warm.history) < len(cold.history) / 2
    assert_allclose(warm.radiosity, exact, rtol=1e-6)
    assert warm.orders is None


def test_it_ends_when_no_light_is_left():
    """A wall that sees nothing but the black one: order 2 is exactly zero."""
    T = facing_walls(0.5, reflectance=[0.9, 0.0])
    result = Neumann(rtol=0.0).solve(T, np.array([[0.0], [4.0]]))
    assert result.converged and len(result.orders) == 2
    assert_allclose(result.radiosity, [[1.8], [4.0]], rtol=1e-15)


def test_black_scene_is_its_emission_bitwise():
    E = np.random.default_rng(0).random((30, 1))
    result = Neumann().solve(closed_box(30, seed=0, absorptance=1.0), E)
    assert_array_equal(result.radiosity, E)
    assert len(result.orders) == 1 and result.converged


def test_what_is_not_converged_says_so_and_the_tail_helps():
    T, E = closed_box(40, seed=4, reflectance=(0.7, 0.8)), np.random.default_rng(0).random((40, 3))
    exact = Neumann(rtol=1e-14).solve(T, E).radiosity
    plain, tail = Neumann(maxiter=4).solve(T, E), Neumann(maxiter=4, tail=True).solve(T, E)
    assert not plain.converged and "not converged after 4 bounces" in plain.status
    assert len(plain.orders) == 5 and "tail" not in plain.status
    error = [np.linalg.norm(r.radiosity - exact) / np.linalg.norm(exact) for r in (plain, tail)]
    assert error[1] < 0.1 * error[0]
    assert not tail.converged and "geometric tail" in tail.status and "an estimate" in tail.status
    assert_allclose(tail.history[-1], T.norm(T.residual(tail.radiosity, E)))


def test_orders_kept_within_the_memory_cap():
    T, E = closed_box(20, seed=5, reflectance=(0.5, 0.9)), np.random.default_rng(0).random((20, 3))
    full = Neumann().solve(T, E)
    capped = Neumann(keep_bytes=3 * E.nbytes).solve(T, E)
    assert_array_equal(capped.orders, full.orders[:3])
    assert_array_equal(capped.radiosity, full.radiosity)
    assert f"Of {len(full.orders) - 1} orders 0 … 2 are kept" in capped.status
    none = Neumann(keep_bytes=0).solve(T, E)
    assert none.orders is None and "None of" in none.status


def test_a_series_that_does_not_fall_is_refused():
    """Raw rows that gather slightly more than 1 (within the rounding allowed) at a reflectance of 1 - 1e-9."""
    grow = FormFactors.from_matrix([[0.0, 1.0 + 5e-7], [1.0, 0.0]], area=[1.0, 1.0], to_sky=[0.0, 0.0])
    T = TransportOperator(grow, absorptance=1e-9)
    with pytest.raises(SolverError, match="spectral radius of channel 0 lies between"):
        Neumann().solve(T, np.ones((2, 1)))


def test_many_emissions_at_once():
    T, E = closed_box(25, seed=6, reflectance=(0.1, 0.9)), np.random.default_rng(0).random((25, 3, 7))
    together = Neumann(rtol=1e-10).solve(T, E)
    assert together.radiosity.shape == E.shape and together.history.shape[1:] == (3, 7)
    for s in range(7):
        alone = Neumann(rtol=1e-10).solve(T, E[..., s])
        shared = len(alone.orders)
        assert_array_equal(together.orders[:shared, ..., s], alone.orders)
        assert_allclose(together.radiosity[..., s], alone.radiosity, rtol=1e-8)
    mixed = Neumann(rtol=1e-12).solve(T, E @ np.arange(7.0)).radiosity
    assert_allclose(together.radiosity @ np.arange(7.0), mixed, rtol=1e-8)
