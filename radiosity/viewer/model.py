"""What there is to show of a solution beside its series, worked out when a state first asks for it. Knows no window."""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..camera import presets
from ..hemisphere import Hemisphere, hemisphere_at
from ..rays import Tracer
from ..transport import TransportOperator
from .changes import Changes, Sliders, relit
from .inspect import HemicubeView, MatrixView
from .race import Race
from .state import Series, ViewState

if TYPE_CHECKING:
    from ..solution import Solution

FloatArray = NDArray[np.float64]


@dataclass(eq=False)
class Model:
    """A solution with everything that a viewer shows of it.

    Attributes
    ----------
    solution, series
        As they were solved, whatever the sliders have changed since.
    """

    solution: Solution
    series: Series

    def __post_init__(self) -> None:
        self._shown: tuple[Changes, Solution, Series] = (Changes(), self.solution, self.series)

    def lit(self, changes: Changes) -> tuple[Solution, Series]:
        """Solution and series under changed light and paint, on the exposure of the unchanged ones.

        Raises
        ------
        RadiosityError
            See `Solution.relight`.
        """
        values = (changes.emission, changes.reflectance)
        if values != (self._shown[0].emission, self._shown[0].reflectance):
            solution = relit(self.solution, changes, self.series.last)
            series = Series.of(solution, common=self.series.common) if changes else self.series
            self._shown = (changes, solution, series)
        return self._shown[1:]

    def held(self, state: ViewState) -> Changes:
        """The changes with the surface that the sliders hold: the one named, else that of the picked patch."""
        if state.changes.surface or state.picked < 0:
            return state.changes
        patches = self.solution.patches
        return state.changes.on(patches.surface_names[patches.surface[state.picked]])

    def sliders(self, state: ViewState) -> Sliders:
        """The emission and reflectance sliders."""
        return Sliders.of(self.solution.scene, self.held(state))

    @functools.cached_property
    def tracer(self) -> Tracer:
        """Rays into the scene."""
        return Tracer(self.solution.patches.grid)

    @functools.lru_cache(maxsize=8)  # noqa: B019 (lives as long as the viewer)
    def hemicube(self, patch: int) -> HemicubeView:
        """What a patch sees, unfolded."""
        return HemicubeView.of(self.solution.patches, patch, tracer=self.tracer)

    @functools.lru_cache(maxsize=32)  # noqa: B019
    def hemisphere(self, patch: int) -> Hemisphere:
        """What a patch sees, by direction."""
        return hemisphere_at(self.solution.patches, patch, upright=self.upright, tracer=self.tracer)

    @functools.cached_property
    def upright(self) -> FloatArray:
        """Up, and on level faces away from who looks at the scene: a dome stands as its patch is seen."""
        camera = presets(self.solution.patches)[0]
        forward = np.subtract(camera.focal_point, camera.position)
        return np.asarray(camera.up) + 0.1 * forward / np.linalg.norm(forward)

    @functools.lru_cache(maxsize=2)  # noqa: B019
    def matrix(self, solution: Solution) -> MatrixView:
        """T of the first channel."""
        operator = TransportOperator(solution.factors, solution.patches)
        return MatrixView.of_operator(operator, 0, solution.patches.surface, solution.patches.surface_names)

    @functools.lru_cache(maxsize=2)  # noqa: B019
    def race(self, solution: Solution) -> Race:
        """Gathering against shooting."""
        return Race(solution)

    def ahead(self, state: ViewState) -> int:
        """Patch that the picked one sees along ω_i; negative for none."""
        if state.picked < 0:
            return -1
        return self.hemisphere(state.picked).seen_at(state.dome.theta, state.dome.azimuth)
