"""`Certificate`: how wrong a solution can be, and why."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..form_factors.levels import TwoLevelFactors
from ..solvers import Solver
from ..solvers.admission import connected_components, where
from ..solvers.bound import ErrorBound, error_bound
from ..transport import TransportOperator
from .energy import RECIPROCAL, EnclosureEnergy, enclosure_energies, energy_error
from .sampling import expected_reciprocity, is_exact, sampling_error

FloatArray = NDArray[np.float64]

Verdict = Literal["certified", "uncertified", "refused"]

ACCURACY = 0.01  # what a solution is certified to unless said otherwise
STANDARD_ERRORS = 2.0  # of the sampling, that must fit in, unless said otherwise
LEAK_LIMIT = 0.1  # of the smallest absorptance in a lit closed enclosure, Eq. (25)
SIGMAS = 5.0
ROUNDING = 1e-12  # of an energy balance


@dataclass(frozen=True, eq=False)
class Certificate:
    """How wrong a solution can be as far as form factors and algebra go (not the size of its patches).

    Errors are area-weighted relative L2 of B - E over patches and channels.

    Attributes
    ----------
    verdict : {"certified", "uncertified", "refused"}
        Certified: the bound on the algebra and two standard errors of the sampling (or as many as were asked for) are
        together within `accuracy`, and nothing else is wrong.
    reasons : tuple of str
        Why not, each with what to do.
    accuracy : float
        What was to be certified.
    algebraic : float
        Bound on the error against the exact solution with these form factors; it holds.
    sampling : float or None
        Standard error from the spread of independent replicates, or on two levels from a spot check; 0.0 for factors
        that were not sampled, None where it is not known.
    closure : float
        Largest ``|1 - Σ_j F_ij - to_sky - to_backs|``.
    reciprocity : float
        ‖G - Gᵀ‖ / ‖G‖.
    reciprocity_expected : float or None
        The same, as the standard errors of raw form factors lead one to expect it; None where there are none.
    leaks : float
        Share of the rays that left a closed scene.
    leaked_rays : int
    enclosures : tuple of EnclosureEnergy
        Lit ones, brightest first.
    energy_defect : float
        (absorbed + escaped + leaked) / emitted - 1 of the whole scene. Not 0 for raw factors, which are not
        reciprocal.
    energy_error : float or None
        Its standard error.
    exact : bool
        Whether the form factors were not sampled: closed forms, or the user's own.
    bound : ndarray (N, C)
        Of the algebraic error, patch by patch, W/m².
    """

    verdict: Verdict
    reasons: tuple[str, ...]
    accuracy: float
    algebraic: float
    sampling: float | None
    closure: float
    reciprocity: float
    reciprocity_expected: float | None
    leaks: float
    leaked_rays: int
    enclosures: tuple[EnclosureEnergy, ...]
    energy_defect: float
    energy_error: float | None
    exact: bool
    bound: FloatArray

    def __repr__(self) -> str:
        return f"<Certificate: {next(_story(self))}>"

    def __str__(self) -> str:
        return "\n".join(_story(self))


def certify(
    T: TransportOperator,
    emission: ArrayLike,
    radiosity: ArrayLike,
    sky: ArrayLike | None = None,
    *,
    accuracy: float = ACCURACY,
    standard_errors: float = STANDARD_ERRORS,
    solver: Solver | None = None,
) -> Certificate:
    """Say how wrong a radiosity can be, whatever computed it.

    Parameters
    ----------
    T : TransportOperator
    emission, radiosity : array_like (N, C), or (N,) where there is one channel
        W/m².
    sky : array_like (C,), optional
        Radiance of the surroundings, W/(m² sr).
    accuracy : float
        What is to be certified, relative.
    standard_errors : float
        How many of the sampling must fit into the accuracy beside the algebra.
    solver : Solver, optional
        For the replicates; by default `Neumann`, and `ConjugateGradient` where that would be slow.

    Returns
    -------
    Certificate

    Raises
    ------
    SolverError
        Shapes that do not fit, rows on demand.

    Examples
    --------
    >>> import numpy as np
    >>> from radiosity.form_factors.factors import FormFactors
    >>> factors = FormFactors.from_matrix([[0.0, 1.0], [1.0, 0.0]], area=[1.0, 1.0])
    >>> T = TransportOperator(factors, reflectance=0.5)
    >>> print(certify(T, [1.0, 1.0], [2.0, 2.0]))
    certified to 1 %: algebra within 3.6e-15, form factors taken as exact
    form factors: closure 0, reciprocity 0, no leaks
    energy: 2 W emitted, 2 W absorbed, 0 W escaped; defect 0
    """
    E = T.check_light(emission).reshape(T.shape[0], T.channels)
    B = T.check_light(radiosity).reshape(E.shape)
    source = T.source(E, sky)
    finite = bool(np.all(np.isfinite(B)))
    algebra = error_bound(T, source, B, E) if finite else _no_bound(B)
    evidence = _evidence(T, E, np.where(np.isfinite(B), B, 0.0), source, sky, solver)
    refusals = list(_refusals(T, source, B, algebra, evidence))
    doubts = [] if refusals else list(_doubts(T, algebra, evidence, accuracy, standard_errors))
    verdict: Verdict = "refused" if refusals else "uncertified" if doubts else "certified"
    return Certificate(
        verdict=verdict,
        reasons=tuple(refusals + doubts),
        accuracy=accuracy,
        algebraic=algebra.relative,
        sampling=evidence.sampling,
        closure=float(np.max(np.abs(T.factors.closure_defect), initial=0.0)),
        reciprocity=evidence.reciprocity,
        reciprocity_expected=None if evidence.reciprocity <= RECIPROCAL else expected_reciprocity(T.stored_factors),
        leaks=evidence.leaks,
        leaked_rays=int(T.stored_factors.statistics.get("rays/leaked", 0)),
        enclosures=evidence.enclosures,
        energy_defect=evidence.defect,
        energy_error=evidence.defect_error,
        exact=is_exact(T.stored_factors),
        bound=algebra.bound,
    )


@dataclass(frozen=True)
class _Evidence:
    """What a verdict is based on, besides the bound. Powers relative to what is emitted."""

    enclosures: tuple[EnclosureEnergy, ...]
    sampling: float | None
    reciprocity: float
    leaks: float
    defect: float
    defect_error: float | None
    from_residual: float
    from_rounding: float
    leaked: float


def _evidence(
    T: TransportOperator,
    emission: FloatArray,
    radiosity: FloatArray,
    source: FloatArray,
    sky: ArrayLike | None,
    solver: Solver | None,
) -> _Evidence:
    enclosures = enclosure_energies(T, emission, radiosity, sky)
    emitted = max(sum(e.emitted for e in enclosures), np.finfo(float).tiny)
    ended = sum(e.absorbed + e.escaped + e.leaked for e in enclosures)
    reciprocity = T.stored_factors.reciprocity_defect
    error = energy_error(T, radiosity, reciprocity)
    residual = T.power(np.abs(T.residual(radiosity, source))).sum()
    return _Evidence(
        enclosures,
        sampling_error(T, emission, radiosity, sky, solver),
        reciprocity,
        float(T.stored_factors.statistics.get("leaks/share", 0.0)),
        ended / emitted - 1.0 if enclosures else 0.0,
        None if error is None else error / emitted,
        float(residual / emitted),
        _lost_by_rounding(T, radiosity) / emitted,
        sum(abs(e.leaked) for e in enclosures) / emitted,
    )


def _lost_by_rounding(T: TransportOperator, radiosity: FloatArray) -> float:
    """Power, W, that rows lose or gain which close but for the digits of their numbers, and so are no leak."""
    factors = T.factors
    open_share = factors.to_sky + factors.to_backs
    rounded = np.abs(factors.closure_defect - (T.to_outside - open_share)) + ROUNDING
    return float(T.power(np.abs(radiosity) * rounded[:, None]).sum())


def _no_bound(radiosity: FloatArray) -> ErrorBound:
    return ErrorBound(np.full(radiosity.shape, np.inf), np.zeros(radiosity.shape), np.inf, 0)


def _refusals(
    T: TransportOperator, source: FloatArray, radiosity: FloatArray, algebra: ErrorBound, evidence: _Evidence
) -> Iterator[str]:
    """Why this cannot be an answer at all."""
    if not np.all(np.isfinite(radiosity)):
        patch, channel = np.argwhere(~np.isfinite(radiosity))[0]
        yield f"radiosity of patch {patch}, channel {channel}, is {radiosity[patch, channel]}"
        return
    if not np.all(np.isfinite(algebra.bound)):
        channel = int(np.argwhere(~np.isfinite(algebra.bound))[0][1])
        yield (
            f"no bound exists for channel {channel}: its spectral radius was not shown to be below 1. Use conserved "
            "factors (factors.conserved()), or give the surfaces more absorptance"
        )
    if np.all(source >= 0.0):
        below = radiosity + algebra.bound < -ROUNDING * np.max(np.abs(radiosity), axis=0)
        if below.any():
            patch, channel = np.argwhere(below)[0]
            value = radiosity[patch, channel]
            yield f"negative light: radiosity of patch {patch}, channel {channel}, is {value:.3g} W/m²"
    yield from _leak_refusal(T, source, evidence.leaks)


def _leak_refusal(T: TransportOperator, source: FloatArray, leaks: float) -> Iterator[str]:
    """Light that leaks where almost none is absorbed: the answer would be that of the leak."""
    open_share = T.factors.to_sky + T.factors.to_backs
    label = connected_components(T.factors)
    lost = T.to_outside - open_share
    for m in np.unique(label[np.any(source != 0.0, axis=1)]):
        here = label == m
        if np.any(open_share[here] > 0.0):
            continue
        leak = max(float(np.sum(T.area[here] * lost[here]) / np.sum(T.area[here])), leaks)
        least = float(T.absorptance[here].min())
        if leak > LEAK_LIMIT * least:
            yield (
                f"{leak:.3g} of the light of a closed enclosure ({where(T.factors, here)}) leaks at every bounce, "
                f"where as little as {least:.3g} is absorbed: mend the mesh, or declare the scene open (closed=False)"
            )


def _doubts(
    T: TransportOperator, algebra: ErrorBound, evidence: _Evidence, accuracy: float, standard_errors: float
) -> Iterator[str]:
    """Why the accuracy is not certified, and what would."""
    sampling = standard_errors * (evidence.sampling or 0.0)
    if algebra.relative + sampling > accuracy:
        if algebra.relative >= sampling:
            yield (
                f"the solver stopped early (error up to {algebra.relative:.2g}): give a smaller rtol or more steps, or "
                "ConjugateGradient on conserved factors"
            )
        else:
            more = int(np.ceil((sampling / max(accuracy - algebra.relative, accuracy / 2.0)) ** 2))
            groups = " and smaller groups" if isinstance(T.stored_factors, TwoLevelFactors) else ""
            yield f"sampling error {evidence.sampling:.2g}: about {more} × as many rays{groups} would do"
    if evidence.sampling is None:
        yield "the sampling error is not known: compute the factors with replicates, MonteCarlo(replicates=2) or more"
    if evidence.leaked > accuracy:
        yield f"rows that do not close lose {evidence.leaked:.2g} of the power: use conserved factors"
    if evidence.defect_error is None:
        if abs(evidence.defect) > accuracy:
            yield f"energy is off by {evidence.defect:.2g}, as the factors are not reciprocal: use conserved factors"
    elif abs(evidence.defect) > evidence.from_residual + SIGMAS * evidence.defect_error + evidence.from_rounding:
        yield (
            f"energy is off by {evidence.defect:.2g}, more than {SIGMAS:g} standard errors of the sampling: look for "
            "patches partly inside other objects, or use conserved factors"
        )


def _story(certificate: Certificate) -> Iterator[str]:
    """The certificate in a few lines."""
    if certificate.exact:
        sampled = "form factors taken as exact"
    else:
        error = certificate.sampling
        sampled = "sampling error not known" if error is None else f"sampling ± {error:.2g}"
    head = f"{certificate.verdict} to {100 * certificate.accuracy:g} %"
    yield f"{head}: algebra within {certificate.algebraic:.2g}, {sampled}"
    expected = certificate.reciprocity_expected
    beside = "" if expected is None else f" (expected {expected:.2g})"
    leaks = "no leaks"
    if certificate.leaks > ROUNDING:
        leaks = f"{certificate.leaked_rays} rays ({certificate.leaks:.2g}) leaked"
    yield f"form factors: closure {certificate.closure:.2g}, reciprocity {certificate.reciprocity:.2g}{beside}, {leaks}"
    for e in certificate.enclosures[:3]:
        place = f" in {e.place}" if len(certificate.enclosures) > 1 else ""
        leaked = f", {e.leaked:.4g} W leaked" if e.leaked else ""
        spread = certificate.energy_error
        known = f" ± {spread:.2g}" if spread and len(certificate.enclosures) == 1 else ""
        ends = f"{e.absorbed:.4g} W absorbed, {e.escaped:.4g} W escaped{leaked}"
        yield f"energy{place}: {e.emitted:.4g} W emitted, {ends}; defect {e.defect:.2g}{known}"
    if len(certificate.enclosures) > 3:
        yield f"and {len(certificate.enclosures) - 3} more enclosures"
    yield from certificate.reasons
