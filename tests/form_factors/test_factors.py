"""`FormFactors` as an object: gathering, defects, refusals."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.sparse import csr_array, random_array

import radiosity as rad
from radiosity.errors import FormFactorError
from radiosity.sparse import csr_matmul


@pytest.mark.parametrize("shape", [(), (1,), (3,), (4,), (3, 5), (0,)])
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_gather_is_the_matrix_product(shape, dtype):
    rng = np.random.default_rng(0)
    matrix = csr_array(random_array((300, 300), density=0.05, rng=rng, dtype=np.float64)).astype(dtype)
    light = rng.random((300, *shape))
    found = csr_matmul(matrix, light)
    true = np.tensordot(matrix.toarray().astype(np.float64), light, axes=1)
    assert found.shape == light.shape
    assert found == pytest.approx(true, rel=1e-13)


def test_sums_are_float64_even_where_weights_are_float32():
    """A million float32 terms: float32 sums would be off by a per cent."""
    count = 1_000_000
    weights = np.full(count, 1e-6, dtype=np.float32)
    matrix = csr_array((weights, np.arange(count), [0, count]), shape=(1, count))
    assert csr_matmul(matrix, np.ones(count))[0] == pytest.approx(float(weights[0]) * count, rel=1e-12)


@pytest.mark.parametrize("threads", [1, 2, 4])
def test_products_have_the_same_bits_for_any_threads(threads):
    rng = np.random.default_rng(1)
    matrix = csr_array(random_array((5000, 5000), density=0.02, rng=rng, dtype=np.float64))
    light = rng.random((5000, 3))
    assert (csr_matmul(matrix, light, threads) == csr_matmul(matrix, light, 1)).all()


def test_a_users_own_matrix_keeps_its_numbers():
    F = rad.FormFactors.from_matrix([[0.0, 0.25], [0.125, 0.0]], area=[1.0, 2.0])
    assert F.to_sky.tolist() == [0.75, 0.875]
    assert F.reciprocity_defect == 0.0
    assert F.row(1).tolist() == [0.125, 0.0]
    assert np.abs(F.closure_defect).max() == 0.0
    skewed = rad.FormFactors.from_matrix([[0.0, 0.25], [0.25, 0.0]], area=[1.0, 2.0])
    assert skewed.reciprocity_defect == pytest.approx(np.sqrt(2) * 0.25 / np.hypot(0.25, 0.5))


@pytest.mark.parametrize(
    ("F", "area", "message"),
    [
        ([[0.0, np.nan], [0.5, 0.0]], [1, 1], r"F\[0, 1\] = nan"),
        ([[0.0, 0.5], [-0.5, 0.0]], [1, 1], r"F\[1, 0\] = -0.5"),
        ([[0.5, 0.502], [0.5, 0.5]], [1, 1], "row 0 of F sums to 1.002"),
        ([[0.5, 0.5], [0.5, np.inf]], [1, 1], r"F\[1, 1\] = inf"),
        ([[0.5, 0.5], [0.5, 0.5]], [1, 0], "area 0 m² of patch 1"),
        ([[0.5, 0.5], [0.5, 0.5]], [1, 1, 1], r"\(2, 2\) and area \(3,\)"),
        ([[0.5, 0.5]], [1], r"\(1, 2\)"),
    ],
)
def test_what_is_no_exchange_of_light_is_refused_with_its_place(F, area, message):
    with pytest.raises(FormFactorError, match=message):
        rad.FormFactors.from_matrix(F, area)


def test_sky_and_backs_count_in_the_row():
    with pytest.raises(FormFactorError, match="more than 1 leaves patch 0"):
        rad.FormFactors.from_matrix([[0.5]], [1.0], to_sky=[0.6])
    with pytest.raises(FormFactorError, match="to_sky -0.1"):
        rad.FormFactors.from_matrix([[0.5]], [1.0], to_sky=[-0.1])
    assert rad.FormFactors.from_matrix([[0.5]], [1.0], to_backs=[0.25]).to_sky.tolist() == [0.25]
