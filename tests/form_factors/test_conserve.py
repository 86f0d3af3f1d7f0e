"""Conserved factors: closed, reciprocal, as near to the raw ones as that allows, and honest about it."""

from __future__ import annotations

import warnings
from dataclasses import dataclass, replace

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from radiosity.errors import FormFactorError, FormFactorWarning
from radiosity.form_factors.factors import FormFactors
from radiosity.solvers import ConjugateGradient, Direct
from radiosity.transport import TransportOperator
from tests.systems import exchange_to_factors, random_exchange


@dataclass(frozen=True)
class Rays:
    """What the factors below were sampled with."""

    rays: int
    replicates: int = 1
    sampling: str = "random"


def exact(count=60, seed=1, sky=0.0):
    return exchange_to_factors(random_exchange(count, seed, density=0.6, spread=1.0), sky)


def sampled(truth, rays, seed=0):
    """Rows of counted hits: closed to the last ray, and not reciprocal."""
    rng = np.random.default_rng(seed)
    shares = np.column_stack([truth.matrix.toarray(), truth.to_sky, truth.to_backs])
    counts = np.array([rng.multinomial(rays, row / row.sum()) for row in shares]) / rays
    factors = FormFactors.from_matrix(counts[:, :-2], truth.area, to_sky=counts[:, -2], to_backs=counts[:, -1])
    return replace(factors, estimator=Rays(rays))


@pytest.mark.parametrize("sky", [0.0, 0.3])
def test_closes_and_is_reciprocal(sky):
    raw = sampled(exact(sky=sky), 1000)
    assert raw.reciprocity_defect > 0.05
    made = raw.conserved()
    assert made.matrix.dtype == np.float64
    assert np.abs(made.closure_defect).max() < 1e-13
    G = made.exchange_area().toarray()
    assert_allclose(G, G.T, rtol=1e-14)
    assert made.reciprocity_defect < 1e-15
    assert np.all(made.matrix.data > 0)


def test_says_what_it_took():
    raw = sampled(exact(), 1000)
    statistics = raw.conserved().statistics
    assert statistics["conserve/reciprocity_before"] == raw.reciprocity_defect
    assert statistics["conserve/reciprocity_after"] < 1e-15
    assert statistics["conserve/closure_before"] == np.abs(raw.closure_defect).max()
    assert statistics["conserve/closure_after"] < 1e-13
    assert 0 < statistics["conserve/passes"] <= 70
    G, new = raw.exchange_area().toarray(), raw.conserved().exchange_area().toarray()
    factor = np.divide(2.0 * new, G + G.T, out=np.ones_like(G), where=G + G.T > 0)
    assert_allclose(statistics["conserve/largest_correction"], np.abs(factor - 1.0).max(), rtol=1e-9)
    i, j = statistics["conserve/largest_correction_at"]
    assert_allclose(np.abs(factor[i, j] - 1.0), np.abs(factor - 1.0).max(), rtol=1e-9)


def test_raw_factors_stay_raw():
    raw = sampled(exact(), 100)
    before = raw.matrix.toarray()
    raw.conserved()
    assert_array_equal(raw.matrix.toarray(), before)
    assert "conserve/passes" not in raw.statistics


def test_exact_factors_are_left_as_they_are():
    truth = exact(sky=0.2)
    made = truth.conserved()
    assert_allclose(made.matrix.toarray(), truth.matrix.toarray(), rtol=1e-14)
    assert_allclose(made.to_sky, truth.to_sky, rtol=1e-14)
    assert made.statistics["conserve/largest_correction"] < 1e-14


def test_is_nearer_to_the_truth_than_the_raw_rows():
    truth = exact(sky=0.2)
    raw = sampled(truth, 2000)
    F = truth.matrix.toarray()
    assert np.linalg.norm(raw.conserved().matrix.toarray() - F) < 0.85 * np.linalg.norm(raw.matrix.toarray() - F)


def test_sky_and_backs_are_receivers():
    truth = exact(sky=0.2)
    truth = replace(truth, to_sky=np.full(60, 0.15), to_backs=np.full(60, 0.05))
    raw = sampled(truth, 500)
    made = raw.conserved()
    d = made.to_sky / np.where(raw.to_sky > 0, raw.to_sky, 1.0)
    assert_allclose(made.to_backs, raw.to_backs * d, rtol=1e-12)
    half = (raw.exchange_area() + raw.exchange_area().T).toarray() / 2.0
    assert_allclose(made.exchange_area().toarray(), d[:, None] * half * d, rtol=1e-12)


