"""`TwoLevelFactors`: form factors as a product of sparse matrices, for more patches than a matrix of their own serves.

The scene is seen twice: as N patches, and as S < N senders, which are groups of patches where light is smooth and
single patches where it is not. Light arrives at R receivers: corners of those groups, and the same single patches.

    means (S, N)          light of the senders: area-weighted means over their patches
    exchange (R, S)       which share of what leaves a receiver arrives at which sender, as sampled
    spread (N, R + S)     arriving light of the patches, from that of the receivers and straight from emitters

    F = spread [exchange (1 - X); 1] means,

where X picks the senders that emit, whose light goes straight to the patches: exact factors × visibility. Every
row of all three is made to add up to what it should, so that rows of F close as those of a plain matrix do.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import csr_array, diags_array

from ..errors import MemoryLimitError
from ..sparse import csr_matmul
from .factors import FormFactors
from .spot_check import SpotCheck

if TYPE_CHECKING:
    from ..patches import Patches

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

MOST_MATRIX_BYTES = 1 << 30  # of F multiplied out
PROBES = 8  # random vectors by which a defect is estimated that would take the whole matrix


@dataclass(frozen=True, eq=False)
class Levels:
    """The sparse matrices of two-level form factors, and the map from patches to senders.

    Attributes
    ----------
    means : csr_array (S, N)
    exchange : csr_array (R, S)
        Rows add up to one with to_sky and to_backs.
    spread : csr_array (N, R + S)
    sender : ndarray of int32 (N,)
        Which sender each patch is, or belongs to.
    emits : ndarray of bool (S,)
        X: senders whose light goes straight to the patches.
    to_sky, to_backs : ndarray (R,)
        Shares beside `exchange`.
    smooth : ndarray of bool (M,)
        Groups that were not given up for their patches.
    side : int
        Patches along the side of a group.
    """

    means: csr_array
    exchange: csr_array
    spread: csr_array
    sender: NDArray[np.int32]
    emits: NDArray[np.bool_]
    to_sky: FloatArray
    to_backs: FloatArray
    smooth: NDArray[np.bool_]
    side: int

    @property
    def receivers(self) -> int:
        """How many receivers there are, R."""
        return len(self.to_sky)

    @property
    def matrices(self) -> tuple[csr_array, csr_array, csr_array]:
        """All three, in the order in which light passes them."""
        return self.means, self.exchange, self.spread

    def gather(self, light: FloatArray, threads: int | None) -> FloatArray:
        """F B for (N, K)."""
        sent = csr_matmul(self.means, light, threads)
        passed = sent.copy()
        passed[self.emits] = 0.0
        arriving = csr_matmul(self.exchange, passed, threads)
        # Patches next to each other take theirs from the same places: nothing is gained by asking ahead.
        return csr_matmul(self.spread, np.concatenate([arriving, sent]), threads, ahead=False)

    def scatter(self, light: FloatArray) -> FloatArray:
        """Fᵀ x for (N, K)."""
        arriving, straight = np.split(self.spread.T @ light, [self.receivers])
        through = self.exchange.T @ arriving
        return self.means.T @ (np.where(self.emits[:, None], 0.0, through) + straight)


class TwoLevelFactors(FormFactors):
    """Form factors of N patches by way of fewer senders and receivers; see the module.

    They gather, close and are read as `FormFactors` are. `matrix`, which multiplies them out, is for few patches.

    Parameters
    ----------
    levels : Levels
    to_sky, to_backs, area : ndarray (N,)
    surface, surface_names, estimator, statistics, exact_columns
        As in `FormFactors`.
    again : callable, optional
        Patches with other light → these factors with straight paths from what emits there; see `lit_by`.
    check : SpotCheck, optional
        Rows by plain rays, for their error.
    """

    levels: Levels
    again: Again | None
    check: SpotCheck | None

    def __init__(
        self,
        levels: Levels,
        to_sky: FloatArray,
        to_backs: FloatArray,
        area: FloatArray,
        surface: NDArray[np.int32] | None = None,
        surface_names: tuple[str, ...] = (),
        estimator: object | None = None,
        statistics: dict[str, Any] | None = None,
        exact_columns: NDArray[np.bool_] | None = None,
        again: Again | None = None,
        check: SpotCheck | None = None,
    ) -> None:
        given = {name: value for name, value in locals().items() if name not in ("self", "__class__")}
        given.update(statistics=statistics or {}, replicates=())
        for name, value in given.items():
            object.__setattr__(self, name, value)

    @property
    def matrix(self) -> csr_array:
        """F multiplied out, float64 `csr_array` (N, N): nearly dense.

        Raises
        ------
        MemoryLimitError
            More than `MOST_MATRIX_BYTES`, with the bytes.
        """
        needed = 12 * len(self) ** 2
        if needed > MOST_MATRIX_BYTES:
            raise MemoryLimitError(
                f"form factors of {len(self):,} patches on two levels take {needed / 1e9:.3g} GB as one matrix, nearly "
                f"dense ({self.nbytes / 1e6:.0f} MB as they are): gather with them, take row(i), or compute a sparse "
                "matrix with MonteCarlo()"
            )
        levels, count = self.levels, self.levels.receivers
        spread, means = levels.spread.astype(np.float64), levels.means.astype(np.float64)
        through = levels.exchange.astype(np.float64) @ diags_array(np.where(levels.emits, 0.0, 1.0))
        product = csr_array(spread[:, :count] @ (through @ means) + spread[:, count:] @ means)
        product.sum_duplicates()
        return product

    @property
    def non_zeros(self) -> int:
        """Entries stored."""
        return sum(int(matrix.nnz) for matrix in self.levels.matrices)

    @property
    def terms(self) -> IntArray:
        """How many numbers add up to the arriving light of each patch, at most, (N,)."""
        means, exchange, spread = (np.diff(matrix.indptr) for matrix in self.levels.matrices)
        return spread.astype(np.int64) + int(exchange.max(initial=0)) + int(means.max(initial=0))

    @property
    def nbytes(self) -> int:
        """Bytes of the matrices."""
        return sum(m.data.nbytes + m.indices.nbytes + m.indptr.nbytes for m in self.levels.matrices)

    @property
    def rounding(self) -> float:
        """How far rows may be from one by rounding: each is a product of three that are."""
        return 4.0 * max(float(np.finfo(self.levels.spread.dtype).eps), 1e-12)

    def gather(self, light: NDArray[Any], threads: int | None = None) -> FloatArray:
        """F B, see `FormFactors.gather`."""
        flat = np.asarray(light, dtype=np.float64).reshape(len(self), -1)
        return self.levels.gather(flat, threads).reshape(np.shape(light))

    def scatter(self, light: NDArray[Any]) -> FloatArray:
        """Fᵀ x for (N,) or (N, K), float64."""
        flat = np.asarray(light, dtype=np.float64).reshape(len(self), -1)
        return self.levels.scatter(flat).reshape(np.shape(light))

    def net_exchange(self, light: FloatArray, beside: FloatArray | None = None) -> FloatArray:
        """Σ_j F_ij [(X_i - X_j) + Y_j], see `TransportOperator.net_exchange`; right to the rounding of X and Y."""
        sums = self._row_sums.reshape((-1,) + (1,) * (light.ndim - 1))
        return sums * light - self.gather(light if beside is None else light - beside)

    def between(self, left: csr_array, right: csr_array) -> FloatArray:
        """Left F right, dense (K, L), of sparse matrices (K, N) and (N, L): factors between sets of patches."""
        levels, count = self.levels, self.levels.receivers
        arriving = csr_array(left @ levels.spread.astype(np.float64))
        passed = diags_array(np.where(levels.emits, 0.0, 1.0)) @ csr_array(levels.means @ right)
        through = arriving[:, :count] @ (levels.exchange.astype(np.float64) @ passed)
        straight = arriving[:, count:] @ (levels.means @ right)
        return np.asarray((through + straight).todense(), dtype=np.float64)

    def row(self, i: int) -> FloatArray:
        """Form factors from patch i to all patches, dense (N,)."""
        levels, count = self.levels, self.levels.receivers
        to = np.zeros(levels.spread.shape[1])
        span = slice(levels.spread.indptr[i], levels.spread.indptr[i + 1])
        to[levels.spread.indices[span]] = levels.spread.data[span]
        receivers = np.flatnonzero(to[:count])
        through = np.asarray(to[receivers] @ levels.exchange[receivers].astype(np.float64)).ravel()
        row: FloatArray = levels.means.T @ (np.where(levels.emits, 0.0, through) + to[count:])
        return row

    @property
    def _row_sums(self) -> FloatArray:
        return self.gather(np.ones(len(self)))

    @property
    def closure_defect(self) -> FloatArray:
        """1 - Σ_j F[i, j] - to_sky - to_backs, (N,)."""
        return 1.0 - self._row_sums - self.to_sky - self.to_backs

    @property
    def reciprocity_defect(self) -> float:
        """‖G - Gᵀ‖ / ‖G‖ (Frobenius), estimated from the products of both with a few random vectors.

        E ‖M x‖² = ‖M‖² for x of independent signs (M. F. Hutchinson 1990, doi:10.1080/03610919008812866).
        """
        signs = np.where(np.random.default_rng(0).random((len(self), PROBES)) < 0.5, -1.0, 1.0)
        area = self.area[:, None]
        forward = area * self.gather(signs)
        size = np.linalg.norm(forward)
        return float(np.linalg.norm(forward - self.scatter(area * signs)) / size) if size > 0 else 0.0

    @property
    def standard_error(self) -> None:
        """None: not estimated."""
        return

    def conserved(self, keep: ArrayLike | None = None) -> FormFactors:
        """Of these multiplied out, see `FormFactors.conserved`.

        Raises
        ------
        MemoryLimitError
            Too many patches for one matrix.
        """
        return self.assembled().conserved(keep)

    def assembled(self) -> FormFactors:
        """The same factors with their matrix multiplied out.

        Raises
        ------
        MemoryLimitError
            Too many patches for one matrix.
        """
        return FormFactors(
            self.matrix,
            self.to_sky,
            self.to_backs,
            self.area,
            self.surface,
            self.surface_names,
            self.estimator,
            dict(self.statistics),
            (),
            self.exact_columns,
        )

    def lit_by(self, patches: Patches) -> TwoLevelFactors:
        """These factors for other light: with straight paths from whatever emits in `patches`, too.

        The geometry stays as it was sampled; only the shadow rays of new emitters are sent. The same factors where
        nothing new emits.
        """
        known = np.zeros(len(self), dtype=bool) if self.exact_columns is None else self.exact_columns
        new = (patches.emission > 0).any(axis=1) & ~known
        if not new.any() or self.again is None:
            return self
        return self.again(self, patches)


Again = Callable[[TwoLevelFactors, "Patches"], TwoLevelFactors]
