"""How far sampled form factors move the answer."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..form_factors.factors import FormFactors
from ..form_factors.levels import TwoLevelFactors
from ..form_factors.spot_check import SpotCheck
from ..solvers import ConjugateGradient, Neumann, Solver
from ..solvers.admission import connected_components, row_excess
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
    """Standard error of B, relative to B - E: from independent replicates, Eq. (26), or a spot check, Eq. (27).

    Each replicate is solved by itself, beginning from the light of their mean.

    Returns
    -------
    float or None
        Area-weighted L2 over patches and channels; 0.0 for exact factors, None where there is neither.
    """
    if is_exact(T.stored_factors):
        return 0.0
    factors = T.stored_factors
    if isinstance(factors, TwoLevelFactors) and factors.check is not None:
        return _from_check(T, factors.check, emission, radiosity, sky)
    runs = factors.replicates
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


def _from_check(
    T: TransportOperator, check: SpotCheck, emission: FloatArray, radiosity: FloatArray, sky: ArrayLike | None
) -> float:
    """Eq. (27): what the checked rows miss, and what the balance of energy misses.

    Rows err each by itself, which the check sees and bounces even out; and all a little alike, which it hardly sees
    and bounces multiply. But that takes or brings power, and by as much of what was put in, all light is wrong.
    """
    E, B = emission, radiosity
    from_sky = np.pi * np.broadcast_to(np.asarray(0.0 if sky is None else sky, dtype=np.float64), (T.channels,))
    unit = max(float(np.abs(B).max(initial=0.0)), float(from_sky.max(initial=0.0)))
    size = float(np.linalg.norm(T.norm(B - E)))
    if not size > 0.0:
        return 0.0
    gathered, sky_share = T.factors.gather(B, T.threads), T.factors.to_sky
    arriving = gathered[check.patch] + np.outer(sky_share[check.patch], from_sky)
    missed = T.reflectance[check.patch] * (arriving - check.arriving(B, from_sky)) / unit
    apart = float(np.mean((missed[0] * missed[1]).sum(axis=1)))
    kept = (1.0 - T.to_outside)[:, None]
    label = connected_components(T.factors)
    brought = _sums(gathered - kept * B, T.area, label)
    put_in = _sums(kept * E + np.outer(sky_share, from_sky), T.area, label)
    defect = np.divide(brought, put_in, out=np.zeros_like(brought), where=put_in > 0.0)
    alike = float(np.linalg.norm(T.norm(defect[label] * (B - E) / unit)))
    return float(np.sqrt(max(apart, 0.0) + alike**2)) * unit / size


def _sums(density: FloatArray, area: FloatArray, label: NDArray[np.int64]) -> FloatArray:
    """Power of each enclosure, (enclosures, C)."""
    return np.stack([np.bincount(label, area * column) for column in density.T], axis=1)


def expected_reciprocity(factors: FormFactors) -> float | None:
    """‖G - Gᵀ‖ / ‖G‖ that the standard errors of the form factors lead one to expect; None where they are not known."""
    error = factors.standard_error
    if error is None:
        return None
    exchange = factors.exchange_area()
    rows = np.repeat(factors.area, np.diff(error.indptr))
    size = float(np.sqrt(np.sum(exchange.data**2)))
    return float(np.sqrt(2.0 * np.sum((rows * error.data) ** 2)) / size) if size > 0 else 0.0
