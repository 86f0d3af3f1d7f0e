"""Shooting: one column a shot, from stored factors or from rows on demand."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from radiosity.errors import FormFactorError, MemoryLimitError, SolverError
from radiosity.form_factors.on_demand import RowsOnDemand
from radiosity.solvers import ConjugateGradient, Direct, Neumann, Shooting
from radiosity.transport import TransportOperator
from tests.systems import closed_box, facing_walls


def test_first_shots_by_hand():
    """Walls that see each other by 0.2: the bright one shoots, then the other."""
    T = facing_walls(0.2, reflectance=[0.5, 0.8])
    steps = list(Shooting(shots=1, maxiter=2).iterate(T, np.array([10.0, 1.0])))
    assert_array_equal(steps[0].radiosity, [10.0, 1.0])
    assert_array_equal(steps[0].unshot, [10.0, 1.0])
    assert_allclose(steps[1].radiosity, [10.0, 1.0 + 0.8 * 0.2 * 10.0], rtol=1e-15)
    assert_allclose(steps[1].unshot, [0.0, 2.6], rtol=1e-15)
    assert_allclose(steps[2].radiosity, [10.0 + 0.5 * 0.2 * 2.6, 2.6], rtol=1e-15)
    assert_allclose(steps[2].unshot, [0.26, 0.0], rtol=1e-15)


def test_what_is_left_over_is_one_bounce_of_the_unshot_light():
    T, E = closed_box(40, seed=1, reflectance=(0.1, 0.9)), np.random.default_rng(0).random((40, 3))
    for step in Shooting(shots=7, maxiter=20).iterate(T, E):
        assert_allclose(T @ step.unshot, T.residual(step.radiosity, E), atol=1e-13)


def test_emissions_in_any_memory_order():
    T = closed_box(20, seed=5, reflectance=(0.1, 0.9))
    E = np.asfortranarray(np.random.default_rng(0).random((20, 3, 4)))
    exact = Direct().solve(T, E).radiosity
    for x0 in (None, np.asfortranarray(0.9 * exact)):
        assert_allclose(Shooting(rtol=1e-10).solve(T, E, x0=x0).radiosity, exact, rtol=1e-8)


def test_light_only_grows():
    T, E = closed_box(40, seed=2, reflectance=(0.1, 0.9)), np.random.default_rng(0).random((40, 3))
    exact = Direct().solve(T, E).radiosity
    steps = list(Shooting(shots=10).iterate(T, E))
    for before, after in pairwise(steps):
        assert np.all(after.radiosity >= before.radiosity) and np.all(after.radiosity <= exact * (1 + 1e-12))


def test_the_lamp_shoots_first_so_few_shots_light_the_room():
    T, E = closed_box(400, seed=3, reflectance=(0.4, 0.6)), np.zeros((400, 3))
    E[:2] = 100.0
    exact = Direct().solve(T, E).radiosity
    *_, last = Shooting(shots=2, maxiter=1).iterate(T, E)
    direct = Neumann(maxiter=1).solve(T, E).radiosity
    assert_allclose(last.radiosity, direct, rtol=0.01)  # the direct light, from 2 of 400 columns
    assert np.linalg.norm(last.radiosity - exact) < np.linalg.norm(E - exact)


def test_rows_on_demand_give_the_same_light():
    T, E = closed_box(50, seed=4, reflectance=(0.1, 0.8), sky=0.2), np.random.default_rng(0).random((50, 3))
    asked = []

    def row(i):
        asked.append(i)
        return T.factors.row(i)

    rows = RowsOnDemand.of(row, T.area, to_sky=T.factors.to_sky)
    on_demand = TransportOperator(rows, reflectance=T.reflectance)
    shot = Shooting(rtol=1e-9).solve(on_demand, E, sky=[1.0, 1.0, 1.0])
    stored = Shooting(rtol=1e-9).solve(T, E, sky=[1.0, 1.0, 1.0])
    assert_allclose(shot.radiosity, stored.radiosity, rtol=1e-7)
    assert shot.statistics["solver/rows"] == len(asked) == shot.statistics["solver/shots"]
    series = Neumann(rtol=1e-10).solve(on_demand, E, sky=[1.0, 1.0, 1.0])
    assert_allclose(series.radiosity, stored.radiosity, rtol=1e-7)
    assert_allclose(on_demand.loss(E), T.loss(E), atol=1e-14)


def test_rows_on_demand_are_checked():
    rows = RowsOnDemand.of(lambda _: [0.0, 1.1], area=[1.0, 1.0])
    with pytest.raises(FormFactorError, match=r"row 0 of F .* sums with sky and backs to 1\.1"):
        Shooting().solve(TransportOperator(rows, reflectance=0.5), np.ones(2))
    with pytest.raises(FormFactorError, match="row 1 of F"):
        RowsOnDemand.of(lambda _: [np.nan, 1.0], area=[1.0, 1.0]).row(1)


def test_what_needs_a_matrix_says_so():
    rows = RowsOnDemand.of(lambda i: np.eye(2)[1 - i], area=[1.0, 1.0])
    T = TransportOperator(rows, reflectance=0.5)
    with pytest.raises(MemoryLimitError, match="use Shooting or Neumann"):
        Direct().solve(T, np.ones(2))
    with pytest.raises(SolverError, match="needs stored form factors"):
        ConjugateGradient().solve(T, np.ones(2))


def test_the_number_of_shots_is_checked():
    with pytest.raises(SolverError, match="shots is 0"):
        Shooting(shots=0)
