"""Rays aimed at patches that are far brighter than the rest, such as the ceiling around a lamp that hangs below it.

Rays at random seldom meet them, and with great effect. Both kinds of rays are weighed by the balance heuristic (Veach &
Guibas 1995, doi:10.1145/218380.218498).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..compiled import kernel
from ..face_points import patch_point
from ..patches import Patches
from ..sequences import BITS_TO_UNIT, high_bits, key
from .kernels import FloatArray
from .share import TILE, part_of

BRIGHT = 4.0  # times the mean radiosity, over which rays are aimed at a patch
WORTHWHILE = 0.005  # share of all reflected power that must leave such patches for the trouble
NOWHERE, ANYWHERE = -2, -1  # goals of rays that are no patches


class Targets(NamedTuple):
    """Bright patches that rays are aimed at.

    patch (B,), and cell (B,): its number on its side of its face; cumulated (B,) chance to choose each; density (N,) of
    aimed rays over all patches, per unit of area and ray: 0 where none is aimed at.
    """

    patch: NDArray[np.int32]
    cell: NDArray[np.int32]
    cumulated: FloatArray
    density: FloatArray


def bright_patches(
    patches: Patches, bright: FloatArray, scale: float, gather: Callable[[FloatArray], FloatArray]
) -> Targets:
    """Patches that are brighter than `BRIGHT` times the mean, chosen by the excess that they send to all others.

    Parameters
    ----------
    patches : Patches
    bright : ndarray (N,)
        Radiosity that is reflected.
    scale : float
        Unit coordinates per metre.
    gather : callable
        Product with the form factors: of the bright patches' light, what they do not send to each other counts.
    """
    area, grid = patches.area * scale**2, patches.grid
    power = area * bright
    excess = np.maximum(0.0, bright - BRIGHT * power.sum() / area.sum())
    chance = area * excess * np.clip(1.0 - gather((excess > 0.0).astype(np.float64)), 0.0, 1.0)
    if chance.sum() <= WORTHWHILE * power.sum():
        chance[:] = 0.0
    else:
        chance /= chance.sum()
    patch = np.flatnonzero(chance).astype(np.int32)
    first = np.where(patches.side > 0, grid.front[patches.face], grid.back[patches.face])
    return Targets(patch, patch - first[patch], np.cumsum(chance[patch]), chance / area)


@kernel
def density_of_rays(room, i, x, j, y):  # type: ignore[no-untyped-def]
    """Random rays from x on patch i per area at y on patch j, cos θ cos θ' / π r²; 0 if one is behind the other."""
    n, m = room.normal[i], room.normal[j]
    dx, dy, dz = y[0] - x[0], y[1] - x[1], y[2] - x[2]
    here = dx * n[0] + dy * n[1] + dz * n[2]
    there = -(dx * m[0] + dy * m[1] + dz * m[2])
    if here <= 0.0 or there <= 0.0:
        return 0.0
    r2 = dx * dx + dy * dy + dz * dz
    return here * there / (np.pi * r2 * r2)


@kernel
def _place(cumulated, u):  # type: ignore[no-untyped-def]
    """First of some increasing numbers that is above u, or the last."""
    low, high = 0, cumulated.shape[0] - 1
    while low < high:
        middle = (low + high) // 2
        if cumulated[middle] > u:
            high = middle
        else:
            low = middle + 1
    return low


@kernel
def aimed_rays(room, table, targets, ground, draw, goal, rays):  # type: ignore[no-untyped-def]
    """Rays to points of the targets; returns how many. See `gather.gather_rays`; goal is `NOWHERE` or the patch."""
    part = draw.numbers.shape[0] // (TILE * TILE)
    rays_each = part // draw.samples
    target, shuffle = np.empty(3), np.empty(3, dtype=np.uint32)
    filled = 0
    for r in range(ground.piece.shape[0]):
        i, x = ground.patch[r], ground.points[r]
        for k in range(r * rays_each, (r + 1) * rays_each):
            goal[k] = NOWHERE
        if ground.piece[r] < 0:
            continue
        pixel = draw.first_pixel + r // draw.samples
        for d in range(3):
            shuffle[d] = high_bits(key(key(np.uint64(draw.run), np.uint64(pixel)), d)) & draw.loose
        first = part_of(pixel, draw.width) * part + (r % draw.samples) * rays_each
        for k in range(rays_each):
            number = draw.numbers[first + k]
            place = _place(targets.cumulated, (number[0] ^ shuffle[0]) * BITS_TO_UNIT)
            j = targets.patch[place]
            s, t = (number[1] ^ shuffle[1]) * BITS_TO_UNIT, (number[2] ^ shuffle[2]) * BITS_TO_UNIT
            patch_point(table, room.face[j], targets.cell[place], 0.0, s, t, target)
            if density_of_rays(room, i, x, j, target) > 0.0:
                goal[r * rays_each + k] = j
                for c in range(3):
                    rays.origins[filled, c] = x[c]
                    rays.directions[filled, c] = target[c] - x[c]
                filled += 1
    return filled
