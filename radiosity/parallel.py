"""Blocks of rows over threads: where work is shared out (over other executors, see `executors`).

The kernels release the interpreter's lock, so plain threads are enough. Blocks are cut by the caller,
never by the number of threads, and each writes to its own rows: results cannot depend on who did what.
"""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor, wait
from functools import lru_cache
from threading import local
from typing import TypeVar

from .errors import ParameterError

Item = TypeVar("Item")
Value = TypeVar("Value")


def thread_count(threads: int | None = None) -> int:
    """How many threads to use: as many as asked for, else as this process may run on.

    Raises
    ------
    ParameterError
        If `threads` is below one.
    """
    if threads is None:
        return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else (os.cpu_count() or 1)
    if threads < 1:
        raise ParameterError(f"threads is {threads}; give at least 1, or None for all processors")
    return threads


def blocks(count: int, size: int) -> list[tuple[int, int]]:
    """Half-open ranges (begin, end) of at most `size` that cover 0 … count.

    >>> blocks(5, 2)
    [(0, 2), (2, 4), (4, 5)]
    """
    return [(begin, min(begin + size, count)) for begin in range(0, count, size)]


def ordered_map(
    function: Callable[[Item], Value], items: Sequence[Item], threads: int | None = None
) -> Iterator[Value]:
    """Apply a function to items on threads, giving values in the order of the items.

    At most twice as many items as threads are under way, so that finished values do not pile up. On an
    interrupt, or when the caller stops early, what has not begun is dropped. Within a function that is itself applied
    so, one after the other: all threads are at work already.
    """
    count = thread_count(threads)
    if count == 1 or len(items) < 2 or getattr(_here, "works", False):
        yield from map(function, items)
        return
    pool = _pool(count)
    pending: deque[Future[Value]] = deque()
    waiting = iter(items)
    try:
        for item in waiting:
            pending.append(pool.submit(function, item))
            if len(pending) >= 2 * count:
                yield _first(pending)
        while pending:
            yield _first(pending)
    finally:
        for future in pending:
            future.cancel()
        wait(pending)  # none writes to arrays of a caller that has gone on


def _first(pending: deque[Future[Value]]) -> Value:
    value = pending[0].result()
    pending.popleft()  # not before: on an interrupt it is still under way
    return value


_here = local()  # .works: whether this thread is one of a pool


def _begin() -> None:
    _here.works = True


@lru_cache(maxsize=4)
def _pool(count: int) -> ThreadPoolExecutor:
    """Threads that stay: to start and end them takes as long as a small product."""
    return ThreadPoolExecutor(count, "radiosity", _begin)


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_pool.cache_clear)  # a forked process has none of its parent's threads
