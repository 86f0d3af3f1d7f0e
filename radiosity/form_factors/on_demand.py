"""Form factors that are computed row by row when asked for, and never stored."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NoReturn

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import FormFactorError, MemoryLimitError

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class RowsOnDemand:
    """N patches whose rows of form factors come from a function, one at a time.

    For scenes whose matrix would not fit, and for `Shooting`, which needs one row a shot. Other solvers run too,
    at N rows a product.

    Attributes
    ----------
    compute : callable
        i → row i of F, dense (N,).
    area : ndarray (N,)
        m².
    to_sky, to_backs : ndarray (N,)
        Shares that leave the scene, and that land on black backs. With the row they have to sum to one: each
        row is checked when it is computed.

    Examples
    --------
    >>> rows = RowsOnDemand.of(lambda i: np.array([[0.0, 0.2], [0.1, 0.0]])[i], area=[1.0, 2.0], to_sky=[0.8, 0.9])
    >>> rows.row(1)
    array([0.1, 0. ])
    """

    compute: Callable[[int], FloatArray]
    area: FloatArray
    to_sky: FloatArray
    to_backs: FloatArray
    surface: NDArray[np.int32] | None = None
    surface_names: tuple[str, ...] = ()

    @classmethod
    def of(
        cls,
        compute: Callable[[int], ArrayLike],
        area: ArrayLike,
        to_sky: ArrayLike | None = None,
        to_backs: ArrayLike | None = None,
    ) -> RowsOnDemand:
        """Take a function and lists; nothing goes to the sky or to backs unless given."""
        areas = np.array(area, dtype=np.float64)
        sky = np.zeros(len(areas)) if to_sky is None else np.array(to_sky, dtype=np.float64)
        backs = np.zeros(len(areas)) if to_backs is None else np.array(to_backs, dtype=np.float64)
        return cls(lambda i: np.asarray(compute(i), dtype=np.float64), areas, sky, backs)

    def __len__(self) -> int:
        """Number of patches N."""
        return len(self.area)

    def row(self, i: int) -> FloatArray:
        """Form factors from patch i to all patches, (N,).

        Raises
        ------
        FormFactorError
            NaN, negative shares, a row that does not close with its sky and backs.
        """
        row = self.compute(i)
        closure = float(np.sum(row)) + self.to_sky[i] + self.to_backs[i] if row.shape == self.area.shape else np.nan
        if not (abs(closure - 1.0) <= 1e-6 and row.min() >= 0.0):
            raise FormFactorError(
                f"row {i} of F has shape {row.shape} and sums with sky and backs to {closure:.9g}: give (N,) shares, "
                "none negative, that sum to 1"
            )
        return row

    @property
    def closure_defect(self) -> FloatArray:
        """Zero, (N,): rows that do not close are refused when they are computed."""
        return np.zeros(len(self))

    def gather(self, light: FloatArray, threads: int | None = None) -> FloatArray:  # noqa: ARG002  as FormFactors
        """F B for (N, …), computing every row once."""
        flat = light.reshape(len(self), -1)
        out = np.empty_like(flat, dtype=np.float64)
        for i in range(len(self)):
            out[i] = np.sum(self.row(i)[:, None] * flat, axis=0)
        return out.reshape(light.shape)

    def net_exchange(self, light: FloatArray, beside: FloatArray | None = None) -> FloatArray:
        """Σ_j F_ij [(X_i - X_j) + Y_j], see `TransportOperator.net_exchange`."""
        flat = light.reshape(len(self), -1)
        added = np.zeros_like(flat) if beside is None else beside.reshape(flat.shape)
        out = np.empty_like(flat, dtype=np.float64)
        for i in range(len(self)):
            out[i] = np.sum(self.row(i)[:, None] * ((flat[i] - flat) + added), axis=0)
        return out.reshape(light.shape)

    @property
    def matrix(self) -> NoReturn:
        """Never stored.

        Raises
        ------
        MemoryLimitError
        """
        raise MemoryLimitError(
            f"rows on demand have no matrix ({8 * len(self) ** 2:.3g} bytes if dense): use Shooting or Neumann, or "
            "FormFactors"
        )
