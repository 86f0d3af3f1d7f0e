"""Rooms are found from the form factors alone."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from radiosity.form_factors.factors import FormFactors
from radiosity.solvers.rooms import coarse_system, find_rooms, slow_modes
from radiosity.transport import TransportOperator
from tests.systems import chain_of_rooms, closed_box, exchange_to_factors, random_exchange


@pytest.mark.parametrize(("rooms", "patches"), [(1, 100), (1, 300), (2, 50), (2, 400), (5, 100), (30, 20)])
@pytest.mark.parametrize("shuffled", [False, True])
def test_finds_the_rooms_of_a_chain(rooms, patches, shuffled):
    factors = chain_of_rooms(rooms, patches, 1e-3)
    truth = np.repeat(np.arange(rooms), patches)
    if shuffled:
        order = np.random.default_rng(0).permutation(len(truth))
        dense = factors.matrix.toarray()[np.ix_(order, order)]
        factors, truth = FormFactors.from_matrix(dense, factors.area[order]), truth[order]
    found = find_rooms(factors)
    assert found.count == rooms
    pairs = np.unique(np.column_stack([truth, found.label]), axis=0)
    assert len(pairs) == rooms  # one name each, and no patch in the wrong room
    assert found.asymmetry < 1e-12
    assert find_rooms(factors) is found


def test_block_lanczos_finds_the_eigenvalues():
    factors = chain_of_rooms(4, 120, 1e-3)
    values, vectors, asymmetry, products = slow_modes(factors)
    root = np.sqrt(factors.area)
    dense = root[:, None] * factors.matrix.toarray() / root
    assert_allclose(values[:4], np.linalg.eigvalsh(dense)[::-1][:4], rtol=1e-6)
    assert_allclose(dense @ vectors[:, :4], vectors[:, :4] * values[:4], atol=2e-3)
    assert products <= 10 and asymmetry < 1e-12


def test_asymmetry_of_raw_rows_is_seen():
    rng = np.random.default_rng(0)
    for count in (50, 400):
        F = rng.random((count, count))
        raw = FormFactors.from_matrix(F / F.sum(axis=1, keepdims=True), np.ones(count))
        assert find_rooms(raw).asymmetry > 1e-3


def test_separate_enclosures_are_separate_rooms():
    G = np.zeros((60, 60))
    for begin in (0, 20, 40):
        G[begin : begin + 20, begin : begin + 20] = random_exchange(20, seed=begin)
    assert_array_equal(find_rooms(exchange_to_factors(G)).label, np.repeat([0, 1, 2], 20))


def test_coarse_system_is_the_system_on_constants():
    """Zᵀ A K Z and K Z against the dense K of the irradiance form."""
    factors = chain_of_rooms(3, 20, 0.05)
    rho = np.random.default_rng(0).random(60)
    rho[::7] = 0.0
    T = TransportOperator(factors, reflectance=rho)
    rooms = find_rooms(factors)
    coarse = coarse_system(T, 0, rooms)
    F = factors.matrix.toarray()
    K = np.diag(rho) @ (np.eye(60) - F @ np.diag(rho))
    Z = (rooms.label[:, None] == np.arange(3)) * (rho > 0)[:, None]
    A = np.diag(factors.area)
    assert_allclose(coarse.apply(np.eye(3)), K @ Z, atol=1e-15)
    field = np.random.default_rng(1).random((60, 2))
    assert_allclose(coarse.restrict(field), Z.T @ A @ field, rtol=1e-13)
    assert_allclose(coarse.apply_transposed(field), (K @ Z).T @ A @ field, atol=1e-13)
    assert_allclose(coarse.prolong(np.eye(3)), Z)
    right = np.random.default_rng(2).random((3, 2))
    assert_allclose(coarse.solve(right), np.linalg.solve(Z.T @ A @ K @ Z, right), rtol=1e-10)


def test_one_room_where_light_spreads_at_once():
    assert find_rooms(closed_box(120, seed=0, absorptance=0.5).factors).count == 1
