"""`TransportOperator`: one bounce of light, T = diag(rho) F, and the equation B = E + T B.

The rendering equation, Eq. (1), is for matt surfaces Eq. (2), in radiosities Eq. (3), and on patches Eq. (7), which
in terms of T is Eq. (8). Two forms of the same equation are kept. `T @ B` gathers. `T.loss(B)` is
(I - T) B without the subtraction that loses all digits where almost nothing is absorbed, Eq. (22). With
Σ_j F_ij + sky_i + backs_i + defect_i = 1,

    (B - T B)_i = α_i B_i + ρ_i [ Σ_j F_ij (B_i - B_j) + (sky_i + backs_i + defect_i) B_i ].

The absorptance α is taken as given, never formed as 1 - ρ from a rounded ρ, and nearly equal B_i - B_j
subtract without rounding (Sterbenz), so that a residual is right at α = 1e-12 too.
"""

from __future__ import annotations

from dataclasses import KW_ONLY, InitVar, dataclass, field
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import csr_array, diags_array
from scipy.sparse.linalg import LinearOperator

from .compiled import kernel
from .errors import FormFactorError, MaterialError, SolverError
from .form_factors.factors import FormFactors, check_matrix, check_shares
from .form_factors.levels import TwoLevelFactors
from .form_factors.on_demand import RowsOnDemand
from .sparse import csr_differences

FloatArray = NDArray[np.float64]


class Materials(Protocol):
    """What the operator needs of patches."""

    @property
    def reflectance(self) -> FloatArray:
        """(N, C)."""
        ...

    @property
    def absorptance(self) -> FloatArray:
        """(N, C)."""
        ...


