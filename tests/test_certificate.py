"""What a certificate says, and that it says so only where it is true."""

from __future__ import annotations

import warnings
from dataclasses import dataclass, replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.sparse import csr_array

from radiosity.certificate import certify
from radiosity.errors import FormFactorWarning
from radiosity.form_factors.factors import FormFactors
from radiosity.solvers import ConjugateGradient, Direct, Neumann
from radiosity.transport import TransportOperator
from tests.systems import closed_box, exchange_to_factors, random_exchange


@dataclass(frozen=True)
class Rays:
    """What the factors below were sampled with."""

    rays: int
    replicates: int = 1
    sampling: str = "random"


def sampled(truth, rays, replicates=1, seed=0):
    """Counted hits in independent replicates, and their mean."""
    rng = np.random.default_rng(seed)
    shares = np.column_stack([truth.matrix.toarray(), truth.to_sky])
    shares /= shares.sum(axis=1, keepdims=True)
    runs = []
    for _ in range(replicates):
        counts = np.array([rng.multinomial(rays // replicates, row) for row in shares]) / (rays // replicates)
        runs.append(FormFactors.from_matrix(counts[:, :-1], truth.area, to_sky=counts[:, -1]))
    mean = FormFactors.from_matrix(
        np.mean([run.matrix.toarray() for run in runs], axis=0),
        truth.area,
        to_sky=np.mean([run.to_sky for run in runs], axis=0),
    )
    how = Rays(rays, replicates)
    runs = tuple(replace(run, estimator=how) for run in runs) if replicates > 1 else ()
    return replace(mean, estimator=how, replicates=runs)


def truth(sky=0.0, count=50):
    return exchange_to_factors(random_exchange(count, seed=1, density=0.6, spread=1.0), sky)


def lamps(count=50, channels=3):
    E = np.zeros((count, channels))
    E[:5] = np.random.default_rng(0).random((5, channels))
    return E


def test_a_converged_solution_with_exact_factors_is_certified():
    T, E = closed_box(50, seed=2, reflectance=(0.1, 0.8), sky=0.1), lamps()
    light = Neumann(rtol=1e-8).solve(T, E, sky=[1.0, 1.0, 1.0]).radiosity
    certificate = certify(T, E, light, sky=[1.0, 1.0, 1.0])
    assert certificate.verdict == "certified" and certificate.reasons == ()
    assert certificate.exact and certificate.sampling == 0.0
    assert 0.0 < certificate.algebraic < 1e-6
    true = Direct().solve(T, E, sky=[1.0, 1.0, 1.0]).radiosity
    assert np.all(np.abs(light - true) <= certificate.bound + 1e-14)
    assert str(certificate).startswith("certified to 1 %: algebra within ")


def test_energy_of_each_enclosure():
    G = np.zeros((40, 40))
    G[:25, :25], G[25:, 25:] = random_exchange(25, seed=3), random_exchange(15, seed=4)
    factors = exchange_to_factors(G, np.where(np.arange(40) < 25, 0.2, 0.0))
    factors = replace(factors, surface=(np.arange(40) >= 25).astype(np.int32), surface_names=("hall", "cellar"))
    T = TransportOperator(factors, reflectance=np.full((40, 2), 0.7))
    E = np.where(np.arange(40) < 25, 1.0, 100.0)[:, None] * np.ones(2)
    light = Neumann(rtol=1e-13).solve(T, E).radiosity
    certificate = certify(T, E, light)
    cellar, hall = certificate.enclosures
    assert (cellar.place, cellar.patches, hall.place, hall.patches) == ("cellar", 15, "hall", 25)
    assert_allclose(cellar.emitted, 200.0 * T.area[25:].sum(), rtol=1e-12)
    assert_allclose(cellar.absorbed, cellar.emitted, rtol=1e-12)
    assert cellar.escaped == 0.0 and cellar.leaked == 0.0 and abs(cellar.defect) < 1e-12
    assert_allclose(hall.absorbed + hall.escaped, hall.emitted, rtol=1e-12)
    assert hall.escaped > 0.1 * hall.emitted
    assert "energy in cellar: " in str(certificate) and "energy in hall: " in str(certificate)


def test_an_early_stop_is_uncertified_with_advice():
    T, E = closed_box(50, seed=2, reflectance=(0.7, 0.9)), lamps()
    certificate = certify(T, E, Neumann(maxiter=3).solve(T, E).radiosity)
    assert certificate.verdict == "uncertified"
    true = Direct().solve(T, E).radiosity
    error = np.linalg.norm(T.norm(Neumann(maxiter=3).solve(T, E).radiosity - true)) / np.linalg.norm(T.norm(true - E))
    assert error <= certificate.algebraic <= 1.5 * error
    assert "the solver stopped early" in str(certificate) and "smaller rtol" in str(certificate)


@pytest.mark.parametrize("replicates", [4, 16])
def test_sampling_error_is_the_true_one(replicates):
    """Its estimate from replicates against the true error over many seeds, from both sides."""
    exact, E = truth(), lamps()
    reference = Direct().solve(TransportOperator(exact, reflectance=np.full((50, 3), 0.7)), E).radiosity
    errors, estimates = [], []
    for seed in range(12):
        T = TransportOperator(sampled(exact, 4096, replicates, seed), reflectance=np.full((50, 3), 0.7))
        light = Neumann(rtol=1e-8).solve(T, E).radiosity
        errors.append(np.linalg.norm(T.norm(light - reference)) / np.linalg.norm(T.norm(reference - E)))
        estimates.append(certify(T, E, light).sampling)
    assert 0.8 < np.sqrt(np.mean(np.square(estimates)) / np.mean(np.square(errors))) < 1.25


def test_too_few_rays_are_uncertified_with_their_number():
    T, E = TransportOperator(sampled(truth(), 512, 4), reflectance=np.full((50, 3), 0.7)), lamps()
    certificate = certify(T, E, Neumann(rtol=1e-8).solve(T, E).radiosity, accuracy=0.01)
    assert certificate.verdict == "uncertified"
    more = (2.0 * certificate.sampling / 0.01) ** 2
    assert f"about {int(np.ceil(more))} × as many rays" in str(certificate) or more > 1.0
    loose = certify(T, E, Neumann(rtol=1e-8).solve(T, E).radiosity, accuracy=3.0 * certificate.sampling)
    assert loose.verdict == "certified"


def test_without_replicates_the_sampling_error_is_not_known():
    T, E = TransportOperator(sampled(truth(), 512), reflectance=np.full((50, 3), 0.7)), lamps()
    certificate = certify(T, E, Neumann(rtol=1e-8).solve(T, E).radiosity)
    assert certificate.sampling is None and certificate.verdict == "uncertified"
    assert "sampling error not known" in str(certificate) and "MonteCarlo(replicates=2)" in str(certificate)


def test_reciprocity_and_energy_come_with_their_standard_errors():
    """Raw rows are neither reciprocal nor balanced, by as much as sampling explains."""
    E, defects = lamps(), []
    for seed in range(20):
        T = TransportOperator(sampled(truth(sky=0.1), 2048, 4, seed), reflectance=np.full((50, 3), 0.7))
        certificate = certify(T, E, Neumann(rtol=1e-10).solve(T, E).radiosity)
        assert 0.8 < certificate.reciprocity / certificate.reciprocity_expected < 1.25
        defects.append(certificate.energy_defect / certificate.energy_error)
        assert not any("energy" in reason for reason in certificate.reasons)
    assert 0.4 < np.std(defects) < 1.3 and np.max(np.abs(defects)) > 0.1


def test_energy_error_of_independent_rays_is_the_true_one():
    """One run of random rays knows its own standard error: defects over many seeds have a spread of one."""
    E, defects = lamps(), []
    for seed in range(60):
        T = TransportOperator(sampled(truth(sky=0.1), 1024, 1, seed), reflectance=np.full((50, 3), 0.7))
        certificate = certify(T, E, Direct().solve(T, E).radiosity)
        defects.append(certificate.energy_defect / certificate.energy_error)
    assert 0.8 < np.std(defects) < 1.2 and np.abs(np.mean(defects)) < 0.4


def test_conserved_factors_balance_to_the_last_digits():
    T = TransportOperator(sampled(truth(), 2048, 4).conserved(), absorptance=np.full((50, 3), 1e-6))
    E = lamps()
    certificate = certify(T, E, ConjugateGradient(rtol=1e-12).solve(T, E).radiosity)
    assert abs(certificate.energy_defect) < 1e-12 and certificate.energy_error == 0.0
    assert certificate.reciprocity < 1e-15 and certificate.algebraic < 1e-9
    assert certificate.closure < 1e-13


def test_columns_that_sampling_does_not_explain_are_a_doubt():
    """Half of what a patch should receive never arrives: energy is off by more than five standard errors."""
    F = truth().matrix.toarray()
    F[:, 7] *= 0.5
    wrong = FormFactors.from_matrix(F / F.sum(axis=1, keepdims=True), truth().area)
    T = TransportOperator(sampled(wrong, 400_000, 4), reflectance=np.full((50, 3), 0.7))
    E = np.zeros((50, 3))
    E[7] = 1.0
    certificate = certify(T, E, Neumann(rtol=1e-8).solve(T, E).radiosity)
    assert certificate.verdict == "uncertified"
    assert any("more than 5 standard errors of the sampling" in reason for reason in certificate.reasons)


def leaky(share, absorptance, count=30):
    """A closed box whose rows lose a share, as rays lost through seams do."""
    box = closed_box(count, seed=5, absorptance=0.5).factors
    factors = replace(box, matrix=csr_array(box.matrix * (1.0 - share)), statistics={"leaks/share": share})
    return TransportOperator(factors, absorptance=np.full((count, 1), absorptance))


@pytest.mark.parametrize(("share", "absorptance", "verdict"), [(1e-5, 0.3, "certified"), (1e-5, 1e-5, "refused")])
def test_leaks_are_judged_by_what_is_absorbed(share, absorptance, verdict):
    T, E = leaky(share, absorptance), np.ones((30, 1))
    certificate = certify(T, E, Direct().solve(T, E).radiosity)
    assert certificate.verdict == verdict
    assert_allclose(certificate.closure, share, rtol=1e-9)
    assert certificate.leaks == share
    if verdict == "refused":
        assert "1e-05 of the light of a closed enclosure" in str(certificate) and "mend the mesh" in str(certificate)


def test_a_leak_that_costs_more_than_the_accuracy_is_a_doubt():
    T, E = leaky(2e-3, 0.05), np.ones((30, 1))
    certificate = certify(T, E, Direct().solve(T, E).radiosity)
    assert certificate.verdict == "uncertified"
    assert any("rows that do not close lose 0.0" in reason for reason in certificate.reasons)


def test_refuses_what_is_no_answer():
    T, E = closed_box(20, seed=6, absorptance=0.3), np.ones((20, 1))
    light = Direct().solve(T, E).radiosity
    poisoned = light.copy()
    poisoned[3] = np.nan
    certificate = certify(T, E, poisoned)
    assert certificate.verdict == "refused" and "radiosity of patch 3, channel 0, is nan" in str(certificate)
    grow = FormFactors.from_matrix([[0.0, 1.0 + 5e-7], [1.0, 0.0]], area=[1.0, 1.0], to_sky=[0.0, 0.0])
    growing = certify(TransportOperator(grow, absorptance=1e-9), np.ones(2), np.full(2, 1e6))
    assert growing.verdict == "refused" and "spectral radius was not shown to be below 1" in str(growing)


def test_negative_light_is_never_certified():
    """What scipy's solvers give at a spectral radius above 1, or a solver with a flaw: far from the solution."""
    T, E = closed_box(20, seed=6, absorptance=0.3), np.ones((20, 1))
    certificate = certify(T, E, -Direct().solve(T, E).radiosity)
    assert certificate.verdict != "certified" and certificate.algebraic > 1.0


def test_a_wrong_solution_is_never_certified():
    """Two-sided: certified exactly where the true error is within the accuracy, over wrong solutions of all sizes."""
    T, E = closed_box(40, seed=7, reflectance=(0.2, 0.9)), lamps(40)
    true = Direct().solve(T, E).radiosity
    rng = np.random.default_rng(0)
    for size in np.geomspace(1e-4, 1.0, 25):
        light = true * (1.0 + size * rng.normal(size=true.shape))
        error = np.linalg.norm(T.norm(light - true)) / np.linalg.norm(T.norm(true - E))
        verdict = certify(T, E, light, accuracy=0.01).verdict
        assert (verdict == "certified") == (error * 1.02 <= 0.01) or abs(error / 0.01 - 1.0) < 0.05


def test_dark_and_black_scenes():
    T = closed_box(10, seed=8, absorptance=1.0)
    black = certify(T, np.ones((10, 1)), np.ones((10, 1)))
    assert black.verdict == "certified" and black.algebraic < 1e-14
    dark = certify(T, np.zeros((10, 1)), np.zeros((10, 1)))
    assert dark.verdict == "certified" and dark.enclosures == () and dark.energy_defect == 0.0


def test_without_symmetry_or_sampling_error_energy_is_judged_by_itself():
    F = truth().matrix.toarray() * np.random.default_rng(1).uniform(0.5, 1.5, (50, 50))
    raw = FormFactors.from_matrix(F / F.sum(axis=1, keepdims=True), truth().area)
    T, E = TransportOperator(raw, reflectance=np.full((50, 3), 0.9)), lamps()
    certificate = certify(T, E, Neumann(rtol=1e-8).solve(T, E).radiosity)
    assert certificate.energy_error is None
    assert (abs(certificate.energy_defect) > 0.01) == (certificate.verdict == "uncertified")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", FormFactorWarning)
        conserved = TransportOperator(raw.conserved(), reflectance=np.full((50, 3), 0.9))
    mended = certify(conserved, E, Neumann(rtol=1e-8).solve(conserved, E).radiosity)
    assert mended.verdict == "certified" and abs(mended.energy_defect) < 1e-6
