"""Synthetic light exchanges that need no scene: random closed boxes, chains of rooms, facing walls."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from radiosity.form_factors.factors import FormFactors
from radiosity.transport import TransportOperator

FloatArray = NDArray[np.float64]


def facing_walls(share: float, reflectance: ArrayLike) -> TransportOperator:
    """Two walls of 1 m² that see each other by `share`; the rest goes to the sky."""
    factors = FormFactors.from_matrix([[0.0, share], [share, 0.0]], area=[1.0, 1.0])
    return TransportOperator(factors, reflectance=reflectance)


def exchange_to_factors(G: FloatArray, to_sky: ArrayLike = 0.0) -> FormFactors:
    """Form factors of a symmetric exchange area G (its row sums and the sky's share make the areas)."""
    share = np.broadcast_to(np.asarray(to_sky, dtype=float), len(G))
    area = G.sum(axis=1) / (1.0 - share)
    return FormFactors.from_matrix(G / area[:, None], area, to_sky=np.array(share))


def random_exchange(count: int, seed: int, density: float = 1.0, spread: float = 2.0) -> FloatArray:
    """Symmetric, non-negative, connected (a ring is always there); entries over a few powers of ten."""
    rng = np.random.default_rng(seed)
    G = rng.random((count, count)) * 10.0 ** (-spread * rng.random((count, count)))
    G *= rng.random((count, count)) < density
    for i in range(count):
        G[i, (i + 1) % count] += rng.random()
    np.fill_diagonal(G, 0.0)
    return np.triu(G + G.T, 1) + np.triu(G + G.T, 1).T


def materials(count: int, seed: int, low: float, high: float, channels: int = 3) -> FloatArray:
    """Reflectances (N, C) between two bounds."""
    return np.random.default_rng(seed + 1000).uniform(low, high, (count, channels))


def closed_box(
    count: int,
    seed: int,
    *,
    reflectance: tuple[float, float] | None = None,
    absorptance: ArrayLike | None = None,
    sky: float = 0.0,
    density: float = 1.0,
) -> TransportOperator:
    """A random symmetric exchange that closes, as an operator."""
    factors = exchange_to_factors(random_exchange(count, seed, density), sky)
    if reflectance is not None:
        return TransportOperator(factors, reflectance=materials(count, seed, *reflectance))
    return TransportOperator(factors, absorptance=absorptance)


def chain_of_rooms(rooms: int, patches: int, coupling: float, seed: int = 0) -> FormFactors:
    """Rooms of some patches each, every one joined to the next by `coupling` times its own exchange."""
    count = rooms * patches
    G = np.zeros((count, count))
    for room in range(rooms):
        begin = room * patches
        G[begin : begin + patches, begin : begin + patches] = random_exchange(patches, seed + room)
        if room:
            door = coupling * random_exchange(2 * patches, seed + 500 + room)[:patches, patches:]
            G[begin - patches : begin, begin : begin + patches] = door
            G[begin : begin + patches, begin - patches : begin] = door.T
    return exchange_to_factors(G)
