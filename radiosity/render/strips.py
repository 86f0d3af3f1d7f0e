"""Some pixels of a picture: what they see, and the rays that go on from there."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..face_points import whole_faces
from ..patches import Patches
from ..rays import Tracer
from ..sequences import BITS_TO_UNIT, seed_key, sobol_points
from .aim import Targets, aimed_rays
from .gather import Near, add_near, gather_rays, near_rays, sum_gathered
from .kernels import Draw, FloatArray, Ground, Landed, Pieces, Rays, Room, View, find_pieces, primary_rays
from .lamps import (
    Sums,
    count_seen,
    direct_irradiance,
    emitters_of,
    look_for_emitters,
    shadow_rays,
)
from .share import MOMENTS, TILE

GATHER_RAYS = 4  # of each sample of a pixel
SHADOW_RAYS = (4, 12)  # of each sample: at first, and more where an emitter turns out to be partly hidden
LENS, SHADOW, GATHER, AIM, NEAR, NEAR_AIM = range(6)  # which random numbers are for what

IntArray = NDArray[np.int32]


class Light(NamedTuple):
    """The solved light of N patches, (N, C), W/m²: what they emit, what they reflect, what of that is direct light."""

    emission: FloatArray
    reflected: FloatArray
    direct: FloatArray


class Strip(NamedTuple):
    """Some pixels, before neighbours share what they gather.

    picture (pixels, C): light that is seen without a further ray; direct (P, C): irradiance straight from emitters;
    gathered (P, C + MOMENTS): means over the rays; rays (P,): how many.
    """

    picture: FloatArray
    pieces: Pieces
    direct: FloatArray
    gathered: FloatArray
    rays: FloatArray


class StripTracer:
    """Traces strips: from the number of the first pixel alone, so that threads do not matter."""

    def __init__(
        self,
        tracer: Tracer,
        camera_tracer: Tracer,
        patches: Patches,
        light: Light,
        targets: Targets,
        view: View,
        samples: int,
        seed: int,
    ) -> None:
        self.tracer, self.camera_tracer = tracer, camera_tracer
        self.targets, self.view, self.samples = targets, view, samples
        self.emitters = emitters_of(patches, tracer)
        self.table, self.whole = tracer.table, whole_faces(tracer.table)
        self.room = _room(patches, tracer, light, targets)
        self.passes_on = bool(light.direct.any())  # whether direct light goes on from patches at all
        self.seed = seed
        self.offsets = self._numbers(LENS, samples, 2) * BITS_TO_UNIT
        self.shadow = np.split(self._numbers(SHADOW, samples * sum(SHADOW_RAYS), 3), [samples * SHADOW_RAYS[0]])
        self.random = self._numbers(GATHER, TILE**2 * samples * GATHER_RAYS, 2)
        self.aimed = self._numbers(AIM, TILE**2 * samples * GATHER_RAYS, 3)

    def __call__(self, pixels: tuple[int, int]) -> Strip:
        """Trace the pixels begin … end, counted row by row."""
        first, count = pixels[0], pixels[1] - pixels[0]
        picture = np.zeros((count, len(self.room.sky)))
        ground, pieces = self._look(first, picture)
        direct = self._direct(first, ground, pieces)
        return Strip(picture, pieces, direct, *self._gather(first, ground, pieces))

    def _numbers(self, purpose: int, count: int, dimensions: int) -> NDArray[np.uint32]:
        return sobol_points(count, dimensions, int(seed_key(self.seed, purpose)) & 0x7FFFFFFF)

    def _draw(self, purpose: int, numbers: NDArray[np.uint32], first: int) -> Draw:
        """Numbers for the strip that begins with pixel `first`; the bits below the finest strata are loose."""
        loose = np.uint32(0xFFFFFFFF >> (len(numbers).bit_length() - 1) // 2)
        return Draw(numbers, self.samples, loose, seed_key(self.seed, purpose), first, self.view.width)

    def _look(self, first: int, picture: FloatArray) -> tuple[Ground, Pieces]:
        """Send the rays of the camera, and add to the picture what shines by itself."""
        rays = Rays.room_for(len(picture) * self.samples)
        primary_rays(self.view, first, self.offsets, rays)
        patch, points = self.camera_tracer.hits(*rays)
        ground = Ground(patch, points, np.empty(len(patch), dtype=np.int64))
        pieces = Pieces.room_for(len(picture), len(ground.piece), picture.shape[1])
        return ground, pieces.cut(find_pieces(self.room, ground, self.samples, pieces, picture))

    def _direct(self, first: int, ground: Ground, pieces: Pieces) -> FloatArray:
        """Irradiance of the pieces straight from emitters, (P, C)."""
        irradiance: FloatArray = np.zeros((len(pieces.tint), len(self.room.sky)))
        if not len(self.emitters.face):
            return irradiance
        sums = Sums.zeros(len(irradiance), len(self.emitters.face), irradiance.shape[1])
        look_for_emitters(self.room, self.emitters, ground, sums)
        wanted = np.ones(sums.seen.shape, dtype=np.bool_)
        for numbers in self.shadow:
            self._look_at_emitters(ground, sums, wanted, self._draw(SHADOW, numbers, first))
            wanted = (sums.seen > 0.0) & (sums.seen < sums.aimed)
        direct_irradiance(self.emitters, sums, irradiance)
        return irradiance

    def _look_at_emitters(self, ground: Ground, sums: Sums, wanted: NDArray[np.bool_], draw: Draw) -> None:
        """Send shadow rays to the emitters that are wanted (P, M), and count which arrive."""
        count = len(ground.piece) * len(draw.numbers) // self.samples
        emitter, weight, rays = np.empty(count, dtype=np.int32), np.empty(count), Rays.room_for(count)
        where = (self.room, self.emitters, self.whole, ground)
        sent = shadow_rays(*where, sums, wanted, draw, emitter, weight, rays)
        met = self.tracer.run(*rays.first(sent))
        count_seen(self.room, self.emitters, ground, emitter, weight, met, sums)

    def _gather(self, first: int, ground: Ground, pieces: Pieces) -> tuple[FloatArray, FloatArray]:
        """Means over the rays that go on from each piece (P, C + MOMENTS), and how many they are (P,)."""
        total = np.zeros((len(pieces.point), len(self.room.sky) + MOMENTS))
        goal = np.empty(len(ground.piece) * GATHER_RAYS, dtype=np.int32)
        rays = Rays.room_for(len(goal))
        sent = gather_rays(self.room, ground, self._draw(GATHER, self.random, first), goal, rays)
        self._land(ground, goal, rays.first(sent), total, seed_key(self.seed, NEAR, first))
        if len(self.targets.patch):
            draw = self._draw(AIM, self.aimed, first)
            sent = aimed_rays(self.room, self.table, self.targets, ground, draw, goal, rays)
            self._land(ground, goal, rays.first(sent), total, seed_key(self.seed, NEAR_AIM, first))
        count = pieces.samples.astype(np.float64) * GATHER_RAYS
        return total / count[:, None], count

    def _land(self, ground: Ground, goal: IntArray, rays: Rays, total: FloatArray, run: np.uint64) -> None:
        """Trace rays to their goals, add what they land on, and look at emitters from where they landed near."""
        landed = Landed(*self.tracer.hits(*rays))
        near = Near.room_for(len(landed.patch))
        count = sum_gathered(self.room, ground, goal, landed, total, near)
        if not (count and self.passes_on):
            return
        near = Near(near.ray[:count], near.piece[:count], near.share[:count])
        emitter, light, rays = np.empty(count, dtype=np.int32), np.empty(count), Rays.room_for(count)
        near_rays(self.room, self.emitters, self.whole, near, landed, run, emitter, light, rays)
        add_near(self.room, self.emitters, near, landed, emitter, light, self.tracer.run(*rays), total)


def _room(patches: Patches, tracer: Tracer, light: Light, targets: Targets) -> Room:
    sky = np.zeros_like(patches.sky) if patches.closed else np.pi * patches.sky  # in a closed scene a miss is a leak
    reflected = np.concatenate([light.reflected, np.zeros((1, patches.channels)), sky[None]])
    return Room(
        face=patches.face,
        side=patches.side,
        normal=np.ascontiguousarray(patches.normal),
        tangent=tracer.table.tangent[patches.face],
        size=np.sqrt(patches.area) * tracer.scale,
        emission=light.emission,
        reflectance=patches.reflectance,
        reflected=reflected,
        bright=reflected.sum(axis=1),
        direct=light.direct,
        density=targets.density,
        sky=patches.sky,
    )
