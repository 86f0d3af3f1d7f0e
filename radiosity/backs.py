"""Light that falls on black backs: fair where it is meant, but mostly a room whose walls are wound the wrong way."""

from __future__ import annotations

import numpy as np

from .finding import names
from .form_factors import FormFactors
from .patches import Patches

MUCH = 0.1  # of what lamps send out
AWAY = 1.0 - 1e-6  # of what leaves a patch goes to the sky: it looks at nothing


def light_on_backs(patches: Patches, factors: FormFactors) -> str:
    """Say how much of the lamps' light falls on black backs, where it is a tenth or more.

    Parameters
    ----------
    patches : Patches
    factors : FormFactors
        Of the patches; lamps whose rows were left out, because they reflect nothing, do not count.

    Returns
    -------
    str
        With the surfaces that look at nothing, whose backs they most likely are, and the remedy; empty where little
        light is lost so.
    """
    power = patches.area * patches.emission.sum(axis=1)
    if factors.left_out is not None:
        power = np.where(factors.left_out, 0.0, power)
    total = float(power.sum())
    share = float(power @ factors.to_backs) / total if total > 0 else 0.0
    if share < MUCH:
        return ""
    away = np.flatnonzero(_area_by_surface(patches, factors.to_sky > AWAY) > 0.99 * _area_by_surface(patches))
    suspects = names([patches.surface_names[k] for k in away])
    whose = f"; {suspects} look{'s' * (len(away) == 1)} away from everything" if len(away) else ""
    return (
        f"{share:.0%} of the lamps' light falls on the black backs of one-sided faces{whose}: turn such faces round "
        "(rad.read_scene(…, turn=[surface]), --turn SURFACE) or make them two-sided (Material(two_sided=True))"
    )


def _area_by_surface(patches: Patches, which: np.ndarray | float = 1.0) -> np.ndarray:
    return np.bincount(patches.surface, patches.area * which, minlength=len(patches.surface_names))
