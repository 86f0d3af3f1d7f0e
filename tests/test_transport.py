"""One bounce: its shapes, its two forms, its neighbours in scipy, and what it refuses."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from scipy.sparse import csr_array
from scipy.sparse.linalg import gmres, svds

from radiosity.errors import FormFactorError, MaterialError, SolverError
from radiosity.form_factors.factors import FormFactors
from radiosity.transport import TransportOperator, area_norm
from tests.systems import closed_box, facing_walls

TRUTH = Path(__file__).parent / "truth"


@pytest.fixture(scope="module")
def box():
    """The 600 quads of the empty box, with exact form factors and orders."""
    with np.load(TRUTH / "empty_box.npz") as file:
        data = {key: file[key] for key in file}
    factors = FormFactors.from_matrix(data["F"], data["area"])
    return TransportOperator(factors, reflectance=data["albedo"]), data


def test_orders_of_the_empty_box(box):
    T, data = box
    orders = T.orders(data["emission"], count=12)
    assert_allclose(orders, data["B_disc"], rtol=0, atol=1e-14 * data["B_disc"].max())


def test_a_bounce_is_rho_times_gathered_light():
    T, rng = closed_box(30, seed=1, reflectance=(0.1, 0.9)), np.random.default_rng(0)
    F, rho = T.factors.matrix.toarray(), T.reflectance
    light = rng.random((30, 3, 4))
    assert_allclose(T @ light, np.einsum("ic,ij,jcs->ics", rho, F, light), rtol=1e-13)
    assert_array_equal((T @ light)[..., 2], T @ light[..., 2])


def test_one_channel_takes_vectors():
    T = facing_walls(0.2, reflectance=[0.5, 0.8])
    assert T.channels == 1 and T.shape == (2, 2)
    assert_allclose(T @ np.array([10.0, 0.0]), [0.0, 1.6], rtol=1e-15)
    assert_allclose(T @ np.array([[10.0], [0.0]]), [[0.0], [1.6]], rtol=1e-15)


def test_sky_arrives_with_order_one():
    T = facing_walls(0.2, reflectance=[0.5, 0.8])
    first = np.pi * 0.8 * 3.0 * np.array([[0.5], [0.8]])
    assert_allclose(T.from_sky([3.0]), first, rtol=1e-15)
    orders = T.orders(np.zeros((2, 1)), sky=[3.0], count=2)
    assert_array_equal(orders[0], 0.0)
    assert_array_equal(orders[1], T.from_sky([3.0]))
    assert_allclose(orders[2], T @ T.from_sky([3.0]), rtol=1e-15)
    hours = T.from_sky(np.array([[3.0, 1.0]]))
    assert hours.shape == (2, 1, 2) and np.allclose(hours[..., 0], first, rtol=1e-14, atol=0)


def test_loss_is_light_minus_its_bounce():
    T, rng = closed_box(50, seed=2, reflectance=(0.0, 0.95), sky=0.3), np.random.default_rng(1)
    light = rng.random((50, 3, 2))
    assert_allclose(T.loss(light), light - T @ light, atol=1e-14)


@pytest.mark.parametrize("absorptance", [1e-6, 1e-12, 1e-15])
def test_loss_keeps_a_small_absorptance(absorptance):
    """Constant light in a closed box loses α B exactly; the subtraction has no right digit left."""
    T = closed_box(40, seed=3, absorptance=absorptance)
    light = np.full((40, 1), 2.0)
    assert_allclose(T.loss(light), 2.0 * absorptance, rtol=1e-13)
    if absorptance < 1e-14:
        assert np.max(np.abs((light - T @ light) / (2.0 * absorptance) - 1.0)) > 0.01


def test_the_given_share_is_kept():
    F = facing_walls(1.0, reflectance=0.5).factors
    assert_array_equal(TransportOperator(F, absorptance=1e-20).absorptance, 1e-20)
    assert_array_equal(TransportOperator(F, reflectance=1 - 1e-12).absorptance, 1.0 - (1 - 1e-12))

    class Patches:
        reflectance = np.full((2, 1), 1.0)
        absorptance = np.full((2, 1), 1e-20)

    T = TransportOperator(F, Patches())
    assert_array_equal(T.absorptance, 1e-20)


def test_linear_operators_are_the_matrix():
    T, rng = closed_box(25, seed=4, reflectance=(0.2, 0.9)), np.random.default_rng(2)
    x, X = rng.random(25), rng.random((25, 4))
    for c in range(3):
        dense = np.diag(T.reflectance[:, c]) @ T.factors.matrix.toarray()
        assert isinstance(T.matrix(c), csr_array)
        assert_allclose(T.matrix(c).toarray(), dense, rtol=1e-15)
        for operator, matrix in ((T.channel(c), dense), (T.system(c), np.eye(25) - dense)):
            assert_allclose(operator @ x, matrix @ x, atol=1e-14)
            assert_allclose(operator @ X, matrix @ X, atol=1e-14)
            assert_allclose(operator.T @ x, matrix.T @ x, atol=1e-14)
            assert_allclose(operator.rmatmat(X), matrix.T @ X, atol=1e-14)


def test_scipy_solves_and_decomposes(box):
    T, data = box
    radiosity, info = gmres(T.system(1), data["emission"][:, 1], rtol=1e-12)
    assert info == 0
    assert_allclose(radiosity, data["total_disc"][:, 1], rtol=1e-9)
    largest = svds(T.channel(0), k=1, return_singular_vectors=False, rng=0)
    assert_allclose(largest, np.linalg.norm(T.matrix(0).toarray(), 2), rtol=1e-10)


def test_norm_survives_squares_that_overflow():
    area = np.array([1.0, 3.0])
    assert_allclose(area_norm(np.array([[1e200], [1e200]]), area), 1e200, rtol=1e-15)
    assert_allclose(area_norm(np.array([[2.0], [0.0]]), area), 1.0, rtol=1e-15)
    assert area_norm(np.zeros((2, 1)), area) == 0.0


def test_same_bits_for_any_threads():
    T = closed_box(400, seed=5, reflectance=(0.1, 0.9))
    light = np.random.default_rng(3).random((400, 3))
    for threads in (1, 2, 4):
        other = TransportOperator(T.factors, reflectance=T.reflectance, threads=threads)
        assert_array_equal(other @ light, T @ light)
        assert_array_equal(other.loss(light), T.loss(light))


@pytest.mark.parametrize("wrong", [[1.2, 0.5], [-0.1, 0.5], [np.nan, 0.5]])
def test_refuses_shares_outside_their_range(wrong):
    with pytest.raises(MaterialError, match="of patch 0, channel 0, is outside"):
        facing_walls(0.2, reflectance=wrong)


@pytest.mark.parametrize(("entry", "word"), [(np.nan, "nan"), (-0.1, "-0.1"), (np.inf, "inf")])
def test_refuses_poisoned_factors(entry, word):
    factors = facing_walls(0.2, reflectance=0.5).factors
    poisoned = replace(factors, matrix=csr_array(np.array([[0.0, 0.2], [entry, 0.1]])))
    with pytest.raises(FormFactorError, match=rf"F\[1, 0\] = {word}"):
        TransportOperator(poisoned, reflectance=0.5)


def test_refuses_rows_above_one():
    factors = replace(facing_walls(1.0, reflectance=0.5).factors, matrix=csr_array([[0.0, 1.0], [1.002, 0.0]]))
    with pytest.raises(FormFactorError, match=r"row 1 of F sums to 1\.002"):
        TransportOperator(factors, reflectance=0.999)


def test_refuses_what_is_not_one_problem():
    T = closed_box(5, seed=0, reflectance=(0.1, 0.9))
    with pytest.raises(SolverError, match="exactly one of"):
        TransportOperator(T.factors, reflectance=0.5, absorptance=0.5)
    with pytest.raises(SolverError, match=r"light has shape \(5,\)"):
        T @ np.ones(5)
    with pytest.raises(SolverError, match=r"light has shape \(4, 3\)"):
        T @ np.ones((4, 3))
    with pytest.raises(SolverError, match="sky has 1 channels"):
        T.from_sky([1.0])
    with pytest.raises(MaterialError, match="reflectance has shape"):
        TransportOperator(T.factors, reflectance=np.ones((4, 3)))
