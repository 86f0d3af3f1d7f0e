"""`solve`: the whole way from a scene to its light."""

from __future__ import annotations

import os
import time
import warnings
from concurrent.futures import Executor
from typing import Any

import numpy as np

from .accuracy import Found, light_to
from .backs import light_on_backs
from .errors import GeometryWarning, ParameterError, UnlitSceneWarning
from .form_factors import MonteCarlo, TwoLevel
from .form_factors.estimate import Estimator
from .parallel import thread_count
from .patches import Patches, subdivide
from .plan import Plan, make_plan
from .plan.work import PATCH_COUNT, Light, Work, light
from .progress import Progress, quiet
from .scene import Scene
from .series import check_bounces
from .solution import Solution, seconds
from .solvers import Neumann, Solver


def solve(
    scene: Scene,
    *,
    patch_count: int | None = None,
    patch_size: float | None = None,
    estimator: Estimator | TwoLevel | None = None,
    solver: Solver | None = None,
    bounces: int | None = None,
    accuracy: float | None = None,
    dtype: Any = None,
    leave_out: bool = True,
    threads: int | None = None,
    executor: Executor | None = None,
    checkpoint: str | os.PathLike[str] | None = None,
    memory_limit: float | None = None,
    progress: Progress | None = None,
) -> Solution:
    """Light of a scene: patches, form factors, the series, one after the other.

    Parameters
    ----------
    scene : Scene
    patch_count : int, optional
        About how many patches; 10 000 if neither count nor size is given.
    patch_size : float, optional
        Longest edge that a patch may have, m.
    estimator : MonteCarlo or Hemicube, optional
        How form factors are computed; ``MonteCarlo(rays=256, replicates=2)`` by default, so that the certificate
        knows the sampling error; ``Analytic()`` for up to 1000 patches among which nothing is hidden, and
        ``TwoLevel()`` from 50 000 patches on where that is as good, see `plan`.
    solver : Solver, optional
        ``Neumann(rtol=1e-6)`` by default, or ``ConjugateGradient`` on conserved factors where so little is absorbed
        that the series would need more than a thousand bounces.
    bounces : int, optional
        Cut the series after this many bounces, whatever the tolerance. The status then says what is left out.
    accuracy : float, optional
        Largest error, relative to B - E: 0.01 is 1 %. Patches (unless given), rays, bounces and tolerance are then
        chosen to reach it with little work, and `Solution.accuracy` says what is known of the error. Of an estimator
        that is given, the seed is taken.
    dtype : float32 or float64, optional
        Of the form factors; float32 by default where its last digits do not matter.
    leave_out : bool, optional
        Whether what the scene does not need is left out, see `plan`; the light is the same.
    threads : int, optional
        As many as there are processors by default. The result has the same bits for any number.
    executor : concurrent.futures.Executor, optional
        Whose workers compute the form factors, instead of threads. See `form_factors`.
    checkpoint : path, optional
        A folder that keeps finished rows of form factors, from which an interrupted solve goes on.
    memory_limit : float, optional
        Bytes that the form factors may take; by default four fifths of what is free.
    progress : callable, optional
        Called as ``progress(stage, done, total)``; stages are "patches", "form factors" and "bounces".

    Returns
    -------
    Solution

    Raises
    ------
    ParameterError
        Settings that do not fit; the message says which.
    MemoryLimitError
        Form factors larger than the memory limit, with the figures and the ways out.
    SolverError
        Light that grows for ever, or that a float64 does not hold.

    Warns
    -----
    UnlitSceneWarning
        The scene has no light: everything is black.
    AccuracyWarning
        The accuracy is not reached within the memory, or with these patches.
    GeometryWarning
        The scene has more faces than `patch_count`, or faces without area; much of the light falls on black backs.

    Examples
    --------
    A furnace with walls of ρ = 0.5 and E = 1 W/m²: every bounce keeps half of the light.

    >>> import radiosity as rad
    >>> solution = rad.solve(rad.scenes.furnace(), patch_count=96, bounces=3)
    >>> solution.orders[:, 0, 0]
    array([1.   , 0.5  , 0.25 , 0.125])
    >>> solution.status
    'cut at 3 bounces, as asked: later bounces are left out; residual 0.062 of the source (rtol is 1e-06)'
    """
    if solver is not None:
        check_bounces(solver, bounces)
    elif bounces is not None:
        check_bounces(Neumann(), bounces)
    _warn_if_unlit(scene)
    work = Work(threads, executor, checkpoint, memory_limit, progress or quiet)
    if accuracy is not None:
        _check_accuracy(solver=solver, bounces=bounces, dtype=dtype, executor=executor, checkpoint=checkpoint)
        found = _to_accuracy(scene, accuracy, patch_count, patch_size, estimator, work)
        patches, solved, reached = found
        last = sum(seconds({**solved.factors.statistics, **solved.result.statistics}).values())
        before = {"seconds/trials": max(0.0, reached.trials[-1].seconds - last)}
    else:
        patches, solved, before = _as_told(
            scene, patch_count, patch_size, estimator, solver, bounces, dtype, leave_out, work
        )
        reached = None
    if lost := light_on_backs(patches, solved.factors):
        warnings.warn(f"{scene.name}: {lost}", GeometryWarning, stacklevel=2)
    made = solved.plan
    if patch_count is patch_size is accuracy is None:
        patch_count = PATCH_COUNT
    told = {"patch_count": patch_count, "patch_size": patch_size, "bounces": bounces}
    settings = {**told, **_chosen(made), "accuracy": accuracy, "leave_out": leave_out}
    statistics = {**_counters(patches), **before, **solved.factors.statistics, **solved.result.statistics}
    if made.story():
        statistics["plan/left out"] = made.story()
    if reached is not None:
        statistics["accuracy/story"] = str(reached)
    return Solution(
        scene, patches, solved.factors, solved.result, made.solver, bounces, settings, statistics, made, reached
    )


