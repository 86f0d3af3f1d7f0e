"""Form factors between whole surfaces: those of their patches, weighted by area."""

from __future__ import annotations

import csv
import io
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import csr_array

from ..compiled import kernel
from ..errors import FormFactorError, MemoryLimitError, ParameterError
from .levels import TwoLevelFactors

if TYPE_CHECKING:
    from .factors import FormFactors
    from .on_demand import RowsOnDemand

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

MAX_BYTES = 1 << 30  # of one dense table
SHOWN = 20  # surfaces that a printed table has room for
SKY, BACKS = "(sky)", "(backs)"  # in brackets, so that no surface has that name by chance


@dataclass(frozen=True, eq=False)
class SurfaceFactors:
    """Form factors between M surfaces: matrix[i, j] is the share of what leaves surface i that arrives at j.

    The light is taken to leave each surface evenly, every square metre as much as every other.

    Attributes
    ----------
    names : tuple of str
        M surfaces.
    area : ndarray (M,)
        m²; both sides of a two-sided surface count.
    matrix : ndarray (M, M)
    to_sky, to_backs : ndarray (M,)
        Shares that leave the scene, and that land on black backs of one-sided faces.
    standard_error : ndarray (M, M) or None
        Of `matrix`; None where the estimator gives none (one low-discrepancy run, a hemicube, exact factors).
    to_sky_error, to_backs_error : ndarray (M,) or None
    """

    names: tuple[str, ...]
    area: FloatArray
    matrix: FloatArray
    to_sky: FloatArray
    to_backs: FloatArray
    standard_error: FloatArray | None = None
    to_sky_error: FloatArray | None = None
    to_backs_error: FloatArray | None = None

    def __len__(self) -> int:
        """Number of surfaces M."""
        return len(self.names)

    def factor(self, source: str, target: str) -> float:
        """Form factor from one named surface to another.

        Raises
        ------
        ParameterError
            A name that there is not, with those that there are.
        """
        return float(self.matrix[place(self.names, source), place(self.names, target)])

    @property
    def row_sums(self) -> FloatArray:
        """Σ_j matrix[i, j] + to_sky + to_backs, (M,): 1 where nothing is lost."""
        return self.matrix.sum(axis=1) + self.to_sky + self.to_backs

    @property
    def exchange_area(self) -> FloatArray:
        """G[i, j] = A[i] F[i, j], m², (M, M); symmetric up to the sampling error."""
        return self.area[:, None] * self.matrix

    @property
    def reciprocity_defect(self) -> float:
        """‖G - Gᵀ‖ / ‖G‖ (Frobenius); 0 for exact factors."""
        exchange = self.exchange_area
        size = float(np.linalg.norm(exchange))
        return float(np.linalg.norm(exchange - exchange.T)) / size if size > 0 else 0.0

    def records(self) -> list[dict[str, Any]]:
        """One entry for each pair: from, to, factor, standard_error (None if unknown); "(sky)" and "(backs)" last.

        For ``pandas.DataFrame(table.records())``, ``csv.DictWriter`` or ``json.dump``.
        """
        errors = _beside(self.standard_error, self.to_sky_error, self.to_backs_error)
        shares = np.column_stack([self.matrix, self.to_sky, self.to_backs])
        return [
            {
                "from": source,
                "to": target,
                "factor": float(shares[i, j]),
                "standard_error": None if errors is None else float(errors[i, j]),
            }
            for i, source in enumerate(self.names)
            for j, target in enumerate((*self.names, SKY, BACKS))
        ]

    def to_csv(self) -> str:
        """The table as comma-separated text with all digits: a head line, then one line a surface."""
        return table_csv(self.names, self.area, np.column_stack([self.matrix, self.to_sky, self.to_backs]))

    def __str__(self) -> str:
        """A table to read: surfaces in rows and, by their numbers, in columns."""
        head = "share of what leaves a surface (row) that arrives at another (column)"
        shares = np.column_stack([self.matrix, self.to_sky, self.to_backs, self.row_sums])
        errors = _beside(self.standard_error, self.to_sky_error, self.to_backs_error)
        note = "" if errors is None else f"\nstandard errors up to {np.max(errors, initial=0.0):.2g}"
        return table_text(head, self.names, shares, ["sky", "backs", "sum"]) + note


