"""Shortcuts with a wrong exchange of light between patches: the cosine forgotten, visibility forgotten."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import csr_array

from ..errors import ParameterError
from ..form_factors import FormFactors
from ..patches import Patches
from ..rays import Tracer
from ..sparse import csr_matmul
from .base import Shortcut, struck
from .rays import ThroughWalls, count_shares, without_cosine

FloatArray = NDArray[np.float64]

POWER_STEPS = 60
MOST_RAYS = 1 << 23  # of all patches together, by default: about a second
FEWEST, MOST = 256, 2048  # of one patch


@dataclass(frozen=True, eq=False)
class WrongExchange:
    """What stands in the place of form factors in a wrong equation. No `FormFactors`, and no solver takes it.

    Attributes
    ----------
    name : str
        Of the shortcut.
    matrix : csr_array (N, N)
        Irradiance at i per radiosity of j.
    to_sky, to_backs : ndarray (N,)
        The same of the sky, and of black backs.
    """

    name: str
    matrix: csr_array
    to_sky: FloatArray
    to_backs: FloatArray

    @property
    def row_sums(self) -> FloatArray:
        """Σ_j matrix[i, j] + to_sky + to_backs, (N,): would be 1."""
        return csr_matmul(self.matrix, np.ones(self.matrix.shape[1])) + self.to_sky + self.to_backs

    def orders(self, patches: Patches, count: int, threads: int | None = None) -> FloatArray:
        """Light by number of bounces, (count + 1, N, C), W/m²: as `TransportOperator.orders`, and wrong."""
        orders = np.zeros((count + 1, *patches.emission.shape))
        orders[0] = patches.emission
        for k in range(1, count + 1):
            arriving = csr_matmul(self.matrix, orders[k - 1], threads)
            if k == 1:
                arriving = arriving + np.pi * self.to_sky[:, None] * patches.sky
            orders[k] = patches.reflectance * arriving
        return orders

    def spectral_radius(self, reflectance: ArrayLike) -> FloatArray:
        """Factor by which each bounce multiplies light in the long run, per channel (C,); 1 or more: no end of light.

        By the power method, from two bounces at a time, because light between two walls alternates. Right where one
        mode leads clearly, as in a single room.

        Parameters
        ----------
        reflectance : array_like (N, C)
        """
        rho = np.asarray(reflectance, dtype=np.float64)
        light = np.ones_like(rho)
        factor = np.zeros(rho.shape[1])
        for _ in range(POWER_STEPS):
            after = rho * csr_matmul(self.matrix, rho * csr_matmul(self.matrix, light))
            size = np.linalg.norm(after, axis=0)
            factor = np.sqrt(size / np.maximum(np.linalg.norm(light, axis=0), 1e-300))
            light = after / np.where(size > 0, size, 1.0)
        return factor


@dataclass(frozen=True)
class _WrongSeries(Shortcut):
    """A shortcut with an exchange of its own, summed over some bounces because its series may have no end.

    Parameters
    ----------
    bounces : int
        Orders 0 … bounces are added up.
    rays : int, optional
        For each patch; by default 2048, fewer where there are so many patches that it would take seconds.
    seed : int
    """

    bounces: int = 4
    rays: int | None = None
    seed: int = 0

    def __post_init__(self) -> None:
        if self.bounces < 0 or (self.rays is not None and self.rays < 1):
            raise ParameterError(f"bounces is {self.bounces} and rays {self.rays}; give at least 0 and 1")

    def rays_for(self, patches: Patches) -> int:
        """How many each patch sends."""
        if self.rays is not None:
            return self.rays
        affordable = MOST_RAYS // max(1, len(patches))
        return min(max(1 << max(0, affordable.bit_length() - 1), FEWEST), MOST)

    def exchange(self, patches: Patches, threads: int | None = None) -> WrongExchange:
        """The wrong exchange of some patches."""
        raise NotImplementedError

    def radiosity(
        self,
        patches: Patches,
        factors: FormFactors,  # noqa: ARG002  as the others
        truth: FloatArray | None = None,  # noqa: ARG002
        *,
        threads: int | None = None,
    ) -> FloatArray:
        """The sum of the wrong orders 0 … bounces, W/m², (N, C). See `Shortcut.radiosity`."""
        return self.exchange(patches, threads).orders(patches, self.bounces, threads).sum(axis=0)


@dataclass(frozen=True)
class NoCosine(_WrongSeries):
    """Irradiance without Lambert's cosine: light that grazes a surface counts as much as light from straight above.

    ∫ cos θ dω = π over the hemisphere, and ∫ dω = 2π: rows sum to 2, Eq. (28), a bounce can double the light, and
    where ρ passes 1/2 all around, the series has no end.
    """

    name = "cosine forgotten"
    equation = (
        r"$L_o = L_e + \frac{\rho}{\pi} \int L_i\,\mathrm{"
        + struck("c o s")
        + r"}\,"
        + struck(r"\theta")
        + r"_i\;d\omega_i$"
    )
    sentence = (
        "Light that grazes a surface counts as much as light from straight above: edges glow, forms go flat, and "
        "bright rooms gain light with every bounce."
    )

    def exchange(self, patches: Patches, threads: int | None = None) -> WrongExchange:
        """Solid angles over π, by rays uniform over the hemisphere with a weight of 2 each."""
        follow = without_cosine(patches, Tracer(patches.grid))
        matrix, missed, backs = count_shares(patches, self.rays_for(patches), self.seed, follow, threads)
        to_sky = np.zeros(len(patches)) if patches.closed else 2.0 * missed
        return WrongExchange(self.name, csr_array(2.0 * matrix), to_sky, 2.0 * backs)


@dataclass(frozen=True)
class NoVisibility(_WrongSeries):
    """Form factors as if nothing stood in between: light goes through walls, and there is no shadow.

    Every front that a ray meets on its way counts, and the sky shines everywhere. Right only in convex rooms.
    """

    name = "visibility forgotten"
    equation = (
        r"$B_i = E_i + \rho_i \sum_j B_j \frac{1}{A_i} \iint "
        + struck("V")
        + r"\,\frac{\cos\theta_i \cos\theta_j}{\pi r^2}\,dA_j\,dA_i$"
    )
    sentence = (
        "Nothing throws a shadow and lamps shine through walls: surfaces get light from more than all around them, and "
        "nothing looks as if it stood on the floor."
    )

    def exchange(self, patches: Patches, threads: int | None = None) -> WrongExchange:
        """Unoccluded form factors, by rays that go through everything."""
        matrix, _, backs = count_shares(patches, self.rays_for(patches), self.seed, ThroughWalls(patches), threads)
        to_sky = np.zeros(len(patches)) if patches.closed else np.ones(len(patches))
        return WrongExchange(self.name, matrix, to_sky, backs)
