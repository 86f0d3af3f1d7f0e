"""Heat: emission from temperature and emissivity, temperature from emission, and heat by surface.

Heat radiation between diffuse surfaces is the same equation as light, with channels that are wavelength bands, or one
channel for grey surfaces. The emissivity of a surface is its absorptance in the same band (Kirchhoff), so that it
emits E = ε × share of the band × σ T⁴. Temperatures are in kelvin, wavelengths in metres, heat in watts.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import zeta

from .errors import ParameterError
from .form_factors.surfaces import grouping, place, sums_over
from .relight import check_names
from .scene import Material, Scene, Surface
from .solution import Solution

FloatArray = NDArray[np.float64]

# Exact since the SI of 2019; the Stefan-Boltzmann constant follows from them.
PLANCK = 6.62607015e-34  # J s
BOLTZMANN = 1.380649e-23  # J/K
SPEED_OF_LIGHT = 299_792_458.0  # m/s
STEFAN_BOLTZMANN = 2 * np.pi**5 * BOLTZMANN**4 / (15 * PLANCK**3 * SPEED_OF_LIGHT**2)  # W/(m² K⁴)
SECOND_CONSTANT = PLANCK * SPEED_OF_LIGHT / BOLTZMANN  # m K

SPLIT = 2.0  # x = h c / (λ k T) above which Planck's integral is summed as exponentials, below as powers
TERMS = 22  # either series is then right to rounding


def black_exitance(temperature: ArrayLike) -> FloatArray:
    """What a black surface emits, σ T⁴, W/m², same shape.

    >>> float(black_exitance(300.0).round(2))
    459.3
    """
    return STEFAN_BOLTZMANN * _kelvin(temperature) ** 4


def share_below(wavelength: ArrayLike, temperature: ArrayLike) -> FloatArray:
    """Share of a black surface's emission at wavelengths below a limit: Planck's integral, in closed series.

    Parameters
    ----------
    wavelength : array_like
        m, from 0 to infinity.
    temperature : array_like
        K; broadcast with the wavelengths.

    Returns
    -------
    ndarray
        In [0, 1], right to 1e-15. At 0 K, where nothing is emitted, the limit from above: 0 below infinity.

    Raises
    ------
    ParameterError
        Wavelengths or temperatures that are negative or not numbers.

    References
    ----------
    S. L. Chang, K. T. Rhee, "Blackbody radiation functions", Int. Comm. Heat Mass Transfer 11 (1984)
    451, for the exponentials; for small x the power series of x³ / (eˣ - 1) by
    Bernoulli numbers (Abramowitz & Stegun 27.1.1).

    Examples
    --------
    A quarter lies below the wavelength of the peak (Wien):

    >>> round(float(share_below(2897.771955e-6 / 1000, 1000.0)), 4)
    0.2501
    """
    length = np.asarray(wavelength, dtype=np.float64)
    if not np.all(length >= 0):
        raise ParameterError(f"wavelength {np.min(length)} m is not a length; give metres from 0 to infinity")
    with np.errstate(invalid="ignore"):
        product = length * _kelvin(temperature)
    product = np.where(np.isnan(product), np.inf, product)  # 0 K to an infinite wavelength: all there is
    with np.errstate(divide="ignore"):
        x = np.atleast_1d(SECOND_CONSTANT / product)
    share = np.empty_like(x)
    low = x < SPLIT
    share[low] = 1.0 - _powers(x[low])
    share[~low] = _exponentials(x[~low])
    return share.reshape(product.shape)


def _exponentials(x: FloatArray) -> FloatArray:
    """15/π⁴ ∫_x^∞ t³ / (eᵗ - 1) dt = 15/π⁴ Σ_n e^(-nx) (x³/n + 3x²/n² + 6x/n³ + 6/n⁴)."""
    n = np.arange(1, TERMS + 1)
    y = np.minimum(x, 800.0)[:, None]  # e^-800 is 0, and infinity times 0 is not
    return 15 / np.pi**4 * np.sum(np.exp(-n * y) * (y**3 / n + 3 * y**2 / n**2 + 6 * y / n**3 + 6 / n**4), axis=1)


def _powers(x: FloatArray) -> FloatArray:
    """15/π⁴ ∫_0^x t³ / (eᵗ - 1) dt = 15/π⁴ x³ (1/3 - x/8 + Σ_k B_2k / (2k)! x^2k / (2k + 3))."""
    k = np.arange(1, TERMS + 1)
    bernoulli = 2 * (-1.0) ** (k + 1) * zeta(2 * k)  # B_2k / (2k)! × (2π)^2k
    series = np.sum(bernoulli * (x[:, None] / (2 * np.pi)) ** (2 * k) / (2 * k + 3), axis=1)
    return 15 / np.pi**4 * x**3 * (1 / 3 - x / 8 + series)


def band_shares(temperature: ArrayLike, band_edges: ArrayLike) -> FloatArray:
    """Shares of a black surface's emission in wavelength bands.

    Parameters
    ----------
    temperature : array_like (…)
        K.
    band_edges : array_like (C + 1,)
        Rising wavelengths, m; 0 and infinity are allowed.

    Returns
    -------
    ndarray (…, C)

    Raises
    ------
    ParameterError
        Edges that do not rise.

    Examples
    --------
    The sun's light: ultraviolet, visible, infrared.

    >>> band_shares(5772.0, [0, 380e-9, 780e-9, np.inf]).round(3)
    array([0.1  , 0.465, 0.435])
    """
    edges = np.asarray(band_edges, dtype=np.float64)
    if edges.ndim != 1 or edges.size < 2 or not np.all(np.diff(edges) > 0):
        raise ParameterError(f"band_edges are {band_edges!r}; give rising wavelengths in metres, one more than bands")
    return np.diff(share_below(edges, np.asarray(temperature)[..., None]), axis=-1)


def exitance(temperature: ArrayLike, emissivity: ArrayLike = 1.0, band_edges: ArrayLike | None = None) -> FloatArray:
    """Emission E of a surface: ε σ T⁴, or that of each wavelength band.

    Parameters
    ----------
    temperature : array_like (…)
        K.
    emissivity : array_like (C,) or scalar, optional
        In [0, 1]; of each band, where there are bands.
    band_edges : array_like (C + 1,), optional
        Wavelengths, m. One grey channel if not given.

    Returns
    -------
    ndarray (…, C)
        W/m²; C = 1 for a grey surface.
    """
    share = np.asarray(emissivity, dtype=np.float64)
    if not np.all((share >= 0) & (share <= 1)):
        raise ParameterError(f"emissivity {emissivity!r} is outside [0, 1]")
    shares = np.ones(1) if band_edges is None else band_shares(temperature, band_edges)
    if share.ndim > 1 or share.size not in (1, shares.shape[-1]):
        raise ParameterError(f"emissivity has shape {share.shape}; give one, or {shares.shape[-1]}, one a band")
    return share * shares * black_exitance(temperature)[..., None]


def temperature(exitance: ArrayLike, emissivity: ArrayLike = 1.0) -> FloatArray:
    """Temperature (E / (ε σ))^¼ at which a grey surface emits E, K, same shape.

    An insulated surface, which sends back all that arrives, is as warm as a black one that emits its irradiance:
    ``temperature(solution.irradiance.sum(axis=1))``.

    Raises
    ------
    ParameterError
        A negative exitance, an emissivity outside (0, 1].

    >>> float(temperature(exitance(300.0, 0.8), 0.8).round(9)[0])
    300.0
    """
    power, share = np.asarray(exitance, dtype=np.float64), np.asarray(emissivity, dtype=np.float64)
    if not np.all((power >= 0) & np.isfinite(power)):
        raise ParameterError(f"exitance {np.min(power)} W/m² is negative or not finite: no temperature emits it")
    if not np.all((share > 0) & (share <= 1)):
        raise ParameterError(f"emissivity {np.min(share)} is outside (0, 1]: no temperature can be told from it")
    return (power / (share * STEFAN_BOLTZMANN)) ** 0.25


def with_temperatures(
    scene: Scene,
    temperatures: Mapping[str, float],
    *,
    emissivity: float | ArrayLike | Mapping[str, ArrayLike] | None = None,
    band_edges: ArrayLike | None = None,
    surroundings: float | None = None,
) -> Scene:
    """The same scene with surfaces that emit by their temperature.

    Parameters
    ----------
    scene : Scene
        Of one channel, or of one for each band.
    temperatures : mapping of str to float
        K, by the name of a surface or, failing that, of a material. The other surfaces stay as they are.
    emissivity : float, array_like (C,) or mapping of str to those, optional
        Of the surfaces named in `temperatures`; becomes their absorptance. By default their absorptance is taken.
    band_edges : array_like (C + 1,), optional
        Wavelengths of the channels, m. One grey channel if not given.
    surroundings : float, optional
        Temperature of black surroundings, K: the scene's sky. It stays as it is if not given.

    Returns
    -------
    Scene

    Raises
    ------
    ParameterError
        Names that the scene does not have, a temperature below 0 K, channels that are no bands.

    Examples
    --------
    >>> from radiosity.scenes import parallel_plates
    >>> scene = with_temperatures(parallel_plates(emission=0), {"lower": 400.0}, emissivity=0.9, surroundings=300.0)
    >>> scene.surfaces[0].material.emission.round(1), scene.sky.round(1)
    (array([1306.5]), array([146.2]))
    """
    channels = 1 if band_edges is None else np.size(band_edges) - 1
    if scene.channels not in (1, channels):
        raise ParameterError(
            f"scene {scene.name!r} has {scene.channels} channels; give band_edges, {scene.channels + 1} wavelengths, "
            "so that each channel is a band, or a scene of one grey channel"
        )
    check_names(scene, temperatures, "temperatures")
    if isinstance(emissivity, Mapping):
        check_names(scene, emissivity, "emissivity")

    def heated(surface: Surface) -> Surface:
        kelvin = _named(temperatures, surface)
        if kelvin is None:
            return surface
        given = _named(emissivity, surface) if isinstance(emissivity, Mapping) else emissivity
        return replace(surface, material=_heated(surface.material, kelvin, given, band_edges))

    sky = scene.sky
    if surroundings is not None:
        sky = exitance(surroundings, 1.0, band_edges) / np.pi
    return replace(scene, surfaces=tuple(heated(surface) for surface in scene.surfaces), sky=sky)


def _heated(old: Material, kelvin: float, emissivity: ArrayLike | None, band_edges: ArrayLike | None) -> Material:
    """A material that emits by its temperature, with the share that was given kept exactly."""
    share = old.absorptance if emissivity is None else np.asarray(emissivity, dtype=np.float64)
    emission = exitance(kelvin, share, band_edges)
    return old.replace(emission=emission, **({} if emissivity is None else {"absorptance": share}))


def _named(values: Mapping[str, Any], surface: Surface) -> Any:
    """What a mapping says of a surface: by its own name, else by its material's."""
    return values[surface.name] if surface.name in values else values.get(surface.material.name)


