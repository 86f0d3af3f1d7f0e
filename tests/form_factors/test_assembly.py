"""Counting hits without sorting them, beside counting them with numpy."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.sparse import random_array

from radiosity.form_factors import assembly
from radiosity.form_factors.assembly import RowBlock, Rows, count_hits
from radiosity.rays import BACK, MISS


@pytest.mark.parametrize("count", [1, 2, 63, 64, 65, 4095, 4096, 4097, 200_000])
@pytest.mark.parametrize("rays", [1, 7, 300])
def test_the_kernel_and_its_readable_twin_agree(count, rays):
    """Patches at the ends of every word of bits, rows without a hit, rows all of one patch."""
    rng = np.random.default_rng(count + rays)
    rows = 20
    ends = np.array([0, 63, 64, 4095, 4096, count - 1])
    hits = np.where(
        rng.random((rows, rays)) < 0.3,
        rng.choice(ends[ends < count], (rows, rays)),
        rng.integers(0, count, (rows, rays)),
    )
    hits[rng.random((rows, rays)) < 0.1] = MISS
    hits[rng.random((rows, rays)) < 0.1] = BACK
    hits[0], hits[1], hits[2] = MISS, BACK, count - 1
    lengths, indices, counts, to_sky, to_backs = count_hits(hits.astype(np.int32).ravel(), rows, count)
    twins = [np.unique(row[row >= 0], return_counts=True) for row in hits]
    assert lengths.tolist() == [len(columns) for columns, _ in twins]
    assert indices.tolist() == np.concatenate([columns for columns, _ in twins]).tolist()
    assert counts.tolist() == np.concatenate([n for _, n in twins]).tolist()
    assert to_sky.tolist() == (hits == MISS).sum(axis=1).tolist()
    assert to_backs.tolist() == (hits == BACK).sum(axis=1).tolist()


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_the_mean_of_estimates_and_its_readable_twin_agree(dtype, monkeypatch):
    """Rows that are empty in one estimate or in all, columns that one has or all have; added in order, rounded once."""
    monkeypatch.setattr(assembly, "MEAN_ENTRIES", 40)
    runs = [
        Rows(random_array((30, 30), density=density, dtype=dtype, rng=seed).tocsr(), np.full(30, seed), np.zeros(30))
        for seed, density in enumerate((0.3, 0.1, 0.0, 0.5))
    ]
    for some in (runs[:2], runs):
        total = some[0].matrix.astype(np.float64)
        for run in some[1:]:
            total = total + run.matrix
        for threads in (1, 2):
            mean = assembly.mean_rows(some, dtype, threads)
            assert mean.matrix.dtype == dtype
            assert np.array_equal(mean.matrix.toarray(), (total.toarray() / len(some)).astype(dtype))
            assert mean.matrix.nnz == total.nnz and (np.diff(mean.matrix.indices[:5]) != 0).all()
            assert (mean.to_sky == np.mean(range(len(some)))).all()


def test_room_grows_where_the_first_rows_foretell_too_little():
    """Three rows with one entry, then full ones; and the other way round."""
    for lengths in ([1, 1, 1, 40, 40, 2], [40, 1, 0, 0, 0, 1]):
        made = [
            RowBlock(k, np.array([n]), np.arange(n, dtype=np.int32), np.full(n, k + 1.0), np.zeros(1), np.zeros(1))
            for k, n in enumerate(lengths)
        ]
        matrix = assembly.stack_rows(made, len(lengths), np.float64, columns=40).matrix
        assert np.diff(matrix.indptr).tolist() == lengths
        assert matrix.sum(axis=1).tolist() == [n * (k + 1) for k, n in enumerate(lengths)]
