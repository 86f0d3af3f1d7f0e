"""Systems whose answers are known: what several cases need."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

import radiosity as rad

FloatArray = NDArray[np.float64]


@cache
def conserved(name: str, count: int, rays: int = 256, **parameters: Any) -> tuple[rad.Patches, rad.FormFactors]:
    """Patches of a built-in scene and their conserved factors."""
    patches = rad.subdivide(getattr(rad.scenes, name)(**parameters), patch_count=count)
    return patches, rad.form_factors(patches, rad.MonteCarlo(rays, light_rays=0)).conserved()


def all_alike(count: int, seed: int = 0) -> rad.FormFactors:
    """Patches of any areas that see all others alike, F_ij = A_j / A: a sphere, with light known for any materials."""
    area = np.random.default_rng(seed).random(count) + 0.1
    return rad.FormFactors.from_matrix(np.tile(area / area.sum(), (count, 1)), area)


def operator(factors: rad.FormFactors, **share: Any) -> rad.TransportOperator:
    """The operator of factors and ``reflectance=`` or ``absorptance=``, one number or many."""
    return rad.TransportOperator(factors, **share)


def light_in_a_sphere(factors: rad.FormFactors, absorptance: FloatArray, emission: FloatArray) -> FloatArray:
    """B = E + ρ <E> / <α>, with means over area: exact where all patches see all others alike."""
    share = factors.area / factors.area.sum()
    return emission + (1.0 - absorptance) * (share @ emission) / (share @ absorptance)


def chain(rooms: int, patches: int, coupling: float, seed: int = 0) -> rad.FormFactors:
    """Rooms of a few patches each, every one joined to the next by `coupling` times its own exchange."""
    rng, count = np.random.default_rng(seed), rooms * patches
    G = np.zeros((count, count))
    for room in range(rooms):
        here = slice(room * patches, (room + 1) * patches)
        G[here, here] = rng.random((patches, patches))
        if room:
            G[slice(here.start - patches, here.start), here] = coupling * rng.random((patches, patches))
    G = np.triu(G, 1) + np.triu(G, 1).T
    return rad.FormFactors.from_matrix(G / G.sum(axis=1, keepdims=True), G.sum(axis=1))


def energy_defect(T: rad.TransportOperator, emission: FloatArray, radiosity: FloatArray) -> float:
    """(absorbed + lost outside) / emitted - 1, the worst channel; absorbed as A α H."""
    absorbed = T.power(T.absorptance * T.factors.gather(radiosity))
    outside = T.power(T.to_outside[:, None] * radiosity)
    return float(np.max(np.abs((absorbed + outside) / T.power(emission) - 1.0)))


def lamp(count: int, channels: int = 1) -> FloatArray:
    """Emission of the first three patches."""
    emission = np.zeros((count, channels))
    emission[:3] = 1.0
    return emission


def moved(scene: rad.Scene, scale: float = 1.0, shift: float = 0.0) -> rad.Scene:
    """The same scene elsewhere, in another size."""
    surfaces = [rad.Surface(s.name, s.vertices * scale + shift, s.faces, s.material) for s in scene.surfaces]
    return rad.Scene(surfaces, sky=scene.sky, name=scene.name, closed=scene.closed)


def plate(name: str, corners: Any, material: rad.Material) -> rad.Surface:
    """One quad."""
    return rad.Surface(name, corners, [[0, 1, 2, 3]], material)
