"""Light to a stated accuracy: patches, rays and bounces chosen so that three errors together stay below it.

    total = √(sampling² + discretisation²) + truncation

relative to B - E, area-weighted L2 over patch means and channels: the first two are independent of each other.
Sampling comes from the spread of independent replicates. Discretisation is the gap between the light of patches and
that of the same patches cut in four, taken back to means; the sampling errors of both, being independent in each
replicate, drop out of the product of two replicates' gaps. Truncation is what a geometric series would still add.

Measured on boxes, rooms with furniture and corridors: the error of the finer patches is 0.55 to 0.9 of the gap, that of
the coarser ones 1.3 to 1.5; sampling falls as rays^-0.55 or faster whatever the patches are, discretisation as
1 / √patches or faster.
"""

from __future__ import annotations

import math
import time
import warnings
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .errors import AccuracyWarning, ParameterError
from .form_factors import MonteCarlo
from .memory import limit_bytes
from .nested import means, refined
from .patches import Patches, subdivide
from .plan import make_plan
from .plan.work import Light, Work, light
from .scene import Scene
from .solvers import ConjugateGradient, Neumann
from .solvers.bound import error_bound
from .transport import TransportOperator

FloatArray = NDArray[np.float64]

FINE, COARSE = 0.75, 1.4  # discretisation error of the finer and the coarser patches, over their gap
NOISE = 0.7  # / N^(1/4): of the sampling errors, what is left in a gap over N patches; smaller ones are not told from 0
CLEAR = 0.35  # of the target: a gap that is known to this is known well enough
RAYS_POWER, PATCHES_POWER = 0.55, 0.5  # how errors fall
TRUNCATION = 0.02  # of the target
AIM = 0.94  # of the target, so that one more trial is seldom needed
LEAST_PATCHES = 100
LEAST_RAYS, MOST_RAYS = 24, 1 << 17
PER_PATCH = 32.0  # rays that a patch costs beside its own
MOST_TRIALS = 8
ENTRY_BYTES = 24  # of a ray, at most: the factors, their replicates, and work under way
MANY_FACES = 5000  # beyond which a trial begins with the faces as they are


@dataclass(frozen=True)
class Trial:
    """One try on the way to an accuracy.

    Attributes
    ----------
    patches, rays, light_rays : int
    sampling, discretisation, truncation : float
        Errors as they were estimated by then, relative.
    seconds : float
        Since the beginning.
    """

    patches: int
    rays: int
    light_rays: int
    sampling: float
    discretisation: float
    truncation: float
    seconds: float

    @property
    def total(self) -> float:
        """All three: two that are independent of each other, and one that is not."""
        return math.hypot(self.sampling, self.discretisation) + self.truncation


@dataclass(frozen=True)
class Accuracy:
    """How accurate a solution is, by its own estimate.

    Attributes
    ----------
    target : float
        What was asked for, relative to B - E.
    trials : tuple of Trial
        Error against time; the last one is the solution's.
    """

    target: float
    trials: tuple[Trial, ...]

    @property
    def sampling(self) -> float:
        """Error from a limited number of rays."""
        return self.trials[-1].sampling

    @property
    def discretisation(self) -> float:
        """Error from patches of constant light."""
        return self.trials[-1].discretisation

    @property
    def truncation(self) -> float:
        """Error from bounces that were left out."""
        return self.trials[-1].truncation

    @property
    def total(self) -> float:
        """All three together."""
        return self.trials[-1].total

    @property
    def reached(self) -> bool:
        """Whether that is within the target."""
        return self.total <= self.target

    def __str__(self) -> str:
        last = self.trials[-1]
        parts = (
            f"sampling {last.sampling:.2%}, discretisation {last.discretisation:.2%}, truncation {last.truncation:.2%}"
        )
        head = f"accuracy: error about {last.total:.2%}, {100 * self.target:g}% asked for"
        return f"{head} ({parts}; {len(self.trials)} trials, {last.seconds:.2f} s)"


class Found(NamedTuple):
    """What `light_to` gives."""

    patches: Patches
    light: Light
    accuracy: Accuracy


