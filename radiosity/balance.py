"""Where the power goes: what is put in, and what becomes of it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .form_factors import FormFactors
from .patches import Patches

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class PowerBalance:
    """Power put into a scene and where it ends, W, (C,) each.

    emitted + from_sky = absorbed + to_sky + to_backs + missing.

    Attributes
    ----------
    emitted : ndarray (C,)
        By the surfaces, Σ A E.
    from_sky : ndarray (C,)
        Sky light that arrives on the surfaces, Σ A π to_sky L_sky.
    absorbed : ndarray (C,)
        By the surfaces, Σ A α H.
    to_sky, to_backs : ndarray (C,)
        What leaves the scene, and what black backs of one-sided faces take.
    missing : ndarray (C,)
        What the sum lacks (above zero) or has too much: the residual of the solution, and with raw form factors
        their sampling error, because they are not reciprocal to the last digit.
    """

    emitted: FloatArray
    from_sky: FloatArray
    absorbed: FloatArray
    to_sky: FloatArray
    to_backs: FloatArray

    @property
    def put_in(self) -> FloatArray:
        """Emitted and from the sky, W, (C,)."""
        return self.emitted + self.from_sky

    @property
    def missing(self) -> FloatArray:
        """put_in - absorbed - to_sky - to_backs, W, (C,)."""
        return self.put_in - self.absorbed - self.to_sky - self.to_backs

    @property
    def defect(self) -> float:
        """(absorbed + to_sky + to_backs) / put_in - 1, all channels together; 0 in a dark scene."""
        total = float(self.put_in.sum())
        return -float(self.missing.sum()) / total if total > 0 else 0.0


def power_balance(
    patches: Patches, factors: FormFactors, radiosity: FloatArray, irradiance: FloatArray
) -> PowerBalance:
    """Power balance of a solution.

    Parameters
    ----------
    patches : Patches
    factors : FormFactors
    radiosity, irradiance : ndarray (N, C)
        W/m².
    """

    def total(density: FloatArray) -> FloatArray:
        return np.sum(patches.area[:, None] * density, axis=0)

    return PowerBalance(
        emitted=total(patches.emission),
        from_sky=total(np.pi * factors.to_sky[:, None] * patches.sky),
        absorbed=total(patches.absorptance * irradiance),
        to_sky=total(factors.to_sky[:, None] * radiosity),
        to_backs=total(factors.to_backs[:, None] * radiosity),
    )
