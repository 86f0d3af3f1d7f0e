"""Numbers that look random: the low-discrepancy points against scipy's."""

import numpy as np
import pytest
from scipy.stats import qmc

from radiosity.sequences import MOST_DIMENSIONS, sobol_points


@pytest.mark.parametrize("dimensions", range(1, MOST_DIMENSIONS + 1))
@pytest.mark.parametrize("seed", [0, 7, 1 << 62])
def test_sobol_points_are_those_of_scipy(dimensions, seed):
    theirs = qmc.Sobol(dimensions, scramble=True, bits=32, rng=np.random.default_rng(seed)).random_base2(10)
    assert np.array_equal(sobol_points(1024, dimensions, seed), (theirs * 2.0**32).astype(np.uint32))


@pytest.mark.parametrize("count", [1, 2, 3, 100])
def test_fewer_points_are_the_first_of_more(count):
    assert np.array_equal(sobol_points(count, 4, 3), sobol_points(128, 4, 3)[:count])


def test_every_quarter_of_every_square_holds_as_many_points():
    points = sobol_points(1 << 10, 4, 5)
    for a in range(4):
        for b in range(a):
            cells = np.stack([points[:, a] >> 27, points[:, b] >> 29])  # 32 × 8 cells
            _, counts = np.unique(cells, axis=1, return_counts=True)
            assert len(counts) == 256
            assert counts.min() >= 1  # t > 0 beyond the first pair of dimensions: not 4 in each
