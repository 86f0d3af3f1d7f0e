"""What lengths a closed form may be asked about."""

from __future__ import annotations

import math

from ...errors import ParameterError


def check_positive(**lengths: float) -> None:
    """Refuse lengths that are not positive and finite, by name.

    Raises
    ------
    ParameterError
    """
    for name, value in lengths.items():
        if not (value > 0.0 and math.isfinite(value)):
            raise ParameterError(f"{name} is {value:g}; give a positive finite length")


def check_not_negative(**lengths: float) -> None:
    """Refuse lengths that are negative or not finite, by name.

    Raises
    ------
    ParameterError
    """
    for name, value in lengths.items():
        if not (value >= 0.0 and math.isfinite(value)):
            raise ParameterError(f"{name} is {value:g}; give a finite length that is not negative")


def check_interval(**intervals: tuple[float, float]) -> None:
    """Refuse intervals that are empty or not finite, by name.

    Raises
    ------
    ParameterError
    """
    for name, (low, high) in intervals.items():
        if not (math.isfinite(low) and math.isfinite(high) and low < high):
            raise ParameterError(f"{name} runs from {low:g} to {high:g}; give two finite ends, the lower one first")
