"""Light straight from emitters to the points that pixels see.

What an emitter would bring if nothing were in between has a closed form (Lambert's), exact also where the emitter is
large, or a hand's breadth away. To shadow rays is left the one question how much of it is hidden: which share of the
kernel cos θ cos θ' / r² over the emitter is seen. Where all is seen, or nothing, there is no noise.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..compiled import kernel
from ..face_points import patch_point
from ..form_factors.polygon_kernels import MAX_CORNERS, clip_to_front, lambert
from ..patches import Patches
from ..rays import Tracer
from ..sequences import BITS_TO_UNIT, high_bits, key
from .kernels import FloatArray

FAR2 = 30.0**2  # (distance / radius)² beyond which an emitter counts as a point: 0.1 % off
LOOKS = 4  # samples of a piece that tell how much of an emitter all of them see, if nothing is in between
ON_PLANE = 1e-12  # height over a plane, in unit coordinates, that is rounding


class Emitters(NamedTuple):
    """M sides of faces that emit, in unit coordinates.

    face, side (M,); corners (M, 4, 3) counter-clockwise from the side that emits, corner_count (M,); normal, centre
    (M, 3); area, radius2 (M,): square of the greatest distance of a corner from the centre; emission (M, C): mean
    exitance; strength (M,): its sum over the channels.
    """

    face: NDArray[np.int32]
    side: FloatArray
    corners: FloatArray
    corner_count: NDArray[np.int64]
    normal: FloatArray
    centre: FloatArray
    area: FloatArray
    radius2: FloatArray
    emission: FloatArray
    strength: FloatArray


class Sums(NamedTuple):
    """What is found out about the M emitters for each of P pieces.

    looks (P,): samples that have looked for emitters, and share (P, M) of their view that each would be, added up; over
    shadow rays, the kernel aimed at each emitter and the kernel seen (P, M), and that times emission (P, M, C).
    """

    looks: NDArray[np.int64]
    share: FloatArray
    aimed: FloatArray
    seen: FloatArray
    light: FloatArray

    @classmethod
    def zeros(cls, pieces: int, emitters: int, channels: int) -> Sums:
        """Nobody has looked."""
        none = (pieces, emitters)
        sums = np.zeros(none), np.zeros(none), np.zeros(none)
        return cls(np.zeros(pieces, dtype=np.int64), *sums, np.zeros((*none, channels)))


def emitters_of(patches: Patches, tracer: Tracer) -> Emitters:
    """The emitting sides of faces. Emission that differs along a side is looked up where shadow rays end."""
    faces = patches.grid.faces
    power = np.zeros((2 * len(faces), patches.channels))
    np.add.at(power, 2 * patches.face + (patches.side < 0), patches.area[:, None] * patches.emission)
    lit = np.flatnonzero(power.any(axis=1))
    face, back, quad = lit // 2, lit % 2 == 1, faces.quad[lit // 2]
    corners = tracer.to_unit(faces.corners[face])
    turned = np.where(quad[:, None], [0, 3, 2, 1], [0, 2, 1, 1])
    corners = np.where(back[:, None, None], np.take_along_axis(corners, turned[..., None], axis=1), corners)
    centre = np.where(quad[:, None], corners.mean(axis=1), corners[:, :3].mean(axis=1))
    emission = power[lit] / faces.area[face, None]
    side = np.where(back, -1.0, 1.0)
    return Emitters(
        face=face.astype(np.int32),
        side=side,
        corners=np.ascontiguousarray(corners),
        corner_count=np.where(quad, 4, 3),
        normal=side[:, None] * faces.normal[face],
        centre=centre,
        area=faces.area[face] * tracer.scale**2,
        radius2=((corners - centre[:, None]) ** 2).sum(axis=2).max(axis=1, initial=0.0),
        emission=emission,
        strength=emission.sum(axis=1),
    )


@kernel
def unhidden(emitters, e, point, normal, heights, clipped):  # type: ignore[no-untyped-def]
    """Form factor from a surface element at `point` to emitter e, nothing being in between.

    heights (4,), clipped (MAX_CORNERS, 3) are room to work in.
    """
    dx = emitters.centre[e, 0] - point[0]
    dy = emitters.centre[e, 1] - point[1]
    dz = emitters.centre[e, 2] - point[2]
    m = emitters.normal[e]
    there = -(dx * m[0] + dy * m[1] + dz * m[2])
    if there <= ON_PLANE:
        return 0.0
    count = emitters.corner_count[e]
    low, high = np.inf, -np.inf
    for k in range(count):
        c = emitters.corners[e, k]
        height = (c[0] - point[0]) * normal[0] + (c[1] - point[1]) * normal[1] + (c[2] - point[2]) * normal[2]
        heights[k], low, high = height, min(low, height), max(high, height)
    if high <= ON_PLANE:
        return 0.0
    r2 = dx * dx + dy * dy + dz * dz
    if r2 > FAR2 * emitters.radius2[e] and low >= 0.0:
        here = dx * normal[0] + dy * normal[1] + dz * normal[2]
        return here * there * emitters.area[e] / (np.pi * r2 * r2)
    if low >= -ON_PLANE:
        return max(0.0, lambert(point[0], point[1], point[2], normal, emitters.corners[e], count)) / (2.0 * np.pi)
    count = clip_to_front(emitters.corners[e], count, heights, ON_PLANE, clipped)
    return max(0.0, lambert(point[0], point[1], point[2], normal, clipped, count)) / (2.0 * np.pi)


@kernel
def choose(weights, total, u):  # type: ignore[no-untyped-def]
    """Which of some weights the number u in [0, 1) falls on."""
    rest = u * total
    for e in range(weights.shape[0]):
        rest -= weights[e]
        if rest < 0.0 and weights[e] > 0.0:
            return e
    last = weights.shape[0] - 1
    while last > 0 and weights[last] <= 0.0:
        last -= 1
    return last


@kernel
def look_for_emitters(room, emitters, ground, sums):  # type: ignore[no-untyped-def]
    """Add to sums.share what share of their view each emitter would be to the first samples of each piece."""
    heights, clipped = np.empty(4), np.empty((MAX_CORNERS, 3))
    for r in range(ground.piece.shape[0]):
        p = ground.piece[r]
        if p < 0 or sums.looks[p] == LOOKS:
            continue
        sums.looks[p] += 1
        for e in range(emitters.face.shape[0]):
            sums.share[p, e] += unhidden(emitters, e, ground.points[r], room.normal[ground.patch[r]], heights, clipped)


@kernel
def shadow_rays(room, emitters, whole, ground, sums, wanted, draw, emitter, weight, rays):  # type: ignore[no-untyped-def]
    """Rays from what pixels see to the emitters that are wanted (P, M); returns how many.

    Emitters are chosen by what they would bring. Ray k of sample r goes, if it is of any use, to emitter[r × K + k]
    (-1 if not) and counts weight: its share in that emitter's kernel. The numbers drawn (S × K, 3) are shifted for each
    pixel by a key of (run, pixel). Points on emitters are those of `whole_faces`.
    """
    samples = draw.samples
    rays_each = draw.numbers.shape[0] // samples
    bright, target, shift = np.empty(emitters.face.shape[0]), np.empty(3), np.empty(3, dtype=np.uint32)
    filled = 0
    for r in range(ground.piece.shape[0]):
        p, x, n = ground.piece[r], ground.points[r], room.normal[ground.patch[r]]
        for k in range(r * rays_each, (r + 1) * rays_each):
            emitter[k] = -1
        if r % samples == 0:
            pixel = key(np.uint64(draw.run), np.uint64(draw.first_pixel + r // samples))
            for d in range(3):
                shift[d] = high_bits(key(pixel, d))
        if p < 0:
            continue
        total = 0.0
        for e in range(bright.shape[0]):
            bright[e] = sums.share[p, e] * emitters.strength[e] if wanted[p, e] else 0.0
            total += bright[e]
        if total <= 0.0:
            continue
        for k in range(rays_each):
            number = draw.numbers[(r % samples) * rays_each + k]
            e = choose(bright, total, (number[0] ^ shift[0]) * BITS_TO_UNIT)
            s, t = (number[1] ^ shift[1]) * BITS_TO_UNIT, (number[2] ^ shift[2]) * BITS_TO_UNIT
            patch_point(whole, emitters.face[e], np.int32(0), 0.0, s, t, target)  # not lifted: rays end on it
            m = emitters.normal[e]
            dx, dy, dz = target[0] - x[0], target[1] - x[1], target[2] - x[2]
            here, there = dx * n[0] + dy * n[1] + dz * n[2], -(dx * m[0] + dy * m[1] + dz * m[2])
            if here <= 0.0 or there <= 0.0:
                continue
            r2 = dx * dx + dy * dy + dz * dz
            emitter[r * rays_each + k] = e
            weight[r * rays_each + k] = here * there / (r2 * r2)
            for c in range(3):
                rays.origins[filled, c] = x[c]
                rays.directions[filled, c] = target[c] - x[c]
            filled += 1
    return filled


@kernel
def count_seen(room, emitters, ground, emitter, weight, met, sums):  # type: ignore[no-untyped-def]
    """Add to the sums which of the shadow rays reached the emitter that they were sent to."""
    rays_each = emitter.shape[0] // ground.piece.shape[0]
    at = 0
    for ray in range(emitter.shape[0]):
        e = emitter[ray]
        if e < 0:
            continue
        j = met[at]
        at += 1
        p = ground.piece[ray // rays_each]
        sums.aimed[p, e] += weight[ray]
        if j >= 0 and room.face[j] == emitters.face[e] and room.side[j] == emitters.side[e]:
            sums.seen[p, e] += weight[ray]
            for c in range(sums.light.shape[2]):
                sums.light[p, e, c] += weight[ray] * room.emission[j, c]


@kernel
def direct_irradiance(emitters, sums, irradiance):  # type: ignore[no-untyped-def]
    """Irradiance (P, C) from all emitters: what each would bring, times the share of its kernel that is seen.

    An emitter that no ray was sent to counts as hidden as the others are.
    """
    for p in range(irradiance.shape[0]):
        for c in range(irradiance.shape[1]):
            bright = unhidden_bright = rest = 0.0
            for e in range(emitters.face.shape[0]):
                share = sums.share[p, e] / sums.looks[p]
                if sums.aimed[p, e] > 0.0:
                    bright += share * sums.light[p, e, c] / sums.aimed[p, e]
                    unhidden_bright += share * emitters.emission[e, c]
                else:
                    rest += share * emitters.emission[e, c]
            visible = bright / unhidden_bright if unhidden_bright > 0.0 else 1.0
            irradiance[p, c] = bright + rest * visible
