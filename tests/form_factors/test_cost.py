"""Bytes foretold are the bytes it takes, and what would not fit is refused before it begins."""

from __future__ import annotations

import numpy as np
import pytest

import radiosity as rad
from radiosity import memory
from radiosity.errors import MemoryLimitError, ParameterError
from radiosity.form_factors import cost, estimate
from radiosity.form_factors.assembly import RowBlock
from radiosity.form_factors.cost import predict


def bytes_of(factors):
    """Of all arrays of a set of factors, and of its replicates."""
    return sum(
        m.matrix.data.nbytes + m.matrix.indices.nbytes + m.matrix.indptr.nbytes + m.to_sky.nbytes + m.to_backs.nbytes
        for m in (factors, *factors.replicates)
    )


@pytest.mark.parametrize(
    ("scene", "count", "method", "dtype"),
    [
        (rad.scenes.cornell_box, 5_000, rad.MonteCarlo(64), np.float32),
        (rad.scenes.cornell_box, 1_500, rad.MonteCarlo(512, replicates=2), np.float64),
        (rad.scenes.cluttered_room, 5_000, rad.MonteCarlo(128, sampling="random"), np.float32),
        (rad.scenes.window_room, 1_500, rad.Hemicube(16), np.float32),
        (rad.scenes.furnace, 300, rad.Analytic(), np.float64),
    ],
    ids=str,
)
def test_bytes_are_foretold(scene, count, method, dtype):
    """Rays of a patch meet the same patch again and again: that, too, is in the sample."""
    patches = rad.subdivide(scene(), patch_count=count)
    found = predict(patches, method, dtype)
    factors = rad.form_factors(patches, method, dtype=dtype)
    assert found.nonzeros == pytest.approx(factors.matrix.nnz, rel=0.05)
    assert found.bytes == pytest.approx(bytes_of(factors), rel=0.05)
    assert found.bytes <= found.peak_bytes
    assert 0 < found.sampled <= len(patches) == found.patches
    assert found.seconds > 0


def test_a_large_assembly_is_foretold_from_few_of_its_rows():
    patches = rad.subdivide(rad.scenes.cornell_box(), patch_count=100_000)
    found = predict(patches, rad.MonteCarlo(128))
    assert found.sampled < 0.1 * len(patches)
    assert str(found).startswith(f"{len(patches):,} patches: about {found.nonzeros:,} non-zeros") and "MB" in str(found)


class Metered:
    """An estimator whose calls cost 3 s and rows 0.01 s (cheap half) or 0.03 s each, by a clock of its own."""

    replicates, rows_at_once, most, divisor, exact_columns = 1, 128, 1, 1.0, None

    def __init__(self):
        self.now = 0.0

    def thread_time(self):
        return self.now

    perf_counter = thread_time

    def rows(self, patches, _tracer, _replicate):
        self.half = len(patches) / 2
        return self

    def __call__(self, span):
        rows = np.arange(*span)
        self.now += 3.0 + np.where(rows < self.half, 0.01, 0.03).sum()
        ones = np.ones(len(rows))
        return RowBlock(span[0], ones.astype(np.int64), rows.astype(np.int32), ones, 0.0 * ones, 0.0 * ones)


@pytest.mark.parametrize("threads", [1, 3])
def test_seconds_are_those_of_whole_blocks_all_over_the_scene(monkeypatch, threads):
    """A sample of small blocks alone would call eight times as often, and one of few places find one price."""
    patches = rad.subdivide(rad.scenes.furnace(), patch_count=20_000)
    estimator = Metered()
    monkeypatch.setattr(cost, "time", estimator)
    monkeypatch.setattr(cost, "ordered_map", lambda function, items, _: map(function, items))
    found = predict(patches, estimator, threads=threads)
    turns = -(-len(patches) // 128 // threads)
    assert found.seconds == pytest.approx(turns * (3.0 + 128 * 0.02), rel=0.02)


def test_more_than_the_limit_is_refused_with_figures_and_ways_out(monkeypatch):
    patches = rad.subdivide(rad.scenes.cornell_box(), patch_count=5_000)
    monkeypatch.setattr(estimate, "RowsToMake", lambda *_: pytest.fail("nothing is assembled"))
    with pytest.raises(MemoryLimitError) as refusal:
        rad.form_factors(patches, rad.MonteCarlo(64, replicates=2), dtype=np.float64, memory_limit=1e6)
    message = str(refusal.value)
    for words in (f"{len(patches):,} patches", "MB", "1 MB", "fewer rays", "one replicate", "float32", "memory_limit"):
        assert words in message
    with pytest.raises(MemoryLimitError):
        rad.solve(rad.scenes.cornell_box(), patch_count=5_000, memory_limit=1e6)


def test_a_limit_between_what_it_takes_and_the_worst_case_lets_it_through():
    """512 rays meet some 300 patches: room for 512 entries is not needed."""
    patches = rad.subdivide(rad.scenes.furnace(), patch_count=600)
    method = rad.MonteCarlo(512, light_rays=0)
    least = predict(patches, method).peak_bytes
    assert least < 8 * 512 * len(patches) + cost.BESIDE
    assert rad.form_factors(patches, method, memory_limit=1.05 * least).matrix.nnz > 0
    with pytest.raises(MemoryLimitError, match="would take"):
        rad.form_factors(patches, method, memory_limit=0.5 * least)


def test_what_has_no_rows_has_no_sample_of_them():
    with pytest.raises(ParameterError, match="TwoLevel.* row by row"):
        predict(rad.subdivide(rad.scenes.furnace()), rad.TwoLevel())


@pytest.mark.parametrize("limit", [0, -1, float("nan")])
def test_a_limit_that_is_none(limit):
    with pytest.raises(ParameterError, match="memory_limit"):
        rad.form_factors(rad.subdivide(rad.scenes.furnace()), memory_limit=limit)


def test_ten_million_patches_are_refused_or_foretold_in_a_moment(monkeypatch):
    """No array of the rows' size is made to find out."""
    patches = rad.subdivide(rad.scenes.cornell_box(), patch_count=200_000)
    monkeypatch.setattr(memory, "available_bytes", lambda: 10**8)
    with pytest.raises(MemoryLimitError, match="this machine has room for 80 MB"):
        rad.form_factors(patches, rad.MonteCarlo(128))


def test_free_memory_is_the_least_of_machine_and_container(tmp_path, monkeypatch):
    monkeypatch.setattr(memory, "MEMINFO", tmp_path / "meminfo")
    monkeypatch.setattr(memory, "CONTAINER", tmp_path)
    (tmp_path / "meminfo").write_text("MemTotal:  9000 kB\nMemAvailable:   4000 kB\n")
    assert memory.available_bytes() == 4_096_000
    (tmp_path / "memory.max").write_text("max\n")
    (tmp_path / "memory.current").write_text("2000000\n")
    (tmp_path / "memory.stat").write_text("anon 1500000\ninactive_file 400000\n")
    assert memory.available_bytes() == 4_096_000
    (tmp_path / "memory.max").write_text("3000000\n")
    assert memory.available_bytes() == 1_400_000
    assert memory.limit_bytes() == 0.8 * 1_400_000
    (tmp_path / "meminfo").unlink()
    (tmp_path / "memory.max").unlink()
    assert memory.available_bytes() > 10**8, "all that the machine has"
