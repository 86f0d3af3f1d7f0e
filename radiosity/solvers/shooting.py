"""Shooting: the patch with the most unshot power sends its light to all others."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..compiled import kernel
from ..errors import SolverError
from ..form_factors.on_demand import RowsOnDemand
from ..result import Step
from .base import Problem, Solver

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class Shooting(Solver):
    """Progressive refinement (Southwell): shoot from where most power waits, until little is left.

    One shot from patch i needs column i of F only:

        B_j, unshot_j  +=  ρ_j F_ji unshot_i   for all j,      then unshot_i = 0.                       Eq. (20)

    With stored factors the true columns are used. With `RowsOnDemand` the column comes from row i by reciprocity,
    F_ji = A_i F_ij / A_j, so one row is computed a shot and nothing is stored. `step.radiosity` holds the unshot
    light `step.unshot` (W/m²) too, which is why its residual is T unshot. The order of shots is that of unshot
    power ``Σ_c A |unshot|``; ties go to the lowest patch.

    Parameters
    ----------
    rtol, atol, maxiter
        See `Solver`; `maxiter` is the most steps.
    shots : int, optional
        Shots a step; by default as many as there are patches (about the work of one product). The residual of a
        step is computed from the equation (with rows on demand, where that would take all rows, it is the
        unshot light).

    References
    ----------
    R. V. Southwell (1940); M. F. Cohen, S. E. Chen, J. R. Wallace & D. P. Greenberg (1988),
    doi:10.1145/54852.378487; S. Gortler, M. F. Cohen & P. Slusallek (1994), doi:10.1109/38.329094.
    """

    shots: int | None = None

    advice = "Allow more steps or shots, or use ConjugateGradient on conserved factors"

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.shots is not None and self.shots < 1:
            raise SolverError(f"shots is {self.shots}; give at least 1, or None for one a patch")

    def steps(self, problem: Problem) -> Iterator[Step]:
        """Yield the start, then one step every `shots` shots."""
        T = problem.T
        on_demand = isinstance(T.factors, RowsOnDemand)
        columns = None if on_demand else T.factors.matrix.T.tocsr()
        unshot = np.array(problem.source if problem.start is None else problem.residual(problem.start), order="C")
        light = unshot.copy()  # unshot light is there already
        if problem.start is not None:
            light += problem.start
        before = np.zeros_like(light)
        for order in range(self.maxiter + 1):
            residual = problem.measure(unshot if on_demand else problem.source + problem.product(light) - light)
            done = problem.reached(residual, light)
            yield problem.step(order, light - before, light.copy(), residual, unshot.copy())
            if done or order == self.maxiter:
                problem.scratch["converged"] = done
                return
            before = light.copy()
            count = self.shots or len(light)
            state = light.reshape(len(light), -1), unshot.reshape(len(light), -1)
            if columns is None:
                made = _shoot_rows(problem, *state, count)
            else:
                made = _shoot(columns.indptr, columns.indices, columns.data, T.reflectance, T.area, *state, count)
            problem.count("solver/shots", made)


@kernel
def _power(area, unshot, i):  # type: ignore[no-untyped-def]
    """Unshot power of a patch, all columns together."""
    total = 0.0
    for m in range(unshot.shape[1]):
        total += abs(unshot[i, m])
    return area[i] * total


@kernel
def _brightest(area, unshot):  # type: ignore[no-untyped-def]
    """Patch with the most unshot power, and that power."""
    best, most = 0, -1.0
    for i in range(len(area)):
        power = _power(area, unshot, i)
        if power > most:
            best, most = i, power
    return best, most


@kernel
def _shoot(indptr, indices, weights, rho, area, light, unshot, count):  # type: ignore[no-untyped-def]
    """Up to `count` shots in place, from columns stored as rows of the transpose; gives how many were made."""
    width = light.shape[1]
    emissions = width // rho.shape[1]
    power = np.empty(len(area))
    for i in range(len(area)):
        power[i] = _power(area, unshot, i)
    for shot in range(count):
        i = int(np.argmax(power))
        if power[i] <= 0.0:
            return shot
        sent = unshot[i].copy()
        unshot[i, :] = 0.0
        power[i] = 0.0
        for p in range(indptr[i], indptr[i + 1]):
            j = indices[p]
            w = np.float64(weights[p])
            for m in range(width):
                arrived = rho[j, m // emissions] * w * sent[m]
                light[j, m] += arrived
                unshot[j, m] += arrived
            power[j] = _power(area, unshot, j)
    return count


def _shoot_rows(problem: Problem, light: FloatArray, unshot: FloatArray, count: int) -> int:
    """As `_shoot`, with columns from rows on demand by reciprocity."""
    T = problem.T
    rho = np.repeat(T.reflectance, light.shape[1] // T.channels, axis=1)
    for shot in range(count):
        i, power = _brightest(T.area, unshot)
        if power <= 0.0:
            return shot
        problem.count("solver/rows")
        column = T.factors.row(i) * (T.area[i] / T.area)
        arrived = rho * column[:, None] * unshot[i]
        unshot[i] = 0.0
        light += arrived
        unshot += arrived
    return count
