"""Light as the eye counts it: lumens in, lux out, with the conventions stated.

Two conventions are in use, and a number means nothing before one of them is chosen:

- **Channels are photometric** (`PHOTOMETRIC`, 1 lm/W, the default here). What the scene calls W is lumen: a lamp of
  800 lm gives lux at once. A single channel is luminous as it is; three channels are linear sRGB and scaled so that
  their luminance Y = 0.2126 R + 0.7152 G + 0.0722 B (ITU-R BT.709) is in lumens. Ratios of light do not depend on this.
- **Channels are radiometric**, W. Then lumens are W × luminous efficacy × weights. Of a spectrum the weights are V(λ)
  (`radiosity.colour.luminous_weights`), and the efficacy is `PEAK`, 683 lm/W, the SI's own number for 540 THz. Of three
  channels in W nobody knows the spectrum inside a channel; `PEAK` with the weights of Y is then the usual choice for
  the same three primaries, and `RADIANCE`, 179 lm/W of equal-energy white, that of the Radiance programs.

Lamps and readings agree as long as both use the same convention: what goes in as lumens comes out as lumens.

========================  =========  ==================  ====================
radiometric                          photometric
========================  =========  ==================  ====================
power                     W          luminous flux       lm
radiosity, exitance       W/m²       luminous exitance   lm/m²
irradiance                W/m²       illuminance         lux = lm/m²
radiance = radiosity / π  W/(m² sr)  luminance           cd/m² = lm/(m² sr)
========================  =========  ==================  ====================
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .display import LUMINANCE_WEIGHTS
from .errors import ParameterError
from .faces import source_faces
from .relight import check_names
from .scene import Material, Scene, Surface
from .solution import Solution

FloatArray = NDArray[np.float64]

PHOTOMETRIC = 1.0  # lm/W: the channels hold lumens already
PEAK = 683.0  # lm/W at 540 THz, exact by the definition of the candela (SI, 1979 and 2019)
RADIANCE = 179.0  # lm/W of equal-energy white: the convention of Radiance (Ward 1994, doi:10.1145/192161.192286)


def luminous(values: ArrayLike, *, efficacy: float = PHOTOMETRIC, weights: ArrayLike | None = None) -> FloatArray:
    """Light of all channels as one photometric number: W/m² to lux, radiance to cd/m², W to lm.

    Parameters
    ----------
    values : array_like (…, C)
        Irradiance, radiosity, radiance or power.
    efficacy : float, optional
        lm/W: `PHOTOMETRIC`, `PEAK`, `RADIANCE` or your own.
    weights : array_like (C,), optional
        Of the channels. By default 1 for one channel and those of linear sRGB for three.

    Returns
    -------
    ndarray (…)

    Raises
    ------
    ParameterError
        Weights that do not fit; channels that have no weights by default.

    Examples
    --------
    >>> float(luminous([100.0, 100.0, 100.0]))
    100.0
    """
    light = np.asarray(values, dtype=np.float64)
    return efficacy * (light @ channel_weights(light.shape[-1] if light.ndim else 0, weights))


def channel_weights(channels: int, weights: ArrayLike | None = None) -> FloatArray:
    """Weights (C,) with which channels count as light: those given, else 1 for one, sRGB's for three.

    Raises
    ------
    ParameterError
    """
    if weights is not None:
        given = np.asarray(weights, dtype=np.float64)
        if given.shape != (channels,) or not np.all((given >= 0) & np.isfinite(given)) or not given.any():
            raise ParameterError(f"weights {weights!r} do not fit {channels} channels: give {channels} of them, ≥ 0")
        return given
    if channels == 1:
        return np.ones(1)
    if channels == 3:
        return np.array(LUMINANCE_WEIGHTS)
    raise ParameterError(
        f"light has {channels} channels: give weights, one each (radiosity.colour.luminous_weights(wavelengths) for a "
        "spectrum)"
    )


def lamp_exitance(
    lumens: float,
    area: float,
    *,
    colour: ArrayLike = 1.0,
    efficacy: float = PHOTOMETRIC,
    weights: ArrayLike | None = None,
) -> FloatArray:
    """Emission of a lamp that gives so many lumens from so much area.

    Parameters
    ----------
    lumens : float
        Luminous flux of the whole lamp, lm.
    area : float
        Of all that shines, m².
    colour : array_like (C,), optional
        Ratios of the channels; only those count.
    efficacy, weights
        As for `luminous`.

    Returns
    -------
    ndarray (C,)
        Exitance, W/m² (lm/m² if the channels are photometric), with area × `luminous` of it the lumens.

    Raises
    ------
    ParameterError
        A flux below zero, an area or an efficacy that is not positive, a colour that is black to the eye.

    Examples
    --------
    A ceiling panel of 60 × 60 cm and 3600 lm:

    >>> lamp_exitance(3600, 0.36)
    array([10000.])
    """
    ratios = np.atleast_1d(np.asarray(colour, dtype=np.float64))
    if not (lumens >= 0 and np.isfinite(lumens) and 0 < area < np.inf and 0 < efficacy < np.inf):
        raise ParameterError(f"{lumens} lm from {area} m² at {efficacy} lm/W: give a flux ≥ 0, and the others above 0")
    brightness = float(luminous(ratios, efficacy=efficacy, weights=weights))
    if not (np.all(ratios >= 0) and 0 < brightness < np.inf):
        raise ParameterError(f"colour {colour!r} is negative somewhere, or black to the eye: lumens cannot scale it")
    return lumens / area / brightness * ratios


def with_lumens(
    scene: Scene,
    lumens: Mapping[str, float],
    *,
    colour: ArrayLike | None = None,
    efficacy: float = PHOTOMETRIC,
    weights: ArrayLike | None = None,
) -> Scene:
    """The same scene with lamps of so many lumens.

    Parameters
    ----------
    scene : Scene
    lumens : mapping of str to float
        Luminous flux by surface name, lm: of the whole surface, both sides of a two-sided one together.
    colour : array_like (C,), optional
        Ratios of the channels. By default those that the lamp emits already, or equal ones where it emits nothing.
    efficacy, weights
        As for `luminous`.

    Returns
    -------
    Scene

    Raises
    ------
    ParameterError
        A name that no surface has; what `lamp_exitance` refuses.

    Examples
    --------
    >>> from radiosity.scenes import parallel_plates
    >>> with_lumens(parallel_plates(size=2.0), {"lower": 800.0}).surfaces[0].material.emission
    array([200.])
    """
    names = dict.fromkeys(scene.surface_names)
    if strangers := [name for name in lumens if name not in names]:
        check_names(scene, {strangers[0]: None}, "lumens")  # says which names there are, if it is none at all
        raise ParameterError(f"lumens: {strangers[0]!r} is a material; give the flux of each surface by its own name")
    faces = source_faces(scene)
    sides = np.bincount(faces.surface, faces.area * faces.sides, len(scene.surfaces))

    def lit(surface: Surface, area: float) -> Surface:
        if surface.name not in lumens:
            return surface
        old = surface.material
        shines = np.broadcast_to(old.emission, scene.channels)
        ratios = (shines if shines.any() else np.ones(scene.channels)) if colour is None else colour
        flux = lumens[surface.name]
        light = lamp_exitance(flux, area, colour=ratios, efficacy=efficacy, weights=weights)
        given = {old.given: getattr(old, old.given)}
        return replace(surface, material=Material(**given, emission=light, two_sided=old.two_sided, name=old.name))

    return replace(scene, surfaces=tuple(lit(s, float(a)) for s, a in zip(scene.surfaces, sides, strict=True)))


@dataclass(frozen=True, eq=False)
class PointGrid:
    """Points in rows on a rectangle, each in the middle of its cell, all looking the same way.

    Attributes
    ----------
    points : ndarray (rows, columns, 3)
        m.
    normal : ndarray (3,)
        Unit vector.
    """

    points: FloatArray
    normal: FloatArray


def point_grid(corner: ArrayLike, along: ArrayLike, across: ArrayLike, columns: int, rows: int) -> PointGrid:
    """Points on a rectangle such as a desk, looking towards along × across.

    Parameters
    ----------
    corner : array_like (3,)
        m.
    along, across : array_like (3,)
        The two edges from that corner, m. With y up, a desk that looks up has `along` towards +z and `across`
        towards +x.
    columns, rows : int
        Number of points along either edge.

    Raises
    ------
    ParameterError
        Edges without a plane, or no points.

    Examples
    --------
    A desk of 1.6 × 0.8 m, 0.75 m high:

    >>> grid = point_grid([1.0, 0.75, 1.0], [0, 0, 1.6], [0.8, 0, 0], columns=4, rows=2)
    >>> grid.points[0, 0], grid.normal
    (array([1.2 , 0.75, 1.2 ]), array([0., 1., 0.]))
    """
    start, first, second = (np.asarray(edge, dtype=np.float64) for edge in (corner, along, across))
    if columns < 1 or rows < 1:
        raise ParameterError(f"the grid has {columns} × {rows} points; give at least 1 along either edge")
    normal = np.cross(first, second)
    length = float(np.linalg.norm(normal))
    if not (0 < length < np.inf and np.isfinite(start).all()):
        raise ParameterError(f"corner {corner!r}, along {along!r} and across {across!r} span no rectangle")
    u, v = (np.arange(columns) + 0.5) / columns, (np.arange(rows) + 0.5) / rows
    points = start + u[None, :, None] * first + v[:, None, None] * second
    return PointGrid(points, normal / length)


@dataclass(frozen=True, eq=False)
class Illuminance:
    """Illuminance on a grid of points.

    Attributes
    ----------
    grid : PointGrid
    lux : ndarray (rows, columns)
    """

    grid: PointGrid
    lux: FloatArray

    @property
    def mean(self) -> float:
        """Mean illuminance, lux; each point stands for its cell."""
        return float(self.lux.mean())

    @property
    def uniformity(self) -> float:
        """Least over mean, U₀ of EN 12464-1; 0 in the dark."""
        return float(self.lux.min()) / self.mean if self.mean > 0 else 0.0

    def __str__(self) -> str:
        """Rows of lux, and their mean, least, most and uniformity."""
        lines = [" ".join(f"{value:8.1f}" for value in row) for row in self.lux]
        least, most = self.lux.min(), self.lux.max()
        return "\n".join(
            [*lines, f"lux: mean {self.mean:.1f}, least {least:.1f}, most {most:.1f}, uniformity {self.uniformity:.2f}"]
        )


def illuminance(
    solution: Solution,
    grid: PointGrid,
    *,
    efficacy: float = PHOTOMETRIC,
    weights: ArrayLike | None = None,
    rays: int = 1024,
    seed: int = 0,
) -> Illuminance:
    """Illuminance on a grid in a solved scene, by rays from its points.

    Parameters
    ----------
    solution : Solution
    grid : PointGrid
    efficacy, weights
        As for `luminous`.
    rays : int, optional
        For each point.
    seed : int, optional

    Returns
    -------
    Illuminance
    """
    flat = grid.points.reshape(-1, 3)
    arriving = solution.irradiance_at(flat, grid.normal, rays=rays, seed=seed)
    return Illuminance(grid, luminous(arriving, efficacy=efficacy, weights=weights).reshape(grid.points.shape[:2]))