@dataclass(frozen=True, eq=False)
class TransportOperator:
    """One bounce: `T @ B` is the light that B sends back after one reflection.

    Give `patches`, or `reflectance`, or `absorptance`. The one that is given is kept exactly, the other
    is one minus it: give `absorptance` where it is small.

    Parameters
    ----------
    factors : FormFactors or RowsOnDemand
        N patches.
    patches : Patches, optional
        For their reflectance and absorptance (N, C).
    reflectance, absorptance : array_like (N, C), (N,) or scalar, optional
        In [0, 1]. One channel where no channel axis is given.
    threads : int, optional
        For the products; as many as there are processors by default. Results do not depend on it.

    Raises
    ------
    MaterialError
        A share outside [0, 1], a shape that does not fit.
    FormFactorError
        Form factors that are not a light exchange (NaN, negative, rows above one), with row and column.

    Examples
    --------
    Two facing walls that see each other by 0.2, the rest of their light goes to the sky:

    >>> F = FormFactors.from_matrix([[0.0, 0.2], [0.2, 0.0]], area=[1.0, 1.0])
    >>> T = TransportOperator(F, reflectance=[0.5, 0.8])
    >>> T @ np.array([10.0, 0.0])
    array([0. , 1.6])

    It goes straight into scipy's solvers, one channel at a time:

    >>> from scipy.sparse.linalg import gmres
    >>> radiosity, info = gmres(T.system(0), np.array([10.0, 0.0]), rtol=1e-12)
    >>> np.round(radiosity, 6)
    array([10.162602,  1.626016])
    """

    factors: FormFactors | RowsOnDemand
    patches: InitVar[Materials | None] = None
    _: KW_ONLY
    reflectance: FloatArray = field(default=None, repr=False)  # type: ignore[arg-type]  # after __post_init__ an array
    absorptance: FloatArray = field(default=None, repr=False)  # type: ignore[arg-type]
    threads: int | None = None
    to_outside: FloatArray = field(init=False, repr=False)

    def __post_init__(self, patches: Materials | None) -> None:
        given = [patches is not None, self.reflectance is not None, self.absorptance is not None]
        if sum(given) != 1:
            raise SolverError("give exactly one of patches, reflectance, absorptance")
        count = len(self.factors)
        if patches is not None:
            reflectance = _shares("reflectance", patches.reflectance, count)
            absorptance = _shares("absorptance", patches.absorptance, count)
        elif self.reflectance is not None:
            reflectance = _shares("reflectance", self.reflectance, count)
            absorptance = 1.0 - reflectance
        else:
            absorptance = _shares("absorptance", self.absorptance, count)
            reflectance = 1.0 - absorptance
        object.__setattr__(self, "reflectance", reflectance)
        object.__setattr__(self, "absorptance", absorptance)
        object.__setattr__(self, "to_outside", _to_outside(self.factors))

    @property
    def channels(self) -> int:
        """Number of channels C."""
        return self.reflectance.shape[1]

    @property
    def shape(self) -> tuple[int, int]:
        """(N, N)."""
        return len(self.factors), len(self.factors)

    @property
    def stored_factors(self) -> FormFactors:
        """`factors`, for what needs more than rows on demand.

        Raises
        ------
        SolverError
            They are rows on demand.
        """
        if isinstance(self.factors, RowsOnDemand):
            raise SolverError("this needs stored form factors, not rows on demand: use Shooting or Neumann with those")
        return self.factors

    @property
    def area(self) -> FloatArray:
        """Area of the patches, m², (N,)."""
        return self.factors.area

    def __matmul__(self, light: ArrayLike) -> FloatArray:
        """Light after one bounce, ρ F L, W/m².

        Parameters
        ----------
        light : array_like (N, C), (N, C, S), or (N,) where there is one channel
            S is any number of emissions at once.

        Returns
        -------
        ndarray of float64, same shape
        """
        light = self.check_light(light)
        gathered = self.factors.gather(light, self.threads)
        gathered *= _like(self.reflectance, light)
        return gathered

    def from_sky(self, sky: ArrayLike) -> FloatArray:
        """Sky light after its first reflection, ρ π to_sky L_sky, W/m², (N, C) or (N, C, S).

        Parameters
        ----------
        sky : array_like (C,) or (C, S)
            Radiance of the surroundings, W/(m² sr).
        """
        radiance = np.atleast_1d(np.asarray(sky, dtype=np.float64))
        if radiance.shape[0] != self.channels:
            raise SolverError(f"sky has {radiance.shape[0]} channels but the reflectance has {self.channels}")
        if not np.all(np.isfinite(radiance)):
            raise SolverError(f"sky radiance {radiance.tolist()} is not finite")
        irradiance = np.pi * self.factors.to_sky.reshape((-1,) + (1,) * radiance.ndim) * radiance
        return _like(self.reflectance, irradiance) * irradiance

    def source(self, emission: ArrayLike, sky: ArrayLike | None = None) -> FloatArray:
        """Right-hand side E + ρ π to_sky L_sky of the equation, W/m², in the shape of the emission."""
        emission = self.check_light(emission)
        if sky is None:
            return emission
        from_sky = self.from_sky(sky)
        return emission + (from_sky[:, 0] if emission.ndim == 1 else _like(from_sky, emission))

    def orders(self, emission: ArrayLike, sky: ArrayLike | None = None, count: int = 8) -> FloatArray:
        """Light by number of bounces, T^k E for k = 0 … count; the sky arrives with order 1.

        Returns
        -------
        ndarray (count + 1, N, C) (or with the shape of the emission)
            W/m².
        """
        term = self.check_light(emission)
        orders = np.empty((count + 1, *term.shape))
        orders[0] = term
        first = self.source(np.zeros_like(term), sky)
        for k in range(1, count + 1):
            term = self @ term
            if k == 1:
                term = term + first
            orders[k] = term
        return orders

    def loss(self, light: ArrayLike) -> FloatArray:
        """(I - T) B without the subtraction (see the module), same shape as `light`, W/m².

        Closure defects no larger than the rounding of the weights count as zero: what is missing stays on
        the patch itself, where B_i - B_i = 0.
        """
        light = self.check_light(light)
        outside = self.to_outside.reshape((-1,) + (1,) * (light.ndim - 1))
        reflected = _like(self.reflectance, light) * (self.net_exchange(light) + outside * light)
        return _like(self.absorptance, light) * light + reflected

    def residual(self, light: ArrayLike, source: ArrayLike) -> FloatArray:
        """Source - (I - T) B from the equation, W/m², same shape as `light`."""
        return self.check_light(source) - self.loss(light)

    def net_exchange(self, light: FloatArray, beside: FloatArray | None = None) -> FloatArray:
        """Σ_j F_ij [(X_i - X_j) + Y_j] for X = `light` and Y = `beside` (0 if not given), same shape."""
        if isinstance(self.factors, RowsOnDemand | TwoLevelFactors):
            return self.factors.net_exchange(light, beside)
        return csr_differences(self.factors.matrix, light, beside, self.threads)

    def norm(self, light: FloatArray) -> FloatArray:
        """Area-weighted root mean square over the patches, per column: (C,) for (N, C)."""
        return area_norm(light, self.area)

    def power(self, light: FloatArray) -> FloatArray:
        """Σ area × light, W, per column: (C,) for (N, C). The order of the sum is fixed."""
        return _weighted_sums(np.ascontiguousarray(light.reshape(len(light), -1)), self.area).reshape(light.shape[1:])

    def check_light(self, light: ArrayLike) -> FloatArray:
        """Light as float64 if its shape fits the operator.

        Raises
        ------
        SolverError
        """
        light = np.asarray(light, dtype=np.float64)
        expected = (len(self.factors), self.channels)
        if light.shape[:2] == expected and light.ndim in (2, 3):
            return light
        if light.ndim == 1 and self.channels == 1 and len(light) == len(self.factors):
            return light
        raise SolverError(
            f"light has shape {light.shape}; with {expected[0]} patches and {expected[1]} channels give "
            f"{expected}, or {expected} and any number of emissions behind"
        )

    def matrix(self, channel: int = 0) -> csr_array:
        """T of one channel as float64 `csr_array` (N, N)."""
        weights = self.factors.matrix.astype(np.float64)
        return csr_array(diags_array(self.reflectance[:, channel]) @ weights)

    def channel(self, channel: int = 0) -> LinearOperator:
        """T of one channel as `scipy.sparse.linalg.LinearOperator`, with its transpose."""
        rho = self.reflectance[:, channel]
        return _operator(self.shape, lambda x: _like(rho, x) * self.factors.gather(x, self.threads), self._back(rho))

    def system(self, channel: int = 0) -> LinearOperator:
        """I - T of one channel as `LinearOperator`, in the form without subtraction, with its transpose.

        For ``scipy.sparse.linalg.gmres(T.system(c), emission[:, c])``, and for ``pyamg.krylov.fgmres`` alike; `matrix`
        is for what needs entries. Where almost nothing is absorbed, their own word for success is no proof: see
        `radiosity.certify`.
        """
        one = TransportOperator(self.factors, _OneChannel(self, channel), threads=self.threads)
        back = self._back(self.reflectance[:, channel])
        return _operator(self.shape, lambda x: _columns(one.loss, x), lambda x: x - back(x))

    def _back(self, rho: FloatArray) -> Any:
        """Product with Tᵀ = Fᵀ ρ."""
        if isinstance(self.factors, TwoLevelFactors):
            scatter = self.factors.scatter
            return lambda x: scatter(_like(rho, x) * x)
        return lambda x: self.factors.matrix.T @ (_like(rho, x) * x)


