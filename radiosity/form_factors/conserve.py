"""Conserved factors: form factors made to close and to be reciprocal, with as little change as that takes.

The exchange areas S = (G + Gᵀ)/2 are scaled symmetrically, G' = D S D with D = diag(exp x), the sky and
the black backs of each patch by the same D as receivers without a balance of their own, so that each row closes,
Eq. (23):

    d_i (Σ_j S_ij d_j + A_i (to_sky_i + to_backs_i)) = A_i.

That x is the minimum of the convex ½ dᵀ S d + Σ_i A_i (to_sky_i + to_backs_i) d_i - Σ_i A_i x_i, found by Newton's
method; where the pattern of S allows no such scaling, x runs away and is stopped (Knight & Ruiz 2013,
doi:10.1093/imanum/drs019; Larsson, Larsson & Andersson 1986, doi:10.1016/0017-9310(86)90060-2 for form factors).
"""

from __future__ import annotations

import time
import warnings
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from ..errors import FormFactorError, FormFactorWarning
from ..sparse import csr_matmul

if TYPE_CHECKING:
    from .factors import FormFactors

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]

CLOSED = 1e-14  # closure defect at which scaling ends
SURELY_CLOSED = 1e-12  # and which it has to reach, where rounding stops it before
LARGEST = np.log(1e3)  # a patch scaled by more was not sampled but missed
MOST_STEPS = 60
MOST_INNER = 30
SIGMAS = 5.0  # of sampling error, beyond which a correction needs another explanation
UNEXPLAINED = 0.1  # correction that is named where the sampling error is not known


def conserve(factors: FormFactors, keep: BoolArray | None = None) -> FormFactors:
    """Give new form factors that close each row and satisfy A_i F_ij = A_j F_ji, in float64.

    Parameters
    ----------
    factors : FormFactors
        Raw.
    keep : ndarray of bool (N,), optional
        Patches whose columns are exact (lamps, say) and are not scaled: G_ij = A_i F_ij of these j is taken
        as it is, and for G_ji too; such a patch's own row closes by its sky and backs, which were sampled, or by its
        diagonal where it has none. By default `factors.exact_columns`.

    Returns
    -------
    FormFactors
        With the same estimator, its replicates conserved likewise, and these statistics: "conserve/closure_before",
        "conserve/closure_after" (largest |defect|), "conserve/reciprocity_before", "conserve/reciprocity_after",
        "conserve/largest_correction" (|d_i d_j - 1|), "conserve/largest_correction_at" (i, j),
        "conserve/kept_on_diagonal" (largest share), "conserve/passes" (products), "seconds/conserve".

    Raises
    ------
    FormFactorError
        No scaling exists: a patch that sees nothing, or can never see enough.

    Warns
    -----
    FormFactorWarning
        Corrections that sampling does not explain (leaks, patches partly inside others), with the patches.
    """
    kept = factors.exact_columns if keep is None else keep
    kept = np.zeros(len(factors), dtype=bool) if kept is None else np.asarray(kept, dtype=bool)
    if kept.shape != factors.area.shape:
        raise FormFactorError(f"keep has shape {kept.shape}; give one truth value per patch, {factors.area.shape}")
    conserved, scale = _conserved(factors, kept)
    _warn_of_unexplained(factors, scale)
    return conserved


def _conserved(factors: FormFactors, kept: BoolArray) -> tuple[FormFactors, FloatArray]:
    """Conserved factors with their statistics, and d (N,)."""
    began = time.perf_counter()
    scaled = _scale(factors, kept)
    new = replace(
        factors,
        matrix=scaled.matrix,
        to_sky=scaled.to_sky,
        to_backs=scaled.to_backs,
        replicates=tuple(_conserved(run, kept)[0] for run in factors.replicates),
        statistics={
            **factors.statistics,
            "conserve/closure_before": float(np.max(np.abs(factors.closure_defect), initial=0.0)),
            "conserve/reciprocity_before": factors.reciprocity_defect,
            "conserve/largest_correction": scaled.largest[0],
            "conserve/largest_correction_at": scaled.largest[1:],
            "conserve/kept_on_diagonal": scaled.diagonal,
            "conserve/passes": scaled.passes,
        },
    )
    new.statistics["conserve/closure_after"] = float(np.max(np.abs(new.closure_defect), initial=0.0))
    new.statistics["conserve/reciprocity_after"] = new.reciprocity_defect
    new.statistics["seconds/conserve"] = time.perf_counter() - began
    return new, scaled.scale


@dataclass(frozen=True, eq=False)
class _Scaled:
    """What scaling gives."""

    matrix: csr_array
    to_sky: FloatArray
    to_backs: FloatArray
    scale: FloatArray  # d of what is not kept, (N,)
    largest: tuple[float, int, int]  # |d_i d_j - 1| over the entries, and where
    diagonal: float
    passes: int


