"""`solve`: the whole way from a scene to its light."""

from __future__ import annotations

import os
import time
import warnings
from concurrent.futures import Executor
from typing import Any

import numpy as np

from .errors import UnlitSceneWarning
from .form_factors.estimate import Estimator
from .parallel import thread_count
from .patches import Patches, subdivide
from .plan import make_plan
from .plan.work import PATCH_COUNT, Work, light
from .progress import Progress, quiet
from .scene import Scene
from .series import check_bounces
from .solution import Solution
from .solvers import Neumann, Solver


def solve(
    scene: Scene,
    *,
    patch_count: int | None = None,
    patch_size: float | None = None,
    estimator: Estimator | None = None,
    solver: Solver | None = None,
    bounces: int | None = None,
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
        knows the sampling error.
    solver : Solver, optional
        ``Neumann(rtol=1e-6)`` by default, or ``ConjugateGradient`` on conserved factors where so little is absorbed
        that the series would need more than a thousand bounces.
    bounces : int, optional
        Cut the series after this many bounces, whatever the tolerance. The status then says what is left out.
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
    GeometryWarning
        The scene has more faces than `patch_count`, or faces without area.

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
    tell = progress or quiet
    if solver is not None:
        check_bounces(solver, bounces)
    elif bounces is not None:
        check_bounces(Neumann(), bounces)
    _warn_if_unlit(scene)
    if patch_count is None and patch_size is None:
        patch_count = PATCH_COUNT

    tell("patches", 0, 1)
    began = time.perf_counter()
    patches = subdivide(scene, patch_count, patch_size)
    seconds = time.perf_counter() - began
    tell("patches", 1, 1)
    began = time.perf_counter()
    at_will = executor is None and checkpoint is None
    made = make_plan(
        patches, estimator, solver, bounces, dtype, thread_count(threads), leave_out=leave_out, rows_at_will=at_will
    )
    planned = time.perf_counter() - began
    work = Work(threads, executor, checkpoint, memory_limit, tell)
    solved = light(made, bounces, work)
    settings = {
        "patch_count": patch_count,
        "patch_size": patch_size,
        "estimator": repr(made.estimator),
        "solver": repr(solved.plan.solver),
        "bounces": bounces,
        "seed": getattr(made.estimator, "seed", None),
        "dtype": str(np.dtype(made.dtype)),
        "leave_out": leave_out,
    }
    statistics = {
        **_counters(patches),
        "seconds/patches": seconds,
        "seconds/plan": planned,
        **solved.factors.statistics,
        **solved.result.statistics,
    }
    return Solution(
        scene, patches, solved.factors, solved.result, solved.plan.solver, bounces, settings, statistics, solved.plan
    )


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
