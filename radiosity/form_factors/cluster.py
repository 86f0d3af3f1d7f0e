"""Rows that stay with the workers of a dask cluster: only light travels to them, and what they gather back.

For matrices that one machine has no room for. The sums are the same, in the same order, as those of the whole matrix in
one place, so the bits are too. Rows of a worker that is lost are made again by another, which dask sees to.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from contextlib import AbstractContextManager
from dataclasses import dataclass, field
from functools import partial
from typing import TYPE_CHECKING, Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from ..errors import MemoryLimitError, ParameterError, WorkerLostError
from ..executors import ATTEMPTS, is_loss
from ..memory import refuse_above
from ..parallel import blocks
from ..patches import Patches
from ..progress import Progress, quiet
from ..rays import Tracer
from ..sparse import csr_differences, csr_matmul
from .assembly import Float, Rows, stack_rows
from .cost import predict
from .identity import fingerprint
from .monte_carlo import MonteCarlo
from .on_demand import RowsOnDemand
from .shares import without_leaks
from .workers import Span, make_rows, packed

if TYPE_CHECKING:
    from .estimate import Estimator

FloatArray = NDArray[np.float64]
Client = Any  # of dask.distributed, which need not be installed

PARTS_EACH = 4  # blocks of rows for each thread of the cluster, at least
MOST_ENTRIES = 1 << 23  # of a block: some 64 MB
FILLED = 0.6  # of a worker's memory, above which dask begins to move it to disk


@dataclass(frozen=True, eq=False)
class RowsOnCluster(RowsOnDemand):
    """Form factors of N patches, in blocks of rows that dask workers hold.

    A `TransportOperator` takes them as they are: `Neumann` and `Shooting` work, at one journey of the light a bounce.

    Attributes
    ----------
    client : distributed.Client
    spans : tuple of (int, int)
        First row of each block, and the one after its last.
    parts : tuple of distributed.Future
        The blocks.
    statistics : dict
    """

    client: Client = None
    spans: tuple[Span, ...] = ()
    parts: tuple[Any, ...] = ()
    statistics: dict[str, Any] = field(default_factory=dict)

    def gather(self, light: FloatArray, threads: int | None = None) -> FloatArray:  # noqa: ARG002  workers have theirs
        """F B for (N, …), each block of rows where it is; float64."""
        return np.concatenate(_at_home(self, lambda _: _gathered, light))

    def net_exchange(self, light: FloatArray, beside: FloatArray | None = None) -> FloatArray:
        """Σ_j F_ij [(X_i - X_j) + Y_j], see `TransportOperator.net_exchange`."""
        return np.concatenate(_at_home(self, lambda span: partial(_exchanged, first=span[0]), light, beside))

    @property
    def non_zeros(self) -> int:
        """Entries of all blocks."""
        return int(self.statistics["matrix/non-zeros"])

    @property
    def matrix(self) -> NoReturn:
        """Nowhere as a whole.

        Raises
        ------
        MemoryLimitError
        """
        raise MemoryLimitError(
            f"these {self.non_zeros:,} non-zeros stay on a cluster, in {len(self.parts)} blocks, with no matrix here: "
            "use Neumann or Shooting; form_factors(…, executor=client.get_executor()) brings them all here"
        )


def form_factors_on_cluster(
    patches: Patches,
    estimator: Estimator | None = None,
    *,
    client: Client,
    dtype: Any = np.float32,
    progress: Progress | None = None,
) -> RowsOnCluster:
    """Form factors whose rows stay with the workers of a dask cluster that make them.

    Parameters
    ----------
    patches : Patches
    estimator : MonteCarlo, Hemicube or Analytic, optional
        ``MonteCarlo()`` by default; one replicate.
    client : distributed.Client
    dtype : float32 or float64, optional
    progress : callable, optional
        Called as ``progress(stage, rows done, rows in all)``.

    Returns
    -------
    RowsOnCluster
        The same factors, to the last bit, as `form_factors` gives.

    Raises
    ------
    ParameterError
        Several replicates; a client that is none.
    MemoryLimitError
        More than the workers have room for.
    WorkerLostError
        Workers are lost again and again at the same rows.
    """
    estimator = MonteCarlo() if estimator is None else estimator
    if estimator.replicates > 1:
        raise ParameterError(f"replicates is {estimator.replicates}; rows on a cluster hold one estimate: give 1")
    if not hasattr(client, "scheduler_info"):
        raise ParameterError(f"client is {client!r}; give a dask.distributed.Client")
    kind: Float = np.dtype(dtype).type
    tracer = Tracer(patches.grid)
    cost = predict(patches, estimator, kind, tracer=tracer)
    _check_room(client, cost.bytes, len(patches))
    spans, parts = _submitted(client, patches, estimator, kind, cost.nonzeros)
    shares = _in_order(client, parts, spans, progress or quiet)
    to_sky, to_backs = (np.concatenate([share[k] for share in shares]) for k in (0, 1))
    statistics: dict[str, Any] = {
        "matrix/non-zeros": sum(share[2] for share in shares),
        "rays/traced": estimator.rays * len(patches),
        "rays/to emitters": sum(share[3] for share in shares),
    }
    to_sky, statistics["leaks/share"] = without_leaks(to_sky, patches)
    return RowsOnCluster(
        lambda i: _row_at(client, parts, spans, i),
        patches.area,
        to_sky,
        to_backs,
        patches.surface,
        patches.surface_names,
        client,
        spans,
        parts,
        statistics,
    )


def _submitted(
    client: Client, patches: Patches, estimator: Estimator, kind: Float, nonzeros: float
) -> tuple[tuple[tuple[int, int], ...], tuple[Any, ...]]:
    """Blocks of rows, and the promises of the workers that make them."""
    threads = max(1, sum(client.nthreads().values()))
    count = max(PARTS_EACH * threads, math.ceil(nonzeros / MOST_ENTRIES))
    spans = tuple(blocks(len(patches), math.ceil(len(patches) / count)))
    key = fingerprint(patches, estimator, kind)
    with _large_graphs():
        content = client.submit(_held, packed(patches, estimator), pure=False)
        make = partial(_make, key=key, dtype=kind, count=len(patches))
        parts = tuple(client.submit(make, content, span, pure=False) for span in spans)
    return spans, parts


def _check_room(client: Client, needed: int, count: int) -> None:
    workers = client.scheduler_info(n_workers=-1)["workers"].values()
    room = FILLED * sum(worker["memory_limit"] or math.inf for worker in workers)
    ways = "start more workers, or take fewer patches or rays"
    refuse_above(
        room, needed, f"form factors of {count:,} patches on {len(workers)} workers", ways, "they have room for"
    )


def _in_order(client: Client, parts: tuple[Any, ...], spans: tuple[Span, ...], tell: Progress) -> list[Any]:
    """What the blocks' rows send to sky and backs, and how many entries they have."""
    asks = [partial(client.submit, _shares, part, pure=False) for part in parts]
    shares, found = [ask() for ask in asks], []
    for share, ask, (_, end) in zip(shares, asks, spans, strict=True):
        found.append(_result(client, share, ask))
        tell("form factors", end, spans[-1][1])
    return found


