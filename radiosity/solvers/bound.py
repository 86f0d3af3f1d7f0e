"""How far a radiosity can be from the solution of its equation: a bound that holds, whatever computed it.

For e = B* - B and the residual r = E - (I - T) B, (I - T) e = r. I - T is an M-matrix: any positive w with
g = (I - T) w > 0 bounds |e| ≤ w max_i |r_i| / g_i, Eq. (24), even where rows of T pass one (Collatz; Ostrowski
1937). That alone loses all signs: in a closed room the residuals of a good solver cancel, and w is 1/α. So a
correction ẽ of any origin is taken first, and only what it leaves, r' = r - (I - T) ẽ, is bounded so:

    |e_i| ≤ |ẽ_i| + w_i max_j (|r'_j| + rounding_j) / g_j.

Nothing is assumed of how w and ẽ were found; r' and g come from the equation, without subtraction. At small α
the correction (elimination, or deflated conjugate gradients) is the energy form's minimiser, so that the bound is as
sharp there as one from the energy norm, and needs no estimate of an eigenvalue.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse.linalg import gmres

from ..compiled import kernel
from ..errors import SolverError
from ..form_factors.levels import TwoLevelFactors
from ..parallel import ordered_map
from ..sparse import row_blocks
from ..transport import TransportOperator
from .admission import connected_components, row_excess
from .conjugate_gradient import ASYMMETRY, ConjugateGradient
from .direct import Direct
from .rooms import find_rooms

FloatArray = NDArray[np.float64]

EPS = float(np.finfo(np.float64).eps)
SHARP = 0.25  # of the correction: what is left may be this large
QUICK = 0.9  # largest row sum of T for which bounces alone serve
PASSES = 60
BLACK = 1e-12
SMALL = 1500  # patches up to which elimination is cheaper than anything else


@dataclass(frozen=True, eq=False)
class ErrorBound:
    """Bound on |B* - B| for the solution B* of the equation with these form factors.

    Attributes
    ----------
    bound : ndarray (N, C)
        W/m²; infinite in a channel for which no positive w was found.
    correction : ndarray (N, C)
        ẽ: added to B it gives a better solution.
    relative : float
        Area-weighted relative L2 of B - E over patches and channels: ‖bound‖ / ‖B* - E‖, at most.
    products : int
    """

    bound: FloatArray
    correction: FloatArray
    relative: float
    products: int


def error_bound(T: TransportOperator, source: FloatArray, radiosity: FloatArray, emission: FloatArray) -> ErrorBound:
    """Bound the error of a radiosity that some solver gave.

    Parameters
    ----------
    T : TransportOperator
    source : ndarray (N, C)
        E + ρ π to_sky L_sky, W/m².
    radiosity, emission : ndarray (N, C)
        W/m².

    Returns
    -------
    ErrorBound

    Raises
    ------
    SolverError
        Rows on demand.
    """
    _ = T.stored_factors
    residual = T.residual(radiosity, source)
    floor = _rounding(T, radiosity, source)
    lit = _lit(T, np.abs(source) + np.abs(residual))
    if float(row_excess(T).min(initial=1.0)) >= 1.0 - QUICK:
        correction, w, products = _by_bounces(T, residual, floor, lit)
    elif T.shape[0] <= SMALL:
        correction, w, products = _eliminate(T, residual), _eliminate(T, lit), 2
    elif isinstance(T.factors, TwoLevelFactors):
        correction, w, products = _by_krylov(T, residual, lit)
    elif find_rooms(T.stored_factors).asymmetry <= ASYMMETRY:
        correction, w, products = _by_conjugate_gradients(T, residual, floor, lit)
    else:
        correction, w, products = _by_krylov(T, residual, lit)
    left = residual - T.loss(correction)
    gain = T.loss(w) - _rounding(T, w, lit)
    rest = _rest(np.abs(left) + floor + _rounding(T, correction, residual), w, gain, lit)
    bound = np.abs(correction) + rest
    indirect = _norm(T, radiosity + correction - emission) - _norm(T, rest)
    relative = _relative(_norm(T, bound), indirect, _norm(T, radiosity))
    return ErrorBound(bound, correction, relative, products + 7)


def _relative(size: float, indirect: float, whole: float) -> float:
    """A bound beside the least that ‖B* - E‖ can be; 0 where both are rounding of B, as in a black scene."""
    if indirect <= size <= BLACK * whole or size == 0.0:
        return 0.0
    return size / indirect if indirect > 0.0 else np.inf


def _lit(T: TransportOperator, light: FloatArray) -> FloatArray:
    """1 in enclosures that light reaches, else 0, (N, C): elsewhere B is exactly 0."""
    label = connected_components(T.stored_factors)
    reached = np.zeros((int(label.max(initial=0)) + 1, light.shape[1]))
    np.maximum.at(reached, label, light)
    return np.where(reached[label] > 0, 1.0, 0.0)


def _norm(T: TransportOperator, field: FloatArray) -> float:
    """Area-weighted L2 over patches and all channels."""
    if not np.all(np.isfinite(field)):
        return np.inf
    return float(np.linalg.norm(T.norm(field)))


def _rest(left: FloatArray, w: FloatArray, gain: FloatArray, lit: FloatArray) -> FloatArray:
    """Bound w max |r'| / g per channel, over what is lit; infinite where w does not serve."""
    serves = np.all(((w > 0) & (gain > 0)) | (lit == 0), axis=0)
    ratio = np.max(np.divide(left, gain, out=np.zeros_like(left), where=(gain > 0) & (lit > 0)), axis=0)
    return np.where(serves, w * lit * ratio, np.where(lit > 0, np.inf, 0.0))


