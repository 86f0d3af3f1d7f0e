"""Light that arrives at points, such as a grid on a desk: rays from the points into the solved scene."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .errors import ParameterError
from .face_points import OFFSET
from .parallel import blocks, ordered_map
from .patches import Patches
from .rays import MISS, Tracer
from .sequences import BITS_TO_UNIT, seed_key, sobol_points

FloatArray = NDArray[np.float64]

BATCH = 1 << 16  # rays at a time


def irradiance_at(
    patches: Patches,
    radiosity: FloatArray,
    points: ArrayLike,
    normals: ArrayLike,
    *,
    rays: int = 1024,
    seed: int = 0,
    threads: int | None = None,
) -> FloatArray:
    """Irradiance at points of a scene whose radiosity is known: the mean radiosity that cosine rays meet.

    Parameters
    ----------
    patches : Patches
    radiosity : ndarray (N, C)
        W/m².
    points : array_like (P, 3) or (3,)
        m. On a surface, or anywhere in space.
    normals : array_like (P, 3) or (3,)
        Which way each point looks, of any length; one serves all points.
    rays : int, optional
        For each point.
    seed, threads : int, optional
        The result depends on the seed, and not on the number of threads.

    Returns
    -------
    ndarray (P, C)
        W/m².

    Raises
    ------
    ParameterError
        Shapes that do not fit, values that are not finite, a normal without a length.
    """
    at, up = _checked(points, normals)
    if rays < 1:
        raise ParameterError(f"rays is {rays}; give at least 1")
    tracer = Tracer(patches.grid)
    origins = tracer.to_unit(at) + OFFSET * up
    sample = sobol_points(rays, 2, int(seed_key(seed)) & 0x7FFFFFFF)
    shifts = np.array([[int(seed_key(seed, p, d)) >> 32 for d in range(2)] for p in range(len(at))], dtype=np.uint32)
    # What a ray meets, by patch number; MISS is -1 and BACK is -2, so they index the last two rows.
    assert MISS == -1
    sky = np.zeros_like(patches.sky) if patches.closed else patches.sky  # in a closed scene a miss is a leak
    met = np.concatenate([radiosity, np.zeros((1, radiosity.shape[1])), np.pi * sky[None]])

    def arriving(block: tuple[int, int]) -> FloatArray:
        these = slice(*block)
        directions = _cosine_directions(sample[None] ^ shifts[these, None], up[these])
        starts = np.repeat(origins[these], rays, axis=0).astype(np.float32)
        hits = tracer.run(np.ascontiguousarray(starts), np.ascontiguousarray(directions.astype(np.float32)))
        return met[hits].reshape(-1, rays, radiosity.shape[1]).mean(axis=1)

    return np.concatenate(list(ordered_map(arriving, blocks(len(at), max(1, BATCH // rays)), threads)))


def _checked(points: ArrayLike, normals: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Points and unit normals, (P, 3) each."""
    at = np.atleast_2d(np.asarray(points, dtype=np.float64))
    towards = np.atleast_2d(np.asarray(normals, dtype=np.float64))
    if at.ndim != 2 or at.shape[1] != 3 or not len(at) or towards.shape not in (at.shape, (1, 3)):
        raise ParameterError(
            f"points have shape {np.shape(points)} and normals {np.shape(normals)}; give (P, 3) and (P, 3), or one "
            "normal (3,) for all"
        )
    towards = np.broadcast_to(towards, at.shape)
    length = np.linalg.norm(towards, axis=1)
    bad = np.flatnonzero(~(np.isfinite(at).all(axis=1) & np.isfinite(length) & (length > 0)))
    if bad.size:
        raise ParameterError(
            f"point {bad[0]}: {at[bad[0]]} with normal {towards[bad[0]]}; give finite points, and normals with a length"
        )
    return at, towards / length[:, None]


def _cosine_directions(samples: NDArray[np.uint32], up: FloatArray) -> FloatArray:
    """Directions (P × rays, 3), cos θ / π about the normals (P, 3), from 32-bit fractions (P, rays, 2)."""
    first, second = samples[..., 0] * BITS_TO_UNIT, samples[..., 1] * BITS_TO_UNIT
    radius, angle = np.sqrt(first), 2.0 * np.pi * second
    helper = np.where(np.abs(up[:, :1]) < 0.6, [1.0, 0.0, 0.0], [0.0, 1.0, 0.0])
    tangent = np.cross(helper, up)
    tangent /= np.linalg.norm(tangent, axis=1, keepdims=True)
    across = np.cross(up, tangent)
    frame = np.stack([tangent, across, up], axis=1)
    local = np.stack([radius * np.cos(angle), radius * np.sin(angle), np.sqrt(1.0 - first)], axis=2)
    return np.einsum("prk,pkx->prx", local, frame).reshape(-1, 3)
