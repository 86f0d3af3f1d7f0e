"""How far sampled form factors move the answer."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..form_factors.factors import FormFactors
from ..solvers import ConjugateGradient, Neumann, Solver
from ..solvers.admission import row_excess
from ..transport import TransportOperator

FloatArray = NDArray[np.float64]

RTOL = 1e-5  # of the replicates' solutions: their spread needs few digits
SLOW = 0.02  # absorptance below which bounces are too many


def is_exact(factors: FormFactors) -> bool:
    """Whether the factors were computed without sampling, or given by the user as they are."""
    return factors.estimator is None or bool(getattr(factors.estimator, "exact", False))


def sampling_error(
    T: TransportOperator,
    emission: FloatArray,
    radiosity: FloatArray,
    sky: ArrayLike | None = None,
    solver: Solver | None = None,
) -> float | None:
    """Standard error of B from independent replicates of the form factors, Eq. (26), relative to B - E.

    Each replicate is solved by itself, beginning from the light of their mean.

    Returns
    -------
    float or None
        Area-weighted L2 over patches and channels; 0.0 for exact factors, None where there are no replicates.
    """
    if is_exact(T.stored_factors):
        return 0.0
    runs = T.stored_factors.replicates
    if len(runs) < 2:
        return None
    if solver is None:
        slow = float(row_excess(T).min(initial=1.0)) < SLOW
        solver = ConjugateGradient(rtol=RTOL) if slow else Neumann(rtol=RTOL)
    materials = SimpleNamespace(reflectance=T.reflectance, absorptance=T.absorptance)
    found = [
        solver.solve(TransportOperator(run, materials, threads=T.threads), emission, sky, x0=radiosity).radiosity
        for run in runs
    ]
    spread = np.std(found, axis=0, ddof=1) / np.sqrt(len(runs))
    size = float(np.linalg.norm(T.norm(radiosity - emission)))
    return float(np.linalg.norm(T.norm(spread))) / size if size > 0 else 0.0


def expected_reciprocity(factors: FormFactors) -> float | None:
    """‖G - Gᵀ‖ / ‖G‖ that the standard errors of the form factors lead one to expect; None where they are not known."""
    error = factors.standard_error
    if error is None:
        return None
    exchange = factors.exchange_area()
    rows = np.repeat(factors.area, np.diff(error.indptr))
    size = float(np.sqrt(np.sum(exchange.data**2)))
    return float(np.sqrt(2.0 * np.sum((rows * error.data) ** 2)) / size) if size > 0 else 0.0