def test_exact_columns_are_kept():
    truth = exact()
    F = sampled(truth, 300).matrix.toarray()
    lamp = np.array([3, 17])
    F[:, lamp] = truth.matrix.toarray()[:, lamp]
    keep = np.isin(np.arange(60), lamp)
    others = F[:, ~keep]
    F[:, ~keep] = others * ((1.0 - F[:, keep].sum(axis=1)) / others.sum(axis=1))[:, None]
    raw = FormFactors.from_matrix(F, truth.area)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", FormFactorWarning)  # without an estimator its error is not known
        made, plain = raw.conserved(keep=keep), raw.conserved()
    new = made.matrix.toarray()
    assert_allclose(new[~keep][:, keep], F[~keep][:, keep], rtol=1e-14)
    assert_allclose(made.reciprocity_defect, 0.0, atol=1e-15)
    assert np.abs(made.closure_defect).max() < 1e-13
    change = plain.matrix.toarray()[~keep][:, keep] - F[~keep][:, keep]
    assert np.linalg.norm(change) > 0.01 * np.linalg.norm(F[~keep][:, keep])  # kept because it was asked for
    assert made.statistics["conserve/kept_on_diagonal"] < 1e-12  # an exact column lacks nothing
    from_factors = replace(raw, exact_columns=keep)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", FormFactorWarning)
        assert_array_equal(from_factors.conserved().matrix.toarray(), new)


@pytest.mark.parametrize("wrong", [0.97, 1.03])
def test_a_kept_column_that_does_not_close(wrong):
    """Visibility is sampled: what is missing stays on the lamp, what is too much is scaled away."""
    truth = exact()
    F = truth.matrix.toarray()
    F[:, 5] *= wrong
    F = F / np.maximum(F.sum(axis=1), 1.0)[:, None]
    raw = FormFactors.from_matrix(F, truth.area, to_sky=np.zeros(60))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", FormFactorWarning)
        made = raw.conserved(keep=np.arange(60) == 5)
    assert np.abs(made.closure_defect).max() < 1e-13 and made.reciprocity_defect < 1e-15
    assert_allclose(made.matrix[5, 5], max(1.0 - wrong, 0.0), atol=2e-3)


@pytest.mark.parametrize("wrong", [0.7, 1.3])
def test_a_kept_lamp_in_the_open_closes_by_its_sky(wrong):
    """Its column is exact and its sky was sampled: the sky gives way, not the lamp."""
    truth = exact(sky=0.3)
    keep = np.arange(60) == 5
    sky = np.where(keep, truth.to_sky * wrong, truth.to_sky)
    raw = replace(truth, to_sky=sky)
    made = raw.conserved(keep=keep)
    assert_allclose(made.matrix.toarray()[:, 5], truth.matrix.toarray()[:, 5], rtol=1e-13)
    assert_allclose(made.to_sky, truth.to_sky, rtol=1e-12)
    assert made.statistics["conserve/kept_on_diagonal"] < 1e-12


def test_replicates_are_conserved_too():
    truth = exact()
    runs = tuple(sampled(truth, 500, seed) for seed in range(4))
    mean = FormFactors.from_matrix(np.mean([run.matrix.toarray() for run in runs], axis=0), truth.area)
    made = replace(mean, replicates=runs, estimator=Rays(2000)).conserved()
    assert len(made.replicates) == 4
    for run in made.replicates:
        assert np.abs(run.closure_defect).max() < 1e-13 and run.reciprocity_defect < 1e-15


def test_sampling_noise_gives_no_warning():
    truth = exact()
    for seed in range(10):
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            sampled(truth, 400, seed).conserved()


