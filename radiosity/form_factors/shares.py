"""Shares that truly go to the sky, and those that have leaked."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..patches import Patches

FloatArray = NDArray[np.float64]

ALL = 1.0 - 1e-6  # of a row that goes to the sky


def without_leaks(to_sky: FloatArray, patches: Patches) -> tuple[FloatArray, float]:
    """Shares that truly go to the sky (N,), and the mean of what has leaked.

    Rays that leave a closed scene have leaked, but for those of patches that see nothing else: outside.
    """
    inside = to_sky < ALL if patches.closed else np.zeros(len(patches), dtype=bool)
    return np.where(inside, 0.0, to_sky), float(np.mean(np.where(inside, to_sky, 0.0)))
