"""What methods are compared with is right: closed forms, exact factors, and walks that agree or do not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import radiosity as rad
from radiosity.nested import means, refined
from radiosity.study.closed_forms import closed_form, sphere_light
from radiosity.study.measures import Light
from radiosity.study.reference import Effort, keep, kept, reference
from radiosity.study.solving import run_method
from radiosity.study.yardstick import checks

QUICK = Effort(rays=1024, replicates=2, factor=2, paths=64)


def cut(scene, count=150):
    return scene, rad.subdivide(scene, patch_count=count)


@pytest.mark.parametrize(
    "scene",
    [rad.scenes.furnace(reflectance=0.7), rad.scenes.uniform_dome(0.4, [1.0, 2.0, 0.5])],
    ids=lambda scene: scene.name,
)
def test_closed_forms_are_what_any_factors_give(scene):
    patches = rad.subdivide(scene)
    light, _ = closed_form(patches)
    found, _ = run_method(patches, rad.MonteCarlo(64))
    np.testing.assert_allclose(found.radiosity, light.radiosity, rtol=1e-5)
    np.testing.assert_allclose(found.orders, light.orders, rtol=1e-5, atol=1e-6)


def test_the_sphere_is_met_as_its_facets_grow_finer():
    gaps = []
    for subdivisions in (1, 2):
        patches = rad.subdivide(rad.scenes.integrating_sphere(subdivisions=subdivisions))
        found, _ = run_method(patches, rad.Analytic())
        true = sphere_light(patches).radiosity
        gaps.append(np.abs(found.radiosity / true - 1.0).max())
    assert gaps[1] < 0.6 * gaps[0] < 0.05


def test_most_scenes_have_no_closed_form():
    for name in ("cornell_box", "red_rug", "parallel_plates", "lit_sphere", "two_rooms"):
        patches = rad.subdivide(getattr(rad.scenes, name)(), patch_count=50 if name != "lit_sphere" else None)
        assert closed_form(patches) is None
        assert sphere_light(patches) is None


def test_where_nothing_hides_anything_the_reference_is_exact():
    scene, patches = cut(rad.scenes.open_rug(), 60)
    truth = reference(scene, patches, QUICK)
    assert truth.discrete_error == truth.continuous_error == 0.0
    fine = refined(scene, patches, 2)
    by_hand, _ = run_method(fine, rad.Analytic())
    np.testing.assert_allclose(truth.continuous.radiosity, means(by_hand.radiosity, fine, patches), rtol=1e-5)
    assert 1e-4 < truth.discretisation < 0.05


def test_the_reference_knows_its_own_error(tmp_path):
    """It is what two references of other seeds differ by, up to chance."""
    scene, patches = cut(rad.scenes.cornell_box())
    truth = reference(scene, patches, replace(QUICK, replicates=4))
    much, _ = run_method(patches, rad.MonteCarlo(1 << 14, 77, light_rays=1 << 12))
    size = np.linalg.norm(np.sqrt(patches.area)[:, None] * (much.radiosity - patches.emission))
    gap = np.linalg.norm(np.sqrt(patches.area)[:, None] * (much.radiosity - truth.discrete.radiosity)) / size
    assert 0.5 * truth.discrete_error < gap < 2.0 * truth.discrete_error

    keep(truth, tmp_path / "truth.npz")
    again = kept(tmp_path / "truth.npz")
    assert again.discrete.orders.tobytes() == truth.discrete.orders.tobytes()
    assert (again.how, again.by_order, again.discretisation) == (truth.how, truth.by_order, truth.discretisation)


def test_the_yardstick_agrees_with_what_is_right_and_not_with_what_is_wrong():
    scene, patches = cut(rad.scenes.cornell_box())
    truth = reference(scene, patches, QUICK)
    assert [check.agrees for check in checks(patches, truth, 64)] == [True, True]

    dimmed = Light(patches.emission + 0.9 * (truth.discrete.radiosity - patches.emission), truth.discrete.orders)
    wrong, _ = checks(patches, replace(truth, discrete=dimmed), 512)
    assert wrong.agrees is False
    assert wrong.excess == pytest.approx(0.111, rel=0.3)
