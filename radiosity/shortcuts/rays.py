"""Rays of the shortcuts: without the cosine, without visibility, and how open a patch is nearby.

They start as the right ones do, from the points of `radiosity.form_factors.monte_carlo`, and go wrong from there.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csr_array, vstack

from ..errors import ParameterError
from ..face_points import OFFSET
from ..form_factors.monte_carlo import BATCH, Places, cosine_rays
from ..parallel import blocks, ordered_map
from ..patches import Grid, Patches
from ..rays import MISS, Tracer
from ..sequences import seed_key, sobol_points

FloatArray = NDArray[np.float64]
Float32Array = NDArray[np.float32]
IntArray = NDArray[np.int64]


class Bundle(NamedTuple):
    """Rays of some patches: origins, directions (n, 3) float32 in unit coordinates; patch (n,) that sends each."""

    origins: Float32Array
    directions: Float32Array
    patch: IntArray


class Hits(NamedTuple):
    """Which patch sent a ray (n,) and which met it (n,); MISS or BACK where none did."""

    sender: IntArray
    receiver: NDArray[np.int32]


Follow = Callable[[Bundle], Hits]


def count_shares(
    patches: Patches, rays: int, seed: int, follow: Follow, threads: int | None
) -> tuple[csr_array, FloatArray, FloatArray]:
    """Hits per ray of every patch: on patches (N, N), on nothing (N,), on black backs (N,).

    Parameters
    ----------
    patches : Patches
    rays : int
        For each patch.
    seed : int
    follow : callable
        What becomes of a bundle of rays.
    threads : int, optional
        The result does not depend on it.
    """
    send = Sender(patches, rays, seed)

    def count(block: tuple[int, int]) -> tuple[csr_array, FloatArray, FloatArray]:
        begin, end = block
        sender, receiver = follow(send(begin, end))
        row = sender - begin
        met = receiver >= 0
        shape = (end - begin, len(patches))
        share = coo_array((np.full(int(met.sum()), 1.0 / rays), (row[met], receiver[met])), shape=shape).tocsr()
        missed, backs = (np.bincount(row[w], minlength=end - begin) / rays for w in (receiver == MISS, receiver < MISS))
        return csr_array(share), missed, backs

    parts = list(ordered_map(count, blocks(len(patches), max(1, BATCH // rays)), threads))
    matrix, missed, backs = zip(*parts, strict=True)
    return csr_array(vstack(matrix, format="csr")), np.concatenate(missed), np.concatenate(backs)


class Sender:
    """Cosine-distributed rays of patches, as `MonteCarlo` sends them."""

    def __init__(self, patches: Patches, rays: int, seed: int, tracer: Tracer | None = None) -> None:
        if rays < 1:
            raise ParameterError(f"rays is {rays}; give at least 1")
        self.patches, self.rays = patches, rays
        self.tracer = Tracer(patches.grid) if tracer is None else tracer
        self.run = seed_key(seed, 0)
        self.points = np.ascontiguousarray(sobol_points(rays, 4, int(self.run)).T)

    def __call__(self, begin: int, end: int) -> Bundle:
        """The rays of patches begin … end, patch by patch."""
        patches, grid = self.patches, self.patches.grid
        places = Places(self.tracer.table, patches.face, patches.side, grid.front, grid.back)
        origins, directions = cosine_rays(places, np.arange(begin, end), self.rays, self.points, self.run)
        return Bundle(origins, directions, np.repeat(np.arange(begin, end), self.rays))


def without_cosine(patches: Patches, tracer: Tracer) -> Follow:
    """Bend cosine-distributed rays so that every direction of the hemisphere is as likely, and find what each meets.

    The height z above the surface, distributed as 2z, becomes z², which is uniform; and as
    √(1 - z⁴) = √(1 + z²) √(1 - z²), the rest of the direction grows by √(1 + z²).
    """

    def follow(bundle: Bundle) -> Hits:
        normal = patches.normal[bundle.patch]
        height = np.einsum("rx,rx->r", bundle.directions, normal)[:, None]
        flat = bundle.directions - height * normal
        bent = flat * np.sqrt(1.0 + height**2) + height**2 * normal
        return Hits(bundle.patch, tracer.run(bundle.origins, np.ascontiguousarray(bent, dtype=np.float32)))

    return follow


class ThroughWalls:
    """Rays that go through everything, and count on every front that they meet.

    Parameters
    ----------
    patches : Patches
    """

    def __init__(self, patches: Patches) -> None:
        self.count = len(patches)
        grid, self.face = _with_backs(patches)
        self.normal = grid.faces.normal
        self.tracer = Tracer(grid)

    def __call__(self, bundle: Bundle) -> Hits:
        """All fronts that the rays of a bundle meet; no ray ends on nothing, as none ends at all."""
        origins, directions, patch = bundle
        senders, receivers = [], []
        for _ in range(len(self.normal) + 1):  # a straight line meets each face once, whatever rounding says
            if not len(origins):
                break
            met, points = self.tracer.hits(origins, directions)
            going = met != MISS
            met, points, directions, patch = met[going], points[going], directions[going], patch[going]
            front = met < self.count
            senders.append(patch[front])
            receivers.append(met[front])
            origins = self._beyond(met, points, directions)
        return Hits(np.concatenate(senders), np.concatenate(receivers))

    def _beyond(self, met: NDArray[np.int32], points: FloatArray, directions: Float32Array) -> Float32Array:
        """Points on the far side of the faces that rays met, (n, 3)."""
        normal = self.normal[self.face[met]]
        towards = np.sign(np.einsum("rx,rx->r", directions, normal))
        return np.ascontiguousarray(points + 2.0 * OFFSET * towards[:, None] * normal, dtype=np.float32)


def openness(patches: Patches, distance: float, rays: int, seed: int, threads: int | None = None) -> FloatArray:
    """Share of the hemisphere, weighted by the cosine, in which nothing is nearer than a distance, (N,).

    Parameters
    ----------
    patches : Patches
    distance : float
        In diagonals of the scene.
    rays : int
        For each patch.
    seed : int
    threads : int, optional
    """
    tracer = Tracer(_with_backs(patches)[0])
    send = Sender(patches, rays, seed, tracer)

    def count(block: tuple[int, int]) -> FloatArray:
        origins, directions, _ = send(*block)
        met, points = tracer.hits(origins, directions)
        length = np.where(met == MISS, np.inf, np.linalg.norm(points - origins, axis=1))
        return (length > distance).reshape(-1, rays).mean(axis=1)

    return np.concatenate(list(ordered_map(count, blocks(len(patches), max(1, BATCH // rays)), threads)))


def _with_backs(patches: Patches) -> tuple[Grid, IntArray]:
    """The grid with numbers from N on for black backs too, so that rays learn where they met one; faces by number."""
    grid = patches.grid
    black = np.flatnonzero(grid.back < 0)
    cells = grid.cells[black]
    back = grid.back.copy()
    back[black] = len(patches) + np.cumsum(cells) - cells
    face = np.concatenate([patches.face.astype(np.int64), np.repeat(black, cells)])
    return replace(grid, back=back), face