@dataclass(frozen=True)
class _OneChannel:
    """Materials of one channel of an operator."""

    operator: TransportOperator
    channel: int

    @property
    def reflectance(self) -> FloatArray:
        return self.operator.reflectance[:, self.channel]

    @property
    def absorptance(self) -> FloatArray:
        return self.operator.absorptance[:, self.channel]


def _operator(shape: tuple[int, int], forward: Any, back: Any) -> LinearOperator:
    return LinearOperator(shape, dtype=np.float64, matvec=forward, matmat=forward, rmatvec=back, rmatmat=back)


def _columns(function: Any, x: FloatArray) -> FloatArray:
    """Apply a function of one-channel light to a vector (N,), a column (N, 1) or columns (N, M)."""
    return function(x) if x.ndim == 1 else function(x[:, None, :])[:, 0, :]


def _like(values: FloatArray, light: FloatArray) -> FloatArray:
    """Values per patch (N,) or per patch and channel (N, C), shaped to multiply light."""
    if light.ndim == 1:
        return values.reshape(-1)
    return values.reshape(values.shape + (1,) * (light.ndim - values.ndim))


def _shares(name: str, given: ArrayLike, count: int) -> FloatArray:
    """Reflectance or absorptance as float64 (N, C), checked."""
    values = np.array(given, dtype=np.float64)
    if values.ndim == 0:
        values = np.full((count, 1), values)
    if values.ndim == 1:
        values = values[:, None]
    if values.ndim != 2 or len(values) != count:
        raise MaterialError(f"{name} has shape {np.shape(given)}; give ({count}, channels), ({count},) or one number")
    bad = np.argwhere(~((values >= 0.0) & (values <= 1.0)))
    if len(bad):
        patch, channel = bad[0]
        raise MaterialError(f"{name} {values[patch, channel]!r} of patch {patch}, channel {channel}, is outside [0, 1]")
    return values


