"""`form_factors`: any estimator on any patches."""

from __future__ import annotations

import os
import time
from collections.abc import Sequence
from concurrent.futures import Executor
from contextlib import closing
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from ..errors import ParameterError
from ..executors import Crew
from ..patches import Patches
from ..progress import Progress, quiet
from ..rays import Tracer
from .analytic import Analytic, ExactRows
from .assembly import Float, Rows, mean_rows, stack_rows
from .checkpoint import Checkpoint
from .cost import check_cost
from .factors import FormFactors
from .gaps import check_gaps
from .hemicube import Hemicube
from .identity import fingerprint
from .monte_carlo import MonteCarlo
from .shares import without_leaks
from .some_rows import RowChoice, SomeRows
from .two_level import TwoLevel
from .workers import RowsToMake

Estimator = MonteCarlo | Hemicube | Analytic  # of rows, one by one


def form_factors(
    patches: Patches,
    estimator: Estimator | TwoLevel | None = None,
    *,
    dtype: Any = np.float32,
    threads: int | None = None,
    executor: Executor | None = None,
    checkpoint: str | os.PathLike[str] | None = None,
    memory_limit: float | None = None,
    progress: Progress | None = None,
    rows: RowChoice | None = None,
    tracer: Tracer | None = None,
) -> FormFactors:
    """Form factors between patches.

    Parameters
    ----------
    patches : Patches
    estimator : MonteCarlo, Hemicube, Analytic or TwoLevel, optional
        ``MonteCarlo()`` by default.
    dtype : float32 or float64, optional
        Of the weights. A row of float32 weights adds up to 1 within about 1e-7.
    threads : int, optional
        As many as there are processors by default. The result has the same bits for any number.
    executor : concurrent.futures.Executor, optional
        Whose workers make the rows, instead of threads: a ``ProcessPoolExecutor``, or ``client.get_executor()`` of a
        dask client. The result has the same bits. Rows of a lost worker are made again.
    checkpoint : path, optional
        A folder that keeps finished rows. An interrupted call that is made again goes on from them, and gives the same
        bits.
    memory_limit : float, optional
        Bytes that the factors may take; by default four fifths of what is free.
    progress : callable, optional
        Called as ``progress(stage, rows done, rows in all)``.
    rows : RowChoice, optional
        Make only these rows; the others are named in `FormFactors.left_out`, and `completed` makes them later, with
        the bits that they would have had. By default all.
    tracer : Tracer, optional
        Of these patches, if there is one already. Workers of an executor make their own.

    Returns
    -------
    FormFactors
        Raw: rows close exactly, reciprocity holds within the sampling error.

    Raises
    ------
    ParameterError
        A dtype that is neither; an executor or a checkpoint that is none.
    GeometryError
        A lamp nearer to what it shines on than rays can tell apart.
    MemoryLimitError
        More than the memory limit, foretold before anything is assembled; with the figures and the ways out.
    WorkerLostError
        Workers are lost again and again at the same rows.

    Warns
    -----
    CheckpointWarning
        Rows in the checkpoint that are damaged, and are made again.

    Examples
    --------
    >>> import radiosity as rad
    >>> patches = rad.subdivide(rad.scenes.furnace())
    >>> F = rad.form_factors(patches, rad.MonteCarlo(rays=64))
    >>> float(abs(F.closure_defect).max())
    0.0
    """
    kind = np.dtype(dtype).type
    estimator = MonteCarlo() if estimator is None else estimator
    _check_fit(estimator, dtype, executor, checkpoint, rows)
    if not isinstance(estimator, Analytic):
        check_gaps(patches)
    begin = time.perf_counter()
    tracer = Tracer(patches.grid) if tracer is None else tracer
    built = time.perf_counter()
    if isinstance(estimator, TwoLevel):
        levels = estimator.factors(patches, tracer, kind, threads, memory_limit, progress or quiet)
        levels.statistics["seconds/ray tree"] = built - begin
        return levels
    makers = [estimator.rows(patches, tracer, replicate) for replicate in range(estimator.replicates)]
    check_cost(patches, estimator, makers, kind, memory_limit, tracer, threads)
    if rows is not None:
        makers = [SomeRows(maker, rows) for maker in makers]
    runs = _runs(patches, estimator, makers, kind, threads, executor, checkpoint, progress or quiet)
    factors = _with_replicates(runs, patches, estimator, kind, threads)
    factors.statistics["seconds/ray tree"] = built - begin
    return _counted(factors, estimator, rows, built)


