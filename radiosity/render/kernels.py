"""What pixels see: the camera's rays, and the pieces of surface that they meet."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..compiled import kernel

FloatArray = NDArray[np.float64]

FOLD = 32  # cos^FOLD: how much points count for each other whose faces make an angle; 0.6 at 10°, 0.01 at 30°
RISE = 0.2  # sine of the angle out of its plane at which a point sees another too high up to be of one surface
SAME = 0.5  # samples of a pixel this much alike make one piece


class Room(NamedTuple):
    """What rays meet: N patches in unit coordinates, and what is to be known of their light.

    face, side (N,): the face of each patch, and which side; normal, tangent (N, 3); size (N,): root of its area;
    emission, reflectance (N, C). reflected (N + 2, C): B - E of each patch, then 0 for black backs and π × radiance
    for the sky, so that rows N + 2 + MISS and N + 2 + BACK are right; bright (N + 2,): its sum over the channels;
    direct (N, C): what of it is light straight from emitters. density (N,): see `aim.Targets`. sky (C,): radiance.
    """

    face: NDArray[np.int32]
    side: NDArray[np.int8]
    normal: FloatArray
    tangent: FloatArray
    size: FloatArray
    emission: FloatArray
    reflectance: FloatArray
    reflected: FloatArray
    bright: FloatArray
    direct: FloatArray
    density: FloatArray
    sky: FloatArray


class View(NamedTuple):
    """A pinhole and its picture, in unit coordinates.

    The ray through pixel coordinates (x, y), y down, goes from `eye` (3,) in the direction corner + x right + y down.
    """

    eye: FloatArray
    corner: FloatArray
    right: FloatArray
    down: FloatArray
    width: int
    height: int


class Rays(NamedTuple):
    """Room for rays, (n, 3) each, in unit coordinates."""

    origins: NDArray[np.float32]
    directions: NDArray[np.float32]

    @classmethod
    def room_for(cls, count: int) -> Rays:
        """None yet."""
        return cls(np.empty((count, 3), dtype=np.float32), np.empty((count, 3), dtype=np.float32))

    def first(self, count: int) -> Rays:
        """Those that were filled in."""
        return Rays(self.origins[:count], self.directions[:count])


class Landed(NamedTuple):
    """What rays met: patch (n,), or `MISS` or `BACK`, and points (n, 3), lifted off it."""

    patch: NDArray[np.int32]
    points: FloatArray


class Ground(NamedTuple):
    """Where samples of pixels landed, S a pixel: as `Landed`, with the piece of each (n,), -1 where there is none."""

    patch: NDArray[np.int32]
    points: FloatArray
    piece: NDArray[np.int64]


class Draw(NamedTuple):
    """Which random numbers the samples of a strip draw.

    numbers (…, d): uint32 fractions; samples: S; loose: bits that may be shuffled without harm; run: the key that
    random numbers come from; first_pixel of the strip, and the width of the picture.
    """

    numbers: NDArray[np.uint32]
    samples: int
    loose: np.uint32
    run: np.uint64
    first_pixel: int
    width: int


class Pieces(NamedTuple):
    """Pieces of surface that pixels see: the samples of one pixel that are alike make one.

    begin (pixels + 1,): first piece of each pixel; point, normal (P, 3) of its first sample; samples (P,): how many;
    tint (P, C): radiance that it adds to the pixel for each W/m² of irradiance, Σ ρ / (π × samples of the pixel).
    """

    begin: NDArray[np.int64]
    point: FloatArray
    normal: FloatArray
    samples: NDArray[np.int64]
    tint: FloatArray

    @classmethod
    def room_for(cls, pixels: int, most: int, channels: int) -> Pieces:
        """Nothing seen yet."""
        vectors = np.empty((most, 3)), np.empty((most, 3))
        return cls(np.zeros(pixels + 1, np.int64), *vectors, np.zeros(most, np.int64), np.zeros((most, channels)))

    def cut(self, count: int) -> Pieces:
        """The first `count` pieces."""
        parts = self.point, self.normal, self.samples, self.tint
        return Pieces(self.begin, *(part[:count].copy() for part in parts))  # type: ignore[arg-type]


@kernel
def primary_rays(view, first_pixel, offsets, rays):  # type: ignore[no-untyped-def]
    """Rays of the pixels from `first_pixel` on, row by row, each through all `offsets` (S, 2) within its square."""
    samples = offsets.shape[0]
    for r in range(rays.origins.shape[0]):
        pixel = first_pixel + r // samples
        x = pixel % view.width + offsets[r % samples, 0]
        y = pixel // view.width + offsets[r % samples, 1]
        for c in range(3):
            rays.origins[r, c] = view.eye[c]
            rays.directions[r, c] = view.corner[c] + x * view.right[c] + y * view.down[c]


@kernel
def alike(p_normal, p, q_normal, q):  # type: ignore[no-untyped-def]
    """How far light that arrives at p tells of light that arrives at q, from 0 to 1.

    1 on one plane; less where faces make an angle, and nothing where one lies above the other's plane. Neither
    materials nor the edges between faces matter, only the shape.
    """
    cosine = p_normal[0] * q_normal[0] + p_normal[1] * q_normal[1] + p_normal[2] * q_normal[2]
    if cosine <= 0.5:
        return 0.0
    dx, dy, dz = q[0] - p[0], q[1] - p[1], q[2] - p[2]
    rise = max(
        abs(dx * p_normal[0] + dy * p_normal[1] + dz * p_normal[2]),
        abs(dx * q_normal[0] + dy * q_normal[1] + dz * q_normal[2]),
    )
    limit = RISE * RISE * (dx * dx + dy * dy + dz * dz)
    if rise * rise > limit:
        return 0.0
    same_plane = 1.0 - rise * rise / limit if limit > 0.0 else 1.0
    return same_plane * cosine**FOLD


@kernel
def find_pieces(room, ground, samples, pieces, picture):  # type: ignore[no-untyped-def]
    """Sort the samples of each pixel into pieces; returns how many there are.

    Writes `pieces` (with room for one a sample), ground.piece and, to picture (pixels, C), the light that needs no
    further ray: the sky and emission.
    """
    channels = picture.shape[1]
    count = 0
    for pixel in range(picture.shape[0]):
        for r in range(pixel * samples, (pixel + 1) * samples):
            j = ground.patch[r]
            ground.piece[r] = -1
            if j < 0:
                for c in range(channels):
                    picture[pixel, c] += room.sky[c] / samples
                continue
            at = pieces.begin[pixel]
            while at < count and alike(pieces.normal[at], pieces.point[at], room.normal[j], ground.points[r]) < SAME:
                at += 1
            if at == count:
                count += 1
                for c in range(3):
                    pieces.normal[at, c], pieces.point[at, c] = room.normal[j, c], ground.points[r, c]
            ground.piece[r] = at
            pieces.samples[at] += 1
            for c in range(channels):
                pieces.tint[at, c] += room.reflectance[j, c] / (np.pi * samples)
                picture[pixel, c] += room.emission[j, c] / (np.pi * samples)
        pieces.begin[pixel + 1] = count
    return count
