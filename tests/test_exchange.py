"""Total exchange (Gebhart) factors: closed forms, closure, reciprocity, what is refused."""

import numpy as np
import pytest

import radiosity as rad
from radiosity.errors import FormFactorError, NoSteadyState, SolverError
from radiosity.exchange import total_exchange_factors
from radiosity.solvers import Direct, GaussSeidel, Neumann
from tests.form_factors.test_surfaces import concentric_spheres
from tests.systems import exchange_to_factors, materials, random_exchange

# A ball in a shell of five times its area.
FIVE = rad.FormFactors.from_matrix([[0.0, 1.0], [0.2, 0.8]], area=[1.0, 5.0])


def two_surfaces(inner, outer, area_ratio):
    """Net heat between a convex body and its enclosure, per (T₁⁴ - T₂⁴) σ A₁: the closed form of two grey surfaces.

    J. P. Holman, Heat Transfer; H. C. Hottel: 1 / (1/ε₁ + A₁/A₂ (1/ε₂ - 1)).
    """
    return 1.0 / (1.0 / inner + area_ratio * (1.0 / outer - 1.0))


@pytest.mark.parametrize("inner", [1.0, 0.8, 0.3, 1e-3])
@pytest.mark.parametrize("outer", [1.0, 0.5, 0.02])
def test_two_grey_surfaces(inner, outer):
    total = total_exchange_factors(rad.TransportOperator(FIVE, absorptance=[inner, outer]), surface=[0, 1])
    assert total.exchange_area[0, 1, 0] == pytest.approx(two_surfaces(inner, outer, 0.2), rel=1e-6)
    assert total.exchange_area[1, 0, 0] == pytest.approx(total.exchange_area[0, 1, 0], rel=1e-6)
    assert np.abs(total.closure_defect).max() < 1e-6


def test_an_absorptance_of_1e_12_needs_elimination_and_is_then_exact():
    T = rad.TransportOperator(FIVE, absorptance=[1e-12, 3e-12])
    total = total_exchange_factors(T, Direct(), surface=[0, 1])
    assert total.exchange_area[0, 1, 0] == pytest.approx(two_surfaces(1e-12, 3e-12, 0.2), rel=1e-12)
    assert total.share.sum(axis=1) == pytest.approx(np.ones((2, 1)), abs=1e-12)


def test_in_a_sphere_light_ends_where_it_is_absorbed_best():
    """Integrating sphere: share[i, j] = A_j α_j / Σ A α, from wherever it comes (Jacquez & Kuppenheim 1955)."""
    area, alpha = np.array([1.0, 2.0, 3.0, 4.0]), np.array([0.1, 0.9, 0.05, 1.0])
    F = rad.FormFactors.from_matrix(np.tile(area / area.sum(), (4, 1)), area)
    total = total_exchange_factors(rad.TransportOperator(F, absorptance=alpha), surface=range(4))
    expected = np.tile(area * alpha / np.sum(area * alpha), (4, 1))
    assert total.share[..., 0] == pytest.approx(expected, abs=1e-8)


def gebhart(F, alpha):
    """The twin: G = F α + F ρ G, solved densely (Gebhart 1961)."""
    return np.linalg.solve(np.eye(len(F)) - F * (1 - alpha), F * alpha)


@pytest.mark.parametrize("solver", [None, Neumann(rtol=1e-9, maxiter=10_000), Direct()])
def test_any_solver_gives_gebharts_factors(solver):
    factors = exchange_to_factors(random_exchange(30, 1), to_sky=0.1)
    rho = materials(30, 2, 0.1, 0.9)
    total = total_exchange_factors(rad.TransportOperator(factors, reflectance=rho), solver, surface=range(30))
    for c in range(3):
        assert total.share[..., c] == pytest.approx(gebhart(factors.matrix.toarray(), 1 - rho[:, c]), abs=1e-7)
    assert np.abs(total.closure_defect).max() < 1e-7
    assert total.reciprocity_defect < 1e-7
    assert (total.to_sky > 0.1).all() and (total.to_backs == 0).all()


