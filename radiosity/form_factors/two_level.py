"""Form factors on two levels: direct light on all patches, the rest between groups of them where light is smooth.

A million patches are needed to draw the edge of a shadow, not to carry what the walls send back. So every patch gets
exact factors × visibility from what emits, as in `MonteCarlo`; all other light is exchanged between groups of patches,
each with as many rays as a group is worth, and spread smoothly over their patches. Where something stands close by
(corners, contacts, small things), light is not smooth: groups there are given up, and their patches send rays of
their own. What is a group and what is not is found out by a few rays of each.
"""

from __future__ import annotations

import itertools
import math
import time
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array, diags_array, hstack

from ..errors import ParameterError
from ..parallel import blocks, ordered_map
from ..patches import Patches
from ..progress import Progress, quiet
from ..rays import Tracer
from ..sequences import BITS_TO_UNIT, seed_key, sobol_points
from ..sparse import csr_matmul
from .assembly import RowBlock, Rows, count_hits, stack_rows
from .direct_light import DirectLight, Emitters, worthwhile_emitters
from .groups import CORNER_SAMPLES, Groups, group_patches
from .levels import Levels, TwoLevelFactors
from .monte_carlo import BATCH, Places, cosine_rays, ray_directions, ray_origins, ray_samples

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

GROUPS = 4096  # by default, about
SURVEY_RAYS = 256  # of each group, to find out what is near
NEAR = 1.0  # in widths of a group
NEAR_SHARE = 0.05  # of its rays: where more end so near, a group is given up
WHOLE_RAYS = 16  # along the surface of each group, to find out whether something parts it
GRAZE = 1e-3
MOST_LAMPS = 64  # emitting faces: every patch looks at each of them
ALL = 1.0 - 1e-6  # of a row that goes to the sky
SURVEY, COARSE, FINE, DIRECT = 1 << 40, (1 << 40) + 1, 0, (1 << 40) + 2  # keys of random numbers, below the seed's
DIRECT_BLOCK = 1 << 11  # patches


@dataclass(frozen=True)
class TwoLevel:
    """Form factors for more patches than a matrix of their own serves, from about 20 000.

    Parameters
    ----------
    rays : int
        Rays of each patch where geometry is near.
    group_rays : int
        Most rays of a group of patches; fewer where it has so few that theirs are not as many.
    light_rays : int
        Shadow rays between a patch and an emitting face where the first few disagree; see `MonteCarlo`.
    group : int, optional
        Patches along the side of a group. By default as many as make about 4096 groups of all patches, and at least 2.
    seed : int

    Raises
    ------
    ParameterError
        Numbers that make no sense; from `form_factors`, more emitting faces than every patch can look at.

    Examples
    --------
    >>> import radiosity as rad
    >>> patches = rad.subdivide(rad.scenes.cornell_box(), patch_count=3000)
    >>> factors = rad.form_factors(patches, TwoLevel(group_rays=256))
    >>> float(abs(factors.closure_defect).max()) < 1e-6
    True
    """

    rays: int = 128
    group_rays: int = 4096
    light_rays: int = 64
    group: int | None = None
    seed: int = 0

    def __post_init__(self) -> None:
        seed_key(self.seed)
        for name in ("rays", "group_rays", "light_rays"):
            if getattr(self, name) < 1:
                raise ParameterError(f"{name} is {getattr(self, name)}; give at least 1")
        if self.group is not None and self.group < 2:
            raise ParameterError(f"group is {self.group}; give at least 2 patches along the side, or use MonteCarlo()")

    def side(self, count: int) -> int:
        """Patches along the side of a group, of `count` patches in all."""
        return self.group or max(2, round(math.sqrt(count / GROUPS)))

    def factors(
        self,
        patches: Patches,
        tracer: Tracer,
        dtype: type[np.float32] | type[np.float64] = np.float32,
        threads: int | None = None,
        progress: Progress = quiet,
    ) -> TwoLevelFactors:
        """The form factors.

        Raises
        ------
        ParameterError
            Too many faces emit.
        """
        emitters = lamps(patches, self.light_rays)
        begin = time.perf_counter()
        groups = group_patches(patches, self.side(len(patches)))
        work = _Work(self, patches, tracer, groups, threads, progress)
        smooth = work.survey()
        senders = senders_of(groups, smooth)
        receivers = _Receivers.of(groups, senders, self)
        surveyed = time.perf_counter()
        rows = work.exchange(receivers, senders, dtype)
        exchanged = time.perf_counter()
        levels = Levels(
            senders.means(patches.area, dtype),
            reshaped(rows.matrix, len(senders)),
            csr_array((len(patches), len(receivers) + len(senders)), dtype=dtype),
            senders.of_patch,
            np.zeros(len(senders), dtype=bool),
            rows.to_sky,
            rows.to_backs,
            smooth,
            self.side(len(patches)),
        )
        made = work.lit(levels, emitters, dtype)
        made.statistics.update(
            {
                "levels/groups": len(senders.group),
                "levels/corners": len(receivers.group),
                "levels/patches alone": len(senders.patch),
                "rays/traced": int(receivers.rays.sum()) + SURVEY_RAYS * len(groups),
                "seconds/levels": surveyed - begin,
                "seconds/exchange": exchanged - surveyed,
                "seconds/direct light": time.perf_counter() - exchanged,
            }
        )
        return made


