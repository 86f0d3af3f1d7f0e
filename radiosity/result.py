"""What solvers give: a step of an iteration, and the result of a solve."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Step:
    """One step of a solver, as `iterate` yields it.

    Attributes
    ----------
    order : int
        Number of the step; for `Neumann` the number of bounces k.
    term : ndarray (N, C)
        What this step added to the radiosity, W/m²; for `Neumann` the order T^k E.
    radiosity : ndarray (N, C)
        The solution so far, W/m²; for `Neumann` the partial sum.
    residual : ndarray (C,)
        Area-weighted root mean square of E + T B - B over the patches, W/m², per channel, computed from the
        equation (never by recursion).
    power : ndarray (C,)
        Power of `term`: Σ area × term, W.
    unshot : ndarray (N, C) or None
        Radiosity not yet shot, for solvers that shoot.
    """

    order: int
    term: FloatArray
    radiosity: FloatArray
    residual: FloatArray
    power: FloatArray
    unshot: FloatArray | None = None


@dataclass(frozen=True, eq=False)
class Result:
    """What `solve` of every solver returns.

    Attributes
    ----------
    radiosity : ndarray (N, C)
        W/m².
    orders : ndarray (K + 1, N, C) or None
        T^k E for k = 0 … K from `Neumann`, as far as its memory cap allows; None from other solvers.
    status : str
        One sentence: "converged …", or why not and what to try.
    converged : bool
    history : ndarray (steps, C)
        Residual after each step, W/m².
    statistics : dict
        Counters, named "group/what".
    """

    radiosity: FloatArray
    orders: FloatArray | None
    status: str
    converged: bool
    history: FloatArray
    statistics: dict[str, Any] = field(default_factory=dict)

    def __repr__(self) -> str:
        return f"<Result: light of {len(self.radiosity):,} patches; {self.status}>"
