"""`form_factors`: any estimator on any patches."""

from __future__ import annotations

import time
from typing import Any

import numpy as np

from ..errors import ParameterError
from ..patches import Patches
from ..progress import Progress, quiet
from ..rays import Tracer
from .analytic import Analytic
from .assembly import Rows
from .factors import FormFactors
from .hemicube import Hemicube
from .monte_carlo import MonteCarlo

ALL = 1.0 - 1e-6  # of a row that goes to the sky
Estimator = MonteCarlo | Hemicube | Analytic


def form_factors(
    patches: Patches,
    estimator: Estimator | None = None,
    *,
    dtype: Any = np.float32,
    threads: int | None = None,
    progress: Progress | None = None,
) -> FormFactors:
    """Form factors between patches.

    Parameters
    ----------
    patches : Patches
    estimator : MonteCarlo, Hemicube or Analytic, optional
        ``MonteCarlo()`` by default.
    dtype : float32 or float64, optional
        Of the weights. A row of float32 weights adds up to 1 within about 1e-7.
    threads : int, optional
        As many as there are processors by default. The result has the same bits for any number.
    progress : callable, optional
        Called as ``progress(stage, rows done, rows in all)``.

    Returns
    -------
    FormFactors
        Raw: rows close exactly, reciprocity holds within the sampling error.

    Raises
    ------
    ParameterError
        A dtype that is neither.

    Examples
    --------
    >>> import radiosity as rad
    >>> patches = rad.subdivide(rad.scenes.furnace())
    >>> F = rad.form_factors(patches, rad.MonteCarlo(rays=64))
    >>> float(abs(F.closure_defect).max())
    0.0
    """
    kind = np.dtype(dtype).type
    if kind not in (np.float32, np.float64):
        raise ParameterError(f"dtype is {dtype!r}; give float32 or float64")
    estimator = MonteCarlo() if estimator is None else estimator
    begin = time.perf_counter()
    tracer = Tracer(patches.grid)
    built = time.perf_counter()
    runs = [
        _factors(rows, patches, estimator)
        for rows in estimator.estimate(patches, tracer, kind, threads, progress or quiet)
    ]
    factors = runs[0] if len(runs) == 1 else _mean(runs, kind)
    seconds = {"seconds/ray tree": built - begin, "seconds/form factors": time.perf_counter() - built}
    factors.statistics.update(_counters(factors, estimator, patches), **seconds)
    return factors


def _factors(rows: Rows, patches: Patches, estimator: Estimator) -> FormFactors:
    """Factors from rows. Rays that leave a closed scene have leaked, but for patches that see nothing else: outside."""
    inside = rows.to_sky < ALL if patches.closed else np.zeros(len(patches), dtype=bool)
    to_sky = np.where(inside, 0.0, rows.to_sky)
    return FormFactors(
        rows.matrix,
        to_sky,
        rows.to_backs,
        patches.area,
        patches.surface,
        patches.surface_names,
        estimator,
        {
            "leaks/share": float(np.mean(np.where(inside, rows.to_sky, 0.0))),
            "rays/to emitters": rows.shadow_rays,
        },
        exact_columns=rows.exact_columns,
    )


def _mean(runs: list[FormFactors], kind: type[np.float32] | type[np.float64]) -> FormFactors:
    """The mean of independent estimates, which keeps them."""
    total = runs[0].matrix.astype(np.float64)
    for run in runs[1:]:
        total = total + run.matrix
    matrix = (total / len(runs)).astype(kind)
    first = runs[0]
    to_sky, to_backs = (np.mean([getattr(run, name) for run in runs], axis=0) for name in ("to_sky", "to_backs"))
    leaks = float(np.mean([run.statistics["leaks/share"] for run in runs]))
    return FormFactors(
        matrix,
        to_sky,
        to_backs,
        first.area,
        first.surface,
        first.surface_names,
        first.estimator,
        {"leaks/share": leaks, "rays/to emitters": sum(run.statistics["rays/to emitters"] for run in runs)},
        tuple(runs),
        first.exact_columns,
    )


def _counters(factors: FormFactors, estimator: Estimator, patches: Patches) -> dict[str, float]:
    rays = estimator.rays * len(patches)
    return {
        "rays/traced": rays,
        "rays/to sky": round(float(np.mean(factors.to_sky)) * rays),
        "rays/to backs": round(float(np.mean(factors.to_backs)) * rays),
        "rays/leaked": round(factors.statistics["leaks/share"] * rays),
        "matrix/non-zeros": factors.matrix.nnz,
        "matrix/bytes": factors.matrix.data.nbytes + factors.matrix.indices.nbytes + factors.matrix.indptr.nbytes,
    }