def _check_fit(
    estimator: Estimator | TwoLevel,
    dtype: Any,
    executor: Executor | None,
    checkpoint: str | os.PathLike[str] | None,
    rows: RowChoice | None,
) -> None:
    """Refuse what does not go together, before any work is done.

    Raises
    ------
    ParameterError
    """
    if np.dtype(dtype).type not in (np.float32, np.float64):
        raise ParameterError(f"dtype is {dtype!r}; give float32 or float64")
    if executor is not None:
        Crew(executor)
    elsewhere = executor is not None or checkpoint is not None
    if isinstance(estimator, TwoLevel) and elsewhere:
        raise ParameterError("two levels are made by threads alone: leave executor and checkpoint out, or MonteCarlo()")
    if rows is not None and elsewhere:
        raise ParameterError("rows are left out only where this process makes them, without a checkpoint")


def _runs(
    patches: Patches,
    estimator: Estimator,
    makers: Sequence[Any],
    kind: Any,
    threads: int | None,
    executor: Executor | None,
    checkpoint: str | os.PathLike[str] | None,
    progress: Progress,
    first: int = 0,
) -> list[Rows]:
    """Factors of every replicate from the `first` on, each by its maker of rows."""
    key, kept = "", None
    if executor is not None or checkpoint is not None:
        key = fingerprint(patches, estimator, kind)
    elif isinstance(makers[0], ExactRows):
        makers[0].at_once(threads)
    if checkpoint is not None:
        kept = Checkpoint(checkpoint, key, f"{patches.name}, {len(patches)} patches, by {estimator}, {np.dtype(kind)}")
    return [
        _assemble(RowsToMake(patches, estimator, maker, replicate, kind, key, threads, executor), kept, progress)
        for replicate, maker in enumerate(makers, start=first)
    ]


def completed(
    factors: FormFactors,
    patches: Patches,
    rows: NDArray[np.bool_] | None = None,
    *,
    threads: int | None = None,
    tracer: Tracer | None = None,
) -> FormFactors:
    """The same factors with rows that were left out: to the last bit those of a `form_factors` that made all.

    Parameters
    ----------
    factors : FormFactors
        Of an estimator of this package.
    patches : Patches
    rows : ndarray of bool (N,), optional
        Which of the rows left out are made now; by default all.
    threads : int, optional
    tracer : Tracer, optional

    Returns
    -------
    FormFactors
        What took how long is added to its statistics.
    """
    if factors.left_out is None:
        return factors
    wanted = factors.left_out if rows is None else factors.left_out & rows
    estimator: Any = factors.estimator
    kind = factors.matrix.dtype.type
    choice = RowChoice(wanted, np.zeros(len(patches), dtype=bool))
    more = form_factors(patches, estimator, dtype=kind, threads=threads, rows=choice, tracer=tracer)
    still = factors.left_out & ~wanted
    return _joined(factors, more, wanted, still if still.any() else None)


def more_replicates(
    factors: FormFactors,
    patches: Patches,
    estimator: MonteCarlo,
    *,
    threads: int | None = None,
    memory_limit: float | None = None,
    progress: Progress | None = None,
    rows: RowChoice | None = None,
    tracer: Tracer | None = None,
) -> FormFactors:
    """Factors with further replicates: to the last bit those of a `form_factors` with `estimator`, which has more.

    Parameters
    ----------
    factors : FormFactors
        Of the same patches by an estimator with fewer replicates of as many rays each.
    patches, estimator, threads, memory_limit, progress, rows, tracer
        As of `form_factors`.

    Raises
    ------
    ParameterError
        An estimator whose replicates are others, or no more.
    MemoryLimitError
    """
    before = factors.estimator
    if not isinstance(before, MonteCarlo) or estimator.replicates <= len(factors.replicates):
        raise ParameterError(f"{estimator} has no more replicates than {before}")
    if _one_replicate(before) != _one_replicate(estimator):
        raise ParameterError(f"{estimator} has replicates that are not those of {before}")
    begin = time.perf_counter()
    tracer = Tracer(patches.grid) if tracer is None else tracer
    made = len(factors.replicates)
    makers: list[Any] = [estimator.rows(patches, tracer, replicate) for replicate in range(made, estimator.replicates)]
    kind = factors.matrix.dtype.type
    check_cost(patches, estimator, makers, kind, memory_limit, tracer, threads)
    makers = makers if rows is None else [SomeRows(maker, rows) for maker in makers]
    new = _runs(patches, estimator, makers, kind, threads, None, None, progress or quiet, made)
    old = [
        Rows(run.matrix, run.to_sky, run.to_backs, run.statistics["rays/to emitters"], run.exact_columns)
        for run in factors.replicates
    ]
    whole = _with_replicates([*old, *new], patches, estimator, kind, threads)
    return _counted(whole, estimator, rows, begin)