def _sharp(
    T: TransportOperator, correction: FloatArray, left: FloatArray, floor: FloatArray, dual: tuple[FloatArray, ...]
) -> bool:
    """Whether what is left is small beside the correction, or beside the rounding that no correction removes."""
    rest, rounding = _norm(T, _rest(np.abs(left) + floor, *dual)), _norm(T, _rest(floor, *dual))
    return rest <= max(SHARP * _norm(T, correction), 2.0 * rounding)


def _by_bounces(
    T: TransportOperator, residual: FloatArray, floor: FloatArray, lit: FloatArray
) -> tuple[FloatArray, FloatArray, int]:
    """ẽ = Σ T^k r and w = Σ T^k 1, k < p, side by side in one product a bounce, until ẽ is sharp."""
    terms = np.stack([residual, lit], axis=2)
    sums = np.zeros_like(terms)
    passes = 0
    while passes < PASSES:
        passes += 1
        sums += terms
        terms = T @ terms
        if _sharp(T, sums[..., 0], terms[..., 0], floor, (sums[..., 1], lit - terms[..., 1], lit)):
            break
    return np.ascontiguousarray(sums[..., 0]), np.ascontiguousarray(sums[..., 1]), passes


def _eliminate(T: TransportOperator, right: FloatArray) -> FloatArray:
    """Solve directly; zeros, which bound nothing, where that is refused."""
    try:
        return Direct().solve(T, right).radiosity
    except SolverError:
        return np.zeros_like(right)


def _by_conjugate_gradients(
    T: TransportOperator, residual: FloatArray, floor: FloatArray, lit: FloatArray
) -> tuple[FloatArray, FloatArray, int]:
    """Find w to a percent and ẽ until it is sharp; zeros, which bound nothing, where that is refused."""
    correction = np.zeros_like(residual)
    try:
        dual = ConjugateGradient(rtol=1e-2).solve(T, lit)
    except SolverError:
        return correction, correction, 0
    w, gain = dual.radiosity, T.loss(dual.radiosity)
    products = dual.statistics["solver/products"] + 1
    for step in ConjugateGradient(rtol=0.0, maxiter=PASSES).iterate(T, residual):
        correction = step.radiosity
        products += 6
        if _sharp(T, correction, residual - T.loss(correction), floor, (w, gain, lit)):
            break
    return correction, w, products


def _by_krylov(T: TransportOperator, residual: FloatArray, lit: FloatArray) -> tuple[FloatArray, FloatArray, int]:
    """Stiff and not symmetric: whatever GMRES reaches in a few products."""
    correction, w = np.zeros_like(residual), np.zeros_like(residual)
    for c in range(T.channels):
        for right, out in ((residual, correction), (lit, w)):
            if right[:, c].any():
                out[:, c] = gmres(T.system(c), right[:, c], rtol=1e-6, restart=PASSES, maxiter=1)[0]
    return correction, w, 2 * PASSES * T.channels


def _rounding(T: TransportOperator, light: FloatArray, source: FloatArray) -> FloatArray:
    """Bound on the rounding of a residual, term by term: sums of n numbers are right to n ε Σ|·|."""
    per_row = T.stored_factors.terms[:, None] + 8.0
    outside = np.abs(T.to_outside)[:, None]
    exchanged = T.reflectance * (_absolute_exchange(T, light) + outside * np.abs(light))
    return EPS * (per_row * exchanged + 4.0 * (T.absorptance * np.abs(light) + np.abs(source)))


def _absolute_exchange(T: TransportOperator, light: FloatArray) -> FloatArray:
    """Σ_j F_ij |B_i - B_j|, (N, C); on two levels no less than that."""
    if isinstance(T.factors, TwoLevelFactors):
        return np.abs(light) + T.factors.gather(np.abs(light), T.threads)
    matrix, out = T.factors.matrix, np.zeros_like(light)
    flat = np.ascontiguousarray(light)

    def rows(block: tuple[int, int]) -> None:
        _absolute_rows(matrix.indptr, matrix.indices, matrix.data, flat, *block, out)

    for _ in ordered_map(rows, row_blocks(matrix.indptr), T.threads):
        pass
    return out


@kernel
def _absolute_rows(indptr, indices, weights, x, begin, end, out):  # type: ignore[no-untyped-def]
    for i in range(begin, end):
        for p in range(indptr[i], indptr[i + 1]):
            w = np.float64(weights[p])
            for c in range(x.shape[1]):
                out[i, c] += w * abs(x[i, c] - x[indices[p], c])
