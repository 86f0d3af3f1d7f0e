"""Light of one cut into patches, with what it tells of its own errors."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..form_factors import FormFactors, MonteCarlo
from ..form_factors.estimate import more_replicates
from ..form_factors.merged import merged
from ..nested import parents
from ..patches import Grid, Patches
from ..plan import make_plan
from ..plan.channels import Channels
from ..plan.work import Light, Work, light, tracer_of
from ..solvers import ConjugateGradient, Neumann
from ..solvers.bound import error_bound
from ..transport import TransportOperator
from .grids import ratios

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

LIGHT_RAYS = 32  # shadow rays of a replicate: few err together in a whole room, which two replicates hardly tell
SPREAD_RTOL = 0.03  # of what one replicate's light is off by
NOISE = 0.25  # of the spread of a gap (in squares), below which its size is not told from 0
MOST_BOUNCES = 500  # of that difference, which falls like the light itself


@dataclass(frozen=True, eq=False)
class Groups:
    """Larger patches that patches are put together to.

    Attributes
    ----------
    grid : Grid
        Whose cells the groups are.
    parent : ndarray of int (N,)
        Group of each patch.
    count : int
    reflectance, absorptance, emission : ndarray (count, C)
    share : ndarray (N,)
        Of the area of its group that each patch has.
    """

    grid: Grid
    parent: IntArray
    count: int
    reflectance: FloatArray
    absorptance: FloatArray
    emission: FloatArray
    share: FloatArray

    def of(self, channels: Channels) -> Groups:
        """Groups with the channels that are solved."""
        names = ("reflectance", "absorptance", "emission")
        return replace(self, **{name: getattr(self, name)[:, channels.solved] for name in names})

    def means(self, light: FloatArray) -> FloatArray:
        """Area-weighted means (count, …) of light on the patches (N, …)."""
        columns = (light.reshape(len(light), -1) * self.share[:, None]).T
        sums = np.stack([np.bincount(self.parent, column, self.count) for column in columns], axis=1)
        return sums.reshape(self.count, *light.shape[1:]).astype(np.float64)


def groups_of(patches: Patches, coarse: Grid) -> Groups:
    """The patches of a coarser grid, as groups of patches that refine it."""
    parent = parents(patches, coarse)
    count, first = np.unique(parent, return_index=True)
    share = patches.area / np.bincount(parent, patches.area)[parent]
    rho, alpha, E = (getattr(patches, name)[first] for name in ("reflectance", "absorptance", "emission"))
    return Groups(coarse, parent, len(count), rho, alpha, E, share)


class Level(NamedTuple):
    """Light of patches with so many rays, and its errors.

    Attributes
    ----------
    patches : Patches
    groups : Groups
    method : MonteCarlo
    light : Light
    sampling, of_groups, truncation : float
        Errors, relative: sampling of the patches, and of the light of groups by the same rays.
    gap, noise : float
        Relative difference of the two, and the part of sampling in it.
    """

    patches: Patches
    groups: Groups
    method: MonteCarlo
    light: Light
    sampling: float
    of_groups: float
    truncation: float
    gap: float
    noise: float

    @property
    def ratios(self) -> tuple[float, float]:
        """Discretisation error of the patches, and of the groups, over the gap."""
        return ratios(self.patches.grid, self.groups.grid)

    @property
    def method_of_groups(self) -> MonteCarlo:
        """As many rays as a group has in the mean: those of one, two or four patches."""
        many, runs = len(self.patches) / self.groups.count, self.method.replicates
        rays, light_rays = (runs * int(many * (n // runs)) for n in (self.method.rays, self.method.light_rays))
        return replace(self.method, rays=rays, light_rays=light_rays)

    @property
    def each(self) -> int:
        """Rays of a replicate."""
        return self.method.rays // self.method.replicates


def method_of(each: int, replicates: int, seed: int) -> MonteCarlo:
    """Replicates of so many rays each, with half as many shadow rays, but not too few to tell their error."""
    light_rays = 1 << round(math.log2(max(each / 2, min(each, LIGHT_RAYS))))
    return MonteCarlo(each * replicates, seed, replicates=replicates, light_rays=light_rays * replicates)


def solve_level(patches: Patches, groups: Groups, method: MonteCarlo, rtol: float, work: Work) -> Level:
    """Solve patches, and see what the errors are."""
    return _judged(patches, groups, method, light(make_plan(patches, method, rtol=rtol), None, work), work)


def with_replicates(level: Level, replicates: int, work: Work) -> Level:
    """The level with more replicates: those that there are, and new ones."""
    method = method_of(level.each, replicates, level.method.seed)
    plan = level.light.plan
    factors = more_replicates(
        level.light.factors,
        plan.patches,
        method,
        threads=work.threads,
        memory_limit=work.memory_limit,
        progress=work.tell,
        rows=plan.needed_rows,
        tracer=tracer_of(plan),
    )
    plan = replace(plan, estimator=method)
    return _judged(level.patches, level.groups, method, light(plan, None, work, factors), work)


def light_of_groups(level: Level, patches: Patches, rtol: float, work: Work) -> Light:
    """The light of the groups as patches of their own, from the same rays."""
    method = level.method_of_groups
    factors = replace(merged(level.light.factors, level.groups.parent, level.groups.count), estimator=method)
    return light(make_plan(patches, method, rtol=rtol), None, work, factors)


def _judged(patches: Patches, groups: Groups, method: MonteCarlo, found: Light, work: Work) -> Level:
    """The level, with its errors."""
    T = TransportOperator(found.factors, patches, threads=work.threads)
    size = _size(found.result.radiosity - patches.emission, patches.area)
    truncation = _truncation(T, found, size)
    if size <= 0:
        return Level(patches, groups, method, found, 0.0, 0.0, truncation, 0.0, 0.0)
    channels = found.plan.channels
    some = channels.of(patches)
    shifts = _shifts(found, some, work)
    coarse, moved = _of_groups(found, some, groups, work)
    B = found.result.radiosity[:, channels.solved]
    area = np.bincount(groups.parent, patches.area).astype(np.float64)
    gap = channels.spread_light(coarse - groups.means(B))
    apart = moved - np.stack([groups.means(shift) for shift in shifts])
    sampling, of_groups, noise = (
        _standard_error(channels.spread_light(part), weight) / size
        for part, weight in ((shifts, patches.area), (moved, area), (apart, area))
    )
    square = (_size(gap, area) / size) ** 2 - noise**2  # the mean product of two replicates' gaps
    gap_size = math.sqrt(max(square, NOISE * noise**2))
    return Level(patches, groups, method, found, sampling, of_groups, truncation, gap_size, noise)


def _standard_error(shifts: FloatArray, area: FloatArray) -> float:
    """Of a mean, from what replicates (k, N, C) differ from it by."""
    runs = len(shifts)
    return math.sqrt(sum(_size(shift, area) ** 2 for shift in shifts) / (runs * (runs - 1)))


def _shifts(found: Light, patches: Patches, work: Work) -> FloatArray:
    """By how much the light of each replicate alone differs from that of all, (replicates, N, C), W/m²."""
    B = found.result.radiosity[:, found.plan.channels.solved]
    runs = found.factors.replicates
    if found.plan.conserve:
        return np.stack([_solved(run, patches, patches.sky, found, B) - B for run in runs])
    T = TransportOperator(found.factors, patches, threads=work.threads)
    return _together([_response(T, _difference(run, T, B, patches)) for run in runs[1:]])


def _of_groups(found: Light, patches: Patches, groups: Groups, work: Work) -> tuple[FloatArray, FloatArray]:
    """Light of the groups (count, C), and by how much it differs in each replicate, (replicates, count, C)."""
    materials = groups.of(found.plan.channels)
    factors = merged(found.factors, groups.parent, groups.count, replicates=found.plan.conserve)
    light = _solved(factors, materials, patches.sky, found)
    if found.plan.conserve:
        return light, np.stack(
            [_solved(run, materials, patches.sky, found, light) - light for run in factors.replicates]
        )
    T = TransportOperator(found.factors, patches, threads=work.threads)
    coarse, spread_out = TransportOperator(factors, materials, threads=work.threads), light[groups.parent]
    sources = [groups.means(_difference(run, T, spread_out, patches)) for run in found.factors.replicates[1:]]
    return light, _together([_response(coarse, source) for source in sources])


def _solved(
    factors: FormFactors, materials: Patches | Groups, sky: FloatArray, found: Light, start: FloatArray | None = None
) -> FloatArray:
    """Light by other factors, with the solver that was found to serve."""
    solver = (ConjugateGradient if found.plan.conserve else Neumann)(rtol=found.plan.solver.rtol)
    return solver.solve(TransportOperator(factors, materials), materials.emission, sky, x0=start).radiosity


def _difference(run: FormFactors, T: TransportOperator, light: FloatArray, patches: Patches) -> FloatArray:
    """What one replicate makes of light in one bounce, less what all make of it, (N, C)."""
    one = TransportOperator(run, patches, threads=T.threads)
    return one @ light - T @ light + one.from_sky(patches.sky) - T.from_sky(patches.sky)


def _together(shifts: list[FloatArray]) -> FloatArray:
    """The shifts of all replicates from those of all but the first: to first order their sum is zero."""
    others = np.stack(shifts)
    return np.concatenate([-others.sum(axis=0, keepdims=True), others])


def _response(T: TransportOperator, source: FloatArray) -> FloatArray:
    """(I - T)⁻¹ of a source of either sign, to few digits."""
    total = term = source
    for _ in range(MOST_BOUNCES):
        term = T @ term
        total = total + term
        if _size(term, T.area) <= SPREAD_RTOL * _size(total, T.area):
            break
    return total


def _truncation(T: TransportOperator, found: Light, size: float) -> float:
    """What later bounces would add, over the reflected light; a bound where the solver does not go by bounces."""
    if size <= 0:
        return 0.0
    history = found.result.history
    if not isinstance(found.plan.solver, Neumann):
        patches = found.plan.patches
        source = T.source(patches.emission, patches.sky)
        return float(error_bound(T, source, found.result.radiosity, patches.emission).relative)
    if len(history) < 2:
        return float(np.linalg.norm(history[-1]) / size)
    ratio = np.divide(history[-1], history[-2], out=np.zeros_like(history[-1]), where=history[-2] > 0)
    return float(np.linalg.norm(history[-1] / (1.0 - np.minimum(ratio, 0.9999))) / size)


def _size(field: FloatArray, area: FloatArray) -> float:
    """Area-weighted root mean square over patches, all channels together."""
    return float(np.sqrt(np.sum(area[:, None] * field**2) / area.sum()))