def test_many_surfaces_are_solved_for_in_blocks(monkeypatch):
    factors = exchange_to_factors(random_exchange(30, 1))
    T = rad.TransportOperator(factors, reflectance=materials(30, 2, 0.1, 0.9))
    at_once = total_exchange_factors(T, surface=range(30))
    monkeypatch.setattr("radiosity.exchange.BLOCK_BYTES", 8 * 30 * 3 * 7)
    assert total_exchange_factors(T, surface=range(30)).share == pytest.approx(at_once.share, abs=1e-8)


def test_a_ball_in_a_shell_by_rays_within_standard_errors():
    """Faceted spheres do not light evenly; by symmetry of the facets the closed form holds to about 1e-3."""
    patches = rad.subdivide(concentric_spheres())
    factors = rad.form_factors(patches, rad.MonteCarlo(1024, replicates=8), dtype=np.float64)
    alpha = np.where(patches.surface == 0, 0.8, 0.3)
    total = total_exchange_factors(rad.TransportOperator(factors, absorptance=alpha))
    assert total.names == ("ball", "shell")
    assert np.abs(total.closure_defect).max() < 1e-8, "raw rows close exactly, so do these"
    expected = two_surfaces(0.8, 0.3, 0.25) / 0.8
    error = total.standard_error[0, 1, 0]
    assert 0 < error < 1e-3
    assert abs(total.factor("ball", "shell")[0] - expected) < 4.5 * error + 1e-3
    assert total.reciprocity_defect < 2e-3


def test_the_cornell_box_sends_a_third_of_its_lamplight_out():
    patches = rad.subdivide(rad.scenes.cornell_box(), patch_count=300)
    factors = rad.form_factors(patches, rad.MonteCarlo(1024))
    T = rad.TransportOperator(factors, patches)
    total = total_exchange_factors(T)
    assert np.abs(total.closure_defect).max() < 1e-6
    assert total.to_sky[total.names.index("lamp")] == pytest.approx([0.32, 0.30, 0.26], abs=0.02)
    assert total.factor("lamp", "green_wall")[0] > total.factor("lamp", "red_wall")[0], "red light"
    assert total.factor("lamp", "green_wall")[1] < total.factor("lamp", "red_wall")[1], "green light"
    solution = Neumann(rtol=1e-8, maxiter=1000).solve(T, patches.emission)
    arriving = factors.gather(solution.radiosity)
    power = np.sum(patches.area[:, None] * patches.absorptance * arriving, axis=0)
    lamp = patches.surface == patches.surface_names.index("lamp")
    emitted = np.sum((patches.area[:, None] * patches.emission)[lamp], axis=0)
    absorbed = total.share[patches.surface_names.index("lamp")].sum(axis=0)
    assert power / emitted == pytest.approx(absorbed, rel=0.02), "gathering, which closes within the sampling error"


def test_both_words_are_printed():
    total = total_exchange_factors(rad.TransportOperator(FIVE, reflectance=np.full((2, 4), 0.5)), surface=[0, 1])
    assert "channel 2" in str(total) and "1 channels more" in str(total)
    assert total.text(3).splitlines()[1].split() == ["1", "2", "sky", "backs", "sum"]
    assert total.to_csv().splitlines()[0] == "surface,area_m2,0,1,(sky),(backs)"


def test_what_is_refused():
    with pytest.raises(NoSteadyState, match="2 patches .* absorb nothing of channel 0"):
        total_exchange_factors(rad.TransportOperator(FIVE, reflectance=1.0), surface=[0, 1])
    with pytest.raises(FormFactorError, match="know no surfaces"):
        total_exchange_factors(rad.TransportOperator(FIVE, reflectance=0.5))
    T = rad.TransportOperator(FIVE, absorptance=1e-6)
    with pytest.raises(SolverError, match="not converged after 3 steps of GaussSeidel"):
        total_exchange_factors(T, GaussSeidel(maxiter=3), surface=[0, 1])


def test_one_bounce_too_few_is_seen():
    """Negative control: absorption of the direct light only leaves rows short of one."""
    alpha = np.array([0.5, 0.5])
    direct_only = FIVE.matrix.toarray() * alpha
    assert (direct_only.sum(axis=1) < 0.6).all()
    total = total_exchange_factors(rad.TransportOperator(FIVE, absorptance=alpha), surface=[0, 1])
    assert np.abs(total.share[..., 0] - direct_only).max() > 0.1
