"""The rays of two levels: a survey of the groups, rows of what receives, and straight paths to all patches."""

from __future__ import annotations

import itertools
import time
from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array, hstack

from ..parallel import blocks, ordered_map
from ..patches import Patches
from ..progress import Progress
from ..rays import BACK, MISS, Tracer
from ..sequences import BITS_TO_UNIT, seed_key, sobol_points
from ..sparse import csr_matmul
from .assembly import Float, RowBlock, Rows, count_hits, stack_rows
from .direct_light import DirectLight, Emitters
from .elements import Receivers, Senders, senders_of
from .groups import CORNER_SAMPLES, Groups
from .levels import Again, Levels, TwoLevelFactors
from .monte_carlo import BATCH, Places, cosine_rays, ray_directions, ray_origins, ray_samples
from .shares import without_leaks
from .spot_check import spot_check

if TYPE_CHECKING:
    from .two_level import TwoLevel

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

SURVEY_RAYS = 256  # of each group, to find out what is near
NEAR = 1.0  # in widths of a group
NEAR_SHARE = 0.05  # of its rays: where more end so near, a group is given up
CORNER_RAYS = 64  # of each corner of a group that is left, to find out whether it alone sees something near
CORNER_SHARE = 0.2  # of its rays: below the quarter that a corner on which a wall ends sees of it
WHOLE_RAYS = 16  # along the surface of each group, to find out whether something parts it
GRAZE = 1e-3  # of such a ray's length: what it may miss by rounding
SURVEY, COARSE, FINE, DIRECT = 1 << 40, (1 << 40) + 1, 0, (1 << 40) + 2  # keys of random numbers, below the seed's
DIRECT_BLOCK = 1 << 11  # patches