def between_surfaces(
    factors: FormFactors, surface: ArrayLike | None = None, names: tuple[str, ...] = ()
) -> SurfaceFactors:
    """Form factors between surfaces, with standard errors where the estimate has them.

    F_IJ = Σ_i∈I A_i Σ_j∈J F_ij / Σ_i∈I A_i: the algebra of form factors, for light that leaves a surface evenly.

    Parameters
    ----------
    factors : FormFactors
    surface : array_like of int (N,), optional
        Another grouping than by the scene's surfaces: the number of each patch's group.
    names : tuple of str, optional
        Of those groups; by default their numbers.

    Returns
    -------
    SurfaceFactors

    Raises
    ------
    FormFactorError
        The factors know no surfaces, or the grouping does not fit them.
    MemoryLimitError
        Too many surfaces for a dense table.
    """
    group, labels = grouping(factors, surface, names)
    table = _aggregate(factors, group, len(labels))
    error = _standard_error(factors, group, len(labels))
    parts = [None] * 3 if error is None else [error[:, :-2], error[:, -2], error[:, -1]]
    area = sums_over(group, factors.area, len(labels))
    return SurfaceFactors(labels, area, table[:, :-2], table[:, -2], table[:, -1], *parts)


def grouping(
    factors: FormFactors | RowsOnDemand, surface: ArrayLike | None = None, names: tuple[str, ...] = ()
) -> tuple[IntArray, tuple[str, ...]]:
    """Number of each patch's group (N,), and the names of the groups; those of the scene by default.

    Surfaces that have no patch are left out.

    Raises
    ------
    FormFactorError
    MemoryLimitError
    """
    if surface is None:
        if factors.surface is None or not factors.surface_names:
            raise FormFactorError(
                "these factors know no surfaces: give surface=, the number of each patch's surface (N,), and names="
            )
        number, given = np.asarray(factors.surface, dtype=np.int64), factors.surface_names
    else:
        number, given = np.asarray(surface), tuple(names)
        if number.shape != (len(factors),) or not np.issubdtype(number.dtype, np.integer) or number.min() < 0:
            raise FormFactorError(
                f"surface has shape {number.shape} and type {number.dtype}; give integers from 0, ({len(factors)},)"
            )
        given = given or tuple(str(k) for k in range(int(number.max()) + 1))
    if number.max() >= len(given) or len(set(given)) < len(given):
        raise FormFactorError(
            f"surfaces are numbered up to {number.max()} and there are {len(given)} names, "
            f"{len(set(given))} of them different; give one name each"
        )
    used, group = np.unique(number, return_inverse=True)
    needed = 8 * len(used) ** 2
    if needed > MAX_BYTES:
        raise MemoryLimitError(
            f"a table of {len(used)} × {len(used)} surfaces takes {needed / 1e9:.1f} GB: group them with surface= and "
            "names="
        )
    return group.astype(np.int64), tuple(given[k] for k in used)


def sums_over(group: IntArray, values: FloatArray, count: int) -> FloatArray:
    """Sums of values (N,) over the patches of each group, (count,)."""
    return np.bincount(group, values, count).astype(np.float64, copy=False)


def _aggregate(factors: FormFactors, group: IntArray, count: int) -> FloatArray:
    """Shares (count, count + 2) with those to sky and backs last."""
    return _grouped(factors, group, count)[0]


def _grouped(factors: FormFactors, group: IntArray, count: int) -> tuple[FloatArray, FloatArray]:
    """Means over each surface of p and (weights squared) p (1 - p), p the shares of its patches."""
    weight = factors.area / sums_over(group, factors.area, count)[group]
    if isinstance(factors, TwoLevelFactors):
        return _grouped_levels(factors, group, weight, count), np.zeros((count, count + 2))
    matrix = factors.matrix
    shares, variances = np.zeros((count, count + 2)), np.zeros((count, count + 2))
    _sum_rows(
        matrix.indptr, matrix.indices, matrix.data, factors.to_sky, factors.to_backs, weight, group, shares, variances
    )
    return shares, variances


