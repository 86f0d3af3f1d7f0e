"""Fine patches lie in coarse ones, tile them, and give back their means."""

from __future__ import annotations

import numpy as np
import pytest

import radiosity as rad
from radiosity.nested import means, parents, refined

from .test_patches import soup


@pytest.mark.parametrize("factor", [1, 2, 3, 5])
@pytest.mark.parametrize("seed", [0, 1])
def test_fine_patches_tile_their_parents(factor, seed):
    scene = soup(seed)
    coarse = rad.subdivide(scene, patch_count=150)
    fine = refined(scene, coarse, factor)
    parent = parents(fine, coarse.grid)

    assert len(fine) == factor**2 * len(coarse)
    assert (np.bincount(parent, minlength=len(coarse)) == factor**2).all()
    np.testing.assert_allclose(np.bincount(parent, fine.area), coarse.area, rtol=1e-12)
    assert (fine.face == coarse.face[parent]).all()
    assert (fine.side == coarse.side[parent]).all()
    for x in range(3):  # the mean of where the parts are is where the whole is: no two parents are mixed up
        middles = np.bincount(parent, fine.area * fine.centroid[:, x]) / coarse.area
        np.testing.assert_allclose(middles, coarse.centroid[:, x], atol=1e-12 * np.abs(coarse.vertices).max())


def test_means_of_a_linear_field_are_its_values_at_the_centroids():
    scene = soup(2)
    coarse = rad.subdivide(scene, patch_count=100)
    fine = refined(scene, coarse, 3)
    slope = np.array([[1.0, 2.0], [-1.0, 0.5], [3.0, 0.0]])
    np.testing.assert_allclose(means(fine.centroid @ slope, fine, coarse), coarse.centroid @ slope, atol=1e-11)


def test_a_factor_below_one_is_refused():
    scene = soup(0)
    with pytest.raises(rad.errors.ParameterError, match="factor is 0"):
        refined(scene, rad.subdivide(scene), 0)
