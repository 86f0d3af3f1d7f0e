"""Heat radiation: constants, Planck's integral, exchange between grey and banded surfaces in closed form."""

import mpmath
import numpy as np
import pytest
import scipy.constants

import radiosity as rad
from radiosity import thermal
from radiosity.errors import ParameterError
from radiosity.solvers import Direct
from tests.form_factors.test_surfaces import concentric_spheres
from tests.test_exchange import two_surfaces

SIGMA = scipy.constants.Stefan_Boltzmann  # CODATA


def test_constants_are_codatas():
    assert pytest.approx(SIGMA, rel=1e-9) == thermal.STEFAN_BOLTZMANN
    assert pytest.approx(scipy.constants.value("second radiation constant"), rel=1e-9) == thermal.SECOND_CONSTANT
    assert thermal.black_exitance([0.0, 300.0]) == pytest.approx([0.0, 459.3003], abs=1e-4)


@pytest.mark.parametrize("product", [100e-6, 500e-6, 1448e-6, 2897.77e-6, 7193e-6, 7195e-6, 20e-3, 0.1, 3.0])
def test_plancks_integral(product):
    """Both series against quadrature at 30 digits; 7194 µm K is where they meet."""
    with mpmath.workdps(30):
        x = mpmath.mpf(thermal.SECOND_CONSTANT) / product
        true = 15 / mpmath.pi**4 * mpmath.quad(lambda t: t**3 / mpmath.expm1(t), [x, x + 5, x + 30, mpmath.inf])
    assert float(thermal.share_below(product / 300.0, 300.0)) == pytest.approx(float(true), abs=2e-15)


def test_plancks_integral_at_its_ends():
    assert thermal.share_below([0.0, 1e-12, np.inf], 300.0) == pytest.approx([0.0, 0.0, 1.0], abs=0)
    assert thermal.share_below([1.0, np.inf], 0.0) == pytest.approx([0.0, 1.0], abs=0)
    assert thermal.share_below(4107e-6 / 500, 500.0) == pytest.approx(0.5, abs=1e-4), "half below 4107 µm K"
    shares = thermal.band_shares([300.0, 1000.0, 6000.0], [0, 1e-6, 3e-6, 8e-6, np.inf])
    assert shares.shape == (3, 4) and (shares >= 0).all()
    assert shares.sum(axis=1) == pytest.approx(np.ones(3), abs=1e-15)


def test_temperature_is_the_inverse_of_exitance():
    for emissivity in (1.0, 0.3, 1e-6):
        kelvin = np.array([1.0, 77.0, 300.0, 5772.0])
        assert thermal.temperature(thermal.exitance(kelvin, emissivity)[:, 0], emissivity) == pytest.approx(kelvin)
    bands = thermal.exitance(1000.0, [0.2, 0.9], [0, 4e-6, np.inf])
    assert bands.sum() == pytest.approx(
        (0.2 * thermal.share_below(4e-6, 1000.0) + 0.9 * (1 - thermal.share_below(4e-6, 1000.0))) * SIGMA * 1e12
    )


@pytest.mark.parametrize(("hot", "cold"), [(1.0, 1.0), (0.8, 0.3), (0.05, 0.9), (1e-4, 1e-4)])
def test_infinite_parallel_plates(hot, cold):
    """Heat flux σ (T₁⁴ - T₂⁴) / (1/ε₁ + 1/ε₂ - 1), Siegel & Howell."""
    F = rad.FormFactors.from_matrix([[0.0, 1.0], [1.0, 0.0]], area=[1.0, 1.0])
    T = rad.TransportOperator(F, absorptance=[hot, cold])
    emission = np.array([thermal.exitance(500.0, hot), thermal.exitance(300.0, cold)])
    light = Direct().solve(T, emission).radiosity
    net = emission - T.absorptance * F.gather(light)
    q = SIGMA * (500.0**4 - 300.0**4) / (1 / hot + 1 / cold - 1)
    assert net[:, 0] == pytest.approx([q, -q], rel=1e-9)


def net_of_plates(factors, emission):
    """Net heat of two facing patches of 100 m², by the 2 × 2 system."""
    T = rad.TransportOperator(factors, absorptance=[0.8, 0.3])
    light = Direct().solve(T, emission).radiosity
    return 100.0 * (emission - T.absorptance * factors.gather(light))[:, 0]


def test_close_plates_in_a_scene():
    """One patch each, 50 times as wide as apart: heat from the exact factor of Howell C-11, by rays."""
    scene = rad.scenes.parallel_plates(emission=0.0, size=10.0, distance=0.2)
    scene = thermal.with_temperatures(scene, {"lower": 500.0, "upper": 300.0}, emissivity={"lower": 0.8, "upper": 0.3})
    rays = rad.MonteCarlo(1 << 15, 1, replicates=16, light_rays=0)  # both plates emit: apart, they would be exact
    solution = rad.solve(scene, patch_count=2, estimator=rays, dtype=np.float64, solver=rad.Neumann(rtol=1e-12))
    X = 50.0
    root = np.sqrt(1 + X * X)
    F = np.log((1 + X * X) / np.sqrt(1 + 2 * X * X)) + 2 * X * root * np.arctan(X / root) - 2 * X * np.arctan(X)
    F *= 2 / (np.pi * X * X)
    assert 0.96 < F < 0.97
    true = rad.FormFactors.from_matrix([[0.0, F], [F, 0.0]], area=[100.0, 100.0])
    E = np.array([[0.8 * SIGMA * 500.0**4], [0.3 * SIGMA * 300.0**4]])
    nets = np.array([net_of_plates(run, E) for run in solution.factors.replicates])
    error = nets.std(axis=0, ddof=1) / 4
    heat = thermal.heat_by_surface(solution)
    assert (np.abs(heat.net[:, 0] - net_of_plates(true, E)) < 4.5 * error).all()
    assert (error < 1e-3 * np.abs(heat.net[:, 0])).all()
    assert heat.of("lower") == heat.net[0, 0]


