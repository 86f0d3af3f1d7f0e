"""Gauss-Legendre rules on [0, 1], as flat tables that kernels can hold as constants."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]

MAX_POINTS = 12


def gauss_tables(count: int) -> tuple[FloatArray, FloatArray]:
    """Nodes and weights (count (count + 1) / 2,) of the rules of 1 … count points, one after the other.

    The rule of n points begins at n (n - 1) / 2.

    >>> nodes, weights = gauss_tables(2)
    >>> nodes.round(3), weights.round(3)
    (array([0.5  , 0.211, 0.789]), array([1. , 0.5, 0.5]))
    """
    rules = [np.polynomial.legendre.leggauss(n) for n in range(1, count + 1)]
    return np.concatenate([0.5 * (x + 1.0) for x, _ in rules]), np.concatenate([0.5 * w for _, w in rules])


NODES, WEIGHTS = gauss_tables(MAX_POINTS)
