"""Gauss elimination without a subtraction, for matrices of exchange and loss.

A matrix M with off-diagonal entries -W_ij ≤ 0 and row sums e_i ≥ 0 is given by W and e; its diagonal
e_i + Σ_j W_ij is never formed by the user. Elimination then only adds, multiplies and divides numbers that are
not negative, so every entry of the factors and, for a right-hand side that is not negative, of the
solution is right to rounding however nearly singular M is (Grassmann, Taksar & Heyman 1985,
doi:10.1287/opre.33.5.1107; with row sums: Alfa, Xue & Ye 2002, doi:10.1090/S0025-5718-01-01325-4).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..compiled import kernel

FloatArray = NDArray[np.float64]

PANEL = 64  # columns eliminated before the rest is updated by one matrix product


@dataclass(frozen=True, eq=False)
class Elimination:
    """Factors of M = (I - L)(D - U), all of L, D, U not negative.

    Attributes
    ----------
    factors : ndarray (n, n)
        L below the diagonal, U above; the diagonal is not used.
    pivots : ndarray (n,)
        D. A pivot of zero is an unknown without any loss; it is set to zero.
    """

    factors: FloatArray
    pivots: FloatArray

    def solve(self, right: FloatArray) -> FloatArray:
        """Solve M x = right, (n,) or (n, m)."""
        columns = np.array(right, dtype=np.float64).reshape(len(right), -1)
        _substitute(self.factors, self.pivots, columns)
        return columns.reshape(right.shape)


def eliminate(exchange: FloatArray, excess: FloatArray) -> Elimination:
    """Factorise the matrix with off-diagonal entries -exchange and row sums excess.

    Parameters
    ----------
    exchange : ndarray (n, n)
        W ≥ 0; the diagonal is ignored.
    excess : ndarray (n,)
        e ≥ 0.

    Returns
    -------
    Elimination

    Examples
    --------
    Two unknowns that lose 1e-30 each and exchange 1: M x = (1, 0) has the solution 5e29 for both; no digit is lost.

    >>> eliminate(np.array([[0.0, 1.0], [1.0, 0.0]]), np.array([1e-30, 1e-30])).solve(np.array([1.0, 0.0]))
    array([5.e+29, 5.e+29])
    """
    W = np.array(exchange, dtype=np.float64, order="C")
    e = np.array(excess, dtype=np.float64)
    pivots = np.zeros(len(e))
    for begin in range(0, len(e), PANEL):
        end = min(begin + PANEL, len(e))
        _eliminate_panel(W, e, pivots, begin, end)
        if end < len(e):  # products of what is not negative: no subtraction here either
            W[end:, end:] += W[end:, begin:end] @ W[begin:end, end:]
            e[end:] += W[end:, begin:end] @ e[begin:end]
    return Elimination(W, pivots)


@kernel
def _eliminate_panel(W, e, pivots, begin, end):  # type: ignore[no-untyped-def]
    """Eliminate columns begin … end; rows of the panel whole, rows below it within the panel only."""
    n = len(e)
    for k in range(begin, end):
        pivot = e[k]
        for j in range(k + 1, n):
            pivot += W[k, j]
        pivots[k] = pivot
        for i in range(k + 1, n):
            if pivot == 0.0:  # an unknown set to zero: what goes there is lost
                e[i] += W[i, k]
            share = W[i, k] / pivot if pivot > 0.0 else 0.0
            W[i, k] = share
            if share > 0.0:
                last = n if i < end else end
                for j in range(k + 1, last):
                    W[i, j] += share * W[k, j]
                if i < end:
                    e[i] += share * e[k]


@kernel
def _substitute(W, pivots, x):  # type: ignore[no-untyped-def]
    n, width = x.shape
    for i in range(n):
        for k in range(i):
            for c in range(width):
                x[i, c] += W[i, k] * x[k, c]
    for i in range(n - 1, -1, -1):
        for j in range(i + 1, n):
            for c in range(width):
                x[i, c] += W[i, j] * x[j, c]
        for c in range(width):
            x[i, c] = x[i, c] / pivots[i] if pivots[i] > 0.0 else 0.0
