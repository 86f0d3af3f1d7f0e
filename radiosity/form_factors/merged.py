"""Form factors of groups of patches: those of the patches, put together."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from .factors import FormFactors

IntArray = NDArray[np.int64]


def merged(factors: FormFactors, group: IntArray, count: int, *, replicates: bool = True) -> FormFactors:
    """What the same rays say of larger patches: F_IJ = Σ_i A_i Σ_j F_ij / Σ_i A_i over i in I and j in J.

    Closure and reciprocity stay as they are, but for rounding to the type of the weights.

    Parameters
    ----------
    factors : FormFactors
        Of N patches.
    group : ndarray of int (N,)
        Number of each patch's group, below `count`; no group is empty, and none spans surfaces.
    count : int
    replicates : bool, optional
        Whether those are put together, too.

    Returns
    -------
    FormFactors
        Of `count` groups, without an estimator. A group's row counts as left out where that of any of its patches is.
    """
    area = np.bincount(group, factors.area, count).astype(np.float64)
    share = factors.area / area[group]
    first = np.unique(group, return_index=True)[1]
    fine = factors.matrix
    columns = group.astype(fine.indices.dtype)[fine.indices]
    relabelled = csr_array((fine.data.astype(np.float64), columns, fine.indptr), shape=(len(group), count))
    rows = csr_array((share, (group, np.arange(len(group)))), shape=(count, len(group)))
    matrix = csr_array(rows @ relabelled)
    matrix.sort_indices()
    shares = (np.bincount(group, share * part, count) for part in (factors.to_sky, factors.to_backs))
    to_sky, to_backs = (part.astype(np.float64) for part in shares)
    return FormFactors(
        csr_array(matrix.astype(fine.dtype)),
        to_sky,
        to_backs,
        area,
        None if factors.surface is None else factors.surface[first],
        factors.surface_names,
        statistics=dict(factors.statistics),
        replicates=tuple(merged(run, group, count) for run in factors.replicates) if replicates else (),
        exact_columns=_any(factors.exact_columns, group, count),
        left_out=_any(factors.left_out, group, count),
    )


def _any(of_patches: NDArray[np.bool_] | None, group: IntArray, count: int) -> NDArray[np.bool_] | None:
    """Whether it is true of any patch of each group (count,)."""
    return None if of_patches is None else np.bincount(group, of_patches, count) > 0
