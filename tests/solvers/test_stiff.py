"""Where almost nothing is absorbed, and light leaks from room to room: right to 1e-9 in few products."""

from __future__ import annotations

import mpmath
import numpy as np
import pytest
from numpy.testing import assert_allclose

from radiosity.form_factors.factors import FormFactors
from radiosity.solvers import ConjugateGradient, Direct, Neumann
from radiosity.solvers import conjugate_gradient as module
from radiosity.solvers.admission import row_excess
from radiosity.solvers.rooms import slow_modes
from radiosity.transport import TransportOperator
from tests.solvers.oracle import fifty_digits
from tests.solvers.table import STIFF, each
from tests.systems import chain_of_rooms, closed_box

ABSORPTANCES = [1e-1, 1e-3, 1e-6, 1e-9, 1e-12]
MOST_PRODUCTS = 60


def lamp(count, channels=1):
    E = np.zeros((count, channels))
    E[:3] = 1.0
    return E


def energy_defect(T, E, radiosity):
    """(absorbed + lost outside) / emitted - 1; absorbed as A α H."""
    absorbed = T.power(T.absorptance * T.factors.gather(radiosity))
    outside = T.power(T.to_outside[:, None] * radiosity)
    return (absorbed + outside) / T.power(E) - 1.0


def mixed(count, least, seed=0):
    """Absorptances log-uniform between `least` and 1, three channels."""
    return least ** np.random.default_rng(seed).random((count, 3))


@pytest.mark.parametrize("absorptance", ABSORPTANCES)
@each(STIFF)
def test_against_fifty_digits(solver, absorptance):
    for T in (
        closed_box(18, seed=1, absorptance=absorptance),
        TransportOperator(chain_of_rooms(2, 9, 1e-4), absorptance=absorptance),
        TransportOperator(chain_of_rooms(2, 9, 1e-2), absorptance=mixed(18, absorptance)),
    ):
        E = lamp(18, T.channels)
        result = solver(rtol=1e-12).solve(T, E)
        for c in range(T.channels):
            assert_allclose(result.radiosity[:, c], fifty_digits(T, E, c), rtol=1e-9)
        assert np.abs(energy_defect(T, E, result.radiosity)).max() <= 1e-12
        assert result.statistics["solver/products"] <= MOST_PRODUCTS


@pytest.mark.parametrize("absorptance", ABSORPTANCES)
@each(STIFF)
def test_furnace_closed_form(solver, absorptance):
    T = closed_box(300, seed=2, absorptance=absorptance)
    result = solver(rtol=1e-12).solve(T, np.full((300, 1), 3.0))
    assert_allclose(result.radiosity * absorptance, 3.0, rtol=1e-9)


@pytest.mark.parametrize("absorptance", ABSORPTANCES)
def test_grey_body_closed_form(absorptance):
    """All patches see all alike, F_ij = A_j / A: B = E + ρ <E> / <α> for any materials (integrating sphere)."""
    rng = np.random.default_rng(3)
    area = rng.random(250) + 0.1
    share = area / area.sum()
    factors = FormFactors.from_matrix(np.tile(share, (250, 1)), area)
    alpha = mixed(250, absorptance)
    E = rng.random((250, 3))
    T = TransportOperator(factors, absorptance=alpha)
    result = ConjugateGradient(rtol=1e-12).solve(T, E)
    true = E + (1.0 - alpha) * (share @ E) / (share @ alpha)
    assert_allclose(result.radiosity, true, rtol=1e-9)
    assert result.statistics["solver/products"] <= MOST_PRODUCTS


@pytest.mark.parametrize("coupling", [1e-1, 1e-2, 1e-4, 1e-6, 1e-9])
@pytest.mark.parametrize("absorptance", [1e-1, 1e-6, 1e-12])
def test_two_rooms_down_to_a_pinhole(coupling, absorptance):
    factors = chain_of_rooms(2, 150, coupling)
    for T in (
        TransportOperator(factors, absorptance=absorptance),
        TransportOperator(factors, absorptance=mixed(300, absorptance)),
    ):
        E = lamp(300, T.channels)
        result = ConjugateGradient(rtol=1e-12).solve(T, E)
        assert result.converged
        assert_allclose(result.radiosity, Direct().solve(T, E).radiosity, rtol=1e-9)
        assert np.abs(energy_defect(T, E, result.radiosity)).max() <= 1e-12
        assert result.statistics["solver/products"] <= MOST_PRODUCTS