class Work:
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

    def survey(self) -> tuple[BoolArray, int]:
        """Which groups are smooth, (M,): nothing stands near or on them, and their patches would cost more.

        And how many rays it took.
        """
        run = seed_key(self.method.seed, SURVEY)
        points = _points(SURVEY_RAYS, run)

        def block(span: tuple[int, int]) -> tuple[BoolArray, int]:
            some = np.arange(*span)
            smooth = self._open(some, points, run) & self._whole(some, points)
            left = some[smooth]
            smooth[smooth] = self._open_at_corners(left, points[:, :CORNER_RAYS], run)
            return smooth, len(some) * (SURVEY_RAYS + WHOLE_RAYS + 4) + len(left) * 4 * CORNER_RAYS

        spans = blocks(len(self.groups), BATCH // SURVEY_RAYS)
        found = list(ordered_map(block, spans, self.threads))
        smooth = np.concatenate([one for one, _ in found])
        fine, coarse = self.patches.grid, self.groups.grid
        fewer = (coarse.columns.astype(np.int64) + 1) * (coarse.rows + 1) < fine.cells
        return smooth & fewer[self.groups.face], sum(rays for _, rays in found)

    def _open(self, some: IntArray, points: NDArray[np.uint32], run: np.uint64) -> BoolArray:
        """Groups from all over which hardly a ray meets anything near."""
        rays = cosine_rays(self.of_groups, some, points.shape[1], points, run)
        near = self._distance(*rays).reshape(len(some), points.shape[1]) < self._reach(some)[:, None]
        return np.asarray(near.mean(axis=1) <= NEAR_SHARE)

    def _open_at_corners(self, some: IntArray, points: NDArray[np.uint32], run: np.uint64) -> BoolArray:
        """Groups none of whose corners looks into something that the rest of the group hardly sees, as a door's jamb.

        What arrives there would be spread over four groups.
        """
        group, corner = np.repeat(some, 4), np.tile(np.arange(4), len(some))
        rays = self._corner_rays(group, corner, points, run)
        near = self._distance(*rays).reshape(len(some), 4, points.shape[1]) < self._reach(some)[:, None, None]
        return np.asarray((near.mean(axis=2) <= CORNER_SHARE).all(axis=1))

    def _reach(self, some: IntArray) -> FloatArray:
        """How far what is near these groups may be from them, in unit coordinates."""
        return np.asarray(NEAR * self.tracer.scale * np.sqrt(self.groups.area[some]))

    def _whole(self, some: IntArray, points: NDArray[np.uint32]) -> BoolArray:
        """Groups whose middle sees all of them, along their surface: nothing stands on them that would part them."""
        quad = self.groups.grid.faces.quad[self.groups.face[some]]
        spread = np.broadcast_to(points[:2, :WHOLE_RAYS].T * BITS_TO_UNIT, (len(some), WHOLE_RAYS, 2))
        to = np.concatenate([spread, CORNER_SAMPLES[np.where(quad, 0, 1)]], axis=1)
        rays = to.shape[1]
        middle, ends = (np.empty((len(some) * rays, 3), dtype=np.float32) for _ in range(2))
        ray_origins(self.of_groups, some, np.ascontiguousarray(to.reshape(-1, 2).T), ends)
        centre = np.stack([np.where(quad, 0.5, 4.0 / 9.0), np.full(len(some), 0.5)])
        ray_origins(self.of_groups, some, np.repeat(centre, rays, axis=1), middle)
        way = ends - middle
        free = self._distance(middle, way) > (1.0 - GRAZE) * np.linalg.norm(way, axis=1)
        return free.reshape(len(some), rays).all(axis=1)

    def _distance(self, origins: NDArray[np.float32], directions: NDArray[np.float32]) -> FloatArray:
        """Distance to the patch that each ray meets, in unit coordinates; infinite where it meets none."""
        patch, met = self.tracer.hits(origins, directions)
        return np.where(patch >= 0, np.linalg.norm(met - origins, axis=1), np.inf)

    def exchange(self, receivers: Receivers, senders: Senders, dtype: Float) -> Rows:
        """Rows (R, S) of all receivers: shares that arrive at each sender, as counted."""
        corners = len(receivers.group)
        runs = seed_key(self.method.seed, COARSE), seed_key(self.method.seed, FINE)
        points = {int(rays): _points(int(rays), runs[0]) for rays in np.unique(receivers.rays[:corners])}
        points_alone = _points(self.method.rays, runs[1])
        sender = np.append(senders.of_patch, np.array([BACK, MISS], dtype=np.int32))  # from its end: -2 and -1

        def rows(span: tuple[int, int]) -> RowBlock:
            begin, end = span
            rays = int(receivers.rays[begin])
            if begin < corners:
                group, corner = receivers.group[begin:end], receivers.corner[begin:end]
                made = self._corner_rays(group, corner, points[rays], runs[0])
            else:
                some = receivers.patch[begin - corners : end - corners]
                made = cosine_rays(self.of_patches, some, rays, points_alone, runs[1])
            met = sender.take(self.tracer.run(*made))
            lengths, indices, counts, to_sky, to_backs = count_hits(met, end - begin, len(senders))
            block = RowBlock(begin, lengths, indices, counts, to_sky, to_backs)
            return block.finished(float(rays), dtype)

        def told(done: int) -> None:
            self.progress("form factors", done, len(receivers))

        made = ordered_map(rows, list(_spans(receivers)), self.threads)
        return stack_rows(made, len(receivers), dtype, told, len(senders), receivers.entries(len(senders)))

    def _corner_rays(
        self, group: IntArray, corner: IntArray, points: NDArray[np.uint32], run: np.uint64
    ) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """Rays from corners of groups: the first two of the numbers choose the direction."""
        rays = points.shape[1]
        samples = np.empty((4, len(group) * rays))
        ray_samples(4 * group + corner, rays, points, run, samples)
        samples[2:] = samples[:2]
        triangle = np.where(self.groups.grid.faces.quad[self.groups.face[group]], 0, 1)
        samples[:2] = np.repeat(CORNER_SAMPLES[triangle, corner].T, rays, axis=1)
        origins, directions = (np.empty((samples.shape[1], 3), dtype=np.float32) for _ in range(2))
        ray_origins(self.of_groups, group, samples, origins)
        ray_directions(self.of_groups, group, samples, directions)
        return origins, directions

    def lit(self, levels: Levels, emitters: Emitters | None, dtype: Float, again: Again) -> TwoLevelFactors:
        """The factors, with straight paths from these emitters."""
        patches = self.patches
        emits = np.zeros(len(levels.emits), dtype=bool)
        if emitters is not None:
            emits[levels.sender[emitters.columns]] = True
        spread = _Spread(self, replace(levels, emits=emits), emitters, dtype)
        made_of = ordered_map(spread, blocks(len(patches), DIRECT_BLOCK), self.threads)
        rows = stack_rows(made_of, len(patches), dtype, columns=levels.spread.shape[1])
        to_sky, leaks = without_leaks(rows.to_sky, patches)
        begin = time.perf_counter()
        check = spot_check(patches, self.tracer, self.method.seed, self.threads)
        seconds = time.perf_counter() - begin
        made = TwoLevelFactors(
            replace(levels, spread=rows.matrix, emits=emits),
            to_sky,
            rows.to_backs,
            patches.area,
            patches.surface,
            patches.surface_names,
            self.method,
            {"leaks/share": leaks, "rays/to emitters": rows.shadow_rays, "seconds/spot check": seconds},
            None if emitters is None else emitters.columns,
            again,
            check,
        )
        made.statistics.update({"matrix/non-zeros": made.non_zeros, "matrix/bytes": made.nbytes})
        return made


def _points(rays: int, run: np.uint64) -> NDArray[np.uint32]:
    return np.ascontiguousarray(sobol_points(rays, 4, int(run)).T)


def _spans(receivers: Receivers) -> Iterator[tuple[int, int]]:
    """Blocks of receivers of one kind and of as many rays each."""
    corners = len(receivers.group)
    steps = 1 + np.flatnonzero(np.diff(receivers.rays[:corners]))
    for first, last in itertools.pairwise([0, *steps.tolist(), corners, len(receivers)]):
        if last > first:
            size = max(1, BATCH // int(receivers.rays[first]))
            yield from ((first + begin, first + end) for begin, end in blocks(last - first, size))


class _Spread:
    """Rows of `Levels.spread`: light of the receivers spread over patches, and straight paths from emitters."""

    def __init__(self, work: Work, levels: Levels, emitters: Emitters | None, dtype: Float) -> None:
        self.levels, self.groups, self.dtype = levels, work.groups, dtype
        self.receivers = Receivers.of(
            work.groups, senders_of(work.groups, levels.smooth), work.method.rays, work.method.group_rays
        )
        others = csr_matmul(levels.exchange, (~levels.emits).astype(np.float64))
        self.shares = np.stack([others, levels.to_sky, levels.to_backs], axis=1)
        self.direct: DirectLight | None = None
        if emitters is not None:
            method = work.method
            run = seed_key(method.seed, DIRECT)
            self.direct = DirectLight(work.patches, work.tracer, emitters, method.light_rays, run, "sobol")

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
        for part, factor in ((spread, scale), (straight, full)):  # in place: a product would touch every column
            part.data *= np.repeat(factor, np.diff(part.indptr))
        rows = csr_array(hstack([spread, straight], format="csr"))
        rows.eliminate_zeros()
        rows.sort_indices()
        return RowBlock(
            begin,
            np.diff(rows.indptr).astype(np.int64),
            rows.indices.astype(np.int32),
            rows.data.astype(self.dtype),
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
        (lengths, indices, weights), traced = self.direct.entries(np.arange(begin, end))
        pointers = np.concatenate([[0], np.cumsum(lengths)])
        rows = csr_array((weights, self.levels.sender[indices], pointers), shape=shape)
        rows.sum_duplicates()
        return rows, traced