@pytest.mark.parametrize(("inner", "outer"), [(0.8, 0.3), (0.1, 1.0)])
def test_concentric_spheres(inner, outer):
    scene = thermal.with_temperatures(
        concentric_spheres(), {"ball": 400.0, "shell": 280.0}, emissivity={"ball": inner, "shell": outer}
    )
    solution = rad.solve(scene, patch_count=640, estimator=rad.MonteCarlo(1024), dtype=np.float64)
    heat = thermal.heat_by_surface(solution)
    expected = heat.area[0] * two_surfaces(inner, outer, heat.area[0] / heat.area[1]) * SIGMA * (400.0**4 - 280.0**4)
    assert heat.of("ball") == pytest.approx(expected, rel=3e-3), "facets, and the sampling error of the rays"
    assert -heat.of("shell") == pytest.approx(expected, rel=2e-2), "what is small beside the shell's own exchange"


def test_nothing_flows_where_all_is_as_warm():
    """The second law: with rows that close, radiosity is σ T⁴ everywhere, whatever the emissivities."""
    scene = rad.scenes.cornell_box()
    names = scene.surface_names
    grey = rad.Scene([rad.Surface(s.name, s.vertices, s.faces, rad.Material(0.5)) for s in scene.surfaces])
    emissivity = dict(zip(names, [0.9, 0.1, 0.5, 0.8, 0.05, 1.0, 0.3, 0.6], strict=True))
    warm = thermal.with_temperatures(grey, dict.fromkeys(names, 350.0), emissivity=emissivity, surroundings=350.0)
    solution = rad.solve(
        warm, patch_count=300, estimator=rad.MonteCarlo(256), dtype=np.float64, solver=rad.Neumann(rtol=1e-13)
    )
    assert solution.radiosity == pytest.approx(np.full_like(solution.radiosity, SIGMA * 350.0**4), rel=1e-9)
    heat = thermal.heat_by_surface(solution)
    assert np.abs(heat.net).max() < 1e-9 * heat.emitted.max()
    cold = solution.relight(sky=[0.0])
    assert thermal.heat_by_surface(cold).net.sum() > 1.0, "heat gets out once it is cold outside"


def test_bands_add_up_to_grey():
    edges = [0, 5e-6, 10e-6, np.inf]
    plates = rad.scenes.parallel_plates(emission=0.0)
    grey, banded = (
        thermal.with_temperatures(plates, {"lower": 600.0}, emissivity=0.7, band_edges=bands, surroundings=300.0)
        for bands in (None, edges)
    )
    assert grey.channels == 1 and banded.channels == 3
    first, second = (
        thermal.heat_by_surface(rad.solve(scene, patch_count=8, estimator=rad.MonteCarlo(256)))
        for scene in (grey, banded)
    )
    assert second.net.sum(axis=1) == pytest.approx(first.net[:, 0], rel=1e-9)
    text = str(second)
    assert text.splitlines()[0].startswith("surface") and "lower" in text
    assert banded.sky.sum() * np.pi == pytest.approx(SIGMA * 300.0**4)


def test_what_is_kept_and_what_is_not():
    scene = rad.scenes.parallel_plates(reflectance=0.4, emission=5.0)
    warm = thermal.with_temperatures(scene, {"upper": 300.0})
    lower, upper = (surface.material for surface in warm.surfaces)
    assert lower.emission == pytest.approx([5.0]), "not named, so left alone"
    assert upper.emission == pytest.approx([0.6 * SIGMA * 300.0**4]), "the absorptance is the emissivity"
    assert (warm.sky == scene.sky).all()
    tiny = thermal.with_temperatures(scene, {"upper": 300.0}, emissivity=1e-12).surfaces[1].material
    assert tiny.given == "absorptance" and tiny.absorptance[0] == 1e-12


@pytest.mark.parametrize(
    ("call", "sentence"),
    [
        (lambda: thermal.black_exitance(-1.0), "negative or not finite; give kelvin"),
        (lambda: thermal.black_exitance(np.nan), "give kelvin"),
        (lambda: thermal.share_below(-1e-6, 300.0), "not a length"),
        (lambda: thermal.band_shares(300.0, [2e-6, 1e-6]), "rising wavelengths"),
        (lambda: thermal.exitance(300.0, 1.2), r"outside \[0, 1\]"),
        (lambda: thermal.exitance(300.0, [0.1, 0.2]), "give one, or 1, one a band"),
        (lambda: thermal.temperature(-1.0), "no temperature emits it"),
        (lambda: thermal.temperature(1.0, 0.0), r"outside \(0, 1\]"),
        (lambda: thermal.with_temperatures(rad.scenes.red_rug(), {"rug": 300.0}), "has 3 channels; give band_edges, 4"),
        (lambda: thermal.with_temperatures(rad.scenes.parallel_plates(), {"wall": 1.0}), "temperatures: no surface"),
        (
            lambda: thermal.with_temperatures(rad.scenes.parallel_plates(), {"lower": 1.0}, emissivity={"x": 1.0}),
            "emissivity: no surface",
        ),
    ],
)
def test_what_no_surface_can_have(call, sentence):
    with pytest.raises(ParameterError, match=sentence):
        call()