def _kelvin(values: ArrayLike) -> FloatArray:
    kelvin = np.asarray(values, dtype=np.float64)
    if not np.all((kelvin >= 0) & np.isfinite(kelvin)):
        raise ParameterError(f"temperature {values!r} K is negative or not finite; give kelvin")
    return kelvin


@dataclass(frozen=True, eq=False)
class SurfaceHeat:
    """Heat of M surfaces, W, (M, C) each.

    Attributes
    ----------
    names : tuple of str
    area : ndarray (M,)
        m².
    emitted, absorbed : ndarray (M, C)
        Σ A E and Σ A α H of the patches.
    """

    names: tuple[str, ...]
    area: FloatArray
    emitted: FloatArray
    absorbed: FloatArray

    @property
    def net(self) -> FloatArray:
        """Heat that each surface gives away, emitted less absorbed, W, (M, C): what keeps it at its temperature."""
        return self.emitted - self.absorbed

    def of(self, name: str) -> float:
        """Net heat that a named surface gives away, all bands together, W.

        Raises
        ------
        ParameterError
            A name that there is not.
        """
        return float(self.net[place(self.names, name)].sum())

    def __str__(self) -> str:
        """A table to read, all bands together."""
        width = max(len("surface"), *map(len, self.names))
        lines = [f"{'surface':<{width}}{'m²':>12}{'emitted, W':>14}{'absorbed, W':>14}{'net, W':>14}{'W/m²':>12}"]
        columns = (values.sum(axis=1) for values in (self.emitted, self.absorbed, self.net))
        for name, area, emitted, absorbed, net in zip(self.names, self.area, *columns, strict=True):
            lines.append(f"{name:<{width}}{area:12.5g}{emitted:14.6g}{absorbed:14.6g}{net:14.6g}{net / area:12.5g}")
        return "\n".join(lines)


def heat_by_surface(solution: Solution) -> SurfaceHeat:
    """Heat that each surface of a solution emits, absorbs and gives away.

    The net heat is emitted less absorbed, A (E - α H); the same as A (B - H), without its loss of digits where
    surfaces reflect almost everything.
    """
    group, names = grouping(solution.factors)
    area = solution.patches.area

    def by_surface(watts: FloatArray) -> FloatArray:
        return np.stack([sums_over(group, column, len(names)) for column in watts.T], axis=1)

    return SurfaceHeat(
        names,
        sums_over(group, area, len(names)),
        by_surface(area[:, None] * solution.emission),
        by_surface(solution.absorbed),
    )
