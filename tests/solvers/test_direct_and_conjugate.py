"""What elimination and conjugate gradients refuse, each for its own reason."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose

from radiosity.errors import MemoryLimitError, SolverError
from radiosity.form_factors.factors import FormFactors
from radiosity.solvers import ConjugateGradient, Direct
from radiosity.transport import TransportOperator
from tests.systems import closed_box


def test_direct_refuses_with_the_bytes():
    T = closed_box(100, seed=0, absorptance=0.5)
    with pytest.raises(MemoryLimitError, match=r"8e\+04 bytes for 100 × 100 patches"):
        Direct(max_bytes=10_000).solve(T, np.ones((100, 1)))


def test_direct_eliminates_once_where_channels_agree():
    factors = closed_box(20, seed=1, absorptance=0.5).factors
    grey = TransportOperator(factors, reflectance=np.full((20, 3), 0.5))
    colour = TransportOperator(factors, reflectance=np.tile([0.5, 0.4, 0.5], (20, 1)))
    E = np.random.default_rng(0).random((20, 3))
    assert Direct().solve(grey, E).statistics["solver/eliminations"] == 1
    assert Direct().solve(colour, E).statistics["solver/eliminations"] == 2


@pytest.mark.parametrize("count", [30, 400])
def test_conjugate_gradient_refuses_raw_factors(count):
    rng = np.random.default_rng(0)
    F = rng.random((count, count))
    raw = FormFactors.from_matrix(F / F.sum(axis=1, keepdims=True), np.ones(count))
    defect = f"{raw.reciprocity_defect:.3g}"
    with pytest.raises(SolverError, match=rf"‖G - Gᵀ‖ / ‖G‖ = {defect}: use factors.conserved\(\)"):
        ConjugateGradient().solve(TransportOperator(raw, reflectance=0.5), np.ones((count, 1)))


def test_conjugate_gradient_stops_where_rounding_stops_it():
    T, E = closed_box(60, seed=2, absorptance=1e-3), np.random.default_rng(0).random((60, 1))
    result = ConjugateGradient(rtol=1e-30).solve(T, E)
    assert not result.converged and "its rounding is reached" in result.status
    assert result.statistics["solver/steps"] < 200 and result.history[-1].max() < 1e-14


def test_conjugate_gradient_goes_on_past_rounding_without_harm():
    """A lamp that lights patches which see nothing else, and lone patches: done after one step, then asked for more."""
    F = np.zeros((12, 12))
    F[0, 1:7] = 0.1
    F[1:7, 0] = 0.1
    T = TransportOperator(FormFactors.from_matrix(F, np.ones(12)), reflectance=0.8)
    E, sky = np.where(np.arange(12) == 0, 5.0, 0.0)[:, None], [1.0]
    steps = list(ConjugateGradient(rtol=0.0, maxiter=40, check=8).iterate(T, E, sky))
    true = Direct().solve(T, E, sky).radiosity
    for step in steps[1:]:
        assert_allclose(step.radiosity, true, rtol=1e-13)
