"""Patches and rays for a stated accuracy: tried, judged by the light itself, and chosen again.

Measured on boxes, rooms with furniture and corridors: the error of patches is 0.45 to 0.9 of the gap to the same
patches put together in fours, that of the groups 1.3 to 1.5; sampling falls as rays^-0.67 in one Sobol sequence, and as
the root of their number in independent ones; discretisation as the area of a patch to the power of 0.4 to 0.7.
"""

from __future__ import annotations

import math
import time
import warnings
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..errors import AccuracyWarning, ParameterError
from ..faces import source_faces
from ..memory import limit_bytes
from ..nested import finer
from ..patches import Grid, Patches, cut, grid_of
from ..plan.work import Light, Work
from ..scene import Scene
from ..solvers import Neumann
from .levels import Level, groups_of, light_of_groups, method_of, solve_level, with_replicates
from .result import Accuracy, Trial

FloatArray = NDArray[np.float64]

FINE, COARSE = 0.75, 1.4  # discretisation error of patches, and of groups of four, over their gap
RAYS_POWER = 0.67  # how the sampling error falls with the rays of a replicate
AREA_POWER = 0.6  # how discretisation falls with the area of a patch
SIZES = 1.2 ** np.arange(-32.0, 9.0)  # of a patch's area, which are thought of
TYPICAL_RAY = 0.3  # sampling error of one ray in two replicates in a usual scene, if it fell so all the way
TYPICAL_PATCHES = 0.011  # discretisation error of the first patches in a usual scene
FIRST = 0.9  # of the target: what a first trial is made for …
LEAST_LEFT = 0.5  # … if so much of it is left for sampling; else its patches will hardly do, as few rays show
PILOT_RAYS = 48
LEAST_RAYS, MOST_RAYS = 16, 1 << 16  # of a replicate
TRUNCATION = 0.02  # of the target
AIM = 0.97  # of the target, so that one more trial is seldom needed
CLEAR = 0.35  # of the target: a gap that is known to this is known well enough
LEAST_MORE = 48  # groups of patches beyond one a face: large faces are cut, as their gap would else say little
MANY_SIDES = 300  # up to which there is one more for each, too, and beyond one for every third
PER_PATCH = 90.0  # rays that a patch costs beside its own
PER_TRIAL = 3e4  # rays that one more trial costs
MOST_TRIALS = 8
ENTRY_BYTES = 24  # of a ray, at most: the factors, their replicates, and work under way


class Found(NamedTuple):
    """What `light_to` gives."""

    patches: Patches
    light: Light
    accuracy: Accuracy


class _Answer(NamedTuple):
    """What a level may answer with, the patches or the groups, and the errors of that."""

    total: float
    groups: bool
    sampling: float
    discretisation: float


class _Choice(NamedTuple):
    """A next trial: fine patches, replicates, rays of each; `same` if it only adds replicates to the last."""

    cost: float
    patches: int
    replicates: int
    each: int
    same: bool


def light_to(
    scene: Scene, target: float, patches: Patches | None = None, seed: int = 0, work: Work | None = None
) -> Found:
    """Light of a scene to an accuracy.

    Parameters
    ----------
    scene : Scene
    target : float
        Largest total error, relative: 0.01 is 1 %.
    patches : Patches, optional
        Those to be used; by default as many as it takes.
    seed : int
    work : Work, optional

    Returns
    -------
    Found

    Raises
    ------
    ParameterError
        A target that is not between 0 and 1.

    Warns
    -----
    AccuracyWarning
        The target is not reached.
    """
    if not 0.0 < target < 1.0:
        raise ParameterError(f"accuracy is {target}; give a share between 0 and 1, as 0.01 for 1 %")
    search = _Search(scene, target, seed, Work() if work is None else work)
    return search.free() if patches is None else search.on(patches)


