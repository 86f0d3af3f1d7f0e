"""How far light is from what it should be: one number for all of it, by order, and patch by patch.

The one number is the project's error: the area-weighted relative L2 of B - E over patches and channels,

    √( Σ A |B - B_true|² / Σ A |B_true - E|² ).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]

FAINT = 1e-9  # of the mean: patches with less light have no relative error of their own


class Light(NamedTuple):
    """Radiosity (N, C) with its emission in it, and its first orders (K + 1, N, C), W/m²."""

    radiosity: FloatArray
    orders: FloatArray


class Errors(NamedTuple):
    """Relative errors.

    l2 : the error of all light.
    maximum, median, p95 : of each patch's |B - B_true| over its own |B_true - E|.
    by_order : L2 of each order from 1 on, relative to that order; None for an order without light.
    """

    l2: float
    maximum: float
    median: float
    p95: float
    by_order: tuple[float | None, ...]


def errors(found: Light, true: Light, area: FloatArray) -> Errors:
    """Errors of light against the true one on the same patches.

    >>> one = np.ones((2, 1))
    >>> errors(Light(2.2 * one, np.stack([one, 0.6 * one])), Light(2 * one, np.stack([one, 0.5 * one])), np.ones(2))
    Errors(l2=0.2..., maximum=0.2..., median=0.2..., p95=0.2..., by_order=(0.19...,))
    """
    emission = true.orders[0]
    patch = per_patch(found.radiosity, true.radiosity, emission)
    kept = min(len(found.orders), len(true.orders))
    return Errors(
        l2=relative_l2(found.radiosity, true.radiosity, area, emission),
        maximum=float(patch.max(initial=0.0)),
        median=float(np.median(patch)) if patch.size else 0.0,
        p95=float(np.quantile(patch, 0.95)) if patch.size else 0.0,
        by_order=tuple(_of_order(found.orders[k], true.orders[k], area) for k in range(1, kept)),
    )


def relative_l2(found: FloatArray, true: FloatArray, area: FloatArray, without: FloatArray | float = 0.0) -> float:
    """√(Σ A |found - true|² / Σ A |true - without|²); 0 where both are 0, infinite where only the latter is."""
    wrong, size = norm(found - true, area), norm(true - without, area)
    return wrong / size if size > 0 else (np.inf if wrong > 0 else 0.0)


def norm(light: FloatArray, area: FloatArray) -> float:
    """√(Σ A |light|²)."""
    return float(np.sqrt(np.sum(area[:, None] * light**2)))


def per_patch(found: FloatArray, true: FloatArray, emission: FloatArray) -> FloatArray:
    """|B - B_true| over |B_true - E| of each patch that gets light, (≤ N,)."""
    wrong, size = np.linalg.norm(found - true, axis=1), np.linalg.norm(true - emission, axis=1)
    lit = size > FAINT * size.mean() if size.any() else np.zeros(len(size), dtype=bool)
    return wrong[lit] / size[lit]


def _of_order(found: FloatArray, true: FloatArray, area: FloatArray) -> float | None:
    return relative_l2(found, true, area) if true.any() else None
