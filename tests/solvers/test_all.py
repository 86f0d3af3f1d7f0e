"""What every solver does alike: the answer, the words, the refusals."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from radiosity.errors import NoSteadyState, SolverError
from radiosity.form_factors.factors import FormFactors
from radiosity.result import Result, Step
from radiosity.solvers import Direct, Shooting
from radiosity.solvers.admission import without_end
from radiosity.transport import TransportOperator
from tests.solvers.table import ITERATIVE, RAW, SOLVERS, each
from tests.systems import chain_of_rooms, closed_box, exchange_to_factors, random_exchange

TRUTH = Path(__file__).parents[1] / "truth"

CUBE = [0.7, 0.7, 0.63, 0.14, 0.5, 0.9]  # floor, ceiling (emits 1), left, right, back, front
CUBE_TOTAL = [
    0.28963482693133, 1.1669221354814, 0.26404803588828, 0.064266331463387, 0.21448678648317, 0.35992098031722,
]  # fmt: skip


def cube(absorptance=None):
    """Zone model of the unit cube, one patch a face; opposite faces by Howell C-11, adjacent by C-14."""
    opposite = 0.19982489569838746
    F = np.full((6, 6), (1.0 - opposite) / 4.0)
    np.fill_diagonal(F, 0.0)
    for a, b in ((0, 1), (2, 3), (4, 5)):
        F[a, b] = F[b, a] = opposite
    factors = FormFactors.from_matrix(F, np.ones(6))
    return TransportOperator(factors, reflectance=CUBE if absorptance is None else None, absorptance=absorptance)


@each(SOLVERS)
def test_cube_zone_model(solver):
    E = np.array([0.0, 1.0, 0.0, 0.0, 0.0, 0.0])
    result = solver(rtol=1e-13).solve(cube(), E)
    assert result.radiosity.shape == (6,)
    assert_allclose(result.radiosity, CUBE_TOTAL, rtol=5e-13)


@each(SOLVERS)
def test_empty_box(solver):
    with np.load(TRUTH / "empty_box.npz") as file:
        data = {key: file[key] for key in file}
    T = TransportOperator(FormFactors.from_matrix(data["F"], data["area"]), reflectance=data["albedo"])
    result = solver(rtol=1e-11).solve(T, data["emission"])
    assert_allclose(result.radiosity, data["total_disc"], rtol=2e-9)


@each(SOLVERS)
def test_result_and_steps(solver):
    T, E = closed_box(40, seed=1, reflectance=(0.1, 0.9), sky=0.1), np.random.default_rng(0).random((40, 3))
    seen = []
    method = solver(rtol=1e-8)
    result = method.solve(T, E, sky=[1.0, 0.5, 0.2], callback=seen.append)
    assert isinstance(result, Result) and all(isinstance(step, Step) for step in seen)
    steps = list(method.iterate(T, E, sky=[1.0, 0.5, 0.2]))
    assert len(steps) == len(seen) == len(result.history)
    for one, other in zip(steps, seen, strict=True):
        assert_array_equal(one.radiosity, other.radiosity)
        assert_allclose(one.power, np.sum(T.area[:, None] * one.term, axis=0), rtol=1e-12)
    assert_array_equal(result.radiosity, steps[-1].radiosity)
    assert_allclose(sum(step.term for step in steps), result.radiosity, rtol=1e-12)
    assert result.converged and result.status.startswith(f"converged: {solver.__name__}")
    assert result.statistics["solver/products"] >= 1
    source = T.source(E, [1.0, 0.5, 0.2])
    assert np.all(result.history[-1] <= 1e-8 * T.norm(source))


@each(SOLVERS)
def test_residual_is_computed_from_the_equation(solver):
    T, E = closed_box(40, seed=2, reflectance=(0.1, 0.9), sky=0.1), np.random.default_rng(0).random((40, 3))
    for step in solver(rtol=1e-6).iterate(T, E, sky=[1.0, 0.5, 0.2]):
        from_equation = T.norm(T.residual(step.radiosity, T.source(E, [1.0, 0.5, 0.2])))
        assert_allclose(step.residual, from_equation, rtol=1e-6, atol=1e-13)


@each(RAW)
def test_raw_factors_have_one_answer(solver):
    """Rows as sampled, not symmetric: gathering and shooting use the same matrix."""
    rng = np.random.default_rng(3)
    F = rng.random((60, 60)) * (rng.random((60, 60)) < 0.3)
    factors = FormFactors.from_matrix(F / F.sum(axis=1, keepdims=True), rng.random(60) + 0.1)
    T, E = TransportOperator(factors, reflectance=rng.random((60, 3)) * 0.9), rng.random((60, 3))
    dense = [np.linalg.solve(np.eye(60) - T.matrix(c).toarray(), E[:, c]) for c in range(3)]
    assert_allclose(solver(rtol=1e-12).solve(T, E).radiosity, np.transpose(dense), rtol=1e-10)


@each(SOLVERS)
def test_sky_light(solver):
    T = closed_box(50, seed=4, reflectance=(0.1, 0.9), sky=0.4)
    sky = np.array([2.0, 1.0, 0.0])
    result = solver(rtol=1e-12).solve(T, np.zeros((50, 3)), sky=sky)
    for c in range(3):
        dense = np.linalg.solve(np.eye(50) - T.matrix(c).toarray(), np.pi * 0.4 * T.reflectance[:, c] * sky[c])
        assert_allclose(result.radiosity[:, c], dense, rtol=1e-10, atol=1e-300)


@each(ITERATIVE)
def test_first_guess(solver):
    T, E = closed_box(60, seed=5, reflectance=(0.3, 0.95), sky=0.1), np.random.default_rng(0).random((60, 3))
    exact = Direct().solve(T, E, sky=[1.0, 1.0, 1.0]).radiosity
    cold = solver(rtol=1e-9).solve(T, E, sky=[1.0, 1.0, 1.0])
    for factor in (1.0 + 1e-5, 1.0 - 1e-5):
        warm = solver(rtol=1e-9).solve(T, E, sky=[1.0, 1.0, 1.0], x0=exact * factor)
        assert warm.history[0].max() < 1e-3 * cold.history[0].max()
        assert_allclose(warm.radiosity, exact, rtol=1e-7)


@each(SOLVERS)
def test_many_emissions_and_many_skies(solver):
    T, rng = closed_box(30, seed=6, reflectance=(0.1, 0.9), sky=0.2), np.random.default_rng(0)
    E, sky = rng.random((30, 3, 5)), rng.random((3, 5))
    together = solver(rtol=1e-11).solve(T, E, sky=sky)
    for s in range(5):
        alone = solver(rtol=1e-11).solve(T, E[..., s], sky=sky[:, s])
        assert_allclose(together.radiosity[..., s], alone.radiosity, rtol=1e-9)


@each(SOLVERS)
def test_black_scene_gives_its_emission_bitwise(solver):
    E = np.random.default_rng(0).random((30, 1)) * np.logspace(-30, 30, 30)[:, None]
    result = solver().solve(closed_box(30, seed=0, absorptance=1.0), E)
    assert_array_equal(result.radiosity, E)
    assert result.converged


@each(SOLVERS)
def test_some_black_surfaces(solver):
    rho = np.where(np.arange(30) % 3 == 0, 0.0, 0.8)
    T, E = TransportOperator(closed_box(30, seed=0, absorptance=1.0).factors, reflectance=rho), np.ones(30)
    dense = np.linalg.solve(np.eye(30) - T.matrix(0).toarray(), E)
    assert_allclose(solver(rtol=1e-12).solve(T, E).radiosity, dense, rtol=1e-10)


@each(SOLVERS)
def test_no_light_at_all(solver):
    result = solver().solve(closed_box(10, seed=0, absorptance=0.1), np.zeros((10, 1)))
    assert result.converged
    assert_array_equal(result.radiosity, 0.0)


def two_enclosures(first=20, second=15):
    """Two rooms that exchange no light at all."""
    G = np.zeros((first + second, first + second))
    G[:first, :first] = random_exchange(first, seed=7)
    G[first:, first:] = random_exchange(second, seed=8)
    return exchange_to_factors(G)


@each(SOLVERS)
def test_an_enclosure_without_light_is_exactly_dark(solver):
    T = TransportOperator(two_enclosures(), reflectance=0.8)
    E = np.where(np.arange(35) < 20, 1.0, 0.0)[:, None]
    result = solver(rtol=1e-9).solve(T, E)
    assert_allclose(result.radiosity[:20], 5.0, rtol=1e-7)
    assert_array_equal(result.radiosity[20:], 0.0)


@each(SOLVERS)
def test_bright_and_faint_in_separate_enclosures(solver):
    """1e30 beside 1e-30 W/m²: each is right to 1e-9."""
    T = TransportOperator(two_enclosures(), reflectance=np.where(np.arange(35) < 20, 0.5, 0.9))
    E = np.where(np.arange(35) < 20, 1e30, 1e-30)[:, None] * np.random.default_rng(0).random((35, 1))
    result = solver(rtol=1e-11).solve(T, E)
    assert result.converged
    dense = np.eye(35) - T.matrix(0).toarray()
    assert_allclose(result.radiosity[:20], np.linalg.solve(dense[:20, :20], E[:20]), rtol=1e-9)
    assert_allclose(result.radiosity[20:], np.linalg.solve(dense[20:, 20:], E[20:]), rtol=1e-9)
    if solver not in (Direct, Shooting):  # which shoots by power
        alone = solver(rtol=1e-11).solve(T, np.where(E < 1.0, E, 0.0))
        assert len(result.history) <= 2 * len(alone.history)  # the bright one does not keep the faint one waiting


@each(SOLVERS)
def test_bright_and_faint_lamps_in_one_enclosure(solver):
    E = np.where(np.arange(35) == 0, 1e30, 1e-30)[:, None]
    T = closed_box(35, seed=9, absorptance=0.5)
    assert_allclose(solver(rtol=1e-11).solve(T, E).radiosity, Direct().solve(T, E).radiosity, rtol=1e-9)


@each(SOLVERS)
def test_reflectance_one_in_a_lit_enclosure_is_refused(solver):
    rho = np.where(np.arange(35) < 20, 0.5, 1.0)
    T, E = TransportOperator(two_enclosures(), reflectance=rho), np.ones((35, 1))
    watts = T.area[20:].sum()
    with pytest.raises(NoSteadyState, match=rf"{watts:.6g} W are put into an enclosure .* 15 patches \(patches 20, 21"):
        solver().solve(T, E)


@each(SOLVERS)
def test_reflectance_one_where_no_light_comes_is_dark_with_a_note(solver):
    rho = np.where(np.arange(35) < 20, 0.5, 1.0)
    E = np.where(np.arange(35) < 20, 1.0, 0.0)[:, None]
    result = solver(rtol=1e-9).solve(TransportOperator(two_enclosures(), reflectance=rho), E)
    assert_allclose(result.radiosity[:20], 2.0, rtol=1e-7)
    assert_array_equal(result.radiosity[20:], 0.0)
    assert "15 patches (patches 20, 21, 22, 23, 24, …) lose no light of channel 0" in result.status


@each(RAW)
def test_light_that_cannot_get_out_is_refused_wherever_it_comes_from(solver):
    """Raw rows: patches 0 and 1 see only each other, 2 and 3 see them too; 4 loses light, 3 leads to it."""
    F = np.zeros((5, 5))
    F[0, 1] = F[1, 0] = 1.0
    F[2, 0] = F[2, 3] = F[3, 1] = F[3, 4] = F[4, 2] = F[4, 3] = 0.5
    T = TransportOperator(FormFactors.from_matrix(F, np.ones(5)), reflectance=[1.0, 1.0, 1.0, 1.0, 0.5])
    assert_array_equal(without_end(T, 0), [True, True, False, False, False])
    with pytest.raises(NoSteadyState, match="1 W are put into an enclosure .* 2 patches"):
        solver().solve(T, np.array([1.0, 0.0, 0.0, 0.0, 0.0]))
    fine = solver(rtol=1e-12).solve(T, np.array([0.0, 0.0, 0.0, 0.0, 1.0]))
    assert_array_equal(fine.radiosity[:2], 0.0)
    assert_allclose(
        fine.radiosity,
        np.append([0.0, 0.0], np.linalg.solve(np.eye(3) - T.matrix(0).toarray()[2:, 2:], [0.0, 0.0, 1.0])),
        rtol=1e-10,
    )


@each(SOLVERS)
def test_reflectance_one_on_some_walls_is_fine(solver):
    """White walls lose light to the others, or to the sky."""
    rho = np.where(np.arange(30) < 20, 1.0, 0.5)
    T = TransportOperator(closed_box(30, seed=1, absorptance=0.5).factors, reflectance=rho)
    dense = np.linalg.solve(np.eye(30) - T.matrix(0).toarray(), np.ones(30))
    assert_allclose(solver(rtol=1e-12).solve(T, np.ones(30)).radiosity, dense, rtol=1e-9)
    open_room = TransportOperator(closed_box(30, seed=1, absorptance=0.5, sky=0.3).factors, reflectance=1.0)
    assert_allclose(solver(rtol=1e-12).solve(open_room, np.ones(30)).radiosity, 1.0 / 0.3, rtol=1e-9)


@each(SOLVERS)
def test_albedo_rounded_to_float32_is_refused(solver):
    """Negative control: float32(1 - 1e-8) is 1, and such a room has no steady state."""
    factors, E = closed_box(20, seed=2, absorptance=0.5).factors, np.ones((20, 1))
    with pytest.raises(NoSteadyState, match="float32 rounds 1 - 1e-8 to 1"):
        solver().solve(TransportOperator(factors, reflectance=np.float32(1.0 - 1e-8)), E)


@each(SOLVERS)
def test_rows_above_one_never_give_an_answer(solver):
    """Negative control: within the tolerance of a row sum, yet a spectral radius above 1."""
    factors = FormFactors.from_matrix([[0.0, 1.0 + 5e-7], [1.0, 0.0]], area=[1.0, 1.0], to_sky=[0.0, 0.0])
    with pytest.raises(SolverError, match=r"spectral radius of channel 0 .* conserved factors"):
        solver().solve(TransportOperator(factors, absorptance=1e-9), np.ones((2, 1)))


@each(SOLVERS)
def test_what_is_not_finite_is_refused(solver):
    T, E = closed_box(10, seed=0, reflectance=(0.1, 0.9)), np.ones((10, 3))
    E[4, 1] = np.nan
    with pytest.raises(SolverError, match="patch 4, channel 1, is not finite"):
        solver().solve(T, E)
    with pytest.raises(SolverError, match="sky radiance .* is not finite"):
        solver().solve(T, np.ones((10, 3)), sky=[1.0, np.inf, 1.0])


@each(SOLVERS)
@pytest.mark.parametrize("unit", [1e-200, 1e200])
def test_any_unit_will_do(solver, unit):
    """Squares of such light are not float64 numbers."""
    T, E = closed_box(20, seed=3, absorptance=0.2), np.random.default_rng(0).random((20, 1))
    result = solver(rtol=1e-11).solve(T, unit * E)
    assert_allclose(result.radiosity / unit, Direct().solve(T, E).radiosity, rtol=1e-9)


@each(SOLVERS)
def test_overflow_is_foreseen(solver):
    with pytest.raises(SolverError, match="more than a float64 holds"):
        solver().solve(closed_box(10, seed=0, absorptance=1e-12), np.full((10, 1), 1e295))


@each(SOLVERS)
def test_atol_alone_can_stop_it(solver):
    T, E = closed_box(20, seed=3, absorptance=0.2), np.ones((20, 1))
    loose = solver(rtol=0.0, atol=0.01).solve(T, E)
    assert loose.converged and loose.history[-1].max() <= 0.01


@each(ITERATIVE)
def test_maxiter_says_what_to_do(solver):
    T, E = closed_box(60, seed=4, absorptance=1e-3), np.random.default_rng(0).random((60, 1))
    result = solver(rtol=1e-14, maxiter=3).solve(T, E)
    assert not result.converged and result.status.startswith("not converged after 3")
    assert "maxiter" in result.status or "more steps" in result.status


@pytest.mark.parametrize("parameters", [{"rtol": -1.0}, {"atol": -1.0}, {"maxiter": -1}, {"rtol": np.nan}])
@each(SOLVERS)
def test_parameters_are_checked(solver, parameters):
    with pytest.raises(SolverError):
        solver(**parameters)


@each(SOLVERS)
def test_factors_are_left_alone(solver):
    T, E = closed_box(30, seed=5, reflectance=(0.1, 0.9)), np.random.default_rng(0).random((30, 3))
    matrix, emission = T.factors.matrix.copy(), E.copy()
    solver().solve(T, E)
    assert_array_equal(T.factors.matrix.toarray(), matrix.toarray())
    assert_array_equal(E, emission)


@each(SOLVERS)
def test_same_bits_for_any_threads(solver):
    factors, E = chain_of_rooms(3, 100, 0.05), np.random.default_rng(0).random((300, 3))
    rho = np.random.default_rng(1).random((300, 3))
    one, two = (solver(rtol=1e-9).solve(TransportOperator(factors, reflectance=rho, threads=t), E) for t in (1, 2))
    assert_array_equal(one.radiosity, two.radiosity)