def _scale(factors: FormFactors, kept: BoolArray) -> _Scaled:
    """Symmetrise and scale; a kept row closes by its sky and backs, or by its diagonal where it has none."""
    area = factors.area
    exchange = _symmetric(factors.exchange_area(), kept)
    outside = area * (factors.to_sky + factors.to_backs)
    row = np.repeat(np.arange(len(area)), np.diff(exchange.indptr))
    fixed = kept[row] | kept[exchange.indices]
    held = csr_array((exchange.data * fixed, exchange.indices, exchange.indptr), shape=exchange.shape)
    if kept.any():
        exchange, held = _shrink_kept(exchange, held, kept, area, row)
    free = csr_array((exchange.data * ~fixed, exchange.indices, exchange.indptr), shape=exchange.shape)
    target = area - csr_matmul(held, np.ones(len(area)))
    x, passes = _balance(free, np.where(kept, 0.0, outside), np.where(kept, 0.0, target), _naming(factors))
    d = np.exp(x)
    factor = np.where(fixed, 1.0, d[row] * d[exchange.indices])
    d[kept] = np.divide(target, outside, out=np.ones_like(target), where=outside > 0)[kept]
    matrix = csr_array((exchange.data * factor / area[row], exchange.indices, exchange.indptr), shape=exchange.shape)
    to_sky, to_backs = factors.to_sky * d, factors.to_backs * d
    spare = np.where(kept, 1.0 - csr_matmul(matrix, np.ones(len(area))) - to_sky - to_backs, 0.0)
    if kept.any():
        matrix = csr_array(matrix + _diagonal(np.maximum(spare, 0.0)))
    change = np.append(np.abs(factor - 1.0), 0.0)
    worst = int(np.argmax(change))
    place = (int(row[worst]), int(exchange.indices[worst])) if change[worst] > 0 else (0, 0)
    largest = (float(change[worst]), *place)
    return _Scaled(matrix, to_sky, to_backs, np.exp(x), largest, float(spare.max(initial=0.0)), passes)


def _symmetric(exchange: csr_array, kept: BoolArray) -> csr_array:
    """(G + Gᵀ)/2, but G_ij and its mirror where column j alone is kept. Symmetric to the bit."""
    if kept.any():
        row = np.repeat(np.arange(len(kept)), np.diff(exchange.indptr))
        column_kept, row_kept = kept[exchange.indices], kept[row]
        weight = np.where(column_kept & ~row_kept, 2.0, np.where(row_kept & ~column_kept, 0.0, 1.0))
        exchange = csr_array((exchange.data * weight, exchange.indices, exchange.indptr), shape=exchange.shape)
    total = csr_array(exchange + exchange.T)
    total.data *= 0.5
    total.eliminate_zeros()
    total.sort_indices()
    return total


def _shrink_kept(
    exchange: csr_array, held: csr_array, kept: BoolArray, room: FloatArray, row: NDArray[Any]
) -> tuple[csr_array, csr_array]:
    """Scale down kept patches whose exact exchange sums to more than they have (visibility is sampled)."""
    sums = csr_matmul(held, np.ones(len(kept)))
    over = kept & (sums > room)
    shrink = np.where(over, np.divide(room, sums, out=np.ones_like(sums), where=over), 1.0)
    factor = shrink[row] * shrink[exchange.indices]

    def shrunk(matrix: csr_array) -> csr_array:
        return csr_array((matrix.data * factor, matrix.indices, matrix.indptr), shape=matrix.shape)

    return shrunk(exchange), shrunk(held)


def _diagonal(values: FloatArray) -> csr_array:
    index = np.arange(len(values))
    return csr_array((values, (index, index)), shape=(len(values), len(values)))


def _balance(
    exchange: csr_array, outside: FloatArray, target: FloatArray, name: Callable[[Any], str]
) -> tuple[FloatArray, int]:
    """Find x with e^x_i (Σ_j S_ij e^x_j + outside_i) = target_i by Newton's method; gives x and the passes made."""
    x = np.zeros(len(target))
    active = target > 0
    seen = csr_matmul(exchange, np.where(active, 1.0, 0.0)) + outside
    _refuse(active & ~(seen > 0), "see no other patch, and neither the sky", name)
    _refuse(target < -SURELY_CLOSED * np.max(target, initial=0.0), "exchange more with kept lamps than they have", name)
    passes, before, defect = 1, np.inf, target
    for _ in range(MOST_STEPS):
        d = np.where(active, np.exp(x), 0.0)
        given = d * (csr_matmul(exchange, d) + outside)
        passes += 1
        defect = np.where(active, target - given, 0.0)
        size = float(np.max(np.abs(defect[active]) / target[active], initial=0.0))
        if size <= CLOSED or (size <= SURELY_CLOSED and size >= before / 2):
            return x, passes
        before = size
        step, inner = _newton_step(exchange, d, given, defect, min(0.1, size), active)
        passes += inner
        x = x + step * min(1.0, 1.0 / max(float(np.max(np.abs(step))), 1e-300))
        _refuse(np.abs(x) > LARGEST, f"would have to be scaled by more than {np.exp(LARGEST):.0f} to close", name)
    _refuse(np.abs(defect) >= 0.5 * np.max(np.abs(defect)), f"do not close after {passes} passes", name)
    return x, passes


