"""What all shortcuts share: how they are described, and direct light with an ambient fitted to it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from ..errors import ParameterError
from ..form_factors import FormFactors
from ..patches import Patches
from ..solvers import Neumann
from ..transport import TransportOperator

FloatArray = NDArray[np.float64]

WRONG = "WRONG"
"""The label that stands beside every picture of a shortcut."""


@dataclass(frozen=True)
class Shortcut:
    """A wrong way to compute light.

    Attributes
    ----------
    name : str
        A few words.
    equation : str
        The equation with the missing term struck out, for matplotlib's and VTK's mathtext.
    sentence : str
        What is left out, and what one sees of it.
    """

    name: ClassVar[str]
    equation: ClassVar[str]
    sentence: ClassVar[str]

    def radiosity(
        self, patches: Patches, factors: FormFactors, truth: FloatArray | None = None, *, threads: int | None = None
    ) -> FloatArray:
        """The wrong light, W/m², (N, C).

        Parameters
        ----------
        patches : Patches
        factors : FormFactors
            The right ones; shortcuts with an exchange of their own leave them unread.
        truth : ndarray (N, C), optional
            The right radiosity, to which an ambient is fitted; solved for where it is needed and not given.
        threads : int, optional
        """
        raise NotImplementedError


STROKE = "\N{COMBINING LONG STROKE OVERLAY}"


def struck(symbols: str) -> str:
    """Mathtext of symbols, given with blanks between them, each with a stroke through it."""
    return "".join(symbol + STROKE for symbol in symbols.split())


def operator(patches: Patches, factors: FormFactors, threads: int | None) -> TransportOperator:
    """One bounce on these patches.

    Raises
    ------
    ParameterError
        Factors of other patches.
    """
    if len(factors) != len(patches):
        raise ParameterError(f"factors are of {len(factors)} patches, and there are {len(patches)}")
    return TransportOperator(factors, patches, threads=threads)


def direct_light(T: TransportOperator, patches: Patches) -> FloatArray:
    """Orders 0 and 1: what lamps and sky do by themselves, (N, C)."""
    return T.orders(patches.emission, patches.sky, count=1).sum(axis=0)


def with_ambient(T: TransportOperator, patches: Patches, openness: FloatArray, truth: FloatArray | None) -> FloatArray:
    """Direct light and ρ × openness × a constant, chosen per channel so that the mean over the area is the truth's.

    Parameters
    ----------
    T : TransportOperator
    patches : Patches
    openness : ndarray (N,)
    truth : ndarray (N, C) or None
        Solved for if not given.
    """
    if truth is None:
        truth = Neumann(rtol=1e-6, maxiter=10_000, keep_bytes=0).solve(T, patches.emission, patches.sky).radiosity
    elif truth.shape != patches.emission.shape:
        raise ParameterError(f"truth has shape {truth.shape}; give a radiosity of shape {patches.emission.shape}")
    direct = direct_light(T, patches)
    spread = patches.reflectance * openness[:, None]
    missing, answer = T.power(truth - direct), T.power(spread)
    ambient = np.divide(missing, answer, out=np.zeros_like(missing), where=answer > 0)
    return direct + ambient * spread
