"""Walks under way: a block of patches sends them out, a step at a time, and adds up what they find."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..patches import Patches
from ..rays import MISS, Tracer
from ..sequences import seed_key
from .kernels import (
    Ground,
    Walks,
    add_seen,
    add_to_patches,
    add_to_walks,
    cosine_rays,
    fresh_points,
    meet,
    roulette,
    shadow_rays,
    walk_keys,
)

if TYPE_CHECKING:
    from .tracer import PathTracer

FloatArray = NDArray[np.float64]
Float32Array = NDArray[np.float32]

BATCH = 1 << 15  # walks at a time: their state stays in cache


@dataclass(frozen=True, eq=False)
class Tally:
    """Sums over walks, and sums of their squares: per order (K, N, C), and of whole walks (N, C)."""

    orders: FloatArray
    squares: FloatArray
    total: FloatArray
    total_squares: FloatArray
    rays: NDArray[np.int64]  # traced, to emitters, leaked

    @classmethod
    def zeros(cls, count: int, bounces: int, channels: int) -> Tally:
        """Nothing found yet."""
        by_order, whole = (bounces, count, channels), (count, channels)
        return cls(np.zeros(by_order), np.zeros(by_order), np.zeros(whole), np.zeros(whole), np.zeros(3, np.int64))

    def put(self, begin: int, end: int, part: Tally) -> None:
        """Take over the sums of the patches begin … end."""
        self.orders[:, begin:end], self.squares[:, begin:end] = part.orders, part.squares
        self.total[begin:end], self.total_squares[begin:end] = part.total, part.total_squares
        self.rays[:] += part.rays


class BlockOfWalks:
    """All walks of the patches begin … end, a batch at a time."""

    def __init__(self, method: PathTracer, patches: Patches) -> None:
        self.method = method
        self.closed = patches.closed
        self.tracer = Tracer(patches.grid)
        self.ground = _ground(patches, self.tracer, method.next_event)
        self.run = seed_key(method.seed)
        self.looks = len(self.ground.emitters) > 0

    def __call__(self, block: tuple[int, int]) -> Tally:
        """Walk."""
        begin, end = block
        channels = self.ground.emission.shape[1]
        tally = Tally.zeros(end - begin, self.method.bounces, channels)
        for first in range(0, self.method.paths, BATCH):
            paths = min(BATCH, self.method.paths - first)
            total = np.zeros(((end - begin) * paths, channels))
            self._walk(self._set_out(begin, end, first, paths), paths, tally, total)
            add_to_patches(np.arange(len(total)), paths, total, tally.total, tally.total_squares)
        return tally

    def _set_out(self, begin: int, end: int, first: int, paths: int) -> Walks:
        """Walks `first` … `first + paths` of each patch that reflects."""
        number = np.arange((end - begin) * paths, dtype=np.int32)
        keys = np.empty(len(number), dtype=np.uint64)
        walk_keys(self.run, begin, first, paths, keys)
        patch = begin + number // np.int32(paths)
        weight = self.ground.reflectance[patch]
        return _kept(Walks(number, keys, patch, np.zeros((len(number), 3)), weight), (weight > 0).any(axis=1))

    def _walk(self, walks: Walks, paths: int, tally: Tally, total: FloatArray) -> None:
        """Go on until all walks have ended, adding what each finds."""
        order = 1
        while len(walks.patch):
            found = np.zeros(walks.weight.shape)
            if order == 1 or self.method.transport == "patches":
                fresh_points(self.ground, walks, order)
            if self.looks:
                self._look_at_emitters(walks, order, found, tally)
            alive = self._step(walks, order, found, tally)
            add_to_walks(walks, found, total)
            if order <= self.method.bounces:
                add_to_patches(walks.number, paths, found, tally.orders[order - 1], tally.squares[order - 1])
            walks = _kept(walks, alive)
            if order >= self.method.bounces:
                if not self.method.tail:
                    return
                walks = _kept(walks, roulette(walks, order))
            order += 1

    def _look_at_emitters(self, walks: Walks, order: int, found: FloatArray, tally: Tally) -> None:
        """Add the light of one point of an emitter for each walk, where nothing hides it."""
        emitter, share = np.empty(len(walks.patch), dtype=np.int32), np.empty(len(walks.patch))
        origins, directions = _room_for_rays(walks)
        faced = shadow_rays(self.ground, walks, order, emitter, share, origins, directions)
        met = self.tracer.run(origins[:faced], directions[:faced])
        add_seen(self.ground, walks, met, emitter, share, found)
        tally.rays[1] += faced

    def _step(self, walks: Walks, order: int, found: FloatArray, tally: Tally) -> NDArray[np.bool_]:
        """Send each walk on, add the light it meets, and tell which can still find more."""
        origins, directions = _room_for_rays(walks)
        cosine_rays(self.ground, walks, order, origins, directions)
        if self.looks or self.method.transport == "continuous":
            met, points = self.tracer.hits(origins, directions)
        else:
            met, points = self.tracer.run(origins, directions), walks.points
        alive = np.empty(len(met), dtype=np.bool_)
        meet(self.ground, walks, met, points, found, alive)
        tally.rays[0] += len(met)
        tally.rays[2] += int((met == MISS).sum()) if self.closed else 0
        return alive


def _room_for_rays(walks: Walks) -> tuple[Float32Array, Float32Array]:
    return np.empty(walks.points.shape, dtype=np.float32), np.empty(walks.points.shape, dtype=np.float32)


def _kept(walks: Walks, alive: NDArray[np.bool_]) -> Walks:
    """The walks that go on."""
    if alive.all():
        return walks
    number, keys, patch, points, weight = walks
    return Walks(number[alive], keys[alive], patch[alive], points[alive], weight[alive])


def _ground(patches: Patches, tracer: Tracer, next_event: bool) -> Ground:
    """The patches as walks need them. Emitters are chosen by power; there are none to look at without `next_event`."""
    grid = patches.grid
    power = patches.area * patches.emission.sum(axis=1) * next_event
    chance = power / (power.sum() or 1.0)
    emitters = np.flatnonzero(power > 0).astype(np.int32)
    cumulated = np.cumsum(chance[emitters])
    return Ground(
        table=tracer.table,
        face=patches.face,
        side=patches.side,
        first=np.where(patches.side > 0, grid.front[patches.face], grid.back[patches.face]),
        emission=patches.emission,
        reflectance=patches.reflectance,
        sky=np.zeros(patches.channels) if patches.closed else np.pi * patches.sky,
        emitters=emitters,
        cumulated=cumulated,
        density=chance / (patches.area * tracer.scale**2),
    )