def test_residual_is_that_of_the_light_before_rounding():
    """Light is 1e12 times its source, and its float64 rounding alone leaves 1e-4: what is claimed is less, and true."""
    T, E = TransportOperator(chain_of_rooms(2, 10, 0.05), absorptance=1e-12), lamp(20)
    method = ConjugateGradient(rtol=1e-11)
    problem = method.pose(T, E, None, None)
    state = module._Irradiance(problem, module.find_rooms(T.factors))
    for _ in range(6):
        claimed = state.balance_rooms()
        state.iterate(4)
    claimed = state.balance_rooms()
    F, A = T.factors.matrix.toarray(), T.area
    with mpmath.workdps(50):
        level = [
            mpmath.mpf(a) + mpmath.mpf(b) for a, b in zip(state.level[:, 0, 0], state.level_low[:, 0, 0], strict=True)
        ]
        label = state.coarse[0].label
        h = [level[label[i]] + mpmath.mpf(state.rest[i, 0, 0]) for i in range(20)]
        true = []
        for i in range(20):
            alpha = mpmath.mpf(T.absorptance[i, 0])
            exchange = mpmath.fsum(mpmath.mpf(F[i, j]) * (h[i] - h[j] + alpha * h[j]) for j in range(20))
            true.append(float(mpmath.mpf(state.right[i, 0, 0]) - (1 - alpha) * exchange) * state.scale[i, 0, 0])
    assert np.abs(claimed).max() < 1e-11 * A.sum()
    assert_allclose(claimed[:, 0], true, atol=1e-9)
    assert T.norm(T.residual(state.radiosity(), E))[0] > 1e-7


def test_the_slowest_mode_of_two_rooms_is_as_slow_as_asked():
    values, *_ = slow_modes(chain_of_rooms(2, 150, 3e-5))
    assert 0.9999 < values[1] < 1.0 and values[2] < 0.7


@pytest.mark.parametrize("rooms", [5, 30])
def test_a_corridor_of_rooms(rooms):
    """Light of the last room, down to 1e-50 of the first, is right too."""
    factors = chain_of_rooms(rooms, 20, 1e-2)
    T, E = TransportOperator(factors, absorptance=0.5), lamp(20 * rooms)
    result = ConjugateGradient(rtol=1e-8).solve(T, E)
    true = Direct().solve(T, E).radiosity
    assert true[-1, 0] < 10.0 ** (-1.5 * rooms)
    assert_allclose(result.radiosity, true, rtol=1e-3)


def test_far_room_against_the_chain_of_zones():
    """Rooms whose patches are all alike are zones: a chain of 30 numbers, solved at 50 digits."""
    rooms, patches, door = 30, 12, 1e-3
    G = np.kron(np.eye(rooms), np.ones((patches, patches))) / patches
    for a in range(rooms - 1):
        G[a * patches : (a + 1) * patches, (a + 1) * patches : (a + 2) * patches] = door / patches
    G = np.triu(G, 1) + np.triu(G, 1).T + np.diag(np.diag(G))
    G += np.diag(1.0 - G.sum(axis=1))
    zones = np.diag(np.full(rooms - 1, door), 1)
    zones = zones + zones.T
    zones += np.diag(1.0 - zones.sum(axis=1))
    T = TransportOperator(FormFactors.from_matrix(G, np.ones(len(G))), absorptance=0.3)
    Z = TransportOperator(FormFactors.from_matrix(zones, np.ones(rooms)), absorptance=0.3)
    E, lamps = np.zeros((len(G), 1)), np.zeros((rooms, 1))
    E[:patches], lamps[0] = 1.0, 1.0
    result = ConjugateGradient().solve(T, E)
    assert_allclose(result.radiosity[::patches, 0], fifty_digits(Z, lamps), rtol=1e-2)


