"""The same bits, whatever engine, workers and blocks, and whatever goes wrong: at length."""

from __future__ import annotations

import logging
import multiprocessing
import os
import random
import signal
import warnings
from contextlib import contextmanager

import pytest

import radiosity as rad
from radiosity.errors import CheckpointWarning
from radiosity.form_factors import checkpoint, hemicube, monte_carlo, workers

from .test_checkpoint import damage, files
from .test_workers import room, same_bits, spawned

pytestmark = pytest.mark.long

METHOD = rad.MonteCarlo(128, 11, replicates=2)


@pytest.fixture(scope="module")
def patches():
    return room(2_000)


@pytest.fixture(scope="module")
def true(patches):
    return rad.form_factors(patches, METHOD, threads=1)


@pytest.fixture(autouse=True)
def _many_small_blocks(monkeypatch):
    monkeypatch.setattr(checkpoint, "RAYS", 1 << 13)
    monkeypatch.setattr(monte_carlo, "BATCH", 1 << 12)
    monkeypatch.setattr(workers, "MOST_BATCHES", 2)


@pytest.mark.parametrize("method", [METHOD, rad.MonteCarlo(100, 5, "random"), rad.Hemicube(16, 2)], ids=str)
def test_threads_processes_dask_and_block_sizes(method, monkeypatch):
    """1, 2, 4 threads, two processes, two dask processes; five sizes of block on threads and on processes."""
    distributed = pytest.importorskip("distributed")
    patches = room(900)
    first = rad.form_factors(patches, method, threads=1)
    with (
        spawned() as pool,
        distributed.LocalCluster(
            n_workers=2, threads_per_worker=1, dashboard_address=":0", silence_logs=logging.CRITICAL
        ) as cluster,
        distributed.Client(cluster) as client,
    ):
        for batch in (1 << 16, 20_000, 5_000, 3_001, 1_000):
            monkeypatch.setattr(monte_carlo, "BATCH", batch)
            monkeypatch.setattr(hemicube, "BATCH", batch)
            for threads in (1, 2, 4):
                assert same_bits(rad.form_factors(patches, method, threads=threads), first)
            for executor in (pool, client.get_executor()):
                assert same_bits(rad.form_factors(patches, method, executor=executor), first)


@contextmanager
def mortal():
    """Two processes whose end is not waited for: a dead one may hold the lock by which the other would hear of it."""
    pool = spawned()
    try:
        yield pool
    finally:
        for child in multiprocessing.active_children():
            child.kill()
        pool.shutdown()


def kill_some(victims, chance, seed):
    """Kill one of this process's children now and then, and note it."""
    choice = random.Random(seed)

    def tell(_stage, _done, _total):
        children = multiprocessing.active_children()
        if children and choice.random() < chance:
            victims.append(choice.choice(children).pid)
            os.kill(victims[-1], signal.SIGKILL)

    return tell


def test_ten_workers_killed_at_random(patches, true):
    victims: list[int] = []
    for seed in range(60):
        with mortal() as pool:
            told = kill_some(victims, 0.1, seed)
            assert same_bits(rad.form_factors(patches, METHOD, executor=pool, progress=told), true)
        if len(victims) >= 10:
            break
    assert len(victims) >= 10


def stop_at_random(seed):
    left = random.Random(seed).randint(1, 12)

    def tell(_stage, _done, _total):
        nonlocal left
        left -= 1
        if left == 0:
            raise KeyboardInterrupt

    return tell


def engine(k, pool):
    """Another one each time: threads, and now and then processes."""
    return {"executor": pool} if k % 4 == 3 else {"threads": (1, 2, 4)[k % 4]}


def test_twenty_interrupts_and_damaged_files_on_the_way(patches, true, tmp_path, monkeypatch):
    """Stopped, then spoilt, then gone on with by another engine and other blocks, until it comes to its end."""
    stops = spoilt = 0
    choice = random.Random(1)
    with spawned() as pool, warnings.catch_warnings():
        warnings.simplefilter("ignore", CheckpointWarning)
        for k in range(200):
            monkeypatch.setattr(monte_carlo, "BATCH", choice.choice([1 << 12, 1 << 13, 3_000]))
            try:
                told = stop_at_random(k) if stops < 12 else None
                found = rad.form_factors(
                    patches, METHOD, checkpoint=tmp_path / "rows", progress=told, **engine(k, pool)
                )
                break
            except KeyboardInterrupt:
                stops += 1
                path = choice.choice(files(tmp_path / "rows") or [None])
                if path is not None:
                    how = choice.choice(["empty", "cut", "longer", "one bit", "zeros", "text"])
                    path.write_bytes(damage(path.read_bytes() or b"\0" * 100, how))
                    spoilt += 1
    assert same_bits(found, true)
    assert stops >= 10 and spoilt >= 8, "with the ten killed workers, and seven of dask's, more than thirty faults"
    assert not list((tmp_path / "rows").rglob(".*"))
