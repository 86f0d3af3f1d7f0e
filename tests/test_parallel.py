"""Blocks of work over threads that stay."""

import multiprocessing
import os
import signal
import time
from threading import Event, current_thread

import pytest

from radiosity.parallel import ordered_map


def test_values_come_in_the_order_of_the_items_whoever_is_first():
    def late(item: int) -> int:
        time.sleep(0.02 if item == 0 else 0.0)
        return item

    assert list(ordered_map(late, range(7), threads=3)) == list(range(7))


def test_threads_stay_from_one_call_to_the_next():
    def name(_: int) -> str:
        return current_thread().name

    first, second = (set(ordered_map(name, range(40), threads=2)) for _ in range(2))
    assert len(first | second) <= 2


def test_a_map_within_a_map_does_not_wait_for_its_own_thread():
    def outer(item: int) -> int:
        return sum(ordered_map(lambda inner: item * inner, range(5), threads=2))

    assert list(ordered_map(outer, range(6), threads=2)) == [10 * item for item in range(6)]


def test_an_error_reaches_the_caller_after_all_that_had_begun_is_done():
    ended, failed = [], Event()

    def work(item: int) -> None:
        if item == 0:
            failed.set()
            raise RuntimeError("item 0")
        failed.wait()
        time.sleep(0.05)
        ended.append(item)

    with pytest.raises(RuntimeError, match="item 0"):
        list(ordered_map(work, range(50), threads=2))
    done = list(ended)
    time.sleep(0.1)
    assert ended == done and len(done) < 49  # nothing goes on behind the caller's back, and not all was begun


def test_a_caller_that_stops_early_drops_what_has_not_begun():
    begun = []
    values = ordered_map(begun.append, range(100), threads=2)
    next(values)
    values.close()
    count = len(begun)
    time.sleep(0.05)
    assert len(begun) == count < 100


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork here")
@pytest.mark.filterwarnings("ignore::DeprecationWarning")  # of forking beside threads, from Python 3.12 on
def test_a_forked_process_has_threads_of_its_own():
    list(ordered_map(abs, range(9), threads=2))
    with multiprocessing.get_context("fork").Pool(1) as pool:
        assert pool.apply_async(_squares).get(timeout=20) == [item * item for item in range(9)]


def _squares() -> list[int]:
    return list(ordered_map(lambda item: item * item, range(9), threads=2))


@pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="no timers here")
def test_an_interrupt_waits_for_what_is_under_way():
    begun, ended = [], []

    def work(item: int) -> None:
        begun.append(item)
        time.sleep(0.2)
        ended.append(item)

    def interrupt(*_: object) -> None:
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGALRM, interrupt)
    signal.setitimer(signal.ITIMER_REAL, 0.1)
    try:
        with pytest.raises(KeyboardInterrupt):
            list(ordered_map(work, range(50), threads=2))
    finally:
        signal.signal(signal.SIGALRM, before)
    assert sorted(begun) == sorted(ended) and len(begun) < 5
