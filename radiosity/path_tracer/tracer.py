"""`PathTracer`: the light of each order by random walks, without any form factors.

The yardstick for everything else: patches, materials and rays are the same, but nothing is assembled and nothing
is solved, and the answer comes with standard errors. A walk starts on the patch that asks and runs against the light:
the emission that it meets on its k-th ray, times the reflectances on the way, is light of order k. The mean over
many walks is T^k E without bias, Eq. (17) (Kajiya 1986, doi 10.1145/15922.15902; Cohen & Wallace 1993, §10).
"""

from __future__ import annotations

import time
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from ..errors import ParameterError
from ..parallel import blocks, ordered_map
from ..patches import Patches
from ..progress import Progress, quiet
from ..sequences import seed_key
from .walks import BATCH, BlockOfWalks, Tally

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class PathTracer:
    """Light of each order per patch, by random walks.

    Parameters
    ----------
    paths : int
        Walks per patch, at least 2. Errors fall as 1/√paths.
    seed : int
    next_event : bool
        Also look straight at a point of an emitter at every step (next-event estimation), and weigh both ways to
        find it by the balance heuristic (Veach & Guibas 1995, doi 10.1145/218380.218498). The same answer,
        with far smaller errors where the emitters are small.
    transport : {"patches", "continuous"}
        What the walk does after a hit. "patches": it starts again from a fresh point of the patch that was met, so
        that light is constant on each patch, and the mean is T^k E of the discrete system: what solvers converge to
        as their form factors do. "continuous": it goes on from the point that was met, and the mean is the light of
        the undivided surfaces, averaged over each patch. The gap between the two is the discretisation error, zero at
        order 1.
    bounces : int
        Highest order K. Walks keep their weight up to it.
    tail : bool
        Walks go on past the highest order, by Russian roulette, so that `WalkedLight.radiosity` holds all orders.

    Examples
    --------
    >>> import radiosity as rad
    >>> furnace = rad.subdivide(rad.scenes.furnace(reflectance=0.5))
    >>> light = PathTracer(paths=2, bounces=3).solve(furnace)
    >>> light.orders[:, 0, 0]
    array([1.   , 0.5  , 0.25 , 0.125])
    """

    paths: int = 256
    seed: int = 0
    next_event: bool = False
    transport: Literal["patches", "continuous"] = "patches"
    bounces: int = 10
    tail: bool = False

    def __post_init__(self) -> None:
        seed_key(self.seed)
        if self.paths < 2:
            raise ParameterError(f"paths is {self.paths}; give at least 2, or there is no standard error")
        if self.bounces < 1:
            raise ParameterError(f"bounces is {self.bounces}; give at least 1")
        if self.transport not in ("patches", "continuous"):
            raise ParameterError(f"transport is {self.transport!r}; give 'patches' or 'continuous'")

    def solve(self, patches: Patches, *, threads: int | None = None, progress: Progress | None = None) -> WalkedLight:
        """Walk.

        Parameters
        ----------
        patches : Patches
        threads : int, optional
            As many as there are processors by default. The result has the same bits for any number.
        progress : callable, optional
            Called as ``progress(stage, patches done, patches in all)``.

        Returns
        -------
        WalkedLight
        """
        begin = time.perf_counter()
        report = progress or quiet
        tally = Tally.zeros(len(patches), self.bounces, patches.channels)
        walks = BlockOfWalks(self, patches)
        spans = blocks(len(patches), max(1, BATCH // self.paths))
        for (first, last), part in zip(spans, ordered_map(walks, spans, threads), strict=True):
            tally.put(first, last, part)
            report("path tracer", last, len(patches))
        return _light(self, patches, tally, time.perf_counter() - begin)


@dataclass(frozen=True, eq=False)
class WalkedLight:
    """Light by random walks, with the standard error of each number.

    Attributes
    ----------
    orders, standard_error : ndarray (K + 1, N, C)
        T^k E for k = 0 … K, W/m²; order 0 is the emission and exact.
    radiosity, radiosity_error : ndarray (N, C)
        Their sum, and that of all orders above K if the tail was walked, W/m².
    area : ndarray (N,)
        m².
    statistics : dict
        Counters: "rays/traced", "rays/to emitters", "rays/leaked", "seconds/path tracer".
    """

    orders: FloatArray
    standard_error: FloatArray
    radiosity: FloatArray
    radiosity_error: FloatArray
    area: FloatArray
    statistics: dict[str, Any] = field(default_factory=dict)

    @property
    def expected_error(self) -> FloatArray:
        """Area-weighted relative L2 error that the standard errors foretell, order by order (K + 1,)."""
        noise, light = (
            np.sqrt(np.einsum("n,knc->k", self.area, values**2)) for values in (self.standard_error, self.orders)
        )
        return np.divide(noise, light, out=np.zeros_like(noise), where=light > 0)


def _light(method: PathTracer, patches: Patches, tally: Tally, seconds: float) -> WalkedLight:
    emission = patches.emission
    orders = np.concatenate([emission[None], tally.orders / method.paths])
    error = _standard_error(tally.orders, tally.squares, method.paths)
    traced, shadow, leaked = tally.rays.tolist()
    return WalkedLight(
        orders,
        np.concatenate([np.zeros_like(emission)[None], error]),
        emission + tally.total / method.paths,
        _standard_error(tally.total, tally.total_squares, method.paths),
        patches.area,
        {
            "rays/traced": traced,
            "rays/to emitters": shadow,
            "rays/leaked": leaked,
            "seconds/path tracer": seconds,
        },
    )


def _standard_error(total: FloatArray, squares: FloatArray, count: int) -> FloatArray:
    """Of the mean of independent values, from their sum and the sum of their squares."""
    variance = np.maximum(squares / count - (total / count) ** 2, 0.0)
    return np.sqrt(variance / (count - 1))
