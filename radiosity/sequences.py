"""Numbers that look random and are not: hashes of a counter, and low-discrepancy points.

A value depends on its key alone, (seed, patch, ray, dimension), never on who asked before. So rows can be
computed in any order, by any number of threads, and come out the same to the last bit.
"""

from __future__ import annotations

import functools
import operator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .compiled import kernel
from .errors import ParameterError

BITS = 32
BITS_TO_UNIT = 1.0 / 4294967296.0  # 32 random bits to [0, 1)
# Primitive polynomials (a bit for each coefficient) and first direction numbers of the second dimension and those after
# it (Joe & Kuo 2008, doi 10.1137/070709359, new-joe-kuo-6).
JOE_KUO = ((0b11, (1,)), (0b111, (1, 3)), (0b1011, (1, 3, 1)))
MOST_DIMENSIONS = 1 + len(JOE_KUO)


@kernel(inline="always")
def mix(z):  # type: ignore[no-untyped-def]
    """The finaliser of SplitMix64 (Steele, Lea & Flood 2014, doi 10.1145/2714064.2660195): uint64 to uint64."""
    z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return z ^ (z >> np.uint64(31))


@kernel(inline="always")
def key(parent, counter):  # type: ignore[no-untyped-def]
    """The key of item `counter` below `parent`, uint64."""
    return mix(parent + (np.uint64(counter) + np.uint64(1)) * np.uint64(0x9E3779B97F4A7C15))


@kernel(inline="always")
def high_bits(z):  # type: ignore[no-untyped-def]
    """The upper 32 bits, uint32."""
    return np.uint32(z >> np.uint64(32))


def keys(parent: Any, counters: NDArray[Any]) -> NDArray[np.uint64]:
    """`key` of many counters, of one parent or one each."""
    return mix.py_func(parent + (counters.astype(np.uint64) + np.uint64(1)) * np.uint64(0x9E3779B97F4A7C15))


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
    count : int
        At least one.
    dimensions : int
        At most `MOST_DIMENSIONS`.
    seed : int

    Returns
    -------
    ndarray of uint32 (count, dimensions)

    Notes
    -----
    Sobol (1967) with Joe & Kuo's direction numbers, random linear matrix scramble and digital shift (Matoušek 1998):
    the points of ``scipy.stats.qmc.Sobol``, bit for bit, without the second that importing it takes.
    """
    rng = np.random.default_rng(seed).spawn(1)[0]  # as scipy does
    shift = _packed(rng.integers(0, 2, (dimensions, BITS), dtype=np.uint32)[:, ::-1])
    lower = np.tril(rng.integers(0, 2, (dimensions, BITS, BITS), dtype=np.uint32), -1) | np.eye(BITS, dtype=np.uint32)
    directions = _directions(dimensions)
    # Bit p of a scrambled direction is the parity of row p of the triangular matrix and the direction.
    parity = np.bitwise_count(_packed(lower)[:, None, :] & directions[:, :, None]) & 1
    scrambled = _packed(parity)
    points = shift[None]
    for bit in range(
        int(count - 1).bit_length()
    ):  # twice as many, those of before in reverse: the order of Gray's code
        points = np.concatenate([points, points[::-1] ^ scrambled[:, bit]])
    return points[:count]


def _packed(bits: NDArray[Any]) -> NDArray[np.uint32]:
    """Bits (…, 32), the highest first, as words (…,)."""
    place = np.arange(BITS - 1, -1, -1, dtype=np.uint32)
    return np.bitwise_or.reduce(bits.astype(np.uint32) << place, axis=-1)


def _directions(dimensions: int) -> NDArray[np.uint32]:
    """Sobol's direction numbers (dimensions, 32), as 32-bit fractions; the first dimension is van der Corput's."""
    rows = [[1] * BITS]
    for polynomial, first in JOE_KUO[: dimensions - 1]:
        degree, m = polynomial.bit_length() - 1, list(first)
        for k in range(degree, BITS):
            terms = [m[k - j] << j for j in range(1, degree + 1) if polynomial >> (degree - j) & 1]
            m.append(functools.reduce(operator.xor, terms, m[k - degree]))
        rows.append(m)
    return np.array([[m << (BITS - 1 - k) for k, m in enumerate(row)] for row in rows], dtype=np.uint32)
