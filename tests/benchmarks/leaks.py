"""Rays in closed rooms: none may find a way out, wherever the room stands and however large it is.

``python -m tests.benchmarks.leaks`` prints the table of docs/evidence/leaks.md: random rays from all patches, and rays
aimed at corners and at points of edges, where two faces meet.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

import radiosity as rad
from radiosity.rays import MISS, Tracer

SCENES = ("furnace", "integrating_sphere", "red_rug", "two_rooms", "cluttered_room")
SCALES = (1e-9, 1.0, 1e9)
SHIFTS = (0.0, 1e6, 1e9)  # in sizes of the scene
RANDOM, AIMED = 230_000, 100_000  # rays a scene, scale and shift


@dataclass(frozen=True)
class Leaks:
    """Rays that were traced, and those that met nothing."""

    rays: int
    lost: int

    def __add__(self, other: Leaks) -> Leaks:
        return Leaks(self.rays + other.rays, self.lost + other.lost)


def placed(name: str, scale: float, shift: float) -> rad.Scene:
    """A built-in scene in another size, that many sizes away from the origin."""
    scene = rad.scenes.BUILT_IN[name]()
    points = np.concatenate([s.vertices for s in scene.surfaces])
    away = shift * np.linalg.norm(np.ptp(points, axis=0)) * np.array([0.6, -0.48, 0.64])
    return replace(scene, surfaces=[replace(s, vertices=(s.vertices + away) * scale) for s in scene.surfaces])


def random_rays(name: str, scale: float, shift: float, rays: int = RANDOM, seed: int = 0) -> Leaks:
    """Cosine rays from points of all patches, as form factors take them."""
    patches = rad.subdivide(placed(name, scale, shift))
    each = max(1, -(-rays // len(patches)))
    factors = rad.form_factors(patches, rad.MonteCarlo(rays=each, seed=seed, sampling="random", light_rays=0))
    statistics = factors.statistics
    return Leaks(int(statistics["rays/traced"]), int(statistics.get("rays/leaked", 0)))


def aimed_rays(name: str, scale: float, shift: float, where: str, rays: int = AIMED, seed: int = 0) -> Leaks:
    """Rays from before the middles of faces towards corners, or towards points of edges, of other faces."""
    patches = rad.subdivide(placed(name, scale, shift))
    tracer, rng = Tracer(patches.grid), np.random.default_rng(seed)
    corners = tracer.to_unit(patches.corners)
    origins = tracer.to_unit(patches.centroid) + 1e-5 * patches.normal
    begin, target = rng.integers(0, len(patches), (2, rays))
    corner = rng.integers(0, 3, rays)
    points = corners[target, corner]
    if where == "edge":
        t = rng.random((rays, 1))
        points = (1 - t) * points + t * corners[target, corner + 1]
    directions = points - origins[begin]
    ahead = np.einsum("nx,nx->n", directions, patches.normal[begin]) > 1e-3
    found = tracer.run(origins[begin][ahead].astype(np.float32), directions[ahead].astype(np.float32))
    return Leaks(int(ahead.sum()), int((found == MISS).sum()))


def main() -> None:
    """Print the table."""
    print("| scene | random rays | lost | at corners | lost | at edges | lost |")
    print("|---|---|---|---|---|---|---|")
    total = [Leaks(0, 0)] * 3
    for name in SCENES:
        row = [Leaks(0, 0)] * 3
        for scale in SCALES:
            for shift in SHIFTS:
                here = [random_rays(name, scale, shift)]
                here += [aimed_rays(name, scale, shift, where) for where in ("corner", "edge")]
                row = [a + b for a, b in zip(row, here, strict=True)]
        total = [a + b for a, b in zip(total, row, strict=True)]
        print(_line(name, row), flush=True)
    print(_line("all", total))


def _line(name: str, row: list[Leaks]) -> str:
    return f"| {name} | " + " | ".join(f"{one.rays:,} | {one.lost}" for one in row) + " |"


if __name__ == "__main__":
    main()
