"""Total exchange between surfaces: where the emission of each finally ends, after any number of reflections.

A portion of light that leaves patch i ends in what absorbs it: on surface J, in the sky, on black backs. Let g_i be
the share that ends in J. It arrives at patch j with probability F_ij, is absorbed there with α_j if j belongs to J,
and is reflected with ρ_j, as if j had sent it out itself:

    g = F u,    u = α 1_J + ρ F u.

That is the equation B = E + ρ F B with emission α on J, and g its irradiance. One solve for each J, all of them at
once, gives the shares from every patch; and as rows of F close, so do those shares, to the solver's tolerance.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .errors import NoSteadyState, SolverError
from .form_factors.surfaces import grouping, place, sums_over, table_csv, table_text
from .solvers import GaussSeidel, Solver
from .solvers.admission import where, without_end
from .transport import TransportOperator

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

RTOL = 1e-9
MAXITER = 20_000
BLOCK_BYTES = 1 << 26  # light of as many surfaces as fit this is solved for at once


@dataclass(frozen=True, eq=False)
class TotalExchange:
    """Total exchange factors of M surfaces: share[i, j, c] of i's emission is finally absorbed by j.

    Known as Gebhart factors or absorption factors (B. Gebhart, "Surface temperature calculations in radiant
    surroundings of arbitrary complexity", Int. J. Heat Mass Transfer 3 (1961) 341).
    Reciprocity: A_i α_i share[i, j] = A_j α_j share[j, i], as far as the form factors are reciprocal.

    Attributes
    ----------
    names : tuple of str
        M surfaces.
    area : ndarray (M,)
        m².
    absorptance : ndarray (M, C)
        Area-weighted mean α; the emissivity, in thermal use.
    share : ndarray (M, M, C)
    to_sky, to_backs : ndarray (M, C)
        Shares that finally leave the scene, and that end on black backs of one-sided faces.
    standard_error : ndarray (M, M, C) or None
        Of `share`, from the replicates of the form factors; None where there are none.
    """

    names: tuple[str, ...]
    area: FloatArray
    absorptance: FloatArray
    share: FloatArray
    to_sky: FloatArray
    to_backs: FloatArray
    standard_error: FloatArray | None = None

    def __len__(self) -> int:
        """Number of surfaces M."""
        return len(self.names)

    def factor(self, source: str, target: str) -> FloatArray:
        """Share of the emission of one named surface that another finally absorbs, (C,).

        Raises
        ------
        ParameterError
            A name that there is not.
        """
        return self.share[place(self.names, source), place(self.names, target)]

    @property
    def closure_defect(self) -> FloatArray:
        """1 - Σ_j share[i, j] - to_sky - to_backs, (M, C): the tolerance of the solver, and what rows of F lack."""
        return 1.0 - self.share.sum(axis=1) - self.to_sky - self.to_backs

    @property
    def reciprocity_defect(self) -> float:
        """‖S - Sᵀ‖ / ‖S‖ of S[i, j, c] = A_i α_i share[i, j, c]; 0 for reciprocal form factors."""
        size = float(np.linalg.norm(self.exchange_area))
        transposed = self.exchange_area.transpose(1, 0, 2)
        return float(np.linalg.norm(self.exchange_area - transposed)) / size if size > 0 else 0.0

    @property
    def exchange_area(self) -> FloatArray:
        """A_i α_i share[i, j, c], m², (M, M, C): net heat from i to j is this times σ (T_i⁴ - T_j⁴), in thermal use."""
        return (self.area[:, None] * self.absorptance)[:, None, :] * self.share

    def to_csv(self, channel: int = 0) -> str:
        """The table of one channel as comma-separated text with all digits."""
        values = np.column_stack([self.share[..., channel], self.to_sky[:, channel], self.to_backs[:, channel]])
        return table_csv(self.names, self.area, values)

    def text(self, channel: int = 0) -> str:
        """The table of one channel to read: surfaces in rows and, by their numbers, in columns."""
        head = "share of a surface's emission (row) that is finally absorbed by another (column)"
        if self.share.shape[2] > 1:
            head += f", channel {channel}"
        total = 1.0 - self.closure_defect[:, channel]
        beside = [self.to_sky[:, channel], self.to_backs[:, channel], total]
        values = np.column_stack([self.share[..., channel], *beside])
        return table_text(head, self.names, values, ["sky", "backs", "sum"])

    def __str__(self) -> str:
        """The tables of up to three channels."""
        channels = self.share.shape[2]
        tables = [self.text(c) for c in range(min(channels, 3))]
        return "\n".join(tables + ([f"… and {channels - 3} channels more: see text(channel)"] if channels > 3 else []))


def total_exchange_factors(
    T: TransportOperator,
    solver: Solver | None = None,
    *,
    surface: ArrayLike | None = None,
    names: tuple[str, ...] = (),
) -> TotalExchange:
    """Total exchange factors between surfaces, after any number of reflections (see the module).

    Parameters
    ----------
    T : TransportOperator
    solver : Solver, optional
        ``GaussSeidel(rtol=1e-9)`` by default. Where almost nothing is absorbed, `ConjugateGradient` on conserved
        factors, or `Direct` on few patches.
    surface : array_like of int (N,), optional
        Another grouping than by the scene's surfaces: the number of each patch's group.
    names : tuple of str, optional
        Of those groups.

    Returns
    -------
    TotalExchange
        With standard errors where the form factors have replicates, each of which is solved for too.

    Raises
    ------
    NoSteadyState
        Light that nothing ever absorbs and that finds no way out.
    SolverError
        The solver did not meet its tolerance.
    FormFactorError
        The factors know no surfaces, or the grouping does not fit them.

    Examples
    --------
    Two facing walls of absorptance 0.5 in the open, seeing each other by 0.2:

    >>> from radiosity.form_factors import FormFactors
    >>> F = FormFactors.from_matrix([[0.0, 0.2], [0.2, 0.0]], area=[1.0, 1.0])
    >>> total = total_exchange_factors(TransportOperator(F, absorptance=0.5), surface=[0, 1])
    >>> np.round(total.share[:, :, 0], 4), np.round(total.to_sky[:, 0], 4)
    (array([[0.0101, 0.101 ],
           [0.101 , 0.0101]]), array([0.8889, 0.8889]))
    """
    group, labels = grouping(T.factors, surface, names)
    solver = GaussSeidel(rtol=RTOL, maxiter=MAXITER) if solver is None else solver
    _check_light_ends(T)
    count = len(labels)
    ends = _where_light_ends(T, solver, group, count)
    runs = [_where_light_ends(_on(run, T), solver, group, count) for run in getattr(T.factors, "replicates", ())]
    error = np.std(runs, axis=0, ddof=1) / np.sqrt(len(runs)) if len(runs) > 1 else None
    return TotalExchange(
        names=labels,
        area=sums_over(group, T.area, count),
        absorptance=_mean_over(T.absorptance, T.area, group, count),
        share=np.moveaxis(ends[:, :, :count], 2, 1),
        to_sky=ends[:, :, count],
        to_backs=ends[:, :, count + 1],
        standard_error=None if error is None else np.moveaxis(error[:, :, :count], 2, 1),
    )


def _on(factors: object, T: TransportOperator) -> TransportOperator:
    """The same materials with other form factors."""
    return TransportOperator(factors, T, threads=T.threads)  # type: ignore[arg-type]


def _check_light_ends(T: TransportOperator) -> None:
    """Refuse enclosures that keep their light for ever.

    Raises
    ------
    NoSteadyState
    """
    for c in range(T.channels):
        endless = without_end(T, c)
        if endless.any():
            raise NoSteadyState(
                f"{int(endless.sum())} patches ({where(T.factors, endless)}) absorb nothing of channel {c} and see "
                "only such: their light never ends. Give some surface there an absorptance above 0, or an opening"
            )


def _where_light_ends(T: TransportOperator, solver: Solver, group: IntArray, count: int) -> FloatArray:
    """Shares (M, C, M + 2) of each surface's emission that end on each surface, in the sky, on backs."""
    each = 8 * len(group) * T.channels
    most = max(1, BLOCK_BYTES // each)
    parts = [
        _absorbed_by(T, solver, group, count, np.arange(begin, min(begin + most, count + 2)))
        for begin in range(0, count + 2, most)
    ]
    return np.concatenate(parts, axis=2)


def _absorbed_by(T: TransportOperator, solver: Solver, group: IntArray, count: int, sinks: IntArray) -> FloatArray:
    """Shares (M, C, S) that end in some of the sinks: surfaces by number, then sky and backs."""
    factors = T.factors
    lost = np.stack([factors.to_sky, factors.to_backs], axis=1)  # what ends after leaving a patch, on no patch
    at_once = np.zeros((len(group), len(sinks)))
    at_once[:, sinks >= count] = lost[:, sinks[sinks >= count] - count]
    on_surface = (group[:, None] == sinks).astype(np.float64)
    emission = T.absorptance[:, :, None] * on_surface[:, None, :] + T.reflectance[:, :, None] * at_once[:, None, :]
    result = solver.solve(T, emission)
    if not result.converged:
        raise SolverError(f"total exchange factors: {result.status}")
    ends = factors.gather(result.radiosity) + at_once[:, None, :]
    return _mean_over(ends, T.area, group, count)


def _mean_over(values: FloatArray, area: FloatArray, group: IntArray, count: int) -> FloatArray:
    """Area-weighted means over the patches of each surface, (N, …) to (M, …)."""
    weight = area / sums_over(group, area, count)[group]
    flat = values.reshape(len(values), -1)
    means = np.stack([sums_over(group, weight * column, count) for column in flat.T], axis=1)
    return means.reshape(count, *values.shape[1:])
