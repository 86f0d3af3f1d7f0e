"""Products with compressed rows: float64 sums, the same bits however they are shared out."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from scipy.sparse import csr_array

from radiosity import sparse
from radiosity.sparse import csr_differences, csr_matmul


def matrix(rows=80, columns=80, dtype=np.float32, seed=0):
    """A third full, with an empty row."""
    rng = np.random.default_rng(seed)
    dense = rng.random((rows, columns)) * (rng.random((rows, columns)) < 0.3)
    dense[5] = 0.0
    return csr_array(dense.astype(dtype))


@pytest.mark.parametrize("shape", [(80,), (80, 1), (80, 2), (80, 3), (80, 7), (80, 3, 5), (80, 2, 40)])
def test_product_is_that_of_numpy(shape):
    M, x = matrix(), np.random.default_rng(1).random(shape)
    assert_allclose(csr_matmul(M, x), np.tensordot(M.toarray().astype(float), x, axes=1), rtol=1e-13)


@pytest.mark.parametrize("shape", [(80,), (80, 1), (80, 3), (80, 7), (80, 3, 5)])
@pytest.mark.parametrize("beside", [False, True])
def test_differences_are_those_of_numpy(shape, beside):
    M, rng = matrix(dtype=np.float64), np.random.default_rng(1)
    x, y = rng.random(shape), rng.random(shape) if beside else None
    dense = M.toarray()
    pairs = x[:, None] - x[None] + (0.0 if y is None else y[None])
    assert_allclose(csr_differences(M, x, y), np.einsum("ij,ij...->i...", dense, pairs), rtol=1e-12, atol=1e-13)


@pytest.mark.parametrize("band", [1, 100, 10_000, 1 << 22])
@pytest.mark.parametrize("many", [9, 30, 50])  # with three channels: less than one panel, less than two, more
def test_same_bits_for_any_bands_widths_and_threads(monkeypatch, band, many):
    M, x = matrix(), np.random.default_rng(2).random((80, 3, many))
    one_by_one = np.stack([csr_matmul(M, x[..., s]) for s in range(many)], axis=2)
    monkeypatch.setattr(sparse, "BAND_BYTES", band)
    monkeypatch.setattr(sparse, "BLOCK_NONZEROS", 200)
    for threads in (1, 2, 4):
        assert_array_equal(csr_matmul(M, x, threads), one_by_one)
        assert_array_equal(csr_differences(M, x, threads=threads), csr_differences(M, x, threads=1))


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("index", [np.int32, np.int64])
def test_light_larger_than_caches_gives_the_same_bits(monkeypatch, dtype, index):
    """One row has more entries than are asked for ahead, most have fewer, and the last has none to ask for."""
    M = matrix(rows=60, columns=900, dtype=dtype)
    M = csr_array((M.data, M.indices.astype(index), M.indptr.astype(index)), shape=M.shape)
    square = matrix(dtype=dtype)
    rng = np.random.default_rng(3)
    products = [(M, rng.random((900, c))) for c in (1, 3)]
    x, y = rng.random((2, 80, 3))

    def found():
        return [csr_matmul(*p) for p in products] + [csr_differences(square, x, beside) for beside in (None, y)]

    near = found()
    for name in ("_rows_times_columns", "_rows_times_differences"):
        monkeypatch.setattr(sparse, name, lambda *_: pytest.fail("the light is taken for near"))
    monkeypatch.setattr(sparse, "FAR_BYTES", 0)
    for far, same in zip(found(), near, strict=True):
        assert_array_equal(far, same)


def test_columns_out_of_order_are_summed_too(monkeypatch):
    monkeypatch.setattr(sparse, "BAND_BYTES", 1)
    M = csr_array((np.array([1.0, 2.0, 4.0]), np.array([2, 0, 1]), np.array([0, 3])), shape=(1, 3))
    x = np.arange(12.0).reshape(3, 4)
    assert_allclose(csr_matmul(M, x), M.toarray() @ x)


def test_float32_weights_are_summed_in_float64():
    """A million terms of 0.1f: a float32 sum is off by almost a percent."""
    M = csr_array(np.full((1, 1_000_000), 0.1, dtype=np.float32))
    assert_allclose(csr_matmul(M, np.ones(1_000_000)), 1e6 * float(np.float32(0.1)), rtol=1e-9)


def test_a_shape_that_does_not_fit_is_refused():
    with pytest.raises(ValueError, match="80 columns but the light has 79 rows"):
        csr_matmul(matrix(), np.ones((79, 3)))


def test_control_subtracting_afterwards_loses_what_differences_keep():
    """Light of 1e12 that differs by 1 from patch to patch."""
    M, x = matrix(dtype=np.float64), 1e12 + np.arange(80.0)
    exact = np.einsum("ij,ij->i", M.toarray(), x[:, None] - x[None])
    assert_allclose(csr_differences(M, x), exact, rtol=1e-12, atol=1e-12)
    afterwards = csr_matmul(M, np.ones(80)) * x - csr_matmul(M, x)
    assert np.abs(afterwards - exact).max() > 1e-4
