"""What all solvers share: the problem they are given, when they stop, and how a solve drains an iteration."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import SolverError
from ..result import Result, Step
from ..transport import TransportOperator, norm_by_group
from .admission import check_overflow, check_steady, connected_components

FloatArray = NDArray[np.float64]

COARSE = 1e-3  # of the source: no solution here is so bright that its rounding leaves a larger residual


@dataclass(frozen=True, eq=False)
class Problem:
    """B = E + T B for one or many emissions, checked, and the tolerance a solution has to meet.

    Attributes
    ----------
    T : TransportOperator
    emission, source : ndarray (N, C) or (N, C, S)
        E, and E + ρ π to_sky L_sky, W/m².
    start : ndarray or None
        First guess x0.
    label : ndarray (N,)
        Enclosure of each patch. The stopping rule holds in each of them, so that a lamp of 1e30 W does not
        hide one of 1e-30 W next door.
    size, tolerance : ndarray (enclosures, C) or (enclosures, C, S)
        ‖source‖ and max(rtol ‖source‖, atol) in each enclosure.
    statistics : dict
        Counters that the solver fills.
    scratch : dict
        What a method wants to remember between its steps and its conclusion.
    """

    T: TransportOperator
    emission: FloatArray
    source: FloatArray
    start: FloatArray | None
    label: NDArray[np.int64]
    size: FloatArray
    tolerance: FloatArray
    statistics: dict[str, Any] = field(default_factory=dict)
    scratch: dict[str, Any] = field(default_factory=dict)

    def product(self, light: FloatArray) -> FloatArray:
        """T @ light, counted."""
        self.count("solver/products")
        return self.T @ light

    def residual(self, light: FloatArray) -> FloatArray:
        """Source - (I - T) B, counted."""
        self.count("solver/products")
        return self.T.residual(light, self.source)

    def count(self, what: str, more: int = 1) -> None:
        """Add to a counter."""
        self.statistics[what] = self.statistics.get(what, 0) + more

    def measure(self, field: FloatArray) -> FloatArray:
        """Area-weighted root mean square in each enclosure, (enclosures, …)."""
        return norm_by_group(field, self.T.area, self.label, len(self.tolerance))

    def reached(self, residual: FloatArray, light: FloatArray | None = None) -> bool:
        """Whether a residual, measured, meets the tolerance in each enclosure.

        With `light` (the solution so far), a residual within the rounding of that light counts as reached too:
        no float64 radiosity has a smaller one.
        """
        if np.all(residual <= self.tolerance):
            return True
        if light is None or np.any(residual > COARSE * self.size):
            return False
        rounding = np.finfo(np.float64).eps * self.measure(light)
        return bool(np.all(residual <= np.maximum(self.tolerance, rounding)))

    def step(
        self, order: int, term: FloatArray, light: FloatArray, residual: FloatArray, unshot: FloatArray | None = None
    ) -> Step:
        """A `Step`, with its residual as measured in each enclosure."""
        if len(residual) == 1:
            whole = residual[0]
        else:
            share = np.bincount(self.label, self.T.area) / np.sum(self.T.area)
            largest = np.maximum(residual.max(axis=0), np.finfo(np.float64).tiny)
            whole = largest * np.sqrt(np.tensordot(share, (residual / largest) ** 2, axes=1))
        return Step(order, term, light, whole, self.T.power(term), unshot)


@dataclass(frozen=True)
class Solver:
    """A method that solves B = E + T B: a small frozen object that holds its tolerances.

    Parameters
    ----------
    rtol, atol : float
        A channel has converged when its residual ≤ max(rtol ‖E + T_sky‖, atol) (scipy's rule), in the
        area-weighted root mean square. In a scene of separate enclosures the rule holds in each.
    maxiter : int
        Most steps.
    """

    rtol: float = 1e-6
    atol: float = 0.0
    maxiter: int = 1000

    advice = "raise maxiter"  # for a status: what to try where the method was too slow

    def __post_init__(self) -> None:
        if not (self.rtol >= 0 and self.atol >= 0):
            raise SolverError(f"rtol {self.rtol} and atol {self.atol} must not be negative")
        if self.maxiter < 0:
            raise SolverError(f"maxiter is {self.maxiter}; give 0 or more")

    def iterate(
        self, T: TransportOperator, emission: ArrayLike, sky: ArrayLike | None = None, x0: ArrayLike | None = None
    ) -> Iterator[Step]:
        """Yield a `Step` after each step of the method, until it has converged or `maxiter` is reached.

        Parameters
        ----------
        T : TransportOperator
        emission : array_like (N, C), (N, C, S), or (N,) where there is one channel
            W/m². S emissions are solved together.
        sky : array_like (C,) or (C, S), optional
            Radiance of the surroundings, W/(m² sr).
        x0 : array_like, optional
            A first guess of the radiosity, in the shape of the emission.

        Yields
        ------
        Step

        Raises
        ------
        NoSteadyState
            Light is put into an enclosure that loses none.
        SolverError
            Light grows without bound, values that are not finite, shapes that do not fit.
        """
        problem = self.pose(T, emission, sky, x0)
        vector = np.ndim(emission) == 1
        for step in self.steps(problem):
            yield _as_vector(step) if vector else step

    def solve(
        self,
        T: TransportOperator,
        emission: ArrayLike,
        sky: ArrayLike | None = None,
        x0: ArrayLike | None = None,
        callback: Callable[[Step], Any] | None = None,
    ) -> Result:
        """Run the method to its end; `callback` is called with each `Step`. See `iterate` for the rest.

        Returns
        -------
        Result
        """
        began = time.perf_counter()
        problem = self.pose(T, emission, sky, x0)
        vector = np.ndim(emission) == 1
        history = []
        step = None
        for step in self.steps(problem):
            step = _as_vector(step) if vector else step
            history.append(step.residual)
            self.keep(problem, step)
            if callback is not None:
                callback(step)
        assert step is not None  # every method yields its start
        result = self.conclude(problem, step, np.array(history))
        problem.statistics["solver/steps"] = step.order
        problem.statistics["seconds/solve"] = time.perf_counter() - began
        return result

    def pose(self, T: TransportOperator, emission: ArrayLike, sky: ArrayLike | None, x0: ArrayLike | None) -> Problem:
        """Check a problem and set its tolerance."""
        given = T.check_light(emission)
        given = given[:, None] if given.ndim == 1 else given
        source = T.source(given, sky)
        if not np.all(np.isfinite(source)):
            patch, channel = np.argwhere(~np.isfinite(source))[0][:2]
            raise SolverError(f"emission or sky of patch {patch}, channel {channel}, is not finite")
        notes = check_steady(T, source)
        check_overflow(T, source)
        label = connected_components(T.factors)
        size = norm_by_group(source, T.area, label, int(label.max(initial=0)) + 1)
        tolerance = np.maximum(self.rtol * size, self.atol)
        start = None if x0 is None else T.check_light(x0).reshape(given.shape)
        return Problem(T, given, source, start, label, size, tolerance, {"solver/notes": notes} if notes else {})

    def steps(self, problem: Problem) -> Iterator[Step]:
        """The method itself."""
        raise NotImplementedError

    def keep(self, problem: Problem, step: Step) -> None:
        """Look at a step while a solve drains the iteration."""

    def conclude(self, problem: Problem, step: Step, history: FloatArray) -> Result:
        """Make the result of the last step."""
        converged = bool(problem.scratch.get("converged", False))
        worst = float(np.max(step.residual, initial=0.0))
        name = type(self).__name__
        if converged:
            status = f"converged: {name}, {step.order} steps, residual {worst:.3g} W/m²"
        else:
            status = f"not converged after {step.order} steps of {name}: residual {worst:.3g} W/m². {self.advice}"
        status = ". ".join([status, *problem.statistics.get("solver/notes", [])])
        return Result(step.radiosity, None, status, converged, history, problem.statistics)


def _as_vector(step: Step) -> Step:
    """A step whose light is (N,) as its emission was."""
    unshot = None if step.unshot is None else step.unshot[:, 0]
    return replace(step, term=step.term[:, 0], radiosity=step.radiosity[:, 0], unshot=unshot)