def _to_outside(factors: FormFactors | RowsOnDemand) -> FloatArray:
    """Share of a patch's light that no patch gets back, (N,): sky, backs, and what a row fails to close by.

    Also the door where poisoned factors are refused, however they were made.
    """
    if not np.all(np.isfinite(factors.area) & (factors.area > 0)):
        raise FormFactorError("areas must be positive and finite")
    if isinstance(factors, RowsOnDemand):  # each row is checked when it is computed
        return factors.to_sky + factors.to_backs
    if isinstance(factors, TwoLevelFactors):
        return _outside_or_refused(factors, factors.rounding)
    weights = factors.matrix.data
    if weights.size and not weights.min() >= 0.0:
        check_matrix(factors.matrix, factors.area)
    return _outside_or_refused(factors, max(float(np.finfo(weights.dtype).eps), 1e-12))


def _outside_or_refused(factors: FormFactors, rounding: float) -> FloatArray:
    """`_to_outside` of rows that close but for rounding, or add up to less than one."""
    defect = factors.closure_defect
    if not np.all(np.abs(defect) <= rounding):
        if not isinstance(factors, TwoLevelFactors):
            check_matrix(factors.matrix, factors.area)
        check_shares(1.0 - defect - factors.to_sky - factors.to_backs, factors.to_sky, factors.to_backs)
    return factors.to_sky + factors.to_backs + np.where(np.abs(defect) <= rounding, 0.0, defect)


def area_norm(light: FloatArray, area: FloatArray) -> FloatArray:
    """Area-weighted root mean square over patches, per column; scaled so that squares cannot overflow."""
    return norm_by_group(light, area, np.zeros(len(area), dtype=np.int64), 1)[0]


def norm_by_group(light: FloatArray, area: FloatArray, group: NDArray[np.int64], groups: int) -> FloatArray:
    """`area_norm` of each group of patches by itself, (groups, …) for (N, …)."""
    flat = np.ascontiguousarray(light.reshape(len(light), -1))
    return _norms(flat, area, group, groups).reshape(groups, *light.shape[1:])


@kernel
def _norms(light, area, group, groups):  # type: ignore[no-untyped-def]
    count, width = light.shape
    largest = np.zeros((groups, width))
    total, weight = np.zeros((groups, width)), np.zeros(groups)
    for i in range(count):
        for c in range(width):
            if abs(light[i, c]) > largest[group[i], c]:
                largest[group[i], c] = abs(light[i, c])
    inverse = np.ones((groups, width))
    for m in range(groups):
        for c in range(width):
            if largest[m, c] > 1e100 or 0.0 < largest[m, c] < 1e-100:
                inverse[m, c] = 1.0 / max(largest[m, c], 1e-300)
    for i in range(count):
        weight[group[i]] += area[i]
        for c in range(width):
            share = light[i, c] * inverse[group[i], c]
            total[group[i], c] += area[i] * share * share
    for m in range(groups):
        for c in range(width):
            total[m, c] = np.sqrt(total[m, c] / weight[m]) / inverse[m, c]
    return total


@kernel
def _weighted_sums(light, area):  # type: ignore[no-untyped-def]
    """Σ area × light per column, in the order of the patches."""
    total = np.zeros(light.shape[1])
    for i in range(light.shape[0]):
        for c in range(light.shape[1]):
            total[c] += area[i] * light[i, c]
    return total
