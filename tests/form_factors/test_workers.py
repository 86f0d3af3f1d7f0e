"""Rows by other workers: the same bits whoever makes them, however they are cut, and whoever dies on the way."""

from __future__ import annotations

import multiprocessing
import os
import signal
import struct
import sys
import time
from concurrent.futures import Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor
from concurrent.futures.process import BrokenProcessPool

import numpy as np
import pytest

import radiosity as rad
from radiosity import executors
from radiosity.errors import ParameterError, WorkerLostError
from radiosity.form_factors import hemicube, monte_carlo, workers

METHODS = [
    rad.MonteCarlo(64, 5, replicates=2),
    rad.MonteCarlo(100, 5, "random"),
    rad.Hemicube(16, 2),
]


def room(count=600):
    return rad.subdivide(rad.scenes.cornell_box(), patch_count=count)


def same_bits(one, other):
    """Two sets of factors with their replicates, to the last bit."""
    for a, b in zip((one, *one.replicates), (other, *other.replicates), strict=True):
        assert a.matrix.dtype == b.matrix.dtype
        for name in ("indptr", "indices", "data"):
            assert np.array_equal(getattr(a.matrix, name), getattr(b.matrix, name))
        assert np.array_equal(a.to_sky, b.to_sky) and np.array_equal(a.to_backs, b.to_backs)
        assert a.statistics["rays/to emitters"] == b.statistics["rays/to emitters"]
    return True


def spawned(count=2):
    return ProcessPoolExecutor(count, mp_context=multiprocessing.get_context("spawn"))


class InTheSameProcess(Executor):
    """Executor that pickles what it is sent and what it gives back, and does the work at once."""

    def __init__(self, lose=()):
        self.sent, self.lose = [], list(lose)

    def submit(self, fn, *args):
        import pickle

        future = Future()
        self.sent.append(args)
        if self.lose and self.lose.pop(0):
            future.set_exception(BrokenProcessPool("a worker was lost on purpose"))
            return future
        try:
            function, arguments = pickle.loads(pickle.dumps((fn, args)))
            future.set_result(pickle.loads(pickle.dumps(function(*arguments))))
        except BaseException as error:
            future.set_exception(error)
        return future


@pytest.mark.parametrize("method", METHODS, ids=str)
def test_an_executor_that_pickles_everything_gives_the_same_bits(method, monkeypatch):
    patches = room()
    first = rad.form_factors(patches, method, threads=1)
    for batch in (1 << 16, 20_000, 6_000):
        monkeypatch.setattr(monte_carlo, "BATCH", batch)
        monkeypatch.setattr(hemicube, "BATCH", batch)
        assert same_bits(rad.form_factors(patches, method, executor=InTheSameProcess()), first)


def test_exact_factors_over_an_executor():
    patches = rad.subdivide(rad.scenes.furnace(), patch_count=150)
    first = rad.form_factors(patches, rad.Analytic(), dtype=np.float64)
    again = rad.form_factors(patches, rad.Analytic(), dtype=np.float64, executor=InTheSameProcess())
    assert same_bits(again, first)


def test_a_pool_of_threads_that_the_caller_keeps():
    patches = room()
    first = rad.form_factors(patches, METHODS[0])
    with ThreadPoolExecutor(3) as pool:
        assert same_bits(rad.form_factors(patches, METHODS[0], executor=pool), first)
        assert pool.submit(len, "abc").result() == 3, "it is left open"


def test_light_does_not_travel_and_shapes_travel_once(monkeypatch):
    """Tasks after the first ones are a few hundred bytes; a worker that lacks the rest asks for it."""
    monkeypatch.setattr(workers, "SMALL", 0)
    monkeypatch.setattr(workers, "TASKS_EACH", 1000)
    monkeypatch.setattr(monte_carlo, "BATCH", 3_000)
    pool = InTheSameProcess()
    monkeypatch.setattr(executors.Crew, "size", 1)
    patches, method = room(), rad.MonteCarlo(64)
    first = rad.form_factors(patches, method)
    assert same_bits(rad.form_factors(patches, method, executor=pool), first)
    whole = [args for args in pool.sent if args[1] is not None]
    assert len(whole) == 2 < len(pool.sent) - 2
    bytes_a_patch = len(whole[0][1]) / len(patches)
    assert bytes_a_patch < 100, "of which vertices, corners and areas are 48"

    workers._known.__init__()  # what a new worker knows
    monkeypatch.setattr(workers, "packed", lambda *_: pytest.fail("only for form_factors"), raising=True)
    with pytest.raises(executors.NotHere):
        workers.make_rows("unheard of", None, 0, np.float32, (0, 1))


