"""Elimination: exact for small systems, however little is absorbed."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..errors import MemoryLimitError
from ..result import Step
from ..transport import TransportOperator
from .admission import row_excess
from .base import Problem, Solver
from .elimination import eliminate

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class Direct(Solver):
    """Solve (I - T) B = E by elimination without subtraction, once per channel of its own reflectance.

    Each B_i is right to rounding (about 1e-15 √N), at absorptances of 1e-12 too, where an ordinary LU of
    I - T is wrong in the sixth digit. Cost 2/3 N³; the matrix is dense.

    Parameters
    ----------
    rtol, atol, maxiter
        As `Solver`; there is only one step.
    max_bytes : int
        Largest dense matrix; beyond it the problem is refused before anything is allocated.

    Raises
    ------
    MemoryLimitError
        With the bytes it would take.

    References
    ----------
    See `radiosity.solvers.elimination`.
    """

    max_bytes: int = 1 << 30

    advice = "Its residual should be rounding only: look at the certificate"

    def steps(self, problem: Problem) -> Iterator[Step]:
        """Yield the one step."""
        T = problem.T
        needed = 8 * T.shape[0] ** 2
        if needed > self.max_bytes:
            raise MemoryLimitError(
                f"Direct would need {needed:.3g} bytes for {T.shape[0]} × {T.shape[0]} patches, more than max_bytes "
                f"{self.max_bytes:.3g}: use ConjugateGradient (on conserved factors) or Neumann, or fewer patches"
            )
        light = np.empty_like(problem.source)
        for channels in channels_alike(T):
            c = channels[0]
            bounce = T.matrix(c).toarray()
            system = eliminate(bounce, row_excess(T)[:, c])
            problem.count("solver/eliminations")
            light[:, channels] = system.solve(problem.source[:, channels])
        residual = problem.measure(problem.residual(light))
        rounding = 1e-15 * np.sqrt(T.shape[0]) * problem.measure(light)
        problem.scratch["converged"] = bool(np.all(residual <= np.maximum(problem.tolerance, rounding)))
        yield problem.step(1, light, light, residual)


def channels_alike(T: TransportOperator) -> list[list[int]]:
    """Channels grouped by equal reflectance and absorptance, each group in order."""
    groups: dict[bytes, list[int]] = {}
    for c in range(T.channels):
        key = T.reflectance[:, c].tobytes() + T.absorptance[:, c].tobytes()
        groups.setdefault(key, []).append(c)
    return list(groups.values())
