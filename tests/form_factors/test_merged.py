"""Form factors of groups of patches: the same light, put together."""

from __future__ import annotations

import numpy as np
import pytest

import radiosity as rad
from radiosity.errors import ParameterError
from radiosity.form_factors.estimate import more_replicates
from radiosity.form_factors.merged import merged
from radiosity.nested import parents, refined


def test_exact_factors_of_groups_are_those_of_the_groups_as_patches():
    scene = rad.scenes.furnace()
    coarse = rad.subdivide(scene, patch_count=24)
    fine = refined(scene, coarse, 2)
    group = parents(fine, coarse.grid)
    found = merged(rad.form_factors(fine, rad.Analytic(), dtype=np.float64), group, len(coarse))
    exact = rad.form_factors(coarse, rad.Analytic(), dtype=np.float64)
    np.testing.assert_allclose(found.matrix.toarray(), exact.matrix.toarray(), atol=1e-12)
    np.testing.assert_allclose(found.area, coarse.area, rtol=1e-14)


def test_merging_is_a_sum_over_columns_and_a_mean_over_rows():
    scene = rad.scenes.open_rug()
    coarse = rad.subdivide(scene, patch_count=60)
    fine = refined(scene, coarse, 2)
    group = parents(fine, coarse.grid)
    factors = rad.form_factors(fine, rad.MonteCarlo(32, replicates=2))
    found = merged(factors, group, len(coarse))
    member = group == np.arange(len(coarse))[:, None]
    mean = member * fine.area / (member @ fine.area)[:, None]
    dense = factors.matrix.toarray()
    np.testing.assert_allclose(found.matrix.toarray(), mean @ dense @ member.T, atol=1e-7)
    np.testing.assert_allclose(found.to_sky, mean @ factors.to_sky, atol=1e-14)
    np.testing.assert_allclose(found.closure_defect, 0.0, atol=1e-6)
    assert len(found.replicates) == 2
    halves = sum(run.matrix.toarray() for run in found.replicates) / 2
    np.testing.assert_allclose(halves, found.matrix.toarray(), atol=1e-6)


@pytest.mark.parametrize("scene", [rad.scenes.cornell_box(), rad.scenes.open_rug()], ids=lambda scene: scene.name)
def test_more_replicates_are_the_bits_of_all_at_once(scene):
    patches = rad.subdivide(scene, patch_count=100)
    two, three = (rad.MonteCarlo(24 * k, 5, replicates=k, light_rays=8 * k) for k in (2, 3))
    found = more_replicates(rad.form_factors(patches, two), patches, three)
    whole = rad.form_factors(patches, three)
    for one, other in ((found, whole), *zip(found.replicates, whole.replicates, strict=True)):
        assert one.matrix.indices.tobytes() == other.matrix.indices.tobytes()
        assert one.matrix.data.tobytes() == other.matrix.data.tobytes()
        assert one.to_sky.tobytes() == other.to_sky.tobytes()
    kept = {"rays/traced", "rays/to sky", "rays/to emitters", "leaks/share", "matrix/non-zeros"}
    assert {k: found.statistics[k] for k in kept} == {k: whole.statistics[k] for k in kept}


def test_replicates_of_another_kind_are_refused():
    patches = rad.subdivide(rad.scenes.furnace(), patch_count=24)
    factors = rad.form_factors(patches, rad.MonteCarlo(32, replicates=2))
    with pytest.raises(ParameterError, match="has no more replicates than"):
        more_replicates(factors, patches, rad.MonteCarlo(32, replicates=2))
    with pytest.raises(ParameterError, match="replicates that are not those of"):
        more_replicates(factors, patches, rad.MonteCarlo(32 * 3, replicates=3))
