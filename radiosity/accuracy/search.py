"""Patches and rays for a stated accuracy: tried, judged by the light itself, and chosen again.

Measured on boxes, rooms with furniture and corridors: sampling falls as rays^-0.67 in one Sobol sequence, and as the
root of their number in independent ones. What is said of discretisation is in `grids`.
"""

from __future__ import annotations

import math
import time
import warnings
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..errors import AccuracyWarning, MemoryLimitError, ParameterError
from ..faces import Faces, source_faces
from ..memory import limit_bytes
from ..nested import finer
from ..patches import Grid, Patches, cut
from ..plan.work import Light, Work
from ..scene import Scene
from ..solvers import Neumann
from .grids import first_grid, halved, other_grids
from .levels import Level, groups_of, light_of_groups, method_of, solve_level, with_replicates
from .result import Accuracy, Trial

FloatArray = NDArray[np.float64]

RAYS_POWER = 0.67  # how the sampling error falls with the rays of a replicate
TYPICAL_RAY = 0.3  # sampling error of one ray in two replicates in a usual scene, if it fell so all the way
TYPICAL_SIDE = 0.016  # discretisation error of a usual scene with two patches for each side of a face, and …
SIDES = 80  # … so many more
PATCHES_POWER = 0.6  # how it falls with more patches than there are sides
SHARE = 0.65  # of the target: discretisation that the first trial is made for
FIRST = 0.92  # of the target: what a first trial is made for, in all
MANY_SIDES = 300  # of faces: where there are more, no more count for that than these and a third of all
PILOT, MANY_RAYS = 0.008, 1e8  # target below which, and rays above which, a first trial only shows what will do, …
PILOT_RAYS = 32  # … with so many rays in a replicate
ELSEWHERE = 1.1  # of the discretisation error foretold for other patches, to be safe
LEAST_RAYS, MOST_RAYS = 16, 1 << 16  # of a replicate
TRUNCATION = 0.02  # of the target
AIM = 0.96  # of the target, so that one more trial is seldom needed
PER_PATCH = 90.0  # rays that a patch costs beside its own
PER_TRIAL = 5e4  # rays that one more trial costs
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
    """A next trial: its patches, replicates, rays of each; `same` if it only adds replicates to the last."""

    cost: float
    grid: Grid
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
        fine = first_grid(faces, _typical_patches(faces, SHARE * self.target))
        each = _typical_rays(self.target, faces, fine.patch_count)
        if self.target < PILOT or 2 * each * fine.patch_count > MANY_RAYS:
            fine, each = first_grid(faces, _typical_patches(faces, 2 * SHARE * self.target)), PILOT_RAYS
        level = self._level(fine, halved(fine), each)
        return self._refined(level, groups_only=False)

    def on(self, patches: Patches) -> Found:
        """Patches as they were asked for: only rays and bounces are chosen."""
        each = _even((TYPICAL_RAY / self.target) ** (1.0 / RAYS_POWER) / 4)
        return self._refined(self._level(finer(patches.grid, 2), patches.grid, each), groups_only=True)

    def _refined(self, level: Level, groups_only: bool) -> Found:
        """One trial after the other until one will do, or no other would."""
        answer = self._note(level, groups_only)
        while self.trials[-1].total > self.target and len(self.trials) < MOST_TRIALS:
            hopeless = groups_only and answer.discretisation - level.ratios[1] * level.noise >= AIM * self.target
            choice = None if hopeless else self._choose(level, groups_only)
            if choice is None:
                break
            try:
                level = self._next(level, choice)
            except MemoryLimitError:  # more than was thought: what takes half as much is looked for
                self.limit /= 2
                continue
            answer = self._note(level, groups_only)
        return self._end(level, answer)

    def _next(self, level: Level, choice: _Choice) -> Level:
        """The level that was chosen.

        Raises
        ------
        MemoryLimitError
        """
        if choice.same:
            return with_replicates(level, choice.replicates, self.work)
        coarse = level.groups.grid if choice.grid is level.patches.grid else halved(choice.grid)
        return self._level(choice.grid, coarse, choice.each)

    def _level(self, fine: Grid, coarse: Grid, each: int) -> Level:
        """Two replicates of so many rays from the patches of a grid."""
        patches = cut(self.scene, fine)
        level = solve_level(patches, groups_of(patches, coarse), method_of(each, 2, self.seed), self.rtol, self.work)
        if level.truncation > 0 and isinstance(level.light.plan.solver, Neumann):  # aim at what it should be next time
            goal = 0.8 * TRUNCATION * self.target
            self.rtol = min(max(self.rtol * goal / level.truncation, 1e-12), 0.1)
        return level

    def _answers(self, level: Level) -> tuple[_Answer, _Answer]:
        """Of the patches, and of the groups."""
        pairs = zip((level.sampling, level.of_groups), level.ratios, strict=True)
        return tuple(  # type: ignore[return-value]  # there are two
            _Answer(math.hypot(s, ratio * level.gap) + level.truncation, groups == 1, s, ratio * level.gap)
            for groups, (s, ratio) in enumerate(pairs)
        )

    def _choose(self, level: Level, groups_only: bool) -> _Choice | None:
        """The next trial that should reach the target with the least work."""
        here, replicates = level.patches.grid, level.method.replicates
        goal = (AIM - TRUNCATION) * self.target
        others = [] if groups_only else list(other_grids(here))
        choices = []
        for answer in self._answers(level)[1 if groups_only else 0 :]:
            for grid, count, growth in [(here, len(level.patches), 1.0), *others]:
                safe = 1.0 if grid is here else ELSEWHERE
                left = _beside(goal, answer.discretisation * growth * safe)
                if left < 0.2 * self.target:
                    continue
                each = self._rays_for(level, answer.sampling, left)
                choices.append(_Choice(count * (PER_PATCH + 2 * each) + PER_TRIAL, grid, 2, each, same=False))
                more = math.ceil(replicates * (answer.sampling / left) ** 2)
                if grid is here and replicates < more <= 2 * replicates and not level.light.plan.conserve:
                    cost = count * (more - replicates) * level.each + 0.5 * PER_TRIAL
                    choices.append(_Choice(cost, grid, more, level.each, same=True))
        if not choices:  # so far off that the laws say little: the finest that is thought of, or more rays
            choices = [_Choice(-n, grid, 2, level.each, same=False) for grid, n, growth in others if growth < 0.9]
            choices += [_Choice(0.0, here, 2, 2 * level.each, same=False)] if groups_only else []
        choices = [choice for choice in choices if self._fits(choice.grid, choice.replicates * choice.each)]
        return min(choices, key=lambda choice: choice.cost, default=None)

    def _rays_for(self, level: Level, error: float, goal: float) -> int:
        """Rays of each of two replicates that bring a sampling error of the level down to a goal."""
        alone = error * math.sqrt(level.method.replicates / 2)
        return _even(level.each * (alone / goal) ** (1.0 / RAYS_POWER))

    def _fits(self, grid: Grid, rays: int) -> bool:
        count = grid.patch_count
        return rays <= 2 * MOST_RAYS and ENTRY_BYTES * count * min(rays, count) <= self.limit

    def _note(self, level: Level, groups_only: bool) -> _Answer:
        """Which answer the level gives: of the patches where that is good enough, or the better one."""
        fine, coarse = self._answers(level)
        answer = coarse if groups_only or not (fine.total <= self.target or fine.total < coarse.total) else fine
        count, method = len(level.patches), level.method
        if answer.groups:
            count, method = level.groups.count, level.method_of_groups
        parts = answer.sampling, answer.discretisation, level.truncation
        self.trials.append(Trial(count, method.rays, method.light_rays, *parts, time.perf_counter() - self.began))
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