def _grouped_levels(factors: TwoLevelFactors, group: IntArray, weight: FloatArray, count: int) -> FloatArray:
    """The means of `_grouped`, without a matrix of all patches."""
    order = np.argsort(group, kind="stable")
    ends = np.append(0, np.cumsum(np.bincount(group, minlength=count)))
    left = csr_array((weight[order], order, ends), shape=(count, len(group)))
    right = csr_array((np.ones(len(group)), group, np.arange(len(group) + 1)), shape=(len(group), count))
    return np.column_stack([factors.between(left, right), left @ factors.to_sky, left @ factors.to_backs])


@kernel
def _sum_rows(indptr, indices, weights, to_sky, to_backs, weight, group, shares, variances):  # type: ignore[no-untyped-def]
    row = np.empty(shares.shape[1])
    for i in range(len(group)):
        row[:] = 0.0
        for p in range(indptr[i], indptr[i + 1]):
            row[group[indices[p]]] += np.float64(weights[p])
        row[-2] = to_sky[i]
        row[-1] = to_backs[i]
        for j in range(len(row)):
            shares[group[i], j] += weight[i] * row[j]
            variances[group[i], j] += weight[i] ** 2 * max(0.0, row[j] * (1.0 - row[j]))


def _standard_error(factors: FormFactors, group: IntArray, count: int) -> FloatArray | None:
    """Standard errors (count, count + 2): from the spread of replicates, or binomial from random rays."""
    if runs := len(factors.replicates):
        tables = np.array([_aggregate(run, group, count) for run in factors.replicates])
        return tables.std(axis=0, ddof=1) / np.sqrt(runs)
    rays = getattr(factors.estimator, "binomial_rays", None)
    return None if rays is None else np.sqrt(_grouped(factors, group, count)[1] / rays)


def _beside(matrix: FloatArray | None, sky: FloatArray | None, backs: FloatArray | None) -> FloatArray | None:
    return None if matrix is None or sky is None or backs is None else np.column_stack([matrix, sky, backs])


def place(names: tuple[str, ...], name: str) -> int:
    """Number of a named surface.

    Raises
    ------
    ParameterError
        With the names that there are.
    """
    if name not in names:
        shown = ", ".join(map(repr, names[:20])) + (" …" if len(names) > 20 else "")
        raise ParameterError(f"no surface is named {name!r}; there are {shown}")
    return names.index(name)


def table_text(head: str, names: tuple[str, ...], values: FloatArray, more: list[str]) -> str:
    """Rows of numbers for surfaces: a column for each of the surfaces by number, then those named in `more`.

    Parameters
    ----------
    head : str
        First line.
    names : tuple of str
        M surfaces.
    values : ndarray (M, M + len(more))
    more : list of str
    """
    count = len(names)
    shown = min(count, SHOWN)
    columns = [*range(shown), *range(count, count + len(more))]
    labels = [f"{k + 1} {name}" for k, name in enumerate(names[:shown])]
    width = max(map(len, labels))
    titles = [str(k + 1) for k in range(shown)] + more
    lines = [head, " " * width + "".join(f"{title:>8}" for title in titles)]
    lines += [f"{label:<{width}}" + "".join(f"{values[k, j]:8.4f}" for j in columns) for k, label in enumerate(labels)]
    if count > shown:
        lines.append(f"… and {count - shown} surfaces more: see records() or to_csv()")
    return "\n".join(lines)


def table_csv(names: tuple[str, ...], area: FloatArray, values: FloatArray) -> str:
    """Comma-separated text of shares (M, M + 2), sky and backs last."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(["surface", "area_m2", *names, SKY, BACKS])
    for name, size, row in zip(names, area, values, strict=True):
        writer.writerow([name, repr(float(size)), *(repr(float(value)) for value in row)])
    return text.getvalue()
