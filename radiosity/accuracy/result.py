"""`Accuracy`: how accurate a solution is by its own estimate, and how that was found."""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class Trial:
    """One try on the way to an accuracy.

    Attributes
    ----------
    patches : int
    rays, light_rays : int
        For each patch; the mean where small faces have fewer.
    sampling, discretisation, truncation : float
        Errors as they were estimated by then, relative.
    seconds : float
        Since the beginning.
    """

    patches: int
    rays: int
    light_rays: int
    sampling: float
    discretisation: float
    truncation: float
    seconds: float

    @property
    def total(self) -> float:
        """All three: two that are independent of each other, and one that is not."""
        return math.hypot(self.sampling, self.discretisation) + self.truncation


@dataclass(frozen=True)
class Accuracy:
    """How accurate a solution is, by its own estimate.

    Attributes
    ----------
    target : float
        What was asked for, relative to B - E.
    trials : tuple of Trial
        Error against time; the last one is the solution's.
    """

    target: float
    trials: tuple[Trial, ...]

    @property
    def sampling(self) -> float:
        """Error from a limited number of rays."""
        return self.trials[-1].sampling

    @property
    def discretisation(self) -> float:
        """Error from patches of constant light."""
        return self.trials[-1].discretisation

    @property
    def truncation(self) -> float:
        """Error from bounces that were left out."""
        return self.trials[-1].truncation

    @property
    def total(self) -> float:
        """All three together."""
        return self.trials[-1].total

    @property
    def reached(self) -> bool:
        """Whether that is within the target."""
        return self.total <= self.target

    def __str__(self) -> str:
        last = self.trials[-1]
        parts = (
            f"sampling {last.sampling:.2%}, discretisation {last.discretisation:.2%}, truncation {last.truncation:.2%}"
        )
        head = f"accuracy: error about {last.total:.2%}, {100 * self.target:g}% asked for"
        tries = f"{len(self.trials)} trial{'s' * (len(self.trials) != 1)}"
        return f"{head} ({parts}; {tries}, {last.seconds:.2f} s)"