def _typical_patches(faces: Faces, error: float) -> int:
    """How many patches of a usual scene have such a discretisation error."""
    sides, more = _sides(faces)
    return math.ceil(sides + more * (TYPICAL_SIDE / error) ** (1.0 / PATCHES_POWER))


def _typical_rays(target: float, faces: Faces, count: int) -> int:
    """Of a replicate, for a first trial with so many patches in a usual scene."""
    sides, more = _sides(faces)
    discretisation = TYPICAL_SIDE * (more / max(count - sides, 1)) ** PATCHES_POWER
    left = _beside(FIRST * target, min(discretisation, SHARE * target))
    return _even((TYPICAL_RAY / left) ** (1.0 / RAYS_POWER))


def _sides(faces: Faces) -> tuple[int, float]:
    """Sides of faces, and by how many more patches a usual scene has `TYPICAL_SIDE`."""
    sides = int(faces.sides.sum())
    return sides, SIDES + min(sides, MANY_SIDES + sides / 3)


def _beside(total: float, part: float) -> float:
    """What an independent error may be beside another one."""
    return math.sqrt(max(total**2 - part**2, 0.0))


def _even(rays: float) -> int:
    """Rays of a replicate, no fewer: a multiple of 8, or of an eighth of the power of two below, for Sobol points."""
    rays = float(np.clip(rays, LEAST_RAYS, 2 * MOST_RAYS))
    step = max(8, 1 << (math.floor(math.log2(rays)) - 3))
    return step * math.ceil(rays / step)
