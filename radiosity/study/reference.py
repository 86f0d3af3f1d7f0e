"""What methods are compared with: a closed form, exact factors, or a converged run whose own error is stated."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

import radiosity as rad

from ..files.atomic import replacing
from ..nested import means, refined
from ..patches import Patches
from ..progress import Progress, quiet
from ..scene import Scene
from .closed_forms import closed_form
from .measures import FloatArray, Light, norm, relative_l2
from .methods import MOST_ANALYTIC, is_convex
from .solving import light_of, series

SEED = 1_000_001  # of the first replicate, far from the seeds of the runs
RTOL = 1e-9


@dataclass(frozen=True)
class Effort:
    """How hard references are worked out.

    Attributes
    ----------
    rays : int
        A patch, in each replicate.
    replicates : int
        Independent runs whose mean is taken; at least 2, so that their spread gives its error.
    factor : int
        Finer patches are cut factor² times as small; with as many rays to each coarse patch.
    paths : int
        Walks a patch of the path tracer, the yardstick.
    """

    rays: int = 16_384
    replicates: int = 4
    factor: int = 3
    paths: int = 1024


@dataclass(frozen=True, eq=False)
class Reference:
    """True light on some patches, as well as it is known.

    Attributes
    ----------
    discrete : Light
        Of exact form factors on these patches: what methods converge to with more rays.
    continuous : Light
        Means over these patches of the light on patches factor² times finer: what methods converge to with more
        patches as well. The same as `discrete` where a closed form holds on any patches.
    discrete_error, continuous_error : float
        Their own relative errors, from the spread of replicates; 0 for what was not sampled.
    by_order : tuple of float
        Own relative error of each order of `discrete`, from 1 on.
    discretisation : float
        Relative error of means over patches that the patches' size causes, as far as the finer ones show it.
    fine_patches : int
    how : str
        Where it comes from, in words.
    """

    discrete: Light
    continuous: Light
    discrete_error: float
    continuous_error: float
    by_order: tuple[float, ...]
    discretisation: float
    fine_patches: int
    how: str


def reference(
    scene: Scene, patches: Patches, effort: Effort, threads: int | None = None, progress: Progress = quiet
) -> Reference:
    """Work out the true light on patches, and on finer ones inside them."""
    known = closed_form(patches)
    if known is not None:
        light, how = known
        return Reference(light, light, 0.0, 0.0, (0.0,) * (len(light.orders) - 1), 0.0, len(patches), how)
    discrete = _converged(patches, effort.rays, effort.replicates, threads, progress)
    fine = refined(scene, patches, effort.factor)
    runs = _converged(fine, max(256, effort.rays // effort.factor**2), effort.replicates, threads, progress)
    back = [Light(means(run.radiosity, fine, patches), _means_by_order(run, fine, patches)) for run in runs.runs]
    continuous = _Converged(back, runs.how)
    return Reference(
        discrete.mean,
        continuous.mean,
        discrete.own(patches.area),
        continuous.own(patches.area),
        discrete.own_by_order(patches.area),
        _gap(discrete.mean, continuous.mean, patches.area),
        len(fine),
        f"{discrete.how}; finer patches: {runs.how}",
    )


@dataclass(frozen=True, eq=False)
class _Converged:
    """Independent runs of one quantity; one run alone is exact."""

    runs: list[Light]
    how: str

    @property
    def mean(self) -> Light:
        return Light(*(np.mean(parts, axis=0) for parts in zip(*self.runs, strict=True)))

    def own(self, area: FloatArray) -> float:
        return self._error([run.radiosity for run in self.runs], area, self.runs[0].orders[0])

    def own_by_order(self, area: FloatArray) -> tuple[float, ...]:
        count = len(self.runs[0].orders)
        return tuple(self._error([run.orders[k] for run in self.runs], area, 0.0) for k in range(1, count))

    def _error(self, parts: list[FloatArray], area: FloatArray, without: FloatArray | float) -> float:
        """Standard error of the mean, relative."""
        if len(parts) < 2:
            return 0.0
        size = norm(np.mean(parts, axis=0) - without, area)
        return norm(np.std(parts, axis=0, ddof=1), area) / np.sqrt(len(parts)) / size if size > 0 else 0.0


def _converged(patches: Patches, rays: int, replicates: int, threads: int | None, progress: Progress) -> _Converged:
    """Light of exact factors where there are any, else of replicates of many rays."""
    if is_convex(patches) and len(patches) <= MOST_ANALYTIC:
        runs = [_solved(patches, rad.Analytic(), threads, progress)]
        return _Converged(runs, f"exact form factors of {len(patches):,} patches")
    runs = [
        _solved(patches, rad.MonteCarlo(rays, SEED + k, light_rays=max(256, rays // 4)), threads, progress)
        for k in range(replicates)
    ]
    return _Converged(runs, f"{replicates} runs of {rays:,} rays on {len(patches):,} patches")


def _solved(patches: Patches, estimator: Any, threads: int | None, progress: Progress) -> Light:
    factors = rad.form_factors(patches, estimator, threads=threads, progress=progress)
    return light_of(series(factors, patches, RTOL, threads))


def _means_by_order(light: Light, fine: Patches, coarse: Patches) -> FloatArray:
    return np.stack([means(order, fine, coarse) for order in light.orders])


def _gap(discrete: Light, continuous: Light, area: FloatArray) -> float:
    return relative_l2(discrete.radiosity, continuous.radiosity, area, continuous.orders[0])


def keep(found: Reference, path: Path) -> None:
    """Write a reference down, so that a study that goes on need not work it out again."""
    arrays = {
        "discrete": found.discrete.radiosity,
        "discrete_orders": found.discrete.orders,
        "continuous": found.continuous.radiosity,
        "continuous_orders": found.continuous.orders,
        "by_order": np.array(found.by_order),
        "numbers": np.array([found.discrete_error, found.continuous_error, found.discretisation, found.fine_patches]),
        "how": np.array(found.how),
    }
    with replacing(path) as temporary:
        np.savez(temporary, allow_pickle=False, **arrays)


def kept(path: Path) -> Reference:
    """Read a reference that `keep` wrote."""
    with np.load(path, allow_pickle=False) as arrays:
        own, fine_own, gap, fine = arrays["numbers"].tolist()
        return Reference(
            Light(arrays["discrete"], arrays["discrete_orders"]),
            Light(arrays["continuous"], arrays["continuous_orders"]),
            own,
            fine_own,
            tuple(arrays["by_order"].tolist()),
            gap,
            int(fine),
            str(arrays["how"]),
        )
