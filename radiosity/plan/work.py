"""The work of a plan: foretold, and done."""

from __future__ import annotations

import os
from concurrent.futures import Executor
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from ..convex import ConvexTracer
from ..errors import FormFactorError
from ..form_factors import FormFactors, TwoLevel, form_factors
from ..form_factors.cost import predict
from ..form_factors.estimate import Estimator, completed
from ..parallel import thread_count
from ..patches import subdivide
from ..progress import Progress, quiet
from ..rays import Tracer
from ..result import Result
from ..scene import Scene
from ..series import check_bounces, run
from ..solvers import ConjugateGradient, Neumann, Solver
from ..solvers.admission import connected_components, row_excess
from ..solvers.ahead import BOUNCES
from ..transport import TransportOperator
from .plan import MANY_BOUNCES, PRODUCT_SECONDS, RTOL, Item, Plan, make_plan

PATCH_COUNT = 10_000


@dataclass(frozen=True, eq=False)
class Work:
    """How work is done: by whom, how much of it at once, and who is told.

    Attributes
    ----------
    threads, executor, checkpoint, memory_limit
        As of `radiosity.form_factors`.
    tell : callable
    """

    threads: int | None = None
    executor: Executor | None = None
    checkpoint: str | os.PathLike[str] | None = None
    memory_limit: float | None = None
    tell: Progress = quiet


class Light(NamedTuple):
    """What a plan gives: form factors, perhaps without rows that were not needed; the light; what was done."""

    factors: FormFactors
    result: Result
    plan: Plan


def light(
    plan: Plan, bounces: int | None = None, work: Work | None = None, factors: FormFactors | None = None
) -> Light:
    """Form factors and light of a plan's patches.

    Parameters
    ----------
    plan : Plan
    bounces : int, optional
        Where the series is cut.
    work : Work, optional
    factors : FormFactors, optional
        Of the plan's estimator, raw, if there are such already.

    Returns
    -------
    Light
        With the plan as it was carried out.
    """
    work = Work() if work is None else work
    if isinstance(plan.solver, Neumann):
        BOUNCES.begin()
    if factors is None:
        factors = form_factors(
            plan.patches,
            plan.estimator,
            dtype=plan.dtype,
            threads=work.threads,
            executor=work.executor,
            checkpoint=work.checkpoint,
            memory_limit=work.memory_limit,
            progress=work.tell,
            rows=plan.needed_rows,
            tracer=tracer_of(plan),
        )
    factors, plan = _accelerated(factors, plan, bounces, work)
    patches = plan.channels.of(plan.patches)
    result = run(plan.solver, TransportOperator(factors, patches, threads=work.threads), patches, bounces, work.tell)
    made = int(result.statistics["solver/steps"])
    if isinstance(plan.solver, Neumann):
        plan = plan.with_item(Item("tail", True, f"bounces after {made}; {result.status.partition('. ')[0]}"))
    return Light(factors, plan.channels.spread(result), plan)


def tracer_of(plan: Plan) -> Tracer:
    """What finds the first hits of rays."""
    return ConvexTracer(plan.patches.grid) if plan.convex else Tracer(plan.patches.grid)


def _accelerated(factors: FormFactors, plan: Plan, bounces: int | None, work: Work) -> tuple[FormFactors, Plan]:
    """Conserved factors for conjugate gradients, where the plan has them or the factors show that they are needed."""
    many = plan.free_solver and bounces is None and bounces_needed(factors, plan) > MANY_BOUNCES
    if not (plan.conserve or many):
        return factors, plan
    whole = completed(factors, plan.patches, ~plan.dark, threads=work.threads, tracer=tracer_of(plan))
    try:
        even = whole.conserved()
    except FormFactorError as error:
        story = f"many bounces are needed, as the factors cannot be conserved: {error}"
        plan = replace(plan, solver=Neumann(rtol=plan.solver.rtol), conserve=False)
        return whole, plan.with_item(Item("acceleration", True, story))
    count = bounces_needed(whole, plan)
    plan = replace(plan, solver=ConjugateGradient(rtol=plan.solver.rtol), conserve=True)
    plan = plan.with_item(Item("acceleration", False, f"conjugate gradients instead of some {count:,.0f} bounces"))
    return even, plan.with_item(Item("conserved factors", False, "conjugate gradients need them, and so little loss"))


def bounces_needed(factors: FormFactors, plan: Plan) -> float:
    """Bounces until light that is spread evenly over an enclosure has fallen to the tolerance, in the slowest lit one.

    The mean over an enclosure of what is lost at each bounce; more are needed where light is lost far from where it is.
    """
    T = TransportOperator(factors, plan.patches)
    label = connected_components(factors)
    source = T.source(plan.patches.emission, plan.patches.sky)
    lit = np.bincount(label, source.any(axis=1)) > 0
    area = np.bincount(label, T.area)
    least = 1.0
    for loss in row_excess(T).T:
        mean = np.bincount(label, T.area * loss) / area
        least = min(least, float(mean[lit].min(initial=1.0)))
    return float("inf") if least <= 0 else float(np.log(RTOL) / np.log1p(-least)) if least < 1 else 1.0


def _foretold(plan: Plan, threads: int | None) -> Plan:
    """The plan with seconds and bytes, from a sample of its rows."""
    if isinstance(plan.estimator, TwoLevel):  # how many groups it takes is found out on the way
        return plan
    cost = predict(plan.patches, plan.estimator, plan.dtype, threads, tracer_of(plan))
    share = float(plan.rows.made.mean())
    bounces = 20.0 if plan.conserve else min(_bounces(plan), MANY_BOUNCES)
    products = PRODUCT_SECONDS * cost.nonzeros * bounces * len(plan.channels.solved) / thread_count(threads)
    orders = 8 * len(plan.patches) * plan.patches.channels * bounces
    return replace(plan, seconds=share * (cost.seconds + products), bytes=share * cost.bytes + orders)


def _bounces(plan: Plan) -> float:
    """Bounces that the series needs, were light lost evenly: for a first idea."""
    area, patches = plan.patches.area, plan.patches
    mean = float((area @ patches.absorptance / area.sum()).min(initial=1.0))
    return 1.0 if mean >= 1 else float(MANY_BOUNCES) if mean <= 0 else float(np.log(RTOL) / np.log1p(-mean))


def plan(
    scene: Scene,
    *,
    patch_count: int | None = None,
    patch_size: float | None = None,
    estimator: Estimator | TwoLevel | None = None,
    solver: Solver | None = None,
    bounces: int | None = None,
    dtype: Any = None,
    threads: int | None = None,
) -> Plan:
    """What `solve` would do with a scene: what it needs, what is left out and what that saves, seconds and bytes.

    Parameters
    ----------
    scene, patch_count, patch_size, estimator, solver, bounces, dtype, threads
        As of `solve`.

    Returns
    -------
    Plan
        ``print`` it. Seconds and bytes are foretold from a small sample of the rows.

    Raises
    ------
    ParameterError
        Settings that do not fit.

    Examples
    --------
    >>> import radiosity as rad
    >>> print(rad.plan(rad.scenes.furnace(), patch_count=96)["sampling"].story)
    nothing hides anything among 96 patches: all pairs are exact
    """
    check_bounces(solver or Neumann(), bounces)
    if patch_count is None and patch_size is None:
        patch_count = PATCH_COUNT
    patches = subdivide(scene, patch_count, patch_size)
    made = make_plan(patches, estimator, solver, bounces, dtype, thread_count(threads))
    return _foretold(made, threads)
