"""`solve`: the whole way from a scene to its light."""

from __future__ import annotations

import os
import time
import warnings
from concurrent.futures import Executor
from typing import Any

import numpy as np

from .errors import UnlitSceneWarning
from .form_factors import MonteCarlo, form_factors
from .form_factors.estimate import Estimator
from .patches import Patches, subdivide
from .progress import Progress, quiet
from .scene import Scene
from .series import check_bounces, run
from .solution import Solution
from .solvers import Neumann, Solver
from .transport import TransportOperator

PATCH_COUNT = 10_000
RAYS = 256
REPLICATES = 2  # the fewest that tell how wrong they are
RTOL = 1e-6


def solve(
    scene: Scene,
    *,
    patch_count: int | None = None,
    patch_size: float | None = None,
    estimator: Estimator | None = None,
    solver: Solver | None = None,
    bounces: int | None = None,
    dtype: Any = np.float32,
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
        ``Neumann(rtol=1e-6)`` by default.
    bounces : int, optional
        Cut the series after this many bounces, whatever the tolerance. The status then says what is left out.
    dtype : float32 or float64, optional
        Of the form factors.
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
    estimator = MonteCarlo(rays=RAYS, replicates=REPLICATES) if estimator is None else estimator
    solver = Neumann(rtol=RTOL) if solver is None else solver
    check_bounces(solver, bounces)
    _warn_if_unlit(scene)
    if patch_count is None and patch_size is None:
        patch_count = PATCH_COUNT

    tell("patches", 0, 1)
    began = time.perf_counter()
    patches = subdivide(scene, patch_count, patch_size)
    seconds = time.perf_counter() - began
    tell("patches", 1, 1)
    factors = form_factors(
        patches,
        estimator,
        dtype=dtype,
        threads=threads,
        executor=executor,
        checkpoint=checkpoint,
        memory_limit=memory_limit,
        progress=tell,
    )
    result = run(solver, TransportOperator(factors, patches, threads=threads), patches, bounces, tell)

    settings = {
        "patch_count": patch_count,
        "patch_size": patch_size,
        "estimator": repr(estimator),
        "solver": repr(solver),
        "bounces": bounces,
        "seed": getattr(estimator, "seed", None),
        "dtype": str(np.dtype(dtype)),
    }
    statistics = {**_counters(patches), "seconds/patches": seconds, **factors.statistics, **result.statistics}
    return Solution(scene, patches, factors, result, solver, bounces, settings, statistics)


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