def test_neumann_would_need_more_bounces_than_there_are():
    """The honest count: ln(1/rtol) / -ln(1 - α) bounces, each one product; checked where it can be run."""
    T, E = closed_box(60, seed=4, absorptance=1e-2), lamp(60)
    result = Neumann(rtol=1e-6, maxiter=3000).solve(T, E)
    assert_allclose(result.statistics["solver/steps"], np.log(1e-6) / np.log(1.0 - 1e-2), rtol=0.15)
    assert np.log(1e-6) / np.log1p(-1e-12) > 1e13


# Negative controls: put back, each makes the tests above fail.


def subtracted(self, light, beside=None):
    """Net exchange as a difference of two large numbers, what is tempting and wrong."""
    gathered = self.factors.gather(light if beside is None else light - beside, self.threads)
    return (1.0 - self.to_outside).reshape(-1, *[1] * (light.ndim - 1)) * light - gathered


def test_control_subtraction(monkeypatch):
    """1 - ρF formed by subtraction: the light level is lost, and the solver does not claim to have found it."""
    T, E = closed_box(60, seed=5, absorptance=1e-12), lamp(60)
    true = Direct().solve(T, E).radiosity
    assert_allclose(ConjugateGradient(rtol=1e-12).solve(T, E).radiosity, true, rtol=1e-9)
    monkeypatch.setattr(TransportOperator, "net_exchange", subtracted)
    wrong = np.linalg.solve(np.eye(60) - T.matrix(0).toarray(), E)
    assert np.abs(wrong / true - 1.0).max() > 1e-6
    assert np.abs(T.loss(true) - E).max() > 1e-6


def test_control_recursive_residual(monkeypatch):
    """One product gone wrong: the residual from the equation notices and repairs it, the recursive one does not."""
    T, E = closed_box(80, seed=6, absorptance=0.05), np.random.default_rng(0).random((80, 1))
    true = Direct().solve(T, E).radiosity
    exact = module._Irradiance._product
    calls = []

    def flawed(self, h):
        calls.append(1)
        return exact(self, h) * (1.5 if len(calls) == 3 else 1.0)

    monkeypatch.setattr(module._Irradiance, "_product", flawed)
    repaired = ConjugateGradient(rtol=1e-9).solve(T, E)
    assert repaired.converged
    assert_allclose(repaired.radiosity, true, rtol=1e-7)

    monkeypatch.setattr(module._Irradiance, "_residual", lambda self: getattr(self, "residual", self.right))
    calls.clear()
    fooled = ConjugateGradient(rtol=1e-9).solve(T, E)
    assert fooled.converged
    assert np.abs(fooled.radiosity / true - 1.0).max() > 1e-5


def test_control_plain_elimination():
    """An ordinary LU of I - T has lost the answer where the elimination without subtraction has every digit."""
    T, E = closed_box(100, seed=7, absorptance=1e-12), lamp(100)
    plain = np.linalg.solve(np.eye(100) - T.matrix(0).toarray(), E)
    furnace = T.area[:3].sum() / (1e-12 * T.area.sum())
    assert_allclose(Direct().solve(T, E).radiosity, furnace, rtol=1e-9)
    assert np.abs(plain / furnace - 1.0).max() > 1e-6


def test_control_deflation_left_out(monkeypatch):
    """Without the rooms, the same iteration takes far more products."""
    T, E = TransportOperator(chain_of_rooms(4, 80, 1e-4), absorptance=1e-6), lamp(320)
    quick = ConjugateGradient(rtol=1e-10).solve(T, E)
    one_room = module.Rooms(np.zeros(320, dtype=np.int64), 0.0, 0)
    monkeypatch.setattr(module, "find_rooms", lambda _: one_room)
    slow = ConjugateGradient(rtol=1e-10).solve(T, E)
    assert quick.statistics["solver/rooms"] == 4
    assert slow.statistics["solver/steps"] > 1.5 * quick.statistics["solver/steps"]


def test_excess_is_kept_beside_the_reflectance():
    T = closed_box(10, seed=8, absorptance=1e-18)
    assert_allclose(row_excess(T), 1e-18, rtol=1e-15)
