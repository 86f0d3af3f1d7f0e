"""What form factors will take, in bytes and seconds, before they are assembled.

How many entries a row has cannot be said from its number of rays, because rays meet the same patch more than once; how
long it takes depends on the scene and the machine. So a small sample of the very rows is made, evenly chosen, and
thrown away.
"""

from __future__ import annotations

import math
import time
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import ParameterError
from ..memory import gigabytes, limit_bytes, refuse_above
from ..parallel import blocks, ordered_map, thread_count
from ..patches import Patches
from ..rays import Tracer
from .analytic import ExactRows
from .assembly import Float, RowBlock, RowMaker, Rows, mean_rows, stack_rows
from .workers import Span, cut

if TYPE_CHECKING:
    from .estimate import Estimator

SHARE = 24  # one block in so many is sampled …
FEWEST, MOST = 32, 128  # … but not fewer and not more
SMALLER = 8  # than what is made at once: neighbours are alike, so many blocks of few rows tell more than few of many
WHOLE = 4  # blocks of as many rows as are made at once, for what their size saves
PER_ROW = 24  # bytes beside the entries: where a row begins, its shares to sky and backs
BESIDE = 100_000_000  # bytes of blocks under way, at most


@dataclass(frozen=True)
class Cost:
    """What an assembly will take, foretold from a sample of its rows.

    Attributes
    ----------
    patches : int
        N.
    nonzeros : int
        Entries of the matrix; of the mean of all replicates, where there are several.
    bytes : int
        Of the form factors once they are there, replicates included.
    peak_bytes : int
        Most that is needed at any time on the way.
    seconds : float
        On this machine with nothing else to do, with the given number of threads, kernels being compiled.
    sampled : int
        Rows that this was foretold from.
    """

    patches: int
    nonzeros: int
    bytes: int
    peak_bytes: int
    seconds: float
    sampled: int

    def __str__(self) -> str:
        """One line."""
        return (
            f"{self.patches:,} patches: about {self.nonzeros:,} non-zeros, {gigabytes(self.bytes)} "
            f"({gigabytes(self.peak_bytes)} at the peak), {_shown(self.seconds)} s"
        )


def _shown(seconds: float) -> str:
    """Two digits, and none behind the point where there are more.

    >>> _shown(0.123), _shown(3.21), _shown(1234.5)
    ('0.12', '3.2', '1,234')
    """
    return f"{seconds:.2g}" if seconds < 10 else f"{seconds:,.0f}"


def predict(
    patches: Patches,
    estimator: Estimator | None = None,
    dtype: Any = np.float32,
    threads: int | None = None,
    tracer: Tracer | None = None,
) -> Cost:
    """Bytes and seconds that `form_factors` will take.

    Nothing is kept; the sample takes a few hundredths of a second to one, the longer the more it foretells.

    Parameters
    ----------
    patches : Patches
    estimator : MonteCarlo, Hemicube or Analytic, optional
        ``MonteCarlo()`` by default.
    dtype : float32 or float64, optional
    threads : int, optional
        As many as there are processors by default.
    tracer : Tracer, optional
        Of these patches, if there is one already.

    Returns
    -------
    Cost

    Raises
    ------
    ParameterError
        An estimator that has no rows to make a sample of: `TwoLevel`, which checks its own memory on the way.

    Examples
    --------
    >>> import radiosity as rad
    >>> patches = rad.subdivide(rad.scenes.furnace(), patch_count=600)
    >>> cost = predict(patches, rad.MonteCarlo(rays=64, replicates=2))
    >>> factors = rad.form_factors(patches, rad.MonteCarlo(rays=64, replicates=2))
    >>> abs(cost.nonzeros / factors.matrix.nnz - 1) < 0.1
    True
    """
    from .monte_carlo import MonteCarlo

    estimator = MonteCarlo() if estimator is None else estimator
    if not hasattr(estimator, "rows"):
        raise ParameterError(f"{estimator} does not work row by row, so that a sample of rows tells nothing about it")
    begin = time.perf_counter()
    tracer = Tracer(patches.grid) if tracer is None else tracer
    makers = [estimator.rows(patches, tracer, replicate) for replicate in range(estimator.replicates)]
    ready = time.perf_counter() - begin
    kind = np.dtype(dtype).type
    sample = [_sample(maker, len(patches), kind, threads) for maker in makers]
    return _scaled(sample, makers, len(patches), kind, ready, thread_count(threads))


@dataclass(frozen=True, eq=False)
class _Sample:
    rows: Rows
    seconds: float  # that all rows will take