def _newton_step(
    exchange: csr_array, d: FloatArray, given: FloatArray, defect: FloatArray, rtol: float, active: BoolArray
) -> tuple[FloatArray, int]:
    """Solve (diag(given) + D S D) step = defect by conjugate gradients with that diagonal as preconditioner."""
    inverse = np.divide(1.0, given, out=np.zeros_like(given), where=active & (given > 0))
    step = np.zeros_like(defect)
    residual = defect.copy()
    z = inverse * residual
    direction = z
    energy = first = float(np.sum(residual * z))
    for inner in range(1, MOST_INNER + 1):
        image = given * direction + d * csr_matmul(exchange, d * direction)
        curvature = float(np.sum(direction * image))
        if not curvature > 1e-12 * float(np.sum(given * direction**2)):  # two facing halves: leave that direction
            return step + direction * (energy / max(curvature, 1e-6 * float(np.sum(given * direction**2)))), inner
        length = energy / curvature
        step = step + length * direction
        residual = residual - length * image
        z = inverse * residual
        energy, last = float(np.sum(residual * z)), energy
        if energy <= rtol**2 * first:
            return step, inner
        direction = z + (energy / last) * direction
    return step, MOST_INNER


def _refuse(wrong: BoolArray, what: str, name: Callable[[Any], str]) -> None:
    """Raise for the patches that are wrong, if any.

    Raises
    ------
    FormFactorError
    """
    if wrong.any():
        raise FormFactorError(
            "no symmetric scaling closes these form factors: "
            f"{int(wrong.sum())} patches ({name(np.flatnonzero(wrong))}) {what}. "
            "Look at their geometry, use more rays, or keep the raw factors"
        )


def _naming(factors: FormFactors) -> Callable[[Any], str]:
    """A function that names patches by number and surface."""

    def name(patches: Any) -> str:
        shown = []
        for i in patches[:5]:
            surface = "" if factors.surface is None else f" of {factors.surface_names[factors.surface[i]]}"
            shown.append(f"{i}{surface}")
        return ", ".join(shown) + (", …" if len(patches) > 5 else "")

    return name


def arrival_defect(factors: FormFactors) -> FloatArray:
    """Σ_i A_i F_ij / A_j + to_sky_j + to_backs_j - 1, (N,): by how much more arrives at j than leaves it."""
    exchange = factors.exchange_area()
    arrived = np.bincount(exchange.indices, exchange.data, len(factors))
    return arrived / factors.area + factors.to_sky + factors.to_backs - 1.0


def arrival_error(factors: FormFactors) -> FloatArray | None:
    """Standard error of `arrival_defect`, (N,); None where nothing is known about the sampling.

    The larger of the spread of replicates (few of them can agree by chance) and the binomial
    √(Σ_i A_i² F_ij (1 - F_ij) / rays) / A_j, right for independent rays and too large for low-discrepancy ones.
    """
    errors = []
    if len(factors.replicates) > 1:
        spread = np.std([arrival_defect(run) for run in factors.replicates], axis=0, ddof=1)
        errors.append(spread / np.sqrt(len(factors.replicates)))
    rays = sampling_rays(factors)
    if rays is not None:
        exchange = factors.exchange_area()
        row = np.repeat(np.arange(len(factors)), np.diff(exchange.indptr))
        variance = exchange.data * np.maximum(factors.area[row] - exchange.data, 0.0) / rays
        errors.append(np.sqrt(np.bincount(exchange.indices, variance, len(factors))) / factors.area)
    return np.max(errors, axis=0) if errors else None


def sampling_rays(factors: FormFactors) -> float | None:
    """Rays per patch that random sampling spent on these factors; None where they were not sampled so."""
    estimator: Any = factors.estimator
    if not hasattr(estimator, "sampling"):
        return None
    return float(estimator.rays) / (1 if factors.replicates else estimator.replicates)


def _warn_of_unexplained(factors: FormFactors, scale: FloatArray) -> None:
    """Name patches whose correction is larger than sampling explains."""
    correction = np.abs(scale**2 - 1.0)
    defect, error = arrival_defect(factors), arrival_error(factors)
    if error is None:
        strange = correction > UNEXPLAINED
        known = "nothing is known about their sampling error"
    else:
        strange = (np.abs(defect) > SIGMAS * error) & (correction > 1e-6)
        known = f"more than {SIGMAS:g} standard errors of the sampling"
    if strange.any():
        worst = np.flatnonzero(strange)[np.argsort(-correction[strange], kind="stable")]
        warnings.warn(
            f"conserved() corrects {int(strange.sum())} patches by up to {correction.max():.3g}, {known}: "
            f"{_naming(factors)(worst)}. Look for leaks and for patches partly inside other objects",
            FormFactorWarning,
            stacklevel=4,  # of whoever called FormFactors.conserved,
        )
