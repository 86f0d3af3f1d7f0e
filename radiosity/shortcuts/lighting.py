"""Shortcuts with the right exchange and too little light: direct only, ambient, ambient occlusion, a cut series."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..errors import ParameterError
from ..form_factors import FormFactors
from ..patches import Patches
from .base import Shortcut, direct_light, operator, struck, with_ambient
from .rays import openness

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class DirectOnly(Shortcut):
    """Orders 0 and 1: light that lamps and sky send straight to a surface."""

    name = "direct light only"
    equation = r"$B = E + \rho F\,(E + " + struck(r"\rho F B") + ")$"
    sentence = (
        "What a lamp does not see is black, and no wall lends its colour to another: light stops at the first surface."
    )

    def radiosity(
        self,
        patches: Patches,
        factors: FormFactors,
        truth: FloatArray | None = None,  # noqa: ARG002  as the others
        *,
        threads: int | None = None,
    ) -> FloatArray:
        """E + T E, W/m², (N, C). See `Shortcut.radiosity`."""
        return direct_light(operator(patches, factors, threads), patches)


@dataclass(frozen=True)
class Ambient(Shortcut):
    """Direct light and one constant for all the rest, fitted to the same mean radiosity."""

    name = "direct light and a constant"
    equation = r"$B = E + \rho\,(F E + " + struck(r"F \rho F B") + " + a)$"
    sentence = (
        "One number stands for all indirect light, and even the best one is too bright in corners, too dark near lit "
        "walls, and carries no colour from wall to wall."
    )

    def radiosity(
        self, patches: Patches, factors: FormFactors, truth: FloatArray | None = None, *, threads: int | None = None
    ) -> FloatArray:
        """E + T E + ρ a with a (C,) such that the mean over the area is right. See `Shortcut.radiosity`."""
        return with_ambient(operator(patches, factors, threads), patches, np.ones(len(patches)), truth)


@dataclass(frozen=True)
class AmbientOcclusion(Shortcut):
    """Direct light and a constant that is dimmed where surfaces are near, fitted to the same mean radiosity.

    Parameters
    ----------
    distance : float
        How near counts as blocked, in diagonals of the scene.
    rays : int
        For each patch.
    seed : int

    References
    ----------
    S. Zhukov, A. Iones, G. Kronin, "An ambient light illumination model", Rendering Techniques '98; H. Landis,
    "Production-ready global illumination", SIGGRAPH course notes (2002).
    """

    distance: float = 0.1
    rays: int = 64
    seed: int = 0

    name = "ambient occlusion"
    equation = r"$B = E + \rho\,(F E + " + struck(r"F \rho F B") + r" + a\,O)$"
    sentence = (
        "Corners are darkened because they are corners, whatever light is in them: a white corner in the sun, where "
        "light gathers, goes as grey as one in the shade."
    )

    def __post_init__(self) -> None:
        if not self.distance > 0:
            raise ParameterError(f"distance is {self.distance}; give a share of the scene's diagonal above 0")

    def radiosity(
        self, patches: Patches, factors: FormFactors, truth: FloatArray | None = None, *, threads: int | None = None
    ) -> FloatArray:
        """E + T E + ρ a O with O the open share of the hemisphere, Eq. (29). See `Shortcut.radiosity`."""
        T = operator(patches, factors, threads)
        open_share = openness(patches, self.distance, self.rays, self.seed, threads)
        return with_ambient(T, patches, open_share, truth)


@dataclass(frozen=True)
class CutAt(Shortcut):
    """The series up to order k: the right light, with its tail missing.

    Parameters
    ----------
    bounces : int
        k.
    """

    bounces: int = 2

    name = "recursion cut off"
    equation = r"$B = E + T E + \ldots + T^k E + " + struck("T") + "^{" + struck("k + 1") + "}" + struck("E") + "$"
    sentence = (
        "Every bounce that is left out was light: the picture is too dark everywhere, most where light arrives late "
        "and where walls are white."
    )

    def __post_init__(self) -> None:
        if self.bounces < 0:
            raise ParameterError(f"bounces is {self.bounces}; give 0 or more")

    def radiosity(
        self,
        patches: Patches,
        factors: FormFactors,
        truth: FloatArray | None = None,  # noqa: ARG002  as the others
        *,
        threads: int | None = None,
    ) -> FloatArray:
        """Σ T^k E for k = 0 … bounces, W/m², (N, C). See `Shortcut.radiosity`."""
        T = operator(patches, factors, threads)
        return T.orders(patches.emission, patches.sky, count=self.bounces).sum(axis=0)