def _result(client: Client, future: Any, again: Callable[[], Any]) -> Any:
    """Value of a future, asked for again where its worker was lost."""
    for attempt in range(1, ATTEMPTS + 1):
        try:
            return client.gather(future)
        except BaseException as error:
            if not is_loss(error):
                raise
            if attempt == ATTEMPTS:
                raise WorkerLostError(
                    f"workers of the cluster were lost {ATTEMPTS} times ({type(error).__name__}: {error}). Rows may "
                    "want more memory than a worker has: start fewer workers on each machine, or ones with more memory"
                ) from error
            future = again()
    raise AssertionError("unreachable")


def _at_home(rows: RowsOnCluster, function: Callable[[Span], Any], *light: FloatArray | None) -> list[FloatArray]:
    """A function of each block and of the light, computed where the block is."""

    def sent() -> list[Any]:
        with _large_graphs():
            held = [None if one is None else rows.client.submit(_held, one, pure=False) for one in light]
            pairs = zip(rows.parts, rows.spans, strict=True)
            return [rows.client.submit(function(span), part, *held, pure=False) for part, span in pairs]

    return list(_result(rows.client, sent(), sent))


def _row_at(client: Client, parts: tuple[Any, ...], spans: tuple[Span, ...], i: int) -> FloatArray:
    k = next(k for k, (_, end) in enumerate(spans) if i < end)
    ask = partial(client.submit, _row, parts[k], i - spans[k][0], pure=False)
    return np.asarray(_result(client, ask(), ask))


def _large_graphs() -> AbstractContextManager[Any]:
    """Have dask send light and patches without a remark on their size: they are sent once."""
    import dask

    return dask.config.set({"distributed.admin.large-graph-warning-threshold": "100 GB"})


# What workers do.


def _held(value: Any) -> Any:
    """The same, in a worker's memory, from where the others get it."""
    return value


def _make(content: bytes, span: Span, key: str, dtype: Float, count: int) -> Rows:
    block = make_rows(key, content, 0, dtype, span)
    return stack_rows([block._replace(begin=0)], len(block.lengths), dtype, columns=count)


def _shares(rows: Rows) -> tuple[FloatArray, FloatArray, int, int]:
    return rows.to_sky, rows.to_backs, rows.matrix.nnz, rows.shadow_rays


def _gathered(rows: Rows, light: FloatArray) -> FloatArray:
    return csr_matmul(rows.matrix, light, threads=1)


def _exchanged(rows: Rows, light: FloatArray, beside: FloatArray | None, first: int) -> FloatArray:
    return csr_differences(rows.matrix, light, beside, threads=1, first=first)


def _row(rows: Rows, k: int) -> FloatArray:
    row = np.zeros(rows.matrix.shape[1])
    span = slice(rows.matrix.indptr[k], rows.matrix.indptr[k + 1])
    row[rows.matrix.indices[span]] = rows.matrix.data[span]
    return row
