"""Numbers that look random and are not: hashes of a counter, and low-discrepancy points.

A value depends on its key alone, (seed, patch, ray, dimension), never on who asked before. So rows can be
computed in any order, by any number of threads, and come out the same to the last bit.
"""

from __future__ import annotations

import numba
import numpy as np
from numpy.typing import NDArray

from .errors import ParameterError

BITS_TO_UNIT = 1.0 / 4294967296.0  # 32 random bits to [0, 1)


@numba.njit(nogil=True, cache=True, inline="always")
def mix(z):  # type: ignore[no-untyped-def]
    """The finaliser of SplitMix64 (Steele, Lea & Flood 2014, doi 10.1145/2714064.2660195): uint64 to uint64."""
    z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return z ^ (z >> np.uint64(31))


@numba.njit(nogil=True, cache=True, inline="always")
def key(parent, counter):  # type: ignore[no-untyped-def]
    """The key of item `counter` below `parent`, uint64."""
    return mix(parent + (np.uint64(counter) + np.uint64(1)) * np.uint64(0x9E3779B97F4A7C15))


@numba.njit(nogil=True, cache=True, inline="always")
def high_bits(z):  # type: ignore[no-untyped-def]
    """The upper 32 bits, uint32."""
    return np.uint32(z >> np.uint64(32))


def seed_key(seed: int, *counters: int) -> np.uint64:
    """The key that a run starts from.

    Raises
    ------
    ParameterError
        If the seed is not an integer ≥ 0 that fits 63 bits.

    >>> bool(seed_key(0) == seed_key(0)), bool(seed_key(0) == seed_key(1))
    (True, False)
    """
    if not isinstance(seed, (int, np.integer)) or not 0 <= seed < 1 << 63:
        raise ParameterError(f"seed is {seed!r}; give an integer from 0 to 2**63 - 1")
    value = key(np.uint64(0), np.uint64(seed))
    for counter in counters:
        value = key(np.uint64(value), np.uint64(counter))
    return np.uint64(value)


def sobol_points(count: int, dimensions: int, seed: int) -> NDArray[np.uint32]:
    """Scrambled Sobol points as 32-bit fractions.

    Points are balanced best where `count` is a power of two. Shift them by an exclusive or with any
    key: the shifted set is as well distributed as this one (a random digital shift).

    Parameters
    ----------
    count, dimensions : int
    seed : int

    Returns
    -------
    ndarray of uint32 (count, dimensions)

    Notes
    -----
    Sobol (1967) with Joe & Kuo's direction numbers, random linear matrix scramble and digital shift (Matoušek 1998).
    """
    from scipy.stats import qmc

    whole = max(0, int(count - 1).bit_length())
    points = qmc.Sobol(dimensions, scramble=True, bits=32, rng=np.random.default_rng(seed)).random_base2(whole)
    return (points[:count] * 4294967296.0).astype(np.uint32)
