"""A solver run on patches: to its tolerance, or bounce by bounce up to where the user cuts the series."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from .errors import ParameterError
from .patches import Patches
from .progress import Progress, quiet
from .result import Result, Step
from .solvers import Neumann, Solver
from .transport import TransportOperator

FloatArray = NDArray[np.float64]


def run(
    solver: Solver,
    T: TransportOperator,
    patches: Patches,
    bounces: int | None = None,
    progress: Progress | None = None,
) -> Result:
    """Solve for the light of patches.

    Parameters
    ----------
    solver : Solver
    T : TransportOperator
    patches : Patches
        For their emission and sky.
    bounces : int, optional
        Cut the series after this many bounces, whatever the tolerance; fewer are made only where no light is
        left. The status says how large the rest is, against the solver's tolerance.
    progress : callable, optional
        Called as ``progress("bounces", bounce, bounces expected)``.

    Raises
    ------
    ParameterError
        A negative number of bounces, or bounces of a solver that does not sum the series.
    """
    watch = _Watch(solver.rtol, progress or quiet, bounces)
    check_bounces(solver, bounces)
    method = solver if bounces is None else replace(solver, rtol=0.0, atol=0.0, maxiter=bounces)
    result = method.solve(T, patches.emission, patches.sky, callback=watch)
    watch.end()
    return result if bounces is None else _cut_short(result, solver, T, patches)


def check_bounces(solver: Solver, bounces: int | None) -> None:
    """Refuse a number of bounces that there cannot be, before any work is done.

    Raises
    ------
    ParameterError
    """
    if bounces is None:
        return
    if not isinstance(solver, Neumann):
        raise ParameterError(f"bounces is {bounces}, but {type(solver).__name__} does not go by bounces; use Neumann")
    if bounces < 0:
        raise ParameterError(f"bounces is {bounces}; give 0 or more")


def _cut_short(result: Result, solver: Solver, T: TransportOperator, patches: Patches) -> Result:
    """Say of a series cut on request how much is left out."""
    source = T.norm(T.source(patches.emission, patches.sky))
    residual = result.history[-1]
    made = result.statistics["solver/steps"]
    share = float(np.max(np.divide(residual, source, out=np.zeros_like(source), where=source > 0)))
    converged = bool(np.all(residual <= np.maximum(solver.rtol * source, solver.atol)))
    if converged:
        status = f"converged: {made} bounces were asked for, residual {share:.2g} of the source"
    else:
        status = (
            f"cut at {made} bounces, as asked: later bounces are left out; residual {share:.2g} of the source "
            f"(rtol is {solver.rtol:g})"
        )
    notes = result.statistics.get("solver/notes", [])
    kept = "" if result.orders is None else result.status.partition(". Orders ")[1:]
    return replace(result, status=". ".join([status + "".join(kept), *notes]), converged=converged)


class _Watch:
    """Tells progress how many bounces there will be, from how fast the residual falls."""

    def __init__(self, rtol: float, progress: Progress, bounces: int | None) -> None:
        self.rtol, self.progress, self.bounces = rtol, progress, bounces
        self.first = 0.0
        self.made = 0

    def __call__(self, step: Step) -> None:
        """Take note of a step."""
        self.made = step.order
        residual = float(np.max(step.residual, initial=0.0))
        self.first = max(self.first, residual)
        total = self.bounces
        if total is None:
            fallen = math.log(residual / self.first) if 0.0 < residual < self.first else 0.0
            goal = math.log(self.rtol) if 0.0 < self.rtol < 1.0 else fallen
            total = max(step.order, round(step.order * goal / fallen)) if fallen < 0.0 else step.order
        self.progress("bounces", step.order, max(total, step.order))

    def end(self) -> None:
        """There were as many as there were."""
        self.progress("bounces", self.made, self.made)
