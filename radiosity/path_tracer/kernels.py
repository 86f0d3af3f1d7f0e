"""Kernels that move many walks by one step.

Nothing here is shared with the estimators of form factors but where the sample points of a patch are: what the two
agree on, neither got wrong alone.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..compiled import kernel
from ..face_points import FaceTable, patch_point
from ..rays import MISS
from ..sequences import BITS_TO_UNIT, high_bits, key

FloatArray = NDArray[np.float64]

SURVIVAL = 0.95  # greatest chance to go on past the last order, so that walks end even where nothing absorbs

# Which random number of a walk's step is for what.
POINT_S, POINT_T, RADIUS, ANGLE, EMITTER, EMITTER_S, EMITTER_T, ROULETTE = range(8)


class Ground(NamedTuple):
    """What walks walk on: N patches in unit coordinates, their materials, the sky, M emitters to look at.

    face, side (N,) of each patch and first (N,) patch on that side of the face; emission, reflectance (N, C); sky
    (C,) as the radiosity that an open direction seems to have; emitters (M,) patches, cumulated (M,) chance to choose
    each, and density (N,) of the chosen points per area: 0 on patches that are not looked at.
    """

    table: FaceTable
    face: NDArray[np.int32]
    side: NDArray[np.int8]
    first: NDArray[np.int32]
    emission: FloatArray
    reflectance: FloatArray
    sky: FloatArray
    emitters: NDArray[np.int32]
    cumulated: FloatArray
    density: FloatArray


class Walks(NamedTuple):
    """n walks under way, sorted by the patch that sent them and their number: sums are always in the same order.

    number (n,): place among the walks that set out together; key (n,) of their random numbers; patch (n,) and
    points (n, 3) where they stand, in unit coordinates and lifted; weight (n, C): reflectances so far.
    """

    number: NDArray[np.int32]
    key: NDArray[np.uint64]
    patch: NDArray[np.int32]
    points: FloatArray
    weight: FloatArray


@kernel(inline="always")
def _random(walks, w, order, which):  # type: ignore[no-untyped-def]
    """Random number in [0, 1) of one step of walk w."""
    return high_bits(key(key(walks.key[w], order), which)) * BITS_TO_UNIT


@kernel
def walk_keys(run, begin, first_path, paths, keys):  # type: ignore[no-untyped-def]
    """Keys of the walks `first_path` … of the patches `begin` …, each from (run, patch, path) alone."""
    for w in range(keys.shape[0]):
        keys[w] = key(key(np.uint64(run), np.uint64(begin + w // paths)), np.uint64(first_path + w % paths))


@kernel
def fresh_points(ground, walks, order):  # type: ignore[no-untyped-def]
    """Put each walk on a point of its patch, uniform in area."""
    for w in range(walks.patch.shape[0]):
        i = walks.patch[w]
        cell, up = i - ground.first[i], np.float64(ground.side[i])
        s, t = _random(walks, w, order, POINT_S), _random(walks, w, order, POINT_T)
        patch_point(ground.table, ground.face[i], cell, up, s, t, walks.points[w])


@kernel
def cosine_rays(ground, walks, order, origins, directions):  # type: ignore[no-untyped-def]
    """Rays from where the walks stand, with density cos θ / π about the normal: sin² θ and φ are uniform."""
    for w in range(walks.patch.shape[0]):
        f = ground.face[walks.patch[w]]
        n, t = ground.table.normal[f], ground.table.tangent[f]
        sine2, angle = _random(walks, w, order, RADIUS), 2.0 * np.pi * _random(walks, w, order, ANGLE)
        x, y = np.sqrt(sine2) * np.cos(angle), np.sqrt(sine2) * np.sin(angle)
        z = ground.side[walks.patch[w]] * np.sqrt(1.0 - sine2)
        directions[w, 0] = x * t[0] + y * (n[1] * t[2] - n[2] * t[1]) + z * n[0]
        directions[w, 1] = x * t[1] + y * (n[2] * t[0] - n[0] * t[2]) + z * n[1]
        directions[w, 2] = x * t[2] + y * (n[0] * t[1] - n[1] * t[0]) + z * n[2]
        for c in range(3):
            origins[w, c] = walks.points[w, c]


@kernel(inline="always")
def _density_of_cosine_rays(ground, i, x, j, y):  # type: ignore[no-untyped-def]
    """Rays per area of patch j at y, of those that leave x on i: cos θ cos θ' / π r²; 0 if one is behind the other."""
    n, m = ground.table.normal[ground.face[i]], ground.table.normal[ground.face[j]]
    dx, dy, dz = y[0] - x[0], y[1] - x[1], y[2] - x[2]
    here = ground.side[i] * (dx * n[0] + dy * n[1] + dz * n[2])
    there = -ground.side[j] * (dx * m[0] + dy * m[1] + dz * m[2])
    if here <= 0.0 or there <= 0.0:
        return 0.0
    r2 = dx * dx + dy * dy + dz * dz
    return here * there / (np.pi * r2 * r2)