class _Level(NamedTuple):
    """Light of patches with so many rays: reflected light (N, C) of the whole and of each replicate, and its errors."""

    patches: Patches
    rays: int
    light_rays: int
    light: Light
    reflected: FloatArray
    runs: list[FloatArray]
    sampling: float
    truncation: float


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
    """Trials, each chosen by what the ones before it have shown."""

    def __init__(self, scene: Scene, target: float, seed: int, work: Work) -> None:
        self.scene, self.target, self.seed, self.work = scene, target, seed, work
        self.began = time.perf_counter()
        self.trials: list[Trial] = []
        self.rtol = 0.2 * TRUNCATION * target
        self.limit = limit_bytes(work.memory_limit)

    def free(self) -> Found:
        """Patches as many as it takes."""
        faces = len(subdivide(self.scene))
        coarse, fine = self._pair(max(LEAST_PATCHES, 2 * faces if faces < MANY_FACES else faces), self._first_rays())
        best = fine
        self._note(best, self._law(coarse, fine, len(fine.patches)))
        while self.trials[-1].total > self.target and len(self.trials) < MOST_TRIALS:
            count, rays = self._next(coarse, fine)
            if not self._fits(count, rays):
                break
            if self._is_clear(coarse, fine) and count in (len(coarse.patches), len(fine.patches)):
                known = coarse if count == len(coarse.patches) else fine
                best = self._level(known.patches, rays, 0)
            else:
                coarse, fine = self._pair(max(1, count // 4), rays)
                best = fine
            self._note(best, self._law(coarse, fine, len(best.patches)))
            if best is not fine:  # the rays are known better now
                fine = fine._replace(rays=best.rays, sampling=best.sampling)
        return self._end(best)

    def on(self, patches: Patches) -> Found:
        """Patches as they were asked for: only rays and bounces are chosen."""
        finer = refined(self.scene, patches, 2)
        level, fine = self._level(patches, self._first_rays(), 0), self._level(finer, self._first_rays(), 1)
        self._note(level, COARSE * self._gap(level, fine)[0])
        while self.trials[-1].total > self.target and len(self.trials) < MOST_TRIALS:
            gap, noise = self._gap(level, fine)
            clear = noise <= CLEAR * self.target
            if clear and COARSE * gap >= AIM * self.target:
                break
            goal = _beside(AIM * self.target, min(COARSE * gap, 0.7 * self.target))
            rays = max(self._rays_for(level, goal), _even(1.3 * level.rays))
            if not self._fits(len(patches if clear else finer), rays):
                break
            level = self._level(patches, rays, 0)
            if not clear:
                fine = self._level(finer, rays, 1)
            self._note(level, COARSE * self._gap(level, fine)[0])
        return self._end(level)

    def _first_rays(self) -> int:
        """Of the first trial: a small part of what the target will take."""
        return _even(float(np.clip(1.2 / self.target, LEAST_RAYS, 256)))

    def _pair(self, count: int, rays: int) -> tuple[_Level, _Level]:
        """Patches, and the same cut in four."""
        patches = subdivide(self.scene, max(count, 1))
        return self._level(patches, rays, 1), self._level(refined(self.scene, patches, 2), rays, 0)

    def _is_clear(self, coarse: _Level, fine: _Level) -> bool:
        return self._gap(coarse, fine)[1] <= CLEAR * self.target

    def _next(self, coarse: _Level, fine: _Level) -> tuple[int, int]:
        """Patches and rays of the next trial: more rays where the gap drowns in noise, else what should do."""
        if not self._is_clear(coarse, fine):
            goal = 0.7 * fine.sampling * CLEAR * self.target / self._gap(coarse, fine)[1]
            return len(fine.patches), max(self._rays_for(fine, goal), _even(1.3 * fine.rays))
        return self._cheapest(coarse, fine)

    def _level(self, patches: Patches, rays: int, stream: int) -> _Level:
        """Solve patches; another stream has other random numbers."""
        replicates = 3 if rays % 3 == 0 else 2
        light_rays = replicates * max(2, 1 << round(math.log2(rays / replicates / 2)))
        method = MonteCarlo(rays, 2 * self.seed + stream, replicates=replicates, light_rays=light_rays)
        plan = make_plan(patches, method, rtol=self.rtol)
        found = light(plan, None, self.work)
        T = TransportOperator(found.factors, patches, threads=self.work.threads)
        reflected = found.result.radiosity - patches.emission
        size = _size(reflected, patches)
        truncation = self._truncation(T, found, size)
        runs = [run - patches.emission for run in self._replicates(found, patches)]
        spread = np.std(runs, axis=0, ddof=1) / math.sqrt(len(runs))
        sampling = _size(spread, patches) / size if size > 0 else 0.0
        if truncation > 0 and isinstance(found.plan.solver, Neumann):  # aim at what it should be next time
            self.rtol = min(max(self.rtol * 0.8 * TRUNCATION * self.target / truncation, 1e-12), 0.1)
        return _Level(patches, rays, light_rays, found, reflected, runs, sampling, truncation)

    def _replicates(self, found: Light, patches: Patches) -> list[FloatArray]:
        """Radiosity by each replicate, beginning from that of their mean."""
        channels = found.plan.channels
        some = channels.of(patches)
        start = found.result.radiosity[:, channels.solved]
        solver = (ConjugateGradient if found.plan.conserve else Neumann)(rtol=max(0.2 * self.rtol, 1e-9))
        out = []
        for run in found.factors.replicates:
            T = TransportOperator(run, some, threads=self.work.threads)
            result = solver.solve(T, some.emission, some.sky, x0=start)
            out.append(channels.spread(result).radiosity)
        return out

    def _truncation(self, T: TransportOperator, found: Light, size: float) -> float:
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

    def _gap(self, coarse: _Level, fine: _Level) -> tuple[float, float]:
        """Discretisation between two levels, relative, and below what it could not be told from sampling."""
        size = _size(coarse.reflected, coarse.patches)
        if size <= 0:
            return 0.0, 0.0
        gaps = [
            one - means(other, fine.patches, coarse.patches) for one, other in zip(coarse.runs, fine.runs, strict=False)
        ]
        area = coarse.patches.area[:, None] / coarse.patches.area.sum()
        pairs = [(i, j) for i in range(len(gaps)) for j in range(i)]
        product = float(np.mean([np.sum(area * gaps[i] * gaps[j]) for i, j in pairs])) / size**2
        noise = NOISE * len(area) ** -0.25 * math.hypot(coarse.sampling, fine.sampling)
        return math.sqrt(max(product, noise**2)), noise

    def _law(self, coarse: _Level, fine: _Level, count: float) -> float:
        """Discretisation error of so many patches, after what two levels show."""
        gap = self._gap(coarse, fine)[0]
        few, many = len(coarse.patches), len(fine.patches)
        if count <= few:
            return COARSE * gap * (few / count) ** PATCHES_POWER
        if count >= many:
            return FINE * gap * (many / count) ** PATCHES_POWER
        share = math.log(count / few) / math.log(many / few)
        return gap * COARSE ** (1.0 - share) * FINE**share

    def _cheapest(self, coarse: _Level, fine: _Level) -> tuple[int, int]:
        """Patches and rays that should reach the target with the least work."""
        few, many = len(coarse.patches), len(fine.patches)
        choices = []
        for count in (few, many, *(int(many * 1.2**k) for k in range(1, 30))):
            left = _beside((AIM - TRUNCATION) * self.target, self._law(coarse, fine, count))
            if left < 0.2 * self.target:
                continue
            rays = self._rays_for(fine, left)
            if count == many and rays <= fine.rays:
                rays = _even(1.3 * fine.rays)
            partner = 0.0 if count in (few, many) else 0.25
            choices.append(((1.0 + partner) * count * (rays + PER_PATCH), count, rays))
        return min(choices)[1:] if choices else (4 * many, fine.rays)

    def _rays_for(self, level: _Level, sampling: float) -> int:
        """Rays that bring the sampling error down to a goal."""
        rays = level.rays * (level.sampling / sampling) ** (1.0 / RAYS_POWER)
        return _even(float(np.clip(rays, LEAST_RAYS, 2 * MOST_RAYS)))

    def _fits(self, count: int, rays: int) -> bool:
        return rays <= MOST_RAYS and ENTRY_BYTES * count * min(rays, count) <= self.limit

    def _note(self, level: _Level, discretisation: float) -> None:
        seconds = time.perf_counter() - self.began
        parts = level.sampling, discretisation, level.truncation
        trial = Trial(len(level.patches), level.rays, level.light_rays, *parts, seconds)
        self.trials.append(trial)
        done = round(100 * min(1.0, self.target / max(trial.total, 1e-12)))
        self.work.tell(f"{trial.total:.2%} error", done, 100)

    def _end(self, level: _Level) -> Found:
        accuracy = Accuracy(self.target, tuple(self.trials))
        if not accuracy.reached:
            warnings.warn(
                f"{accuracy}; more would not fit the memory, or the patches that were asked for are too coarse: give "
                "more memory (memory_limit=, --memory) or leave the number of patches open",
                AccuracyWarning,
                stacklevel=5,  # of whoever called `solve`
            )
        return Found(level.patches, level.light, accuracy)


def _beside(total: float, part: float) -> float:
    """What an independent error may be beside another one."""
    return math.sqrt(max(total**2 - part**2, 0.0))


def _size(field: FloatArray, patches: Patches) -> float:
    """Area-weighted root mean square over patches, all channels together."""
    return float(np.sqrt(np.sum(patches.area[:, None] * field**2) / patches.area.sum()))


def _even(rays: float) -> int:
    """The least 2 · 2^k or 3 · 2^k that is no less: what Sobol points serve best, in two or three replicates."""
    two = 2 * (1 << max(0, math.ceil(math.log2(max(rays, 2.0) / 2))))
    three = 3 * (1 << max(0, math.ceil(math.log2(max(rays, 3.0) / 3))))
    return min(two, three)
