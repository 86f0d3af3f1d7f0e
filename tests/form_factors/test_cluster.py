"""Rows on the workers of a dask cluster: the same bits as here, also when workers die between two bounces."""

from __future__ import annotations

import logging
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

import radiosity as rad
from radiosity.errors import MemoryLimitError, ParameterError
from radiosity.form_factors import cluster, monte_carlo
from radiosity.form_factors.cluster import form_factors_on_cluster

from .test_workers import room, same_bits

distributed = pytest.importorskip("distributed", reason="the group `cluster` is not installed")
dask = pytest.importorskip("dask")

METHOD = rad.MonteCarlo(64, 5)


@pytest.fixture(scope="module")
def client() -> Iterator[object]:
    """Two workers in this process; patient ones, because machines that test have other work to do."""
    with (
        dask.config.set({"distributed.comm.timeouts.connect": "120s"}),
        distributed.LocalCluster(n_workers=2, threads_per_worker=1, processes=False, dashboard_address=":0") as workers,
        distributed.Client(workers) as found,
    ):
        yield found


@pytest.fixture(scope="module")
def patches():
    return room(600)


@pytest.fixture(scope="module")
def here(patches):
    return rad.form_factors(patches, METHOD)


def test_the_clients_executor_gives_the_same_bits(client, patches, here, monkeypatch):
    monkeypatch.setattr(monte_carlo, "BATCH", 4_096)
    assert same_bits(rad.form_factors(patches, METHOD, executor=client.get_executor()), here)


def test_a_bounce_where_the_rows_are(client, patches, here):
    there = form_factors_on_cluster(patches, METHOD, client=client)
    assert len(there.parts) == 2 * cluster.PARTS_EACH
    assert there.non_zeros == here.matrix.nnz
    assert np.array_equal(there.to_sky, here.to_sky) and np.array_equal(there.to_backs, here.to_backs)
    one, other = rad.TransportOperator(there, patches), rad.TransportOperator(here, patches)
    light = np.random.default_rng(0).random((len(patches), 3))
    assert np.array_equal(one @ light, other @ light)
    assert np.array_equal(one.net_exchange(light, 0.5 * light), other.net_exchange(light, 0.5 * light))
    many = np.random.default_rng(1).random((len(patches), 3, 4))
    assert np.array_equal(one @ many, other @ many)
    assert np.array_equal(one.net_exchange(many), other.net_exchange(many))
    for i in (0, 77, len(patches) - 1):
        assert np.array_equal(there.row(i), here.row(i))


def test_solvers_take_them_as_they_are(client, patches, here):
    there = form_factors_on_cluster(patches, METHOD, client=client)
    solver = rad.Neumann(rtol=1e-6)
    one, other = (
        solver.solve(rad.TransportOperator(F, patches), patches.emission, sky=patches.sky) for F in (there, here)
    )
    assert one.converged and np.array_equal(one.orders, other.orders)


def test_a_closed_room_has_no_sky(client):
    patches = rad.subdivide(rad.scenes.cluttered_room(6), patch_count=300)
    assert patches.closed
    there, here = form_factors_on_cluster(patches, METHOD, client=client), rad.form_factors(patches, METHOD)
    assert np.array_equal(there.to_sky, here.to_sky)
    assert there.statistics["leaks/share"] == here.statistics["leaks/share"]


def test_what_cannot_be(client, patches, monkeypatch):
    there = form_factors_on_cluster(patches, METHOD, client=client)
    with pytest.raises(MemoryLimitError, match=r"non-zeros stay on a cluster.*get_executor"):
        _ = there.matrix
    with pytest.raises(ParameterError, match="replicates is 2"):
        form_factors_on_cluster(patches, rad.MonteCarlo(64, replicates=2), client=client)
    with pytest.raises(ParameterError, match="Client"):
        form_factors_on_cluster(patches, METHOD, client=client.get_executor())
    monkeypatch.setattr(cluster, "FILLED", 1e-9)
    with pytest.raises(MemoryLimitError, match="on 2 workers would take .* they have room for .* start more workers"):
        form_factors_on_cluster(patches, METHOD, client=client)


def both_alive(client):
    """Numbers of the workers' processes, once there are two that answer."""
    deadline = time.monotonic() + 200
    while time.monotonic() < deadline:
        found = list(client.run(os.getpid, on_error="ignore").values())
        if len(found) == 2:
            return found
        time.sleep(0.2)
    raise TimeoutError("the cluster did not start its workers again")


@pytest.mark.long
def test_two_processes_killed_one_after_the_other(patches, here):
    """While rows are made, and between bounces, six times: what was lost is made again."""
    light = np.random.default_rng(0).random((len(patches), 3))
    true = here.gather(light)
    with (
        distributed.LocalCluster(
            n_workers=2, threads_per_worker=1, dashboard_address=":0", silence_logs=logging.CRITICAL
        ) as workers,
        distributed.Client(workers) as client,
    ):
        there = form_factors_on_cluster(patches, METHOD, client=client)
        for k in range(6):
            os.kill(both_alive(client)[k % 2], signal.SIGKILL)
            assert np.array_equal(there.gather(light), true)
        os.kill(both_alive(client)[0], signal.SIGKILL)
        assert same_bits(rad.form_factors(patches, METHOD, executor=client.get_executor()), here)


@pytest.mark.long
def test_the_example_of_the_book():
    script = Path(__file__).resolve().parents[2] / "docs" / "howto" / "cluster_example.py"
    run = subprocess.run([sys.executable, script], capture_output=True, text=True, timeout=400, check=True)
    assert "same bits: True" in run.stdout
