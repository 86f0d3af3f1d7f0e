"""The methods that are compared, each with a row of budgets."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from typing import Any, Literal

import radiosity as rad

from ..errors import OccludedSceneError, ParameterError
from ..form_factors.analytic import check_unoccluded
from ..form_factors.two_level import lamps
from ..patches import Patches

BOUNCES = 8  # orders that are compared one by one
LEAST_TWO_LEVEL = 900  # patches; made for far more
MOST_ANALYTIC = 4500  # patches, whose exact factors take 0.3 GB


@dataclass(frozen=True)
class Family:
    """Methods that differ only in how much work they do; how they look in a plot.

    Colours are of M. Okabe and K. Ito, "Color Universal Design" (2008), told apart with any kind of colour vision;
    markers tell the same without colour.
    """

    title: str
    short: str
    colour: str
    marker: str


FAMILIES = {
    "apart": Family("Monte Carlo, direct light apart", "direct light apart", "#0072B2", "o"),
    "sobol": Family("Monte Carlo, Sobol rays alone", "Sobol rays", "#56B4E9", "s"),
    "random": Family("Monte Carlo, random rays", "random rays", "#E69F00", "^"),
    "hemicube": Family("hemicube, one point, by resolution", "hemicube", "#D55E00", "D"),
    "hemicube points": Family("hemicube of 32², by points", "hemicube of 32²", "#CC79A7", "v"),
    "analytic": Family("exact factors", "exact factors", "#000000", "*"),
    "two levels": Family("two levels", "two levels", "#7D5A00", "h"),
    "walks": Family("path tracer, patches", "path tracer", "#009E73", "P"),
    "continuous walks": Family("path tracer, undivided surfaces", "path tracer, undivided", "#6E6E6E", "X"),
}


@dataclass(frozen=True)
class Method:
    """One method with one budget.

    Attributes
    ----------
    family : str
        Key of `FAMILIES`.
    budget : str
        In words: "1024 rays".
    work : int
        Rays a patch.
    make : callable
        Seed → estimator, or `PathTracer`.
    seeded : bool
        Whether the seed changes anything.
    """

    family: str
    budget: str
    work: int
    make: Callable[[int], Any]
    seeded: bool = True


def methods(patches: Patches, *, few: bool = False) -> list[Method]:
    """All methods and budgets that fit some patches; `few` leaves out the larger budgets."""
    found = [*_monte_carlo(few), *_hemicubes(few), *_walks(few)]
    if is_convex(patches) and len(patches) <= MOST_ANALYTIC:
        found.append(Method("analytic", "exact", len(patches), partial(_whatever_seed, rad.Analytic()), seeded=False))
    return [*found, *_two_levels(patches, few)]


def _monte_carlo(few: bool) -> Iterator[Method]:
    for rays in (64, 256, 1024) if few else (64, 256, 1024, 4096):
        yield Method("apart", f"{rays} rays", rays, partial(rad.MonteCarlo, rays))
        yield Method("sobol", f"{rays} rays", rays, partial(rad.MonteCarlo, rays, light_rays=0))
        yield Method("random", f"{rays} rays", rays, partial(rad.MonteCarlo, rays, sampling="random"))


def _hemicubes(few: bool) -> Iterator[Method]:
    for resolution in (16, 32) if few else (16, 32, 64):
        cube = rad.Hemicube(resolution)
        yield Method("hemicube", f"{resolution}²", cube.rays, partial(_whatever_seed, cube), seeded=False)
    for samples in (4,) if few else (4, 16):
        cube = rad.Hemicube(32, samples)
        yield Method("hemicube points", f"{samples} points", cube.rays, partial(_whatever_seed, cube), seeded=False)


def _walks(few: bool) -> Iterator[Method]:
    kinds: tuple[tuple[str, Literal["patches", "continuous"]], ...] = (
        ("walks", "patches"),
        ("continuous walks", "continuous"),
    )
    for family, transport in kinds:
        for paths in (16, 64) if few else (16, 64, 256):
            settings: dict[str, Any] = {"next_event": True, "transport": transport, "bounces": BOUNCES, "tail": True}
            yield Method(family, f"{paths} paths", paths, partial(rad.PathTracer, paths, **settings))


def _seeded(kind: Any, settings: dict[str, Any], seed: int) -> Any:
    return kind(**settings, seed=seed)


def _whatever_seed(method: Any, _seed: int) -> Any:
    return method


def _two_levels(patches: Patches, few: bool) -> Iterator[Method]:
    """Where there are enough patches to group them, and few enough lamps to look at each."""
    if len(patches) < LEAST_TWO_LEVEL:
        return
    with suppress(ParameterError):  # too many lamps
        lamps(patches, rad.TwoLevel().light_rays)
        for rays in (256, 1024) if few else (256, 1024, 4096):
            settings = {"group_rays": rays, "rays": rays // 8, "light_rays": max(64, rays // 4)}
            yield Method("two levels", f"{rays} rays", rays, partial(_seeded, rad.TwoLevel, settings))


def is_convex(patches: Patches) -> bool:
    """Whether no surface hides anything from another, so that exact factors exist."""
    try:
        check_unoccluded(patches.grid.faces, patches.surface_names)
    except OccludedSceneError:
        return False
    return True