def test_a_worker_that_knows_nothing_is_sent_everything(monkeypatch):
    monkeypatch.setattr(workers, "SMALL", 0)
    monkeypatch.setattr(workers, "TASKS_EACH", 1000)
    monkeypatch.setattr(monte_carlo, "BATCH", 3_000)
    monkeypatch.setattr(executors.Crew, "size", 1)
    patches, method = room(), rad.MonteCarlo(64)
    first = rad.form_factors(patches, method)

    class Forgetful(InTheSameProcess):
        def submit(self, fn, *args):
            if len(self.sent) % 3 == 2:
                workers._known.__init__()
            return super().submit(fn, *args)

    pool = Forgetful()
    assert same_bits(rad.form_factors(patches, method, executor=pool), first)
    assert any(args[-1] > 1 and args[1] is not None for args in pool.sent)


def test_what_is_no_executor_is_refused_before_any_work():
    class Client:
        def get_executor(self):
            raise AssertionError

    with pytest.raises(ParameterError, match="concurrent.futures.Executor"):
        rad.form_factors(room(50), executor=4)
    with pytest.raises(ParameterError, match=r"client.get_executor\(\)"):
        rad.form_factors(room(50), executor=Client())


def test_an_executor_that_only_its_owner_can_mend():
    with pytest.raises(WorkerLostError, match="rows 0 … .* cost a worker its life 5 times"):
        rad.form_factors(room(50), executor=InTheSameProcess(lose=[True] * 100))
    patches = room(50)
    lost_twice = InTheSameProcess(lose=[True, True, False, True])
    assert same_bits(rad.form_factors(patches, executor=lost_twice), rad.form_factors(patches))


def test_an_error_of_the_work_is_not_taken_for_a_lost_worker():
    top = rad.scenes.furnace().surfaces
    twice = rad.Scene([*top, rad.Surface("again", top[0].vertices, top[0].faces, top[0].material)], closed=True)
    pool = InTheSameProcess()
    with pytest.raises(rad.errors.FormFactorError, match="overlap"):
        rad.form_factors(rad.subdivide(twice), rad.Analytic(), executor=pool)
    assert {args[-1] for args in pool.sent} == {1}, "no second attempt"


@pytest.mark.slow
def test_two_spawned_processes_one_of_which_is_killed(monkeypatch):
    monkeypatch.setattr(workers, "TASKS_EACH", 12)
    monkeypatch.setattr(monte_carlo, "BATCH", 4_096)
    patches, method = room(), rad.MonteCarlo(64, 5)
    first = rad.form_factors(patches, method)
    killed = []

    def kill_one(_stage, done, _total):
        if done > 100 and not killed:
            killed.append(multiprocessing.active_children()[0].pid)
            os.kill(killed[0], signal.SIGKILL)
            time.sleep(0.1)

    with spawned() as pool:
        assert same_bits(rad.form_factors(patches, method, executor=pool, progress=kill_one), first)
    assert killed
    assert not multiprocessing.active_children(), "the pool in its place is closed"


def double(number, attempt):
    """Twice a number; the worker of 3 dies at the first attempt while it sends what it has found."""
    if number == 3 and attempt == 1:
        frame = sys._getframe()
        while "result_queue" not in frame.f_locals:
            frame = frame.f_back
        queue = frame.f_locals["result_queue"]
        queue._wlock.acquire()
        os.write(queue._writer.fileno(), struct.pack("!i", 1000) + b"half of it")
        os.kill(os.getpid(), signal.SIGKILL)
    return 2 * number


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="needs a signal that nothing survives")
def test_a_worker_that_dies_while_it_sends_is_noticed(monkeypatch):
    """Python's own pool would wait for the other half for ever."""
    monkeypatch.setattr(executors, "PATIENCE", 0.3)
    with spawned() as pool:
        found = executors.map_over(pool, range(8), lambda crew, item, attempt: crew.submit(double, item, attempt))
        assert list(found) == [2 * k for k in range(8)]
