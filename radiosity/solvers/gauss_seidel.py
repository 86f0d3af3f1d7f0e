"""Gathering: each patch in turn takes in the newest light of all others."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..compiled import kernel
from ..result import Step
from .admission import row_excess
from .base import Problem, Solver

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class GaussSeidel(Solver):
    """Sweep over the patches in their order, each gathering in place; about half the sweeps of `Neumann`.

        B_i ← (E_i + ρ_i Σ_{j≠i} F_ij B_j) / (1 - ρ_i F_ii),                                            Eq. (19)

    with the denominator as a sum, α_i + ρ_i (Σ_{j≠i} F_ij + outside_i). A sweep goes through the matrix once, and
    the residual from the equation once more. One thread, as each patch needs the one before.

    Parameters
    ----------
    rtol, atol, maxiter
        See `Solver`; `maxiter` is the most sweeps.

    References
    ----------
    M. F. Cohen, J. R. Wallace, Radiosity and Realistic Image Synthesis (1993), section 5.3.2.
    """

    advice = "Allow more sweeps (maxiter), or use ConjugateGradient on conserved factors"

    def steps(self, problem: Problem) -> Iterator[Step]:
        """Yield the start, then one step a sweep."""
        matrix = problem.T.factors.matrix
        excess = row_excess(problem.T)
        light = problem.source if problem.start is None else problem.start
        source = problem.source.reshape(len(light), -1)
        before = np.zeros_like(light)
        for order in range(self.maxiter + 1):
            residual = problem.measure(problem.residual(light))
            done = problem.reached(residual, light)
            yield problem.step(order, light - before, light, residual)
            if done:
                problem.scratch["converged"] = True
                return
            before, flat = light, light.reshape(len(light), -1).copy()
            _sweep(matrix.indptr, matrix.indices, matrix.data, problem.T.reflectance, excess, source, flat)
            problem.count("solver/products")
            light = flat.reshape(light.shape)


@kernel
def _sweep(indptr, indices, weights, rho, excess, source, light):  # type: ignore[no-untyped-def]
    """One sweep in place; columns are channels times emissions."""
    width = light.shape[1]
    emissions = width // rho.shape[1]
    gathered = np.empty(width)
    for i in range(len(light)):
        gathered[:] = 0.0
        others = 0.0
        for p in range(indptr[i], indptr[i + 1]):
            j = indices[p]
            if j != i:
                w = np.float64(weights[p])
                others += w
                for m in range(width):
                    gathered[m] += w * light[j, m]
        for m in range(width):
            c = m // emissions
            kept = excess[i, c] + rho[i, c] * others
            light[i, m] = (source[i, m] + rho[i, c] * gathered[m]) / kept if kept > 0.0 else 0.0