class _Search:
    """Trials, each chosen by what the one before it has shown."""

    def __init__(self, scene: Scene, target: float, seed: int, work: Work) -> None:
        self.scene, self.target, self.seed, self.work = scene, target, seed, work
        self.began = time.perf_counter()
        self.trials: list[Trial] = []
        self.rtol = 0.2 * TRUNCATION * target
        self.limit = limit_bytes(work.memory_limit)

    def free(self) -> Found:
        """Patches as many as it takes."""
        faces = source_faces(self.scene)
        sides = int((1 + faces.two_sided).sum())
        least = sides + max(LEAST_MORE, min(sides, MANY_SIDES + sides // 3))
        level = self._level(grid_of(faces, least), self._typical_rays())
        answer = self._note(level, groups_only=False)
        while self._goes_on():
            choice = self._choose(level, 4 * least)
            if choice is None:
                break
            if choice.same:
                level = with_replicates(level, choice.replicates, self.work)
            else:
                same = choice.patches == len(level.patches)
                grid = level.groups.grid if same else grid_of(faces, choice.patches // 4)
                level = self._level(grid, choice.each)
            answer = self._note(level, groups_only=False)
        return self._end(level, answer)

    def on(self, patches: Patches) -> Found:
        """Patches as they were asked for: only rays and bounces are chosen."""
        level = self._level(patches.grid, _even(self._typical_rays() / 4))
        answer = self._note(level, groups_only=True)
        while self._goes_on() and answer.discretisation - COARSE * level.noise < AIM * self.target:
            choice = self._choose(level, None)
            if choice is None:
                break
            if choice.same:
                level = with_replicates(level, choice.replicates, self.work)
            else:
                level = self._level(patches.grid, choice.each)
            answer = self._note(level, groups_only=True)
        return self._end(level, answer)

    def _goes_on(self) -> bool:
        return self.trials[-1].total > self.target and len(self.trials) < MOST_TRIALS

    def _typical_rays(self) -> int:
        """Of a replicate, for the first trial in a usual scene."""
        left = _beside(FIRST * self.target, TYPICAL_PATCHES)
        if left < LEAST_LEFT * self.target:
            return PILOT_RAYS
        return _even((TYPICAL_RAY / left) ** (1.0 / RAYS_POWER))

    def _level(self, coarse: Grid, each: int) -> Level:
        """Two replicates of so many rays from the patches of a grid cut in four."""
        patches = cut(self.scene, finer(coarse, 2))
        level = solve_level(patches, groups_of(patches, coarse), method_of(each, 2, self.seed), self.rtol, self.work)
        if level.truncation > 0 and isinstance(level.light.plan.solver, Neumann):  # aim at what it should be next time
            goal = 0.8 * TRUNCATION * self.target
            self.rtol = min(max(self.rtol * goal / level.truncation, 1e-12), 0.1)
        return level

    def _answers(self, level: Level) -> tuple[_Answer, _Answer]:
        """Of the patches, and of the groups."""
        pairs = (level.sampling, FINE * level.gap), (level.of_groups, COARSE * level.gap)
        return tuple(  # type: ignore[return-value]  # there are two
            _Answer(math.hypot(s, d) + level.truncation, groups == 1, s, d) for groups, (s, d) in enumerate(pairs)
        )

    def _choose(self, level: Level, least: int | None) -> _Choice | None:
        """The next trial that should reach the target with the least work; if `least` is None, for groups as now."""
        count, replicates = len(level.patches), level.method.replicates
        goal = (AIM - TRUNCATION) * self.target
        others = [] if least is None else [other for other in self._finer_and_coarser(level) if other[0] >= least]
        choices = []
        for answer in self._answers(level)[1 if least is None else 0 :]:
            for many, growth in [(count, 1.0), *others]:
                left = _beside(goal, answer.discretisation * growth)
                if left < 0.2 * self.target:
                    continue
                each = self._rays_for(level, answer.sampling, left)
                choices.append(_Choice(many * (PER_PATCH + 2 * each) + PER_TRIAL, many, 2, each, same=False))
                more = math.ceil(replicates * (answer.sampling / left) ** 2)
                if many == count and replicates < more <= 2 * replicates and not level.light.plan.conserve:
                    cost = many * (more - replicates) * level.each + 0.5 * PER_TRIAL
                    choices.append(_Choice(cost, many, more, level.each, same=True))
        if not choices:  # so far off that the law says little
            choices = [_Choice(0.0, 4 * count if least is not None else count, 2, 2 * level.each, same=False)]
        choices = [choice for choice in choices if self._fits(choice.patches, choice.replicates * choice.each)]
        return min(choices, default=None)

    def _finer_and_coarser(self, level: Level) -> list[tuple[int, float]]:
        """Other numbers of patches, and by how much discretisation grows with each.

        It goes by the area-weighted mean area of a patch: small faces stay whole, and count for little.
        """
        faces = level.patches.grid.faces
        area, sides = faces.area, 1 + faces.two_sided

        def cut_to(size: FloatArray) -> tuple[FloatArray, FloatArray]:
            cells = np.maximum(1.0, area / size[:, None])
            return cells @ sides, (area / cells) @ (sides * area)

        size = area @ sides / level.groups.count * 2.0 ** np.arange(-8.0, 8.0, 0.125)
        now = size[np.argmin(np.abs(cut_to(size)[0] - level.groups.count))]
        many, mean = cut_to(now * SIZES)
        growth = (mean / cut_to(np.array([now]))[1]) ** AREA_POWER
        return [(4 * int(n), float(g)) for n, g in zip(many, growth, strict=True)]

    def _rays_for(self, level: Level, error: float, goal: float) -> int:
        """Rays of each of two replicates that bring a sampling error of the level down to a goal."""
        alone = error * math.sqrt(level.method.replicates / 2)
        return _even(level.each * (alone / goal) ** (1.0 / RAYS_POWER))

    def _fits(self, count: int, rays: int) -> bool:
        return rays <= 2 * MOST_RAYS and ENTRY_BYTES * count * min(rays, count) <= self.limit

    def _note(self, level: Level, groups_only: bool) -> _Answer:
        """Which answer the level gives: of the patches where that is good enough, or the better one."""
        fine, coarse = self._answers(level)
        answer = coarse if groups_only or not (fine.total <= self.target or fine.total < coarse.total) else fine
        count, rays, light_rays = len(level.patches), level.method.rays, level.method.light_rays
        if answer.groups:
            count, rays, light_rays = level.groups.count, 4 * rays, 4 * light_rays
        parts = answer.sampling, answer.discretisation, level.truncation
        self.trials.append(Trial(count, rays, light_rays, *parts, time.perf_counter() - self.began))
        done = round(100 * min(1.0, self.target / max(answer.total, 1e-12)))
        self.work.tell(f"{answer.total:.2%} error", done, 100)
        return answer

    def _end(self, level: Level, answer: _Answer) -> Found:
        """The answer, with a warning where it is not good enough."""
        accuracy = Accuracy(self.target, tuple(self.trials))
        if not accuracy.reached:
            warnings.warn(
                f"{accuracy}; more would not fit the memory, or the patches that were asked for are too coarse: give "
                "more memory (memory_limit=, --memory) or leave the number of patches open",
                AccuracyWarning,
                stacklevel=5,  # of whoever called `solve`
            )
        if not answer.groups:
            return Found(level.patches, level.light, accuracy)
        patches = cut(self.scene, level.groups.grid)
        rtol = level.light.plan.solver.rtol
        return Found(patches, light_of_groups(level, patches, rtol, self.work), accuracy)


def _beside(total: float, part: float) -> float:
    """What an independent error may be beside another one."""
    return math.sqrt(max(total**2 - part**2, 0.0))


def _even(rays: float) -> int:
    """Rays of a replicate, no fewer: a multiple of 8, or of an eighth of the power of two below, for Sobol points."""
    rays = float(np.clip(rays, LEAST_RAYS, 2 * MOST_RAYS))
    step = max(8, 1 << (math.floor(math.log2(rays)) - 3))
    return step * math.ceil(rays / step)
