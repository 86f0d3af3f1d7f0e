"""Light and paint that the viewer has changed, as a value; and the same scene solved again with them.

A slider gives one number for a surface: its emission or reflectance, the mean over the channels. The hue stays as the
scene has it; what has none (black paint, no lamp) becomes grey.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from ..scene import Scene
    from ..solution import Solution

Values = tuple[tuple[str, float], ...]

LARGEST_REFLECTANCE = 0.95  # of any channel, by slider: beyond, the series that is shown would have to be very long
BRIGHTER_THAN_LAMPS = 2.0  # how far the emission slider reaches, against the brightest lamp
STEPS = 20  # of a slider, by key


@dataclass(frozen=True)
class Changes:
    """What differs from the scene as it was solved.

    Attributes
    ----------
    surface : str
        Whose emission and reflectance the sliders hold; empty for that of the picked patch, or the brightest.
    emission : tuple of (str, float)
        Name of a surface and its new exitance, mean over the channels, W/m².
    reflectance : tuple of (str, float)
        Name of a surface and its new reflectance, mean over the channels.
    """

    surface: str = ""
    emission: Values = ()
    reflectance: Values = ()

    def __bool__(self) -> bool:
        """Whether anything differs."""
        return bool(self.emission or self.reflectance)

    def on(self, surface: str) -> Changes:
        """With the sliders of another surface."""
        return replace(self, surface=surface)

    def emitting(self, surface: str, value: float) -> Changes:
        """With the emission of a surface changed."""
        return replace(self, surface=surface, emission=_with(self.emission, surface, value))

    def painted(self, surface: str, value: float) -> Changes:
        """With the reflectance of a surface changed."""
        return replace(self, surface=surface, reflectance=_with(self.reflectance, surface, value))

    def undone(self) -> Changes:
        """As the scene was solved, with the sliders of the same surface."""
        return Changes(self.surface)


def _with(values: Values, surface: str, value: float) -> Values:
    return tuple(sorted({**dict(values), surface: float(value)}.items()))


@dataclass(frozen=True)
class Sliders:
    """What the sliders of one surface hold and how far they reach; all are means over the channels.

    Attributes
    ----------
    surface : str
    emission, most_emission : float
        W/m².
    reflectance, most_reflectance : float
    """

    surface: str
    emission: float
    most_emission: float
    reflectance: float
    most_reflectance: float

    @classmethod
    def of(cls, scene: Scene, changes: Changes) -> Sliders:
        """The sliders of the surface that `changes` names; `scene` is as it was solved."""
        named = {surface.name: surface.material for surface in scene.surfaces}
        name = changes.surface if changes.surface in named else brightest(scene)
        brightest_mean = max(float(material.emission.mean()) for material in named.values())
        paint = named[name].reflectance
        grey = float(paint.mean())
        return cls(
            name,
            dict(changes.emission).get(name, float(named[name].emission.mean())),
            BRIGHTER_THAN_LAMPS * brightest_mean if brightest_mean > 0.0 else 1.0,
            dict(changes.reflectance).get(name, grey),
            max(LARGEST_REFLECTANCE * grey / float(paint.max()) if grey > 0.0 else LARGEST_REFLECTANCE, grey),
        )

    def brighter(self, changes: Changes, steps: int) -> Changes:
        """Some steps more or less emission."""
        value = self.emission + steps * self.most_emission / STEPS
        return changes.emitting(self.surface, float(np.clip(value, 0.0, self.most_emission)))

    def lighter(self, changes: Changes, steps: int) -> Changes:
        """Some steps more or less reflectance."""
        value = self.reflectance + steps / STEPS
        return changes.painted(self.surface, float(np.clip(value, 0.0, self.most_reflectance)))


def brightest(scene: Scene) -> str:
    """Name of the surface that emits most, the first one if none does."""
    return max(scene.surfaces, key=lambda surface: float(surface.material.emission.mean())).name


def next_surface(scene: Scene, changes: Changes) -> Changes:
    """The sliders of the next surface."""
    names = [surface.name for surface in scene.surfaces]
    now = Sliders.of(scene, changes).surface
    return changes.on(names[(names.index(now) + 1) % len(names)])


def relit(solution: Solution, changes: Changes, bounces: int) -> Solution:
    """The solution with other light and paint, on the same form factors, bounce by bounce up to a number of them.

    Raises
    ------
    RadiosityError
        See `Solution.relight`.
    """
    from ..solvers import Neumann

    if not changes:
        return solution
    named = {surface.name: surface.material for surface in solution.scene.surfaces}
    emission = {name: hued(named[name].emission, mean) for name, mean in changes.emission}
    reflectance = {name: hued(named[name].reflectance, mean) for name, mean in changes.reflectance}
    solver = solution.solver if isinstance(solution.solver, Neumann) else Neumann()
    series = replace(solution, solver=solver, bounces=bounces)
    given: Mapping[str, Any] = {"emission": emission or None, "reflectance": reflectance or None}
    return series.relight(**given)


def hued(values: NDArray[np.float64], mean: float) -> NDArray[np.float64]:
    """Channels in the ratios that they had, with another mean; grey where they had none.

    >>> hued(np.array([0.6, 0.2, 0.1]), 0.6)
    array([1.2, 0.4, 0.2])
    >>> hued(np.zeros(3), 0.5)
    array([0.5, 0.5, 0.5])
    """
    old = float(values.mean())
    return values * (mean / old) if old > 0.0 else np.full_like(values, mean)


def in_words(changes: Changes) -> str:
    """What was changed, for a label.

    >>> in_words(Changes().painted("floor", 0.25).emitting("lamp", 3.0))
    'lamp E = 3 W/m², floor ρ = 0.25'
    """
    emission = [f"{name} E = {value:.3g} W/m²" for name, value in changes.emission]
    return ", ".join(emission + [f"{name} ρ = {value:.2g}" for name, value in changes.reflectance])
