"""Elimination without subtraction, beside ordinary linear algebra and 50 digits."""

from __future__ import annotations

import mpmath
import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from radiosity.solvers.elimination import PANEL, eliminate


def dense(exchange, excess):
    off = exchange - np.diag(np.diag(exchange))
    return np.diag(excess + off.sum(axis=1)) - off


@pytest.mark.parametrize("count", [1, 2, 7, PANEL - 1, PANEL, PANEL + 1, 3 * PANEL + 5])
def test_solves_as_linear_algebra(count):
    rng = np.random.default_rng(count)
    W, e, b = rng.random((count, count)) * (rng.random((count, count)) < 0.5), rng.random(count), rng.random((count, 3))
    M = dense(W, e)
    system = eliminate(W, e)
    assert_allclose(system.solve(b), np.linalg.solve(M, b), rtol=1e-12)
    assert_allclose(system.solve(b[:, 0]), np.linalg.solve(M, b[:, 0]), rtol=1e-12)
    factors = (np.eye(count) - np.tril(system.factors, -1)) @ (np.diag(system.pivots) - np.triu(system.factors, 1))
    assert_allclose(factors, M, atol=1e-13 * np.abs(M).max())


@pytest.mark.parametrize("excess", [1e-3, 1e-12, 1e-30, 1e-200])
def test_every_entry_keeps_its_digits(excess):
    """Entries of the solution over many powers of ten, each right to 1e-13."""
    count, rng = 20, np.random.default_rng(0)
    W = 10.0 ** rng.uniform(-20, 0, (count, count))
    e = excess * rng.random(count)
    b = 10.0 ** rng.uniform(-20, 20, count)
    with mpmath.workdps(400):
        M = mpmath.matrix(count, count)
        for i in range(count):
            M[i, i] = mpmath.mpf(e[i]) + mpmath.fsum(mpmath.mpf(W[i, j]) for j in range(count) if j != i)
            for j in range(count):
                if j != i:
                    M[i, j] = -mpmath.mpf(W[i, j])
        true = np.array([float(x) for x in mpmath.lu_solve(M, mpmath.matrix(b.tolist()))])
    assert_allclose(eliminate(W, e).solve(b), true, rtol=1e-13)


@pytest.mark.parametrize("order", [[0, 1, 2], [2, 0, 1], [1, 2, 0]])
def test_unknowns_without_any_loss_are_set_to_zero(order):
    """0 and 1 exchange with each other alone; what 2 gives them is lost to it."""
    W = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.5, 0.0, 0.0]])[np.ix_(order, order)]
    found = eliminate(W, np.array([0.0, 0.0, 2.0])[order]).solve(np.array([0.0, 0.0, 5.0])[order])
    assert_allclose(found, np.array([0.0, 0.0, 2.0])[order], rtol=1e-15)


def test_what_is_given_is_left_alone():
    W, e, b = np.ones((3, 3)), np.ones(3), np.ones(3)
    eliminate(W, e).solve(b)
    assert_array_equal(W, 1.0)
    assert_array_equal(e, 1.0)
    assert_array_equal(b, 1.0)
