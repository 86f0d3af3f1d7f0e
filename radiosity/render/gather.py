"""Light that arrives after two bounces and more: rays from what pixels see into the solved room.

A ray brings home what the patch that it meets reflects. Where it meets one so close that the patch would be seen as
such, a shadow ray from there to an emitter replaces the patch's own direct light, and with it the blur of
shadows over the patch.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..compiled import kernel
from ..face_points import patch_point
from ..form_factors.monte_carlo import cosine_directions
from ..form_factors.polygon_kernels import MAX_CORNERS
from ..sequences import BITS_TO_UNIT, high_bits, key
from .aim import ANYWHERE, NOWHERE, density_of_rays
from .kernels import FloatArray
from .lamps import choose, unhidden
from .share import TILE, part_of

NEAR = 4.0  # sizes of a patch from which it is seen as such


class Near(NamedTuple):
    """Rays that landed near (K,): their number, the piece that sent them, the share of direct light left out."""

    ray: NDArray[np.int64]
    piece: NDArray[np.int64]
    share: FloatArray

    @classmethod
    def room_for(cls, rays: int) -> Near:
        """None yet."""
        return cls(np.empty(rays, dtype=np.int64), np.empty(rays, dtype=np.int64), np.empty(rays))


@kernel
def gather_rays(room, ground, draw, goal, rays):  # type: ignore[no-untyped-def]
    """Cosine-distributed rays from each sample that sees a surface; returns how many.

    Of the numbers drawn (TILE² × S × G, 2) each pixel of a tile uses a part of its own, each sample a part of that.
    Their `loose` bits are shuffled by a key of (run, pixel). goal (S × G of each pixel,) becomes `ANYWHERE` for each
    ray, and `NOWHERE` for those that are not sent.
    """
    part = draw.numbers.shape[0] // (TILE * TILE)
    rays_each = part // draw.samples
    s, t = np.empty(rays_each), np.empty(rays_each)
    filled = 0
    for r in range(ground.piece.shape[0]):
        for k in range(r * rays_each, (r + 1) * rays_each):
            goal[k] = ANYWHERE if ground.piece[r] >= 0 else NOWHERE
        if ground.piece[r] < 0:
            continue
        pixel = draw.first_pixel + r // draw.samples
        shuffle = key(np.uint64(draw.run), np.uint64(pixel))
        shuffle_s, shuffle_t = high_bits(key(shuffle, 0)) & draw.loose, high_bits(key(shuffle, 1)) & draw.loose
        first = part_of(pixel, draw.width) * part + (r % draw.samples) * rays_each
        for k in range(rays_each):
            s[k] = (draw.numbers[first + k, 0] ^ shuffle_s) * BITS_TO_UNIT
            t[k] = (draw.numbers[first + k, 1] ^ shuffle_t) * BITS_TO_UNIT
        i, out = ground.patch[r], rays.directions[filled : filled + rays_each]
        cosine_directions(room.tangent[i], room.normal[i], 1.0, s, t, out)
        for k in range(filled, filled + rays_each):
            for c in range(3):
                rays.origins[k, c] = ground.points[r, c]
        filled += rays_each
    return filled


@kernel
def sum_gathered(room, ground, goal, landed, total, near):  # type: ignore[no-untyped-def]
    """Add what the rays of each piece landed on; returns how many landed near.

    goal: where rays were sent; landed: what those that were sent met. Adds to total (P, C + MOMENTS) the radiosity
    met, weighed between rays at random and aimed rays, and the moments of `share`. Of rays that landed near, a share
    of the patch's direct light is left out, and put down in `near`.
    """
    patches, channels = room.emission.shape
    rays_each = goal.shape[0] // ground.piece.shape[0]
    found, ray = 0, -1
    for number in range(goal.shape[0]):
        aim = goal[number]
        if aim == NOWHERE:
            continue
        ray += 1
        r, j = number // rays_each, landed.patch[ray]
        p, x, y = ground.piece[r], ground.points[r], landed.points[ray]
        if aim >= 0 and (j < 0 or room.face[j] != room.face[aim] or room.side[j] != room.side[aim]):
            continue  # something is in the way
        if j < 0:
            for c in range(channels):
                total[p, c] += room.reflected[patches + 2 + j, c]
            total[p, channels + 2] += room.bright[patches + 2 + j] ** 2
            continue
        weight = 1.0
        if room.density[j] > 0.0:
            at_random = density_of_rays(room, ground.patch[r], x, j, y)
            weight = at_random / (at_random + room.density[j])
        distance = np.sqrt((y[0] - x[0]) ** 2 + (y[1] - x[1]) ** 2 + (y[2] - x[2]) ** 2)
        total[p, channels] += weight / distance
        total[p, channels + 1] += weight * room.bright[j] / distance
        total[p, channels + 2] += (weight * room.bright[j]) ** 2
        share = weight * max(0.0, min(1.0, 2.0 - 2.0 * distance / (NEAR * room.size[j])))
        for c in range(channels):
            total[p, c] += weight * room.reflected[j, c] - share * room.direct[j, c]
        if share > 0.0:
            near.ray[found], near.piece[found], near.share[found] = ray, p, share
            found += 1
    return found


@kernel
def near_rays(room, emitters, whole, near, landed, run, emitter, light, rays):  # type: ignore[no-untyped-def]
    """From each point where a ray landed near, a shadow ray to one emitter.

    light (K,): the irradiance, added up over the channels, that all emitters would bring if nothing hid them; emitter
    (K,) is -1 where that is none. Random numbers come from (run, ray).
    """
    heights, clipped, target = np.empty(4), np.empty((MAX_CORNERS, 3)), np.empty(3)
    bright = np.empty(emitters.face.shape[0])
    for k in range(near.ray.shape[0]):
        ray = near.ray[k]
        x = landed.points[ray]
        total = 0.0
        for e in range(bright.shape[0]):
            bright[e] = emitters.strength[e] * unhidden(
                emitters, e, x, room.normal[landed.patch[ray]], heights, clipped
            )
            total += bright[e]
        numbers = key(np.uint64(run), np.uint64(ray))
        e = choose(bright, total, high_bits(key(numbers, 0)) * BITS_TO_UNIT)
        s, t = high_bits(key(numbers, 1)) * BITS_TO_UNIT, high_bits(key(numbers, 2)) * BITS_TO_UNIT
        patch_point(whole, emitters.face[e], np.int32(0), 0.0, s, t, target)
        emitter[k], light[k] = e if total > 0.0 else -1, total
        for c in range(3):
            rays.origins[k, c] = x[c]
            rays.directions[k, c] = target[c] - x[c]


@kernel
def add_near(room, emitters, near, landed, emitter, light, met, total):  # type: ignore[no-untyped-def]
    """Add to total (P, C + MOMENTS) the direct light that is reflected where rays landed near."""
    for k in range(near.ray.shape[0]):
        e, j = emitter[k], met[k]
        if e < 0 or j < 0 or room.face[j] != emitters.face[e] or room.side[j] != emitters.side[e]:
            continue
        for c in range(room.emission.shape[1]):
            irradiance = light[k] * room.emission[j, c] / emitters.strength[e]
            total[near.piece[k], c] += near.share[k] * room.reflectance[landed.patch[near.ray[k]], c] * irradiance
