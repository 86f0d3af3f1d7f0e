"""`FormFactors`: which share of the light that leaves one patch arrives at another, Eq. (4).

Reciprocity is Eq. (5), closure Eq. (6).
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import csr_array, issparse

from ..errors import FormFactorError
from ..sparse import csr_matmul

if TYPE_CHECKING:
    from typing import Self

    from ..patches import Patches
    from .surfaces import SurfaceFactors

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

ROW_SUM_TOLERANCE = 1e-6  # float32 weights of one row add up to this near


@dataclass(frozen=True, eq=False)
class FormFactors:
    """Form factors of N patches: F[i, j] is the share of what leaves i that arrives at j.

    What estimators return, raw: rows close (`closure_defect` is zero to rounding) and reciprocity
    A_i F_ij = A_j F_ji holds only within the sampling error.

    Attributes
    ----------
    matrix : csr_array (N, N)
        float32 or float64, rows sorted by column.
    to_sky, to_backs : ndarray (N,)
        Shares that leave the scene, and that land on black backs of one-sided faces.
    area : ndarray (N,)
        m².
    surface : ndarray of int (N,) or None
        Index of each patch's surface in `surface_names`.
    surface_names : tuple of str
    estimator : object or None
        What computed the factors.
    statistics : dict
        Counters ("rays/traced", "rays/to_backs", "seconds/…") in the order of the work.
    replicates : tuple of FormFactors
        Independent estimates whose mean this is; empty when there was only one.
    exact_columns : ndarray of bool (N,) or None
        Patches whose columns are exact factors times visibility, and were not sampled like the rest: emitters, for
        direct light. None if there are no such.
    left_out : ndarray of bool (N,) or None
        Patches whose rows were not made, because nothing that was asked for depends on them: they are empty, with all
        light on black backs. None if there are no such. See `radiosity.form_factors.estimate.completed`.
    """

    matrix: csr_array
    to_sky: FloatArray
    to_backs: FloatArray
    area: FloatArray
    surface: NDArray[np.int32] | None = None
    surface_names: tuple[str, ...] = ()
    estimator: object | None = None
    statistics: dict[str, Any] = field(default_factory=dict)
    replicates: tuple[FormFactors, ...] = ()
    exact_columns: NDArray[np.bool_] | None = None
    left_out: NDArray[np.bool_] | None = None

    @classmethod
    def from_matrix(
        cls, F: ArrayLike, area: ArrayLike, *, to_sky: ArrayLike | None = None, to_backs: ArrayLike | None = None
    ) -> Self:
        """Take form factors that something else computed.

        Parameters
        ----------
        F : array_like or sparse (N, N)
            Shares in [0, 1]; row i is what leaves patch i.
        area : array_like (N,)
            m², positive.
        to_sky : array_like (N,), optional
            Share that leaves the scene; by default what is missing from a row sum of one.
        to_backs : array_like (N,), optional
            Share that lands on black backs; none by default.

        Raises
        ------
        FormFactorError
            Shapes that do not fit, entries that are NaN or negative, rows that pass 1: with row and column.

        Examples
        --------
        >>> F = FormFactors.from_matrix([[0.0, 0.2], [0.1, 0.0]], area=[1.0, 2.0])
        >>> F.to_sky
        array([0.8, 0.9])
        """
        matrix = csr_array(F) if issparse(F) else csr_array(np.atleast_2d(np.asarray(F, dtype=np.float64)))
        if matrix.dtype not in (np.float32, np.float64):
            matrix = matrix.astype(np.float64)
        matrix.sum_duplicates()
        areas = np.array(area, dtype=np.float64)
        check_matrix(matrix, areas)
        sums = row_sums(matrix)
        backs = np.zeros(len(areas)) if to_backs is None else np.array(to_backs, dtype=np.float64)
        if to_sky is None:
            check_shares(sums, np.zeros(len(areas)), backs)
            sky = 1.0 - sums - backs
            sky[sky < ROW_SUM_TOLERANCE] = 0.0  # rounding of a closed row, not a window
        else:
            sky = np.array(to_sky, dtype=np.float64)
        check_shares(sums, sky, backs)
        return cls(matrix, sky, backs, areas)

    def __repr__(self) -> str:
        return f"<{type(self).__name__} of {len(self):,} patches by {self.estimator}>"

    def __len__(self) -> int:
        """Number of patches N."""
        return len(self.area)

    @property
    def non_zeros(self) -> int:
        """Entries stored."""
        return int(self.matrix.nnz)

    @property
    def terms(self) -> IntArray:
        """How many numbers add up to the arriving light of each patch, (N,)."""
        return np.diff(self.matrix.indptr).astype(np.int64)

    @property
    def nbytes(self) -> int:
        """Bytes of the matrix."""
        matrix = self.matrix
        return int(matrix.data.nbytes + matrix.indices.nbytes + matrix.indptr.nbytes)

    def gather(self, light: NDArray[Any], threads: int | None = None) -> FloatArray:
        """Irradiance F B that light B brings to each patch.

        Parameters
        ----------
        light : ndarray (N,), (N, C) or (N, C, S)
            Radiosity, W/m².
        threads : int, optional

        Returns
        -------
        ndarray of float64, same shape
            W/m². Sums are float64, and the same bits for any number of threads.
        """
        return csr_matmul(self.matrix, light, threads)

    def row(self, i: int) -> FloatArray:
        """Form factors from patch i to all patches, dense (N,).

        Raises
        ------
        FormFactorError
            The row was left out.
        """
        if self.left_out is not None and self.left_out[i]:
            raise FormFactorError(
                f"row {i} was left out, as no light depends on it: take Solution.factors, which makes what is missing, "
                "or solve(…, leave_out=False)"
            )
        row = np.zeros(len(self))
        span = slice(self.matrix.indptr[i], self.matrix.indptr[i + 1])
        row[self.matrix.indices[span]] = self.matrix.data[span]
        return row

    @property
    def closure_defect(self) -> FloatArray:
        """1 - Σ_j F[i, j] - to_sky - to_backs, (N,): what is lost (above zero) or invented (below)."""
        return 1.0 - row_sums(self.matrix) - self.to_sky - self.to_backs

    @property
    def reciprocity_defect(self) -> float:
        """‖G - Gᵀ‖ / ‖G‖ (Frobenius) of the exchange areas G[i, j] = A[i] F[i, j]; 0 for exact factors."""
        exchange = self.exchange_area()
        size = np.sqrt(np.sum(exchange.data**2))
        if size == 0.0:
            return 0.0
        return float(np.sqrt(np.sum((exchange - exchange.T).data ** 2)) / size)

    def between_surfaces(self, surface: ArrayLike | None = None, names: tuple[str, ...] = ()) -> SurfaceFactors:
        """Form factors between whole surfaces, area-weighted, with standard errors where there are any.

        Parameters
        ----------
        surface : array_like of int (N,), optional
            Another grouping than by the scene's surfaces: the number of each patch's group.
        names : tuple of str, optional
            Of those groups.

        Returns
        -------
        SurfaceFactors
            ``print`` it for a table. See `radiosity.form_factors.surfaces`.

        Examples
        --------
        >>> import radiosity as rad
        >>> patches = rad.subdivide(rad.scenes.furnace(), patch_count=24)
        >>> table = rad.form_factors(patches, rad.MonteCarlo(rays=4096)).between_surfaces()
        >>> round(table.factor("floor", "ceiling"), 2)
        0.2
        """
        from .surfaces import between_surfaces

        return between_surfaces(self, surface, names)

    def conserved(self, keep: ArrayLike | None = None) -> FormFactors:
        """New float64 factors that close and are reciprocal, from these by the least symmetric scaling.

        For conjugate gradients, small absorptances and exact energy balances; raw factors serve ordinary ones better.

        Parameters
        ----------
        keep : array_like of bool (N,), optional
            Patches whose columns are left as they are; by default `exact_columns`.

        Returns
        -------
        FormFactors
            What it took is in `statistics`, under "conserve/…". See `radiosity.form_factors.conserve`.

        Raises
        ------
        FormFactorError
            No such scaling exists; with the patches.

        Examples
        --------
        >>> import radiosity as rad
        >>> patches = rad.subdivide(rad.scenes.furnace())
        >>> even = rad.form_factors(patches, rad.MonteCarlo(rays=64, replicates=2)).conserved()
        >>> even.reciprocity_defect
        0.0
        >>> float(np.max(np.abs(even.closure_defect))) < 1e-15
        True
        """
        from .conserve import conserve

        return conserve(self, None if keep is None else np.asarray(keep, dtype=bool))

    def lit_by(self, patches: Patches) -> FormFactors:  # noqa: ARG002  # see TwoLevelFactors
        """Factors for the light that `patches` emit: these, which serve any light."""
        return self

    def exchange_area(self) -> csr_array:
        """G[i, j] = A[i] F[i, j], m², float64 (N, N); symmetric up to the sampling error."""
        weights = np.repeat(self.area, np.diff(self.matrix.indptr)) * self.matrix.data.astype(np.float64)
        return csr_array((weights, self.matrix.indices, self.matrix.indptr), shape=self.matrix.shape)

    @property
    def standard_error(self) -> csr_array | None:
        """Standard error of each form factor, on the sparsity of `matrix` (N, N); None where there is no estimate.

        From the spread of independent replicates. One replicate of plain random rays is binomial:
        √(F (1 - F) / rays). One low-discrepancy sequence holds no estimate of its own error.
        """
        if self.replicates:
            return _spread(self.replicates, len(self))
        rays = getattr(self.estimator, "binomial_rays", None)
        if rays is None:
            return None
        share = self.matrix.data.astype(np.float64)
        error = np.sqrt(share * (1.0 - share) / rays)
        return csr_array((error, self.matrix.indices, self.matrix.indptr), shape=self.matrix.shape)


def _spread(replicates: tuple[FormFactors, ...], count: int) -> csr_array:
    """Standard error of the mean of replicates, entry by entry."""
    runs = len(replicates)
    total = csr_array((count, count))
    squares = csr_array((count, count))
    for run in replicates:
        matrix = run.matrix.astype(np.float64)
        total = total + matrix
        squares = squares + matrix.multiply(matrix).tocsr()
    variance = squares - total.multiply(total).tocsr() / runs
    variance.data = np.sqrt(np.maximum(variance.data, 0.0) / (runs - 1) / runs)
    return csr_array(variance)


def row_sums(matrix: csr_array) -> FloatArray:
    """Σ_j F[i, j] in float64, (N,)."""
    return csr_matmul(matrix, np.ones(matrix.shape[1]))


def check_matrix(matrix: csr_array, area: FloatArray) -> None:
    """Refuse what cannot be a matrix of form factors, with row and column.

    Raises
    ------
    FormFactorError
    """
    rows, columns = matrix.shape
    if rows != columns or area.shape != (rows,):
        raise FormFactorError(f"F has shape {matrix.shape} and area {area.shape}; give (N, N) and (N,)")
    bad = np.flatnonzero(~(np.isfinite(area) & (area > 0)))
    if bad.size:
        raise FormFactorError(f"area {area[bad[0]]:g} m² of patch {bad[0]} is not positive and finite")
    wrong = np.flatnonzero(~(matrix.data >= 0) | ~np.isfinite(matrix.data))
    if wrong.size:
        row = int(np.searchsorted(matrix.indptr, wrong[0], side="right")) - 1
        raise FormFactorError(
            f"F[{row}, {matrix.indices[wrong[0]]}] = {matrix.data[wrong[0]]:g} is not a share in [0, 1] "
            f"({wrong.size} such entries); compute the factors again"
        )


def check_shares(sums: FloatArray, to_sky: FloatArray, to_backs: FloatArray) -> None:
    """Refuse rows that send out more than they have, or a negative share.

    Raises
    ------
    FormFactorError
    """
    for name, share in (("to_sky", to_sky), ("to_backs", to_backs)):
        if share.shape != sums.shape:
            raise FormFactorError(f"{name} has shape {share.shape}; give one share per patch, {sums.shape}")
    over = sums + to_sky + to_backs - 1.0
    worst = int(np.argmax(np.where(np.isfinite(over), over, np.inf)))
    if not over[worst] <= ROW_SUM_TOLERANCE:
        raise FormFactorError(
            f"row {worst} of F sums to {sums[worst]:.9g}, with sky {to_sky[worst]:.3g} and backs "
            f"{to_backs[worst]:.3g}: more than 1 leaves patch {worst}. Scale the row, or use conserved factors"
        )
    for name, share in (("to_sky", to_sky), ("to_backs", to_backs)):
        least = int(np.argmin(share))
        if share[least] < -ROW_SUM_TOLERANCE:
            raise FormFactorError(f"{name} {share[least]:.3g} of patch {least} is negative")
