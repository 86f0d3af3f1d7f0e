"""Work over any `concurrent.futures.Executor`, whose workers may be lost on the way.

Values come in the order of the items, whoever computed them. What a lost worker was at is done again, a few times: its
process may have been killed for want of memory, or its machine switched off.
"""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import BrokenExecutor, CancelledError, Executor, Future, ProcessPoolExecutor
from contextlib import suppress
from dataclasses import dataclass
from typing import Any, TypeVar

from .errors import ParameterError, WorkerLostError

Item = TypeVar("Item")
Value = TypeVar("Value")

ATTEMPTS = 5  # at one item: others that were under way when a worker died are innocent, so a few are needed
PATIENCE = 2.0  # seconds without a value between looks at the workers
LOST_IN_DASK = ("KilledWorker", "CommClosedError")  # by name: dask need not be installed


class NotHere(Exception):
    """A worker lacks what it needs to do its work: send it again, with everything."""


class Crew:
    """An executor, and the one that takes its place once it is broken.

    Parameters
    ----------
    executor : concurrent.futures.Executor

    Raises
    ------
    ParameterError
        Something else.
    """

    def __init__(self, executor: Executor) -> None:
        if not isinstance(executor, Executor):
            hint = "; a dask client gives one by client.get_executor()" if hasattr(executor, "get_executor") else ""
            raise ParameterError(f"executor is {executor!r}; give a concurrent.futures.Executor{hint}")
        self.executor = self._given = executor
        self._dead: set[int] = set()  # processes that were dead when last looked after

    @property
    def size(self) -> int:
        """How many workers there are, as far as the executor tells."""
        workers = getattr(self.executor, "_max_workers", None)
        client = getattr(self.executor, "_client", None)
        if workers is None and client is not None:
            workers = sum(client.nthreads().values())
        return int(workers or os.cpu_count() or 1)

    def submit(self, function: Callable[..., Value], *args: Any) -> Future[Value]:
        """As `Executor.submit`, on a new pool of processes where the old one is broken."""
        try:
            return self.executor.submit(function, *args)
        except BrokenExecutor as error:
            self.renew(error)
            return self.executor.submit(function, *args)

    def renew(self, error: BaseException) -> None:
        """Put a pool of processes with the same settings in the place of a broken one.

        Raises
        ------
        WorkerLostError
            Another kind of executor is broken, which only its owner can make anew.
        """
        broken = self.executor
        if not isinstance(broken, ProcessPoolExecutor):
            raise WorkerLostError(f"{type(broken).__name__} is broken ({error}): make a new one and go on") from error
        self.close()
        settings = {name: getattr(broken, f"_{name}", None) for name in ("max_workers", "mp_context", "initializer")}
        self.executor = ProcessPoolExecutor(**settings, initargs=getattr(broken, "_initargs", ()))

    def look_after(self) -> None:
        """Break a pool of processes that has not noticed the death of one, at the second look.

        A worker that dies while it sends a value leaves half of it in the pipe, where the pool waits for the rest for
        ever, and a lock for which the other workers wait. Once no process can write to the pipe any more, the pool sees
        its end, and breaks.
        """
        pool, processes = self.executor, getattr(self.executor, "_processes", None)
        if not isinstance(pool, ProcessPoolExecutor) or not processes:
            return
        dead = {number for number, process in list(processes.items()) if process.exitcode not in (None, 0)}
        if dead & self._dead:
            for process in list(processes.values()):
                process.kill()
            with suppress(AttributeError, OSError):
                pool._result_queue._writer.close()  # type: ignore[attr-defined]  # this process's own end of it
        self._dead = dead

    def close(self) -> None:
        """End a pool that was put in place of a broken one; leave alone what was given.

        Its workers are ended first: one that died unseen may hold the lock of the queue from which the others would
        hear that they may go, and they would be waited for in vain.
        """
        if self.executor is self._given:
            return
        for process in list((getattr(self.executor, "_processes", None) or {}).values()):
            process.terminate()
        self.executor.shutdown(wait=True, cancel_futures=True)


@dataclass
class _Task:
    """An item under way."""

    item: Any
    future: Future[Any]
    attempts: int = 1


def map_over(
    executor: Executor,
    items: Iterable[Item],
    submit: Callable[[Crew, Item, int], Future[Value]],
    name: Callable[[Item], str] = str,
) -> Iterator[Value]:
    """Values of items, computed by an executor's workers, in the order of the items.

    At most twice as many items as workers are under way. On an interrupt, or when the caller stops early, what has not
    begun is dropped.

    Parameters
    ----------
    executor : concurrent.futures.Executor
    items : iterable
    submit : callable
        (crew, item, attempt) → future, by `Crew.submit`. Attempts count from 1; from the second on, the worker may be a
        new one that knows nothing.
    name : callable, optional
        What to call an item in an error.

    Raises
    ------
    WorkerLostError
        Workers were lost `ATTEMPTS` times at one item.
    """
    crew = Crew(executor)
    pending: deque[_Task] = deque()
    try:
        for item in items:
            pending.append(_Task(item, submit(crew, item, 1)))
            if len(pending) >= 2 * crew.size:
                yield _result(crew, pending, submit, name)
        while pending:
            yield _result(crew, pending, submit, name)
    finally:
        for task in pending:
            task.future.cancel()
        crew.close()


def _result(crew: Crew, pending: deque[_Task], submit: Any, name: Callable[[Any], str]) -> Any:
    """Value of the first task, which leaves the queue. All that were lost by then are sent out again."""
    while True:
        try:
            value = _wait(crew, pending[0].future)
        except BaseException as error:
            if not is_loss(error):
                raise
            for task in [task for task in pending if _lost(task.future)]:
                _send_again(crew, task, submit, name)
        else:
            pending.popleft()
            return value


def _wait(crew: Crew, future: Future[Any]) -> Any:
    """Value of a future, looking after the workers while it is not there."""
    while True:
        try:
            return future.result(PATIENCE)
        except TimeoutError:
            if future.done():  # the work itself says so, or has just come to its end
                return future.result()
            crew.look_after()


def _send_again(crew: Crew, task: _Task, submit: Any, name: Callable[[Any], str]) -> None:
    error = _lost(task.future)
    if task.attempts >= ATTEMPTS:
        raise WorkerLostError(
            f"{name(task.item)} cost a worker its life {task.attempts} times ({type(error).__name__}: {error}). It may "
            "want more memory than a worker has: give fewer workers, or ones with more memory"
        ) from error
    task.attempts += 1
    task.future = submit(crew, task.item, task.attempts)


def _lost(future: Future[Any]) -> BaseException | None:
    """Why a future's worker was lost; None where it was not, or is still at it."""
    if future.cancelled():
        return CancelledError("cancelled by the executor")
    error = future.exception() if future.done() else None
    return error if error is not None and is_loss(error) else None


def is_loss(error: BaseException) -> bool:
    """Whether a worker is gone, or new, and not the work itself wrong."""
    return isinstance(error, (BrokenExecutor, CancelledError, NotHere)) or type(error).__name__ in LOST_IN_DASK
