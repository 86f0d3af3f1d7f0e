"""Patches that no light is found for, and why: they cost as much as others, and often tell of a slip in the model."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .form_factors import FormFactors
from .patches import Patches
from .solvers.admission import connected_components, where

IntArray = NDArray[np.int64]

ALL = 1.0 - 1e-6  # of what leaves a patch


@dataclass(frozen=True, eq=False)
class DarkPatches:
    """Patches of enclosures without any light, by what they see.

    Attributes
    ----------
    outside : ndarray of int
        Nothing but black surroundings: outer sides of a room's walls, bottoms of things that reach through a floor.
    covered : ndarray of int
        Nothing but black backs: faces inside of bodies.
    shut_in : ndarray of int
        Each other, or some of all this: insides of closed bodies, and what was left out because it stays dark.
    story : str
        One sentence, with the surfaces; empty where there are none.
    """

    outside: IntArray
    covered: IntArray
    shut_in: IntArray
    story: str

    def __len__(self) -> int:
        """Number of dark patches."""
        return len(self.outside) + len(self.covered) + len(self.shut_in)


def dark_patches(patches: Patches, factors: FormFactors) -> DarkPatches:
    """Find patches to which no path of light leads, however often it bounces.

    Parameters
    ----------
    patches : Patches
    factors : FormFactors
        Of the patches. What no ray has found is not known: with few rays, a pinhole or a narrow gap may be missed.

    Returns
    -------
    DarkPatches
        Empty for a scene without any light, of which there is no more to say.
    """
    label = connected_components(factors)
    source = patches.emission.any(axis=1) | ((factors.to_sky > 0) & bool(patches.sky.any()))
    lit = np.bincount(label, source, minlength=label.max(initial=0) + 1) > 0
    dark = ~lit[label] if lit.any() else np.zeros(len(label), dtype=bool)
    outside = dark & (factors.to_sky > ALL)
    covered = dark & (factors.to_backs > ALL)
    if factors.left_out is not None:  # light was known not to get there; what they see was not looked at
        covered &= ~factors.left_out
    kinds = [np.flatnonzero(which) for which in (outside, covered, dark & ~outside & ~covered)]
    words = ("look at nothing but the black surroundings", "see nothing but black backs", "are shut off")
    parts = [f"{len(k):,} {what} ({where(factors, k)})" for k, what in zip(kinds, words, strict=True) if len(k)]
    head = f"no light was found for {int(dark.sum()):,} of {len(patches):,} patches"
    return DarkPatches(kinds[0], kinds[1], kinds[2], f"{head}: {', '.join(parts)}" if parts else "")
