"""CIE 171:2006, tests 5.6, 5.7 and 5.8, through the whole pipeline. The tables: tests/benchmarks/cie171.py."""

import numpy as np
import pytest

import radiosity as rad
from radiosity.errors import OccludedSceneError
from tests.benchmarks import cie171
from tests.benchmarks.cie171 import FLUX, SIDE, TRUTH


@pytest.fixture(params=[cie171.scene_5_6, cie171.scene_5_7], ids=["5.6", "5.7"])
def scene(request):
    return request.param()


def exact(scene):
    return {name: 100.0 * factor for name, factor in TRUTH[scene.name]["configuration_factor"].items()}


def test_the_closed_form_is_what_the_standard_prints(scene):
    """Table 17 and the corrected Table 19, to half of their last digit."""
    published = TRUTH[scene.name]["published_percent"]
    for name, value in exact(scene).items():
        digits = 0.005 if published[name] == round(published[name], 2) else 0.0005
        assert abs(value - published[name]) <= 1.1 * digits, name


def test_points_by_rays_within_their_standard_errors(scene):
    reading = cie171.read_points(scene, cie171.RAYS)
    deviations = []
    for name, value in exact(scene).items():
        if value == 0.0:
            assert reading.percent[name] == 0.0 == reading.error[name], "the box hides all of S2"
            continue
        assert 0.0 < reading.error[name] < 0.1, "per cent of E × ρ"
        deviations.append((reading.percent[name] - value) / reading.error[name])
    assert np.abs(deviations).max() < 4.5
    assert 0.4 < np.sqrt(np.mean(np.square(deviations))) < 1.8, "neither bias, nor errors that explain anything"


def test_points_by_hemicube(scene):
    reading = cie171.read_points(scene, rad.Hemicube(256))
    for name, value in exact(scene).items():
        assert reading.percent[name] == pytest.approx(value, abs=0.2), name


def test_points_by_rays_from_them(scene):
    """`irradiance_at`, as a user reads a grid."""
    reading = cie171.read_by_points(scene)
    for name, value in exact(scene).items():
        assert reading.percent[name] == pytest.approx(value, abs=0.25), name


def test_points_by_exact_factors():
    """5.6 hides nothing; 5.7 does, and is refused. A sensor of 1 mm is a point to 1e-7."""
    scene = cie171.scene_5_6()
    reading = cie171.read_points(scene, rad.Analytic())
    for name, value in exact(scene).items():
        assert reading.percent[name] == pytest.approx(value, rel=1e-6), name
    with pytest.raises(OccludedSceneError):
        cie171.read_points(cie171.scene_5_7(), rad.Analytic())


def test_without_the_box_the_shadow_is_missed():
    """Negative control of 5.7: points J and K, which the box leaves dark, get light when visibility is forgotten."""
    scene = cie171.scene_5_7()
    patches = rad.subdivide(scene)
    open_share = rad.shortcuts.NoVisibility(rays=4096).exchange(patches).matrix.toarray()
    for name in "JK":
        assert 100.0 * open_share[scene.surface_names.index(name), 0] > 3.0


# 5.8


@pytest.fixture(scope="module")
def room():
    return cie171.room_5_8(patch_count=216)


def formula(room):
    """Φ ρ / (S (1 - ρ)): the answer for any distribution of the first reflection."""
    rho = np.array(room.reflectance)
    return FLUX * rho / (6 * SIDE**2 * (1 - rho))


def test_the_point_source_gives_all_its_flux_to_the_walls(room):
    first = np.sum(room.patches.area[:, None] * room.emission, axis=0)
    assert first == pytest.approx(FLUX * np.array(room.reflectance), rel=1e-13)
    direct = room.emission[:, 0] / room.reflectance[0]
    assert direct.max() / direct.min() > 2.0, "more in the middle of the walls than in the corners"


def test_the_mean_indirect_illuminance_of_a_cube(room):
    exact_factors = rad.form_factors(room.patches, rad.Analytic(), dtype=np.float64)
    found = cie171.mean_indirect(room, exact_factors)
    assert found == pytest.approx(formula(room), rel=1e-6)
    published = np.array(list(TRUTH["5.8"]["published_lux"].values()))
    assert found == pytest.approx(published, rel=2.5e-3), "Table 20 is printed to three digits"


def test_the_mean_by_rays_within_its_standard_error_and_exactly_once_conserved(room):
    factors = rad.form_factors(room.patches, rad.MonteCarlo(512, 0, replicates=8), dtype=np.float64)
    runs = np.array([cie171.mean_indirect(room, run) for run in factors.replicates])
    error = runs.std(axis=0, ddof=1) / np.sqrt(8)
    deviation = (cie171.mean_indirect(room, factors) - formula(room)) / error
    assert np.abs(deviation).max() < 4.5
    assert error[-1] < 0.003 * formula(room)[-1]
    assert cie171.mean_indirect(room, factors.conserved()) == pytest.approx(formula(room), rel=1e-6)


def test_a_cap_of_eight_reflections_loses_two_thirds_of_the_light_at_095(room):
    """The rest after k reflections is ρ^k of the whole: 66 % at k = 8, ρ = 0.95; 32 % takes 22 reflections."""
    factors = rad.form_factors(room.patches, rad.Analytic(), dtype=np.float64)
    for bounces, lost in ((8, 0.6634), (22, 0.3235)):
        found = cie171.mean_indirect(room, factors, bounces=bounces)
        assert found == pytest.approx(formula(room) * (1 - np.array(room.reflectance) ** bounces), rel=1e-6)
        assert 1 - found[-1] / formula(room)[-1] == pytest.approx(lost, abs=1e-4)
