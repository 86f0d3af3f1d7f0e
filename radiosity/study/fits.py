"""Exponents of power laws, with their standard errors."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

FloatArray = NDArray[np.float64]

PLACES = 3  # that a line needs before it is a fit
SLOW = 0.1  # exponent of convergence below which a method does not converge


class Exponent(NamedTuple):
    """p in y ∝ x^p: least squares in the logarithms, and the standard error of that slope.

    The error holds both the scatter of runs at one place and the bend of a curve that is no power law.
    """

    value: float
    error: float
    points: int

    def __str__(self) -> str:
        """Value and standard error.

        >>> str(Exponent(-0.613, 0.021, 12))
        '-0.61 ± 0.02'
        """
        return f"{self.value:.2f} ± {self.error:.2f}"


def exponent(x: ArrayLike, y: ArrayLike) -> Exponent | None:
    """Fit y ∝ x^p; None where there are not three places above zero.

    Equal points count once: a method without a seed that is run again has not been tried again.

    >>> str(exponent([1, 1, 2, 2, 4, 4], [3.0, 3.3, 1.6, 1.5, 0.77, 0.74]))
    '-1.03 ± 0.03'
    """
    px, py = np.asarray(x, dtype=np.float64), np.asarray(y, dtype=np.float64)
    good = (px > 0) & (py > 0) & np.isfinite(px) & np.isfinite(py)
    px, py = np.unique(np.log([px[good], py[good]]), axis=1)
    if len(np.unique(px)) < PLACES:
        return None
    away = px - px.mean()
    slope = float(away @ py) / float(away @ away)
    rest = py - py.mean() - slope * away
    return Exponent(slope, float(np.sqrt(rest @ rest / (len(px) - 2) / (away @ away))), len(px))


def cost_exponent(
    x: Sequence[float], work: Sequence[float], error: Sequence[float], seconds: Sequence[float]
) -> Exponent | None:
    """Growth with x of the time to one and the same error.

    Error is taken to fall as work^-q with one q for all x: seconds × error^(1/q) is then the time to an error of 1, up
    to a factor. None where the method does not converge (q below a tenth), or there are too few runs. The standard
    error takes q as known.
    """
    columns = np.array([x, work, error, seconds], dtype=np.float64)
    place, amount, wrong, time = columns[:, (columns > 0).all(axis=0) & np.isfinite(columns).all(axis=0)]
    if len(np.unique(amount)) < 2:
        return None
    fall = -_slope_within(place, np.log(amount), np.log(wrong))
    return exponent(place, time * wrong ** (1.0 / fall)) if fall > SLOW else None


def _slope_within(group: FloatArray, x: FloatArray, y: FloatArray) -> float:
    """Slope of y over x inside groups, one for all of them; 0 where x does not vary there."""
    _, number = np.unique(group, return_inverse=True)
    size = np.bincount(number)
    across, up = (values - (np.bincount(number, values) / size)[number] for values in (x, y))
    spread = float(across @ across)
    return float(across @ up) / spread if spread > 0 else 0.0
