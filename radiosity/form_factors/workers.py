"""Where blocks of rows are made: on threads of this process, or by the workers of an executor.

A worker is sent a span of rows and the key of an estimate; what the key stands for (patches and estimator, no light)
goes along until each worker should have it, and the ray tree is built from it once in each process. Every row is the
same to the last bit, whoever makes it and whatever is made beside it.
"""

from __future__ import annotations

import math
import os
import pickle
import threading
from collections.abc import Callable, Generator, Iterator, Sequence
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from ..executors import Crew, NotHere, map_over
from ..parallel import blocks, ordered_map
from ..patches import Patches
from ..rays import Tracer
from .assembly import Float, RowBlock, RowMaker, joined

if TYPE_CHECKING:
    from .estimate import Estimator

Span = tuple[int, int]

SMALL = 1 << 18  # bytes that may as well be sent each time
MOST_BATCHES = 16  # of rows in one task: a tenth of a second
TASKS_EACH = 8  # for a worker at least, so that none waits long for the last
KEPT = 2  # estimates that a worker remembers


@dataclass(frozen=True, eq=False)
class RowsToMake:
    """The rows of one replicate, and who makes them.

    Attributes
    ----------
    patches : Patches
    estimator : Estimator
    maker : RowMaker
        Of this process.
    replicate : int
    dtype : float32 or float64
    key : str
        `identity.fingerprint` of the estimate; needed by executors only.
    threads : int or None
    executor : Executor or None
    """

    patches: Patches
    estimator: Estimator
    maker: RowMaker
    replicate: int
    dtype: Float
    key: str = ""
    threads: int | None = None
    executor: Executor | None = None

    def make(self, spans: Sequence[Span]) -> Generator[RowBlock]:
        """Finished blocks that cover the spans, in their order."""
        if self.executor is None or isinstance(self.executor, ThreadPoolExecutor):
            yield from self._here(spans)
        else:
            yield from self._elsewhere(spans, self.executor)

    def _here(self, spans: Sequence[Span]) -> Iterator[RowBlock]:
        def make(span: Span) -> RowBlock:
            return self.maker(span).finished(self.maker.divisor, self.dtype)

        def submit(crew: Crew, span: Span, _attempt: int) -> Future[RowBlock]:
            return crew.submit(make, span)

        tasks = cut(spans, self.maker.rows_at_once)
        if self.executor is None:
            return ordered_map(make, tasks, self.threads)
        return map_over(self.executor, tasks, submit)

    def _elsewhere(self, spans: Sequence[Span], executor: Executor) -> Iterator[RowBlock]:
        content = packed(self.patches, self.estimator)
        size = Crew(executor).size
        rows = sum(end - begin for begin, end in spans)
        batches = math.ceil(rows / self.maker.rows_at_once / (TASKS_EACH * size))
        tasks = cut(spans, self.maker.rows_at_once * min(MOST_BATCHES, max(1, batches)))
        first = set(tasks[: 2 * size])

        def submit(crew: Crew, span: Span, attempt: int) -> Future[RowBlock]:
            whole = attempt > 1 or span in first or len(content) < SMALL
            sent = content if whole else None
            return crew.submit(make_rows, self.key, sent, self.replicate, self.dtype, span, attempt)

        return map_over(executor, tasks, submit, lambda span: f"rows {span[0]} … {span[1] - 1} of F")


def cut(spans: Sequence[Span], rows: int) -> list[Span]:
    """Spans of at most so many rows that cover the same.

    >>> cut([(0, 5), (8, 9)], 3)
    [(0, 3), (3, 5), (8, 9)]
    """
    return [(begin + a, begin + b) for begin, end in spans for a, b in blocks(end - begin, rows)]


def packed(patches: Patches, estimator: Estimator) -> bytes:
    """Patches and estimator for a worker: shapes, and which patches emit, but no light and no materials."""
    nothing = np.empty((len(patches), 0))
    bare = replace(
        patches,
        normal=nothing,
        reflectance=nothing,
        absorptance=nothing,
        emission=np.any(patches.emission > 0, axis=1, keepdims=True),
    )
    return pickle.dumps((bare, estimator), protocol=5)


class _Known:
    """What a worker process remembers: how to make the rows of the estimates that it was sent last."""

    def __init__(self) -> None:
        self.lock = threading.Lock()
        self.estimates: dict[str, tuple[Callable[[int], RowMaker], dict[int, RowMaker]]] = {}

    def maker(self, key: str, content: bytes | None, replicate: int) -> RowMaker:
        """The maker of one replicate's rows; made from the content if need be.

        Raises
        ------
        NotHere
            There is no content, and this process knows the key for the first time.
        """
        with self.lock:
            if key not in self.estimates:
                if content is None:
                    raise NotHere(key)
                patches, estimator = pickle.loads(content)
                tracer = Tracer(patches.grid)
                for old in list(self.estimates)[: 1 - KEPT]:
                    del self.estimates[old]
                self.estimates[key] = (lambda r: estimator.rows(patches, tracer, r), {})
            make, makers = self.estimates[key]
            if replicate not in makers:
                makers[replicate] = make(replicate)
            return makers[replicate]


_known = _Known()
if hasattr(os, "register_at_fork"):  # a copied process has no use for its parent's ray tree
    os.register_at_fork(after_in_child=_known.__init__)  # type: ignore[misc]


def make_rows(key: str, content: bytes | None, replicate: int, dtype: Float, span: Span, attempt: int = 1) -> RowBlock:  # noqa: ARG001  tells dask that another attempt is another task
    """Finished rows of an estimate, made in a worker's process."""
    maker = _known.maker(key, content, replicate)
    made = [maker(part).finished(maker.divisor, dtype) for part in cut([span], maker.rows_at_once)]
    return joined(made)
