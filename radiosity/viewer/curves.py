"""What the dashboard plots, as a value: curves, ticks and a marker in shares of a box. Knows no window."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import display
from .palette import CHANNEL_COLOURS, GATHERING, INK, SHOOTING
from .race import Race
from .state import Series, ViewState

FloatArray = NDArray[np.float64]
Ticks = tuple[tuple[float, str], ...]

MOST_DECADES = 8
MOST_BOUNCES = 11  # that are numbered along the axis


@dataclass(frozen=True, eq=False)
class Curve:
    """A line through points (n, 2), shares of the box, in a colour; with a dot at each point if asked."""

    points: FloatArray
    colour: str
    dots: bool = False


@dataclass(frozen=True, eq=False)
class Curves:
    """A plot.

    Attributes
    ----------
    title, below : str
        Above the plot, and under it.
    across, up : tuple of (float, str)
        Ticks: share of the box, and what stands there.
    curves : tuple of Curve
    marker : float
        Where the upright line stands, share of the box.
    """

    title: str
    below: str
    across: Ticks
    up: Ticks
    curves: tuple[Curve, ...]
    marker: float

    def same_but_for_marker(self, other: Curves | None) -> bool:
        """Whether another plot differs in nothing but its marker."""
        if other is None or len(self.curves) != len(other.curves):
            return False
        words = (self.title, self.below, self.across, self.up) == (other.title, other.below, other.across, other.up)
        return words and all(
            (one.colour, one.dots) == (two.colour, two.dots) and np.array_equal(one.points, two.points)
            for one, two in zip(self.curves, other.curves, strict=True)
        )


def power_curves(series: Series, state: ViewState) -> Curves:
    """Power per bounce on a logarithmic axis, one curve a channel; of a picked patch, its light by order."""
    power = series.power
    low, high = decades(power)
    place = (np.arange(len(power)) + 0.5) / len(power)
    channels = power.shape[1]
    curves = []
    for c in range(channels):
        colour = CHANNEL_COLOURS[c] if channels == 3 else INK
        curves.append(_logarithmic(place, power[:, c], low, high, colour, dots=True))
    if state.picked >= 0:
        light = display.luminance(series.orders[:, state.picked].astype(np.float64))
        if light.max() > 0.0:  # its shape, lifted to the top of the plot
            curves.append(_logarithmic(place, light * (10.0**high / light.max()), low, high, INK))
    shown = range(0, len(power), -(-len(power) // MOST_BOUNCES))
    unit = "lm" if state.photometric else "W"
    of_patch = " (white: of the patch)" if state.picked >= 0 else ""
    return Curves(
        title=f"power per bounce, {unit}{of_patch}",
        below="bounce k",
        across=tuple((float(place[k]), str(k)) for k in shown),
        up=decade_ticks(low, high),
        curves=tuple(curve for curve in curves if len(curve.points)),
        marker=float(place[state.order]),
    )


def sum_curves(running: FloatArray, solved: FloatArray, theta: float) -> Curves:
    """The sum Σ L_i cos θ dω as it grows from the normal to the horizon, and where the solver has it.

    Parameters
    ----------
    running : ndarray (R + 1, 3)
        W/m².
    solved : ndarray (3,)
        W/m².
    theta : float
        Of ω_i, degrees.
    """
    top = float(max(running.max(), solved.max())) * 1.1 or 1.0
    place = np.linspace(0.0, 1.0, len(running))
    curves = [Curve(np.column_stack([place, running[:, c] / top]), CHANNEL_COLOURS[c]) for c in range(3)]
    for c in range(3):
        level = float(solved[c]) / top
        curves.append(Curve(np.array([[0.94, level], [1.0, level]]), CHANNEL_COLOURS[c], dots=True))
    ticks = display.scale_ticks(0.0, top, count=3)
    return Curves(
        title="Σ Lᵢ cos θ Δω up to θ, W/m² (dots: solver)",
        below="θ, degrees",
        across=tuple((degrees / 90.0, str(degrees)) for degrees in (0, 15, 30, 45, 60, 75, 90)),
        up=tuple((tick / top, f"{tick:g}") for tick in ticks),
        curves=tuple(curves),
        marker=theta / 90.0,
    )


def race_curves(race: Race, number: int) -> Curves:
    """Light that is still missing after so many rows, and after as many columns."""
    frames = [race[i] for i in range(number + 1)]
    end = np.log10(1.0 + race.work[-1])
    place = np.array([np.log10(1.0 + frame.rows) / end for frame in frames])
    gathered = np.array([frame.missing_gathered for frame in frames])
    shot = np.array([frame.missing_shot for frame in frames])
    powers = range(int(end) + 1)
    return Curves(
        title="light still missing: blue gathers, orange shoots",
        below="rows gathered, columns shot",
        across=tuple((float(np.log10(1.0 + 10.0**n) / end), f"{10**n:,}") for n in powers),
        up=((0.0, "0"), (0.5, "50 %"), (1.0, "100 %")),
        curves=(
            Curve(np.column_stack([place, gathered]), GATHERING, dots=True),
            Curve(np.column_stack([place, shot]), SHOOTING, dots=True),
        ),
        marker=float(place[-1]),
    )


def _logarithmic(
    place: FloatArray, values: NDArray[Any], low: int, high: int, colour: str, *, dots: bool = False
) -> Curve:
    """Positive values as a curve between two powers of ten; those below the lower one are left out."""
    shown = np.flatnonzero(values >= 10.0**low)
    height = (np.log10(values[shown]) - low) / (high - low)
    return Curve(np.column_stack([place[shown], np.minimum(height, 1.0)]), colour, dots)


def decades(power: FloatArray, most: int = MOST_DECADES) -> tuple[int, int]:
    """Powers of ten around positive values, not more than `most` apart.

    >>> decades(np.array([0.02, 7.0]))
    (-2, 1)
    """
    positive = power[power > 0.0]
    if positive.size == 0:
        return (0, 1)
    high = int(np.ceil(np.log10(positive.max()) + 1e-9))
    low = int(np.floor(np.log10(positive.min()) - 1e-9))
    return (max(low, high - most), high)


def decade_ticks(low: int, high: int, most: int = 4) -> Ticks:
    """Powers of ten along an axis.

    >>> decade_ticks(-2, 0)
    ((0.0, '10⁻²'), (0.5, '10⁻¹'), (1.0, '1'))
    """
    step = max(1, -(-(high - low) // most))
    return tuple(((n - low) / (high - low), power_of_ten(n)) for n in range(low, high + 1, step))


def power_of_ten(power: int) -> str:
    """A power of ten for an axis.

    >>> power_of_ten(-2), power_of_ten(1)
    ('10⁻²', '10')
    """
    if power in (0, 1):
        return "1" if power == 0 else "10"
    return "10" + str(power).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))