@pytest.mark.parametrize("replicated", [False, True])
def test_what_sampling_does_not_explain_is_a_warning_with_names(replicated):
    """A patch half hidden inside a block receives half of what it should."""
    truth = exact()
    broken = truth.matrix.toarray()
    broken[:, 7] *= 0.5
    broken = broken / broken.sum(axis=1, keepdims=True)
    wrong = FormFactors.from_matrix(broken, truth.area)
    raw = sampled(wrong, 20_000)
    if replicated:
        raw = replace(raw, estimator=None, replicates=tuple(sampled(wrong, 5000, seed) for seed in range(4)))
    raw = replace(raw, surface=np.full(60, 1, dtype=np.int32), surface_names=("wall", "floor"))
    with pytest.warns(FormFactorWarning, match=r"more than 5 standard errors of the sampling: 7 of floor"):
        raw.conserved()


def test_unknown_error_warns_only_of_large_corrections():
    truth = exact()
    F = truth.matrix.toarray()
    F[:, 7] *= 0.5
    with pytest.warns(FormFactorWarning, match="nothing is known about their sampling error: 7"):
        FormFactors.from_matrix(F / F.sum(axis=1, keepdims=True), truth.area).conserved()


@pytest.mark.parametrize(
    ("F", "area", "what"),
    [
        ([[0.0, 1.0], [1.0, 0.0]], [1.0, 2.0], "2 patches .0, 1. would have to be scaled by more than"),
        ([[0.0, 0.5, 0.5], [1.0, 0.0, 0.0], [1.0, 0.0, 0.0]], [3.0, 1.0, 1.0], "would have to be scaled"),
        ([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 0.0]], [1.0, 1.0, 1.0], "1 patches .2. see no other patch"),
    ],
    ids=["two of unequal area", "one that cannot be seen enough", "one that sees nothing"],
)
def test_patterns_that_cannot_be_scaled_are_refused(F, area, what):
    raw = FormFactors.from_matrix(F, area, to_sky=np.zeros(len(area)))
    with pytest.raises(FormFactorError, match=what):
        raw.conserved()


def test_nearly_unscalable_is_scaled():
    """Two plates of unequal area that see little else: slow for alternating scaling, a few Newton steps."""
    F = np.array([[0.0, 0.99, 0.01], [0.97, 0.0, 0.03], [0.3, 0.6, 0.1]])
    with pytest.warns(FormFactorWarning):
        made = FormFactors.from_matrix(F, [1.0, 1.1, 0.2]).conserved()
    assert np.abs(made.closure_defect).max() < 1e-13 and made.reciprocity_defect < 1e-15
    assert made.statistics["conserve/passes"] <= 60


def test_keep_is_checked():
    with pytest.raises(FormFactorError, match=r"keep has shape \(3,\)"):
        exact().conserved(keep=[True, False, True])


@pytest.mark.parametrize("absorptance", [1e-3, 1e-6, 1e-12])
def test_small_absorptance_is_right_on_conserved_factors(absorptance):
    """The light level of a closed room is lamp / (α area), whatever the sampling."""
    raw = sampled(exact(), 200)
    T = TransportOperator(raw.conserved(), absorptance=absorptance)
    E = np.zeros((60, 1))
    E[0] = 1.0
    for solver in (ConjugateGradient(rtol=1e-12), Direct()):
        radiosity = solver.solve(T, E).radiosity
        absorbed = T.power(absorptance * T.factors.gather(radiosity))
        assert_allclose(absorbed, T.power(E), rtol=1e-12)
    assert_allclose(T.power(radiosity) / raw.area.sum(), T.power(E) / (absorptance * raw.area.sum()), rtol=2e-3)


# Negative control.


def test_control_averaging_is_not_scaling():
    """(G + Gᵀ)/2 alone is reciprocal but sends out more than it has; its rows closed by force are not."""
    raw = sampled(exact(), 300)
    half = (raw.exchange_area() + raw.exchange_area().T).toarray() / 2.0
    averaged = half / raw.area[:, None]
    assert averaged.sum(axis=1).max() > 1.001
    with pytest.raises(FormFactorError, match="more than 1 leaves patch"):
        FormFactors.from_matrix(averaged, raw.area)
    unchecked = replace(raw, matrix=type(raw.matrix)(averaged))
    with pytest.raises(FormFactorError, match="more than 1 leaves patch"):
        TransportOperator(unchecked, reflectance=0.999)
    closed = FormFactors.from_matrix(averaged / averaged.sum(axis=1, keepdims=True), raw.area)
    assert closed.reciprocity_defect > 1e-3
