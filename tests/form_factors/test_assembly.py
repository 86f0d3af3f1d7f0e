"""Counting hits without sorting them, beside counting them with numpy."""

from __future__ import annotations

import numpy as np
import pytest

from radiosity.form_factors.assembly import count_hits
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