def _one_replicate(method: MonteCarlo) -> tuple[Any, ...]:
    """What the bits of a replicate depend on."""
    return method.seed, method.sampling, method.rays // method.replicates, method.light_rays // method.replicates


def _counted(factors: FormFactors, estimator: Estimator, rows: RowChoice | None, begin: float) -> FormFactors:
    """Factors with their counters, that say which rows they lack; so do their replicates."""
    seconds = {"seconds/form factors": time.perf_counter() - begin}
    factors.statistics.update(_counters(factors, estimator, rows), **seconds)
    if rows is None or rows.left_out is None:
        return factors
    runs = tuple(replace(run, left_out=rows.left_out) for run in factors.replicates)
    return replace(factors, left_out=rows.left_out, replicates=runs)


def _joined(
    first: FormFactors, second: FormFactors, of_second: NDArray[np.bool_], left_out: NDArray[np.bool_] | None
) -> FormFactors:
    """Factors whose rows are those of one or of another; either has no entries where they are the other's."""
    replicates = tuple(
        _joined(one, two, of_second, left_out) for one, two in zip(first.replicates, second.replicates, strict=True)
    )
    statistics = dict(first.statistics)
    for name, value in second.statistics.items():
        statistics[name] = statistics.get(name, 0) + value
    return replace(
        first,
        matrix=csr_array(first.matrix + second.matrix),
        to_sky=np.where(of_second, second.to_sky, first.to_sky),
        to_backs=np.where(of_second, second.to_backs, first.to_backs),
        statistics=statistics,
        replicates=replicates,
        left_out=left_out,
    )


def _assemble(work: RowsToMake, kept: Checkpoint | None, tell: Progress) -> Rows:
    """All rows of one replicate."""
    count, replicates = len(work.patches), work.estimator.replicates

    def told(rows: int) -> None:
        tell("form factors", work.replicate * count + rows, replicates * count)

    if kept is None:
        blocks = work.make([(0, count)])
    else:
        blocks = kept.rows(work, count, work.estimator.rays // replicates or count)
    with closing(blocks):
        rows = stack_rows(blocks, count, work.dtype, told)
    return rows._replace(exact_columns=work.maker.exact_columns)


def _with_replicates(
    runs: list[Rows], patches: Patches, estimator: Estimator, dtype: Float, threads: int | None
) -> FormFactors:
    """Factors from rows; where there are several independent estimates, their mean, which keeps them."""
    found = [_factors(rows, patches, estimator) for rows in runs]
    if len(found) == 1:
        return found[0]
    mean = _factors(mean_rows(runs, dtype, threads), patches, estimator, tuple(found))
    mean.statistics["leaks/share"] = float(np.mean([run.statistics["leaks/share"] for run in found]))
    return replace(mean, to_sky=np.mean([run.to_sky for run in found], axis=0))


def _factors(
    rows: Rows, patches: Patches, estimator: Estimator, replicates: tuple[FormFactors, ...] = ()
) -> FormFactors:
    """Factors from rows, without what has leaked."""
    to_sky, leaks = without_leaks(rows.to_sky, patches)
    return FormFactors(
        rows.matrix,
        to_sky,
        rows.to_backs,
        patches.area,
        patches.surface,
        patches.surface_names,
        estimator,
        {
            "leaks/share": leaks,
            "rays/to emitters": rows.shadow_rays,
        },
        replicates,
        rows.exact_columns,
    )


def _counters(factors: FormFactors, estimator: Estimator, rows: RowChoice | None) -> dict[str, float]:
    """Where the rays went; those of rows that were not made are not counted."""
    traced = np.ones(len(factors), dtype=bool) if rows is None else rows.made
    rays = estimator.rays * int(traced.sum())
    return {
        "rays/traced": rays,
        "rays/to sky": round(float(np.mean(factors.to_sky[traced])) * rays) if rays else 0,
        "rays/to backs": round(float(np.mean(factors.to_backs[traced])) * rays) if rays else 0,
        "rays/leaked": round(factors.statistics["leaks/share"] * estimator.rays * len(factors)),
        "matrix/non-zeros": factors.matrix.nnz,
        "matrix/bytes": factors.matrix.data.nbytes + factors.matrix.indices.nbytes + factors.matrix.indptr.nbytes,
    }