def lamps(patches: Patches, light_rays: int) -> Emitters | None:
    """What emits, as `worthwhile_emitters` finds it.

    Raises
    ------
    ParameterError
        More emitting faces than every patch can look at.
    """
    emitting = (patches.emission > 0).any(axis=1)
    if not emitting.any() or (patches.closed and emitting.all()):
        return None
    emitters = worthwhile_emitters(patches, MOST_LAMPS << 20, light_rays)
    assert emitters is not None
    if len(emitters) > MOST_LAMPS:
        raise ParameterError(
            f"{len(emitters)} faces emit, and on two levels every patch looks at each: more than {MOST_LAMPS} take too "
            "long. Use MonteCarlo(), or make fewer faces shine"
        )
    return emitters


class Senders(NamedTuple):
    """Smooth groups (numbers), then single patches; of_patch (N,) says which of them each patch is, or belongs to."""

    group: IntArray
    patch: IntArray
    of_patch: NDArray[np.int32]

    def __len__(self) -> int:
        return len(self.group) + len(self.patch)

    def means(self, area: FloatArray, dtype: type[np.floating]) -> csr_array:
        """Area-weighted means over the patches of each sender, (S, N)."""
        count = len(self)
        total = np.bincount(self.of_patch, area, count)
        order = np.argsort(self.of_patch, kind="stable")
        weight = (area / total[self.of_patch])[order].astype(dtype)
        ends = np.concatenate([[0], np.cumsum(np.bincount(self.of_patch, minlength=count))])
        arrays = weight, order.astype(np.int32), ends.astype(np.int32)
        return csr_array(arrays, shape=(count, len(area)), copy=False)


def senders_of(groups: Groups, smooth: BoolArray) -> Senders:
    """Senders: groups of which these are smooth, and the patches of the others."""
    group = np.flatnonzero(smooth)
    number = np.full(len(groups), -1, dtype=np.int32)
    number[group] = np.arange(len(group))
    of_patch = number[groups.of_patch]
    patch = np.flatnonzero(of_patch < 0)
    of_patch[patch] = np.arange(len(group), len(group) + len(patch))
    return Senders(group, patch, of_patch)


