"""Error and products against absorptance, for every solver: where each of them stops being one.

Two closed rooms with conserved form factors. The truth is an elimination without subtraction in the longest
floating-point numbers of the machine (80 bits on x86, 19 digits; elsewhere often no longer than 64), written here a
second time so that it shares nothing with the solver that it judges.
"""

from __future__ import annotations

import time
import warnings
from collections.abc import Callable, Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse.linalg import LinearOperator, bicgstab, gmres

import radiosity as rad

from ...progress import Progress, quiet
from .systems import conserved, operator

ABSORPTANCES = tuple(10.0**-k for k in (0.5, 1, 2, 3, 4, 6, 8, 10, 12))
PATCHES = 200
RTOL = 1e-10
MOST_PRODUCTS = 2000


class Point(NamedTuple):
    """One solver at one absorptance.

    claimed : whether the solver says that it has converged.
    error : relative L2 of B - E against the truth, without weights.
    """

    solver: str
    absorptance: float
    products: int
    seconds: float
    error: float
    claimed: bool


def curve(absorptances: Sequence[float] = ABSORPTANCES, progress: Progress = quiet) -> list[Point]:
    """All solvers at all absorptances, to a residual of 1e-10, with at most 2000 products each."""
    patches, factors = conserved("two_rooms", PATCHES, 1024)
    emission = patches.emission[:, :1]
    points = []
    progress("curves", 0, len(absorptances))
    for done, alpha in enumerate(absorptances, 1):
        T = operator(factors, absorptance=alpha)
        true = exact(T, emission[:, 0])
        for name, solve in solvers():
            points.append(_point(name, solve, T, emission, true, alpha))
        progress("curves", done, len(absorptances))
    return points


Solve = Callable[[rad.TransportOperator, NDArray[np.float64]], tuple[NDArray[np.float64], int, bool]]


def solvers() -> Iterator[tuple[str, Solve]]:
    """Ours, and scipy's two that take the operator as it is."""
    for solver in (
        rad.Neumann(rtol=RTOL, maxiter=MOST_PRODUCTS, keep_bytes=0),
        rad.GaussSeidel(rtol=RTOL, maxiter=MOST_PRODUCTS // 2),
        rad.Shooting(rtol=RTOL, maxiter=MOST_PRODUCTS // 2),
        rad.ConjugateGradient(rtol=RTOL),
        rad.Direct(rtol=RTOL),
    ):
        yield type(solver).__name__, _ours(solver)
    yield "scipy gmres", _foreign(lambda A, b: gmres(A, b, rtol=RTOL, restart=50, maxiter=MOST_PRODUCTS // 50))
    yield "scipy bicgstab", _foreign(lambda A, b: bicgstab(A, b, rtol=RTOL, maxiter=MOST_PRODUCTS // 2))


def _ours(solver: Any) -> Solve:
    def solve(T: rad.TransportOperator, emission: NDArray[np.float64]) -> tuple[NDArray[np.float64], int, bool]:
        result = solver.solve(T, emission)
        return result.radiosity[:, 0], result.statistics.get("solver/products", 0), result.converged

    return solve


def _foreign(method: Callable[[LinearOperator, NDArray[np.float64]], tuple[NDArray[np.float64], int]]) -> Solve:
    def solve(T: rad.TransportOperator, emission: NDArray[np.float64]) -> tuple[NDArray[np.float64], int, bool]:
        system, products = T.system(0), 0

        def counted(x: NDArray[np.float64]) -> NDArray[np.float64]:
            nonlocal products
            products += 1
            return system @ x

        found, info = method(LinearOperator(T.shape, matvec=counted, dtype=np.float64), emission[:, 0])
        return found, products, info == 0

    return solve


def _point(
    name: str, solve: Solve, T: rad.TransportOperator, emission: NDArray[np.float64], true: NDArray[Any], alpha: float
) -> Point:
    began = time.perf_counter()
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")  # scipy's, of what it divides by
        found, products, claimed = solve(T, emission)
    seconds = time.perf_counter() - began
    reflected = true - emission[:, 0]
    error = float(np.linalg.norm((found - true).astype(np.float64)) / np.linalg.norm(reflected.astype(np.float64)))
    return Point(name, alpha, products, seconds, error, claimed)


def exact(T: rad.TransportOperator, source: NDArray[np.float64]) -> NDArray[Any]:
    """B of one channel by elimination without subtraction, in long floating-point numbers, (N,).

    Unknown k is taken out of the rest: what they exchanged through it they exchange with each other, and what it
    loses they lose through it (Grassmann, Taksar & Heyman 1985).
    """
    alpha = T.absorptance[:, 0].astype(np.longdouble)
    rho = 1 - alpha
    W = rho[:, None] * T.factors.matrix.toarray().astype(np.longdouble)
    lost = alpha + rho * T.to_outside.astype(np.longdouble)
    right, count = source.astype(np.longdouble), len(source)
    pivots = np.zeros(count, dtype=np.longdouble)
    for k in range(count):
        pivots[k] = lost[k] + W[k, k + 1 :].sum()
        share = W[k + 1 :, k] / pivots[k]
        W[k + 1 :, k + 1 :] += np.outer(share, W[k, k + 1 :])
        lost[k + 1 :] += share * lost[k]
        right[k + 1 :] += share * right[k]
    for k in range(count - 1, -1, -1):
        right[k] = (right[k] + W[k, k + 1 :] @ right[k + 1 :]) / pivots[k]
    return right