def _sample(maker: RowMaker, count: int, dtype: Float, threads: int | None) -> _Sample:
    """Some blocks of rows, made and stacked as all will be, and the seconds that all will take.

    Small blocks all over the scene tell what a row costs there; a few whole ones, made again in small ones, how much
    less it costs in those. In time of the processor, which other work of the machine hardly lengthens.
    """
    workers = thread_count(threads)
    size = math.ceil(maker.rows_at_once / SMALLER)
    whole, small = blocks(count, maker.rows_at_once), _evenly(blocks(count, size), workers)
    paired = _evenly(whole, workers, max(WHOLE, workers))
    parts = cut(paired, size)

    def make(span: Span) -> tuple[RowBlock, float]:
        begin = time.thread_time()
        block = maker(span).finished(maker.divisor, dtype)
        return block, time.thread_time() - begin

    warm = paired[:1] * (2 * workers)  # each thread has loaded the kernels, and has its memory
    made = list(ordered_map(make, [*warm, *paired, *parts, *small], threads))[len(warm) :]
    each = np.split([seconds for _, seconds in made], np.cumsum([len(paired), len(parts)]))
    in_whole, in_parts, in_small = (seconds.sum() for seconds in each)
    sampled = sum(end - begin for begin, end in small)
    begin = time.thread_time()
    rows = stack_rows(_closed_up(block for block, _ in made[-len(small) :]), sampled, dtype, columns=count)
    stacking = time.thread_time() - begin
    block = (in_whole / in_parts * in_small + stacking) / sampled * count / len(whole)
    return _Sample(rows, block * math.ceil(len(whole) / workers))


def _closed_up(made: Iterable[RowBlock]) -> Iterator[RowBlock]:
    """Blocks one after the other, as if there were no others between them."""
    filled = 0
    for block in made:
        yield block._replace(begin=filled)
        filled += len(block.lengths)


def _evenly(spans: Sequence[Span], threads: int, most: int = MOST) -> list[Span]:
    """Some of the spans, from the middles of equal parts of them all; enough for all threads."""
    wanted = min(len(spans), most, max(FEWEST, 4 * threads, len(spans) // SHARE))
    return [spans[int((k + 0.5) * len(spans) / wanted)] for k in range(wanted)]


def _scaled(
    samples: list[_Sample], makers: list[RowMaker], count: int, dtype: Float, ready: float, threads: int
) -> Cost:
    """Cost of all rows from that of some."""
    entry = 4 + np.dtype(dtype).itemsize
    sampled = samples[0].rows.matrix.shape[0]
    scale = count / sampled
    nonzeros = [scale * sample.rows.matrix.nnz for sample in samples]
    seconds = ready + sum(sample.seconds for sample in samples)
    whole, kept = nonzeros[0], entry * sum(nonzeros) + PER_ROW * count * len(samples)
    if len(samples) > 1:
        runs = [sample.rows for sample in samples]
        mean_rows(runs, dtype, threads)
        begin = time.perf_counter()
        mean = mean_rows(runs, dtype, threads)
        seconds += scale * (time.perf_counter() - begin)
        whole = scale * mean.matrix.nnz
        kept += entry * whole + PER_ROW * count
    peak = kept + min(BESIDE, kept)
    if isinstance(makers[0], ExactRows):
        seconds, peak = ready + 0.5 * (seconds - ready), kept + 8 * count**2
    return Cost(count, round(whole), round(kept), round(peak), seconds, sampled)


def check_cost(
    patches: Patches,
    estimator: Estimator,
    makers: list[RowMaker],
    dtype: Float,
    memory_limit: float | None,
    tracer: Tracer,
    threads: int | None,
) -> None:
    """Refuse an assembly that would not fit the memory limit.

    What could not fill it even if no two rays met the same patch is let through at once, the rest is foretold.

    Raises
    ------
    MemoryLimitError
        With the figures and the ways out.
    """
    limit = limit_bytes(memory_limit)
    count = len(patches)
    most = (4 + np.dtype(dtype).itemsize) * count * min(makers[0].most, count) * (2 * len(makers) - (len(makers) == 1))
    if most + BESIDE + 8 * count**2 * isinstance(makers[0], ExactRows) <= limit:
        return
    cost = predict(patches, estimator, dtype, threads, tracer)
    refuse_above(
        limit,
        cost.peak_bytes,
        f"form factors of {count:,} patches by {estimator} ({cost.nonzeros:,} non-zeros, {_shown(cost.seconds)} s)",
        _ways_out(estimator, dtype),
        "this machine has room for" if memory_limit is None else "the memory limit is",
    )


def _ways_out(estimator: Estimator, dtype: Float) -> str:
    ways = ["fewer patches (patch_count=, --patches)"]
    if isinstance(getattr(estimator, "seed", None), int):
        ways.append("fewer rays (MonteCarlo(rays=…), --rays)")
    else:
        ways.append("MonteCarlo() with few rays")
    if estimator.replicates > 1:
        ways.append("one replicate (--replicates 1) takes about a quarter to a half")
    if dtype is np.float64:
        ways.append("dtype=numpy.float32")
    ways.append("the workers of a cluster hold rows between them (radiosity.form_factors.cluster)")
    ways.append("a larger memory_limit (--memory), if there is more")
    return "; ".join(ways)