class _Receivers(NamedTuple):
    """Corners of smooth groups, those of most rays first, then single patches.

    point (G,) are lattice points in rising order of which `order` says the receiver; group and corner (G,) are a group
    at whose corner each receiver is; patch as in `Senders`; rays (R,).
    """

    point: IntArray
    order: IntArray
    group: IntArray
    corner: IntArray
    patch: IntArray
    rays: IntArray

    def __len__(self) -> int:
        return len(self.rays)

    @classmethod
    def of(cls, groups: Groups, senders: Senders, method: TwoLevel) -> _Receivers:
        """Those of the same groups and patches."""
        corners = groups.corners[senders.group]
        point, first = np.unique(corners, return_index=True)
        group, corner = senders.group[first // 4], first % 4
        worth = method.rays * 2 ** np.ceil(np.log2(np.maximum(groups.patches[group], 1))).astype(np.int64)
        rays = np.minimum(method.group_rays, worth)
        most_first = np.argsort(-rays, kind="stable")
        order = np.empty(len(point), dtype=np.int64)
        order[most_first] = np.arange(len(point))
        alone = np.full(len(senders.patch), method.rays)
        rays = np.concatenate([rays[most_first], alone])
        return cls(point, order, group[most_first], corner[most_first], senders.patch, rays)

    def at(self, point: IntArray) -> IntArray:
        """Receivers at lattice points."""
        return self.order[np.searchsorted(self.point, point)]


class _Work:
    """What is done with the rays."""

    def __init__(
        self,
        method: TwoLevel,
        patches: Patches,
        tracer: Tracer,
        groups: Groups,
        threads: int | None,
        progress: Progress,
    ) -> None:
        self.method, self.patches, self.tracer, self.groups = method, patches, tracer, groups
        self.threads, self.progress = threads, progress
        fine, coarse = patches.grid, groups.grid
        table = tracer.table._replace(columns=coarse.columns, rows=coarse.rows)
        self.of_groups = Places(table, groups.face, groups.side, coarse.front, coarse.back)
        self.of_patches = Places(tracer.table, patches.face, patches.side, fine.front, fine.back)

    def survey(self) -> BoolArray:
        """Which groups are smooth, (M,): nothing stands near or on them, and their patches would cost more."""
        run = seed_key(self.method.seed, SURVEY)
        points = _points(SURVEY_RAYS, run)
        reach = NEAR * self.tracer.scale * np.sqrt(self.groups.area)

        def block(span: tuple[int, int]) -> BoolArray:
            some = np.arange(*span)
            origins, directions = cosine_rays(self.of_groups, some, SURVEY_RAYS, points, run)
            apart = self._distance(origins, directions).reshape(len(some), SURVEY_RAYS)
            return ((apart < reach[some, None]).mean(axis=1) <= NEAR_SHARE) & self._whole(some, points)

        spans = blocks(len(self.groups), BATCH // SURVEY_RAYS)
        smooth = np.concatenate(list(ordered_map(block, spans, self.threads)))
        fine, coarse = self.patches.grid, self.groups.grid
        fewer = (coarse.columns.astype(np.int64) + 1) * (coarse.rows + 1) < fine.cells
        return smooth & fewer[self.groups.face]

    def _whole(self, some: IntArray, points: NDArray[np.uint32]) -> BoolArray:
        """Groups whose middle sees all of them, along their surface: nothing stands on them that would part them."""
        quad = self.groups.grid.faces.quad[self.groups.face[some]]
        spread = np.broadcast_to(points[:2, :WHOLE_RAYS].T * BITS_TO_UNIT, (len(some), WHOLE_RAYS, 2))
        to = np.concatenate([spread, CORNER_SAMPLES[np.where(quad, 0, 1)]], axis=1)
        rays = to.shape[1]
        middle, ends = (np.empty((len(some) * rays, 3), dtype=np.float32) for _ in range(2))
        ray_origins(self.of_groups, some, rays, np.ascontiguousarray(to.reshape(-1, 2).T), ends)
        centre = np.stack([np.where(quad, 0.5, 4.0 / 9.0), np.full(len(some), 0.5)])
        ray_origins(self.of_groups, some, rays, np.repeat(centre, rays, axis=1), middle)
        way = ends - middle
        free = self._distance(middle, way) > (1.0 - GRAZE) * np.linalg.norm(way, axis=1)
        return free.reshape(len(some), rays).all(axis=1)

    def _distance(self, origins: NDArray[np.float32], directions: NDArray[np.float32]) -> FloatArray:
        """Distance to the patch that each ray meets, in unit coordinates; infinite where it meets none."""
        patch, met = self.tracer.hits(origins, directions)
        return np.where(patch >= 0, np.linalg.norm(met - origins, axis=1), np.inf)

    def exchange(self, receivers: _Receivers, senders: Senders, dtype: type[np.float32] | type[np.float64]) -> Rows:
        """Rows (R, S) of all receivers: shares that arrive at each sender, as counted."""
        corners = len(receivers.group)
        runs = seed_key(self.method.seed, COARSE), seed_key(self.method.seed, FINE)
        points = {int(rays): _points(int(rays), runs[0]) for rays in np.unique(receivers.rays[:corners])}
        points_alone = _points(self.method.rays, runs[1])

        def block(span: tuple[int, int]) -> RowBlock:
            begin, end = span
            rays = int(receivers.rays[begin])
            if begin < corners:
                made = self._corner_rays(receivers, span, points[rays], runs[0])
            else:
                some = receivers.patch[begin - corners : end - corners]
                made = cosine_rays(self.of_patches, some, rays, points_alone, runs[1])
            hits = self.tracer.run(*made)
            met = np.where(hits >= 0, senders.of_patch[hits], hits)
            lengths, indices, counts, to_sky, to_backs = count_hits(met, end - begin, len(senders))
            return RowBlock(begin, lengths, indices, counts / rays, to_sky / rays, to_backs / rays)

        def told(done: int) -> None:
            self.progress("form factors", done, len(receivers))

        made = ordered_map(block, list(_spans(receivers)), self.threads)
        most = int(np.minimum(receivers.rays, len(senders)).sum())
        return stack_rows(made, len(receivers), most, 1.0, dtype, told)

    def _corner_rays(
        self, receivers: _Receivers, span: tuple[int, int], points: NDArray[np.uint32], run: np.uint64
    ) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """Rays from corners of groups: the first two of the numbers choose the direction."""
        group, corner, rays = receivers.group[slice(*span)], receivers.corner[slice(*span)], points.shape[1]
        samples = np.empty((4, len(group) * rays))
        ray_samples(4 * group + corner, rays, points, run, samples)
        samples[2:] = samples[:2]
        triangle = np.where(self.groups.grid.faces.quad[self.groups.face[group]], 0, 1)
        samples[:2] = np.repeat(CORNER_SAMPLES[triangle, corner].T, rays, axis=1)
        origins, directions = (np.empty((samples.shape[1], 3), dtype=np.float32) for _ in range(2))
        ray_origins(self.of_groups, group, rays, samples, origins)
        ray_directions(self.of_groups, group, rays, samples, directions)
        return origins, directions

    def lit(
        self, levels: Levels, emitters: Emitters | None, dtype: type[np.float32] | type[np.float64]
    ) -> TwoLevelFactors:
        """The factors, with straight paths from these emitters."""
        patches = self.patches
        emits = np.zeros(len(levels.emits), dtype=bool)
        if emitters is not None:
            emits[levels.sender[emitters.columns]] = True
        spread = _Spread(self, replace(levels, emits=emits), emitters)
        made_of = ordered_map(spread, blocks(len(patches), DIRECT_BLOCK), self.threads)
        rows = stack_rows(made_of, len(patches), len(patches) * spread.most, 1.0, dtype)
        matrix = reshaped(rows.matrix, levels.spread.shape[1])
        inside = rows.to_sky < ALL if patches.closed else np.zeros(len(patches), dtype=bool)
        made = TwoLevelFactors(
            replace(levels, spread=matrix, emits=emits),
            np.where(inside, 0.0, rows.to_sky),
            rows.to_backs,
            patches.area,
            patches.surface,
            patches.surface_names,
            self.method,
            {"leaks/share": float(np.mean(np.where(inside, rows.to_sky, 0.0))), "rays/to emitters": rows.shadow_rays},
            None if emitters is None else emitters.columns,
            straight_to_new,
        )
        made.statistics.update({"matrix/non-zeros": made.non_zeros, "matrix/bytes": made.nbytes})
        return made


def _points(rays: int, run: np.uint64) -> NDArray[np.uint32]:
    return np.ascontiguousarray(sobol_points(rays, 4, int(run)).T)


def _spans(receivers: _Receivers) -> Iterator[tuple[int, int]]:
    """Blocks of receivers of one kind and of as many rays each."""
    corners = len(receivers.group)
    steps = 1 + np.flatnonzero(np.diff(receivers.rays[:corners]))
    for first, last in itertools.pairwise([0, *steps.tolist(), corners, len(receivers)]):
        if last > first:
            size = max(1, BATCH // int(receivers.rays[first]))
            yield from ((first + begin, first + end) for begin, end in blocks(last - first, size))


class _Spread:
    """Rows of `Levels.spread`: light of the receivers spread over patches, and straight paths from emitters."""

    def __init__(self, work: _Work, levels: Levels, emitters: Emitters | None) -> None:
        self.levels, self.groups = levels, work.groups
        self.receivers = _Receivers.of(work.groups, senders_of(work.groups, levels.smooth), work.method)
        others = csr_matmul(levels.exchange, (~levels.emits).astype(np.float64))
        self.shares = np.stack([others, levels.to_sky, levels.to_backs], axis=1)
        self.direct: DirectLight | None = None
        self.most = 4  # entries in a row
        if emitters is not None:
            method = work.method
            run = seed_key(method.seed, DIRECT)
            self.direct = DirectLight(work.patches, work.tracer, emitters, method.light_rays, run, "sobol")
            self.most += min(int(levels.emits.sum()), len(emitters) * method.light_rays)

    def __call__(self, span: tuple[int, int]) -> RowBlock:
        """Rows begin … end: closed by scaling what is spread, whatever the straight paths bring."""
        begin, end = span
        spread = self._spread(begin, end)
        straight, traced = self._straight(begin, end)
        brought = straight.sum(axis=1)
        shares = spread @ self.shares
        rest = shares.sum(axis=1)  # what does not come from emitters, as sampled
        only = (rest <= 0.0) | (brought > 1.0)
        scale = np.where(only, 0.0, 1.0 - brought) / np.where(rest > 0.0, rest, 1.0)
        full = np.where(only & (brought > 0.0), 1.0 / np.where(brought > 0.0, brought, 1.0), 1.0)
        rows = csr_array(hstack([diags_array(scale) @ spread, diags_array(full) @ straight], format="csr"))
        rows.sort_indices()
        return RowBlock(
            begin,
            np.diff(rows.indptr).astype(np.int64),
            rows.indices.astype(np.int32),
            rows.data,
            scale * shares[:, 1],
            scale * shares[:, 2],
            traced,
        )

    def _spread(self, begin: int, end: int) -> csr_array:
        """Weights (rows, R) of the light of the receivers."""
        patch, corners = np.arange(begin, end), len(self.receivers.group)
        inside = self.levels.smooth[self.groups.of_patch[patch]]
        point, weight = self.groups.spread(patch[inside])
        alone = corners + np.searchsorted(self.receivers.patch, patch[~inside])
        row = np.concatenate([np.repeat(np.flatnonzero(inside), 4), np.flatnonzero(~inside)])
        column = np.concatenate([self.receivers.at(point.ravel()), alone])
        weights = np.concatenate([weight.ravel(), np.ones(len(alone))])
        return csr_array((weights, (row, column)), shape=(end - begin, len(self.receivers)))

    def _straight(self, begin: int, end: int) -> tuple[csr_array, int]:
        """Exact factors × visibility (rows, P) of the emitters, by element; and how many shadow rays it took."""
        shape = (end - begin, len(self.levels.emits))
        if self.direct is None:
            return csr_array(shape), 0
        (lengths, indices, weights), traced = self.direct.entries(begin, end)
        pointers = np.concatenate([[0], np.cumsum(lengths)])
        rows = csr_array((weights, self.levels.sender[indices], pointers), shape=shape)
        rows.sum_duplicates()
        return rows, traced


def reshaped(matrix: csr_array, columns: int) -> csr_array:
    """The same entries with another number of columns."""
    shape = (matrix.shape[0], columns)
    return csr_array((matrix.data, matrix.indices, matrix.indptr), shape=shape, copy=False)


def straight_to_new(factors: TwoLevelFactors, patches: Patches) -> TwoLevelFactors:
    """The same factors with straight paths from what emits in `patches`, besides those that they have."""
    method = factors.estimator
    assert isinstance(method, TwoLevel)
    known = np.zeros(len(patches), dtype=bool) if factors.exact_columns is None else factors.exact_columns
    bright = (patches.emission > 0).any(axis=1) | known
    emitters = lamps(replace(patches, emission=bright[:, None].astype(np.float64)), method.light_rays)
    levels = factors.levels
    work = _Work(method, patches, Tracer(patches.grid), group_patches(patches, levels.side), None, quiet)
    made = work.lit(levels, emitters, levels.exchange.dtype.type)
    return TwoLevelFactors(
        made.levels,
        made.to_sky,
        made.to_backs,
        made.area,
        made.surface,
        made.surface_names,
        method,
        {**factors.statistics, **made.statistics},
        made.exact_columns,
        straight_to_new,
    )
