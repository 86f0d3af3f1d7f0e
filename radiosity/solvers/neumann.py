"""The Neumann series, Eq. (9): light bounce by bounce."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..errors import SolverError
from ..result import Result, Step
from .admission import row_excess
from .base import Problem, Solver

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class Neumann(Solver):
    """B = E + T E + T² E + …: one product a bounce, each term the light that has bounced exactly k times.

    `step.term` is T^k E; the sky arrives with order 1. With a first guess x0 the terms are T^k r of its residual
    r, and add up to the same B. `step.residual` is the size of the next term, for which one product is made
    ahead. For a method with fewer products where little is absorbed, see `ConjugateGradient`.

    Parameters
    ----------
    rtol, atol, maxiter
        See `Solver`; `maxiter` is the most bounces.
    tail : bool
        Where `maxiter` ends the series: add the rest as a geometric series with the ratio of the last two
        powers, per channel. An estimate, and reported as one in `Result.status`.
    keep_bytes : int
        Most memory for `Result.orders`; later orders are summed but not kept, and the status says so.

    References
    ----------
    C. Neumann (1877); M. F. Cohen, J. R. Wallace, Radiosity and Realistic Image Synthesis (1993), section 5.3.

    Examples
    --------
    A furnace: each bounce keeps half of the light.

    >>> import numpy as np
    >>> from radiosity.form_factors.factors import FormFactors
    >>> from radiosity.transport import TransportOperator
    >>> F = FormFactors.from_matrix([[0.0, 1.0], [1.0, 0.0]], area=[1.0, 1.0])
    >>> T = TransportOperator(F, reflectance=0.5)
    >>> for step in Neumann(maxiter=3).iterate(T, np.ones((2, 1))):
    ...     print(step.order, step.term[0], step.power)
    0 [1.] [2.]
    1 [0.5] [1.]
    2 [0.25] [0.5]
    3 [0.125] [0.25]
    """

    tail: bool = False
    keep_bytes: int = 1 << 30

    advice = "Allow more bounces (maxiter), or use ConjugateGradient on conserved factors"

    def steps(self, problem: Problem) -> Iterator[Step]:
        """Yield one step a bounce."""
        first = problem.source - problem.emission  # of the sky, which arrives with order 1
        if problem.start is None:
            term, light = problem.emission, problem.emission.copy()
        else:
            term, first = problem.residual(problem.start), np.zeros_like(first)
            light = problem.start + term
        before = None
        for order in range(self.maxiter + 1):
            following = problem.product(term)
            if order == 0:
                following = following + first
            residual = problem.measure(following)
            done = problem.reached(residual, light)
            yield problem.step(order, term, light, residual)
            if done:
                problem.scratch["converged"] = True
                return
            if before is not None and not _falls(problem, before, following):
                raise SolverError(
                    f"the series does not fall: order {order + 1} is nowhere less than order {order - 1} (spectral "
                    "radius 1 or more). Use conserved factors, or give the surfaces some absorptance"
                )
            before, term = term, following
            light = light + term

    def keep(self, problem: Problem, step: Step) -> None:
        """Keep the terms while they fit; from a first guess they are not the orders of light."""
        if problem.start is not None:
            return
        orders = problem.scratch.setdefault("orders", [])
        if len(orders) == step.order and (step.order + 1) * step.term.nbytes <= self.keep_bytes:
            orders.append(step.term)

    def conclude(self, problem: Problem, step: Step, history: FloatArray) -> Result:
        """Add the orders, and the tail if asked."""
        orders = problem.scratch.get("orders", [])
        result = super().conclude(problem, step, history)
        kept = np.array(orders) if orders else None
        status = result.status.replace("steps", "bounces")
        if problem.start is None and len(orders) <= step.order:
            which = f"Of {step.order} orders 0 … {len(orders) - 1}" if orders else f"None of {step.order} orders"
            status += f". {which} are kept (keep_bytes is {self.keep_bytes})"
        result = replace(result, orders=kept, status=status)
        if not self.tail or result.converged:
            return result
        return self._with_tail(problem, step, result)

    def _with_tail(self, problem: Problem, step: Step, result: Result) -> Result:
        """Add term × q / (1 - q), q the ratio of the last two powers (per channel), Eq. (10)."""
        term = step.term if step.term.ndim > 1 else step.term[:, None]
        following = problem.product(term)
        power, after = problem.T.power(term), problem.T.power(following)
        ratio = np.divide(after, power, out=np.zeros_like(power), where=power > 0)
        if not np.all(ratio < 1):
            return replace(result, status=result.status + f". No tail: the last ratio of powers is {ratio.max():.6g}")
        tail = (following / (1.0 - ratio)).reshape(step.term.shape)
        radiosity = result.radiosity + tail
        residual = problem.T.norm(problem.residual(radiosity.reshape(term.shape)))
        problem.statistics["solver/tail_power"] = problem.T.power(tail.reshape(term.shape)).tolist()
        status = (
            f"{result.status}. A geometric tail of ratio {np.max(ratio):.4g} was added: an estimate, with residual "
            f"{np.max(residual):.3g} W/m²"
        )
        return replace(
            result, radiosity=radiosity, status=status, history=np.concatenate([result.history, residual[None]])
        )


def _falls(problem: Problem, before: FloatArray, after: FloatArray) -> bool:
    """Whether some patch of each lit enclosure has less light after two bounces than before them.

    T² t ≥ t with t ≥ 0, t ≠ 0 shows a spectral radius of one or more (Collatz, Wielandt). Two bounces, because
    light between two facing plates alternates. Only needed where rows of T reach one.
    """
    if "contracts" not in problem.scratch:
        problem.scratch["contracts"] = bool(row_excess(problem.T).min(initial=1.0) > 0)
    if problem.scratch["contracts"] or np.any(before < 0):
        return True
    below = np.zeros((int(problem.label.max(initial=0)) + 1, *before.shape[1:]), dtype=bool)
    lit = np.zeros_like(below)
    np.logical_or.at(below, problem.label, after < before)
    np.logical_or.at(lit, problem.label, before > 0)
    return bool(np.all(below | ~lit))