@kernel
def shadow_rays(ground, walks, order, emitter, share, origins, directions):  # type: ignore[no-untyped-def]
    """Choose a point of an emitter for each walk; returns how many of them face it. Their rays come first.

    emitter (n,) becomes -1 where it is not faced. share (n,) is what its emission counts if it is seen: the kernel k
    over the density p of choosing the point, times the balance heuristic's p / (k + p), Eq. (18). So never more than 1.
    """
    target = np.empty(3)
    lit = 0
    for w in range(walks.patch.shape[0]):
        choice = np.searchsorted(ground.cumulated, _random(walks, w, order, EMITTER), side="right")
        e = ground.emitters[min(choice, ground.emitters.shape[0] - 1)]
        s, t = _random(walks, w, order, EMITTER_S), _random(walks, w, order, EMITTER_T)
        patch_point(ground.table, ground.face[e], e - ground.first[e], 0.0, s, t, target)  # not lifted: rays end on it
        k = _density_of_cosine_rays(ground, walks.patch[w], walks.points[w], e, target)
        emitter[w] = e if k > 0.0 else -1
        share[w] = k / (k + ground.density[e])
        if k > 0.0:
            for x in range(3):
                origins[lit, x] = walks.points[w, x]
                directions[lit, x] = target[x] - walks.points[w, x]
            lit += 1
    return lit


@kernel
def add_seen(ground, walks, met, emitter, share, found):  # type: ignore[no-untyped-def]
    """Add the emitters that shadow rays reached. Any patch of the face will do: rounding may say the one beside."""
    lit = 0
    for w in range(emitter.shape[0]):
        e = emitter[w]
        if e < 0:
            continue
        j = met[lit]
        lit += 1
        if j >= 0 and ground.face[j] == ground.face[e] and ground.side[j] == ground.side[e]:
            for c in range(found.shape[1]):
                found[w, c] += walks.weight[w, c] * ground.emission[e, c] * share[w]


@kernel
def meet(ground, walks, met, points, found, alive):  # type: ignore[no-untyped-def]
    """Add the light that rays met at `points` of the patches `met`, move the walks there, and tell which go on."""
    for w in range(met.shape[0]):
        j = met[w]
        alive[w] = False
        if j == MISS:
            for c in range(found.shape[1]):
                found[w, c] += walks.weight[w, c] * ground.sky[c]
        if j < 0:
            continue
        share = 1.0
        if ground.density[j] > 0.0:  # shadow rays find this emitter, too: the balance heuristic's k / (k + p)
            k = _density_of_cosine_rays(ground, walks.patch[w], walks.points[w], j, points[w])
            share = k / (k + ground.density[j])
        for c in range(found.shape[1]):
            found[w, c] += walks.weight[w, c] * ground.emission[j, c] * share
            walks.weight[w, c] *= ground.reflectance[j, c]
            alive[w] |= walks.weight[w, c] > 0.0
        for x in range(3):
            walks.points[w, x] = points[w, x]
        walks.patch[w] = j


@kernel
def roulette(walks, order):  # type: ignore[no-untyped-def]
    """Which walks go on: with the chance of their greatest weight, which the weights of survivors make up for."""
    alive = np.empty(walks.patch.shape[0], dtype=np.bool_)
    for w in range(walks.patch.shape[0]):
        chance = min(SURVIVAL, walks.weight[w].max())
        alive[w] = _random(walks, w, order, ROULETTE) < chance
        for c in range(walks.weight.shape[1]):
            walks.weight[w, c] /= chance
    return alive


@kernel
def add_to_walks(walks, found, total):  # type: ignore[no-untyped-def]
    """Add what this step found to the total of each walk (walks that set out, C)."""
    for w in range(found.shape[0]):
        for c in range(found.shape[1]):
            total[walks.number[w], c] += found[w, c]


@kernel
def add_to_patches(number, paths, found, sums, squares):  # type: ignore[no-untyped-def]
    """Add what walks found (n, C), and its squares, to the patches that sent them, `paths` walks each, in order."""
    for w in range(found.shape[0]):
        i = number[w] // paths
        for c in range(found.shape[1]):
            sums[i, c] += found[w, c]
            squares[i, c] += found[w, c] ** 2
