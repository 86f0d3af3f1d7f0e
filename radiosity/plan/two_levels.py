"""Where two levels are taken without being asked for: where they were measured to be as good in clearly less time.

Whole solves of 256 rays in two replicates against `TwoLevel()`, in the Cornell box, the cluttered room, behind a screen
and in a corridor: with 50 000 patches and more its errors are 0.6 to 1.0 times as large. Seconds fall to 0.5 to 0.8 at
50 000 patches and to 0.3 to 0.4 at 200 000, bytes to a half and a quarter. Nothing was measured under a sky, or where
little is absorbed.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..errors import ParameterError
from ..form_factors import TwoLevel
from ..form_factors.two_level import lamps
from ..patches import Patches

LEAST = 50_000  # patches
LEAST_EACH = 20.0  # patches a side of a face, on average: else there is nothing to group
LEAST_ABSORBED = 0.01  # of what arrives: below that, light of very many bounces counts
MOST_LEFT_OUT = 0.1  # of the rows: one matrix then has less to do
SAVED_SECONDS, SAVED_BYTES = 0.2, 0.4  # of one matrix, at least


def serve(patches: Patches, least_absorbed: float, rows_made: NDArray[np.bool_]) -> bool:
    """Whether two levels are as good for these patches, in less time.

    Parameters
    ----------
    patches : Patches
    least_absorbed : float
        Smallest absorptance of what reflects.
    rows_made : ndarray of bool (N,)
        Rows that one matrix would need.
    """
    faces = patches.grid.faces
    sides = int(faces.sides.sum())
    if len(patches) < max(LEAST, LEAST_EACH * sides) or least_absorbed < LEAST_ABSORBED:
        return False
    if patches.sky.any() and not patches.closed:
        return False
    if rows_made.mean() < 1.0 - MOST_LEFT_OUT:
        return False
    try:
        return lamps(patches, TwoLevel().light_rays) is not None
    except ParameterError:  # too many
        return False
