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
    if not patches.closed:
        return to_sky, 0.0
    outside = to_sky >= ALL
    kept = np.zeros(len(patches))
    kept[outside] = to_sky[outside]
    return kept, float(np.mean(to_sky - kept))
