"""Where the power of each enclosure goes, and how exactly it must add up."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..form_factors.conserve import arrival_defect, sampling_rays
from ..solvers.admission import connected_components, where
from ..transport import TransportOperator

FloatArray = NDArray[np.float64]

RECIPROCAL = 1e-12  # reciprocity defect of factors that balance exactly


@dataclass(frozen=True)
class EnclosureEnergy:
    """Power of one connected enclosure, all channels together, W.

    Attributes
    ----------
    place : str
        Its surfaces.
    patches : int
    emitted : float
        By its surfaces, and by the sky onto them.
    absorbed : float
        Σ A α H.
    escaped : float
        To the sky and to black backs.
    leaked : float
        Through rows that do not close.
    """

    place: str
    patches: int
    emitted: float
    absorbed: float
    escaped: float
    leaked: float

    @property
    def defect(self) -> float:
        """(absorbed + escaped + leaked) / emitted - 1; 0 in a dark enclosure."""
        return (self.absorbed + self.escaped + self.leaked) / self.emitted - 1.0 if self.emitted > 0 else 0.0


def enclosure_energies(
    T: TransportOperator, emission: FloatArray, radiosity: FloatArray, sky: ArrayLike | None = None
) -> tuple[EnclosureEnergy, ...]:
    """Power put into each enclosure and where it ends, brightest first; dark enclosures are left out.

    Parameters
    ----------
    T : TransportOperator
    emission, radiosity : ndarray (N, C)
        W/m².
    sky : array_like (C,), optional
        W/(m² sr).
    """
    factors = T.factors
    from_sky = np.zeros(T.channels) if sky is None else np.pi * np.asarray(sky, dtype=np.float64)
    arriving = factors.to_sky[:, None] * from_sky
    open_share = factors.to_sky + factors.to_backs
    power = {
        "emitted": emission + arriving,
        "absorbed": T.absorptance * (factors.gather(radiosity, T.threads) + arriving),
        "escaped": open_share[:, None] * radiosity,
        "leaked": (T.to_outside - open_share)[:, None] * radiosity,
    }
    label = connected_components(factors)
    sums = {name: np.bincount(label, T.area * density.sum(axis=1)) for name, density in power.items()}
    order = np.argsort(-sums["emitted"], kind="stable")
    return tuple(
        EnclosureEnergy(where(factors, label == m), int(np.sum(label == m)), *(float(sums[name][m]) for name in power))
        for m in order
        if sums["emitted"][m] > 0
    )


def energy_error(T: TransportOperator, radiosity: FloatArray, reciprocity: float) -> float | None:
    """Standard error of absorbed + escaped - emitted, W, that sampled form factors leave; None where it is not known.

    The defect is Σ_j A_j B_j (Σ_i A_i F_ij / A_j + to_sky_j + to_backs_j - 1): columns of sampled factors do not
    close. The larger of the spread of replicates and of independent rays, Σ_i A_i² (F B² - (F B)²)_i / rays, which is
    too large for low-discrepancy ones.
    """
    if reciprocity <= RECIPROCAL:
        return 0.0
    factors, light = T.stored_factors, radiosity.sum(axis=1)
    errors = []
    if len(factors.replicates) > 1:
        defects = [np.sum(T.area * light * arrival_defect(run)) for run in factors.replicates]
        errors.append(float(np.std(defects, ddof=1) / np.sqrt(len(defects))))
    rays = sampling_rays(factors)
    if rays is not None:
        mean, squares = factors.gather(np.column_stack([light, light**2]), T.threads).T
        errors.append(float(np.sqrt(np.sum(T.area**2 * np.maximum(squares - mean**2, 0.0)) / rays)))
    return max(errors) if errors else None
