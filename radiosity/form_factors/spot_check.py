"""A spot check: some rows of form factors made again, twice, by plain rays, to tell how wrong the others are.

Form factors that err by more than chance, as those on two levels do, do not show it in replicates of themselves: all
would err alike. But a row made by Monte Carlo is right on average, whatever it is held against. With the light a that
arrives at a patch by the factors in question, and x and y by two such rows that are independent of each other,

    E[(a - x) (a - y)] = (a - true)²,

the noise of x and y notwithstanding: their errors vanish on average, and so does their product.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from ..parallel import blocks, ordered_map
from ..patches import Patches
from ..rays import Tracer
from ..sparse import csr_matmul
from .assembly import RowBlock, stack_rows
from .monte_carlo import MonteCarlo, MonteCarloRows

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

SPOTS = 1024  # patches, at most
SHARE = 16  # one in so many …
LEAST = 64  # … but as many as these, where there are
RAYS = 256  # of each, twice
LIGHT_RAYS = 64
REPLICATES = 1 << 20, (1 << 20) + 1  # their numbers: no estimate has as many of its own


@dataclass(frozen=True, eq=False)
class SpotCheck:
    """Rows of n of N patches, twice.

    Attributes
    ----------
    patch : ndarray of int (n,)
        In rising order, spread evenly over the area: each stands for as much of it, large ones several times.
    rows : tuple of two csr_array (n, N)
    to_sky : ndarray (2, n)
    """

    patch: IntArray
    rows: tuple[csr_array, csr_array]
    to_sky: FloatArray

    @property
    def rays(self) -> int:
        """Sampling rays that it took."""
        return 2 * RAYS * len(self.patch)

    def arriving(self, light: FloatArray, from_sky: FloatArray) -> FloatArray:
        """What arrives at the n patches, twice, (2, n, C), of light (N, C) and irradiance (C,) of an open sky."""
        found = [
            csr_matmul(rows, light) + np.outer(sky, from_sky) for rows, sky in zip(self.rows, self.to_sky, strict=True)
        ]
        return np.stack(found)


def spot_check(patches: Patches, tracer: Tracer, seed: int, threads: int | None = None) -> SpotCheck:
    """Make the rows.

    Parameters
    ----------
    patches : Patches
    tracer : Tracer
    seed : int
        Of the factors that are to be checked: their own rays are others.
    threads : int, optional
    """
    chosen = evenly_chosen(patches.area, min(max(len(patches) // SHARE, LEAST), SPOTS))
    method = MonteCarlo(RAYS, seed, light_rays=LIGHT_RAYS)
    made = []
    for replicate in REPLICATES:
        maker = MonteCarloRows(method, patches, tracer, replicate)

        def rows(span: tuple[int, int], maker: MonteCarloRows = maker) -> RowBlock:
            block = maker.of(chosen[slice(*span)])._replace(begin=span[0])
            return block.finished(maker.divisor, np.float32)

        spans = blocks(len(chosen), maker.rows_at_once)
        made.append(stack_rows(ordered_map(rows, spans, threads), len(chosen), np.float32, columns=len(patches)))
    return SpotCheck(chosen, (made[0].matrix, made[1].matrix), np.stack([one.to_sky for one in made]))


def evenly_chosen(area: FloatArray, count: int) -> IntArray:
    """The patches that the middles of `count` equal parts of all area lie in; of a larger patch there are several."""
    ends = np.cumsum(area)
    middles = (np.arange(count) + 0.5) / count * ends[-1]
    return np.minimum(np.searchsorted(ends, middles), len(area) - 1)