def _chosen(plan: Plan) -> dict[str, Any]:
    """Estimator, solver and precision, as plain values."""
    return {
        "estimator": repr(plan.estimator),
        "solver": repr(plan.solver),
        "seed": getattr(plan.estimator, "seed", None),
        "dtype": str(np.dtype(plan.dtype)),
    }


def _as_told(
    scene: Scene,
    patch_count: int | None,
    patch_size: float | None,
    estimator: Estimator | TwoLevel | None,
    solver: Solver | None,
    bounces: int | None,
    dtype: Any,
    leave_out: bool,
    work: Work,
) -> tuple[Patches, Light, dict[str, Any]]:
    """Patches, plan, light; and the seconds of the first two."""
    if patch_count is None and patch_size is None:
        patch_count = PATCH_COUNT
    work.tell("patches", 0, 1)
    began = time.perf_counter()
    patches = subdivide(scene, patch_count, patch_size)
    cut = time.perf_counter()
    work.tell("patches", 1, 1)
    at_will = work.executor is None and work.checkpoint is None
    threads = thread_count(work.threads)
    made = make_plan(patches, estimator, solver, bounces, dtype, threads, leave_out=leave_out, rows_at_will=at_will)
    planned = time.perf_counter()
    spent = {"seconds/patches": cut - began, "seconds/plan": planned - cut}
    return patches, light(made, bounces, work), spent


def _to_accuracy(
    scene: Scene,
    accuracy: float,
    patch_count: int | None,
    patch_size: float | None,
    estimator: Estimator | TwoLevel | None,
    work: Work,
) -> Found:
    if estimator is not None and not isinstance(estimator, MonteCarlo):
        raise ParameterError(f"accuracy is for MonteCarlo, not for {type(estimator).__name__}; leave the estimator out")
    given = patch_count is not None or patch_size is not None
    patches = subdivide(scene, patch_count, patch_size) if given else None
    return light_to(scene, accuracy, patches, 0 if estimator is None else estimator.seed, work)


def _check_accuracy(**chosen: Any) -> None:
    """Refuse settings that an accuracy chooses by itself.

    Raises
    ------
    ParameterError
    """
    for name, value in chosen.items():
        if value is not None:
            raise ParameterError(f"{name} would not be used: accuracy chooses it, or works without; leave one out")


def _counters(patches: Patches) -> dict[str, int]:
    return {
        "patches/count": len(patches),
        "patches/faces": len(patches.grid.faces),
        "patches/surfaces": len(patches.surface_names),
    }


def _warn_if_unlit(scene: Scene) -> None:
    """A black picture is a fair answer, but seldom what was wanted."""
    if scene.sky.any() or any(surface.material.emission.any() for surface in scene.surfaces):
        return
    warnings.warn(
        f"scene {scene.name!r} has no light: no surface emits and the sky is black, so that everything is black. "
        "Give it a sky (rad.read_scene(…, sky=…), --sky) or make a surface shine "
        "(Material(emission=…), rad.read_scene(…, lamps={surface: …}), --lamp SURFACE=…)",
        UnlitSceneWarning,
        stacklevel=3,
    )
