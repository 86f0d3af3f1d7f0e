"""The rendering equation at the picked patch in numbers, and the colours of its dome. Knows no window."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from .. import display
from .state import Pane, Series, ViewState, coloured

if TYPE_CHECKING:
    from .model import Model

FloatArray = NDArray[np.float64]
ByteArray = NDArray[np.uint8]

DIM = 26  # of 255, where the sum has not come yet


def arriving(model: Model, series: Series, state: ViewState) -> FloatArray:
    """Radiance that arrives at the picked patch from each cell of its hemisphere, W/(m² sr), (R, S, 3).

    What leaves it with up to k bounces has arrived with up to k - 1; sky light is there before the first bounce.
    """
    solution = model.lit(state.changes)[0]
    k, single = state.order, state.dome.single
    from_sky = not solution.patches.closed and (k == 1 if single else k >= 1)
    sky = display.as_rgb(solution.sky) if from_sky else np.zeros(3)
    leaving = series.orders if single else series.sums
    light = leaving[k - 1] if k else np.zeros_like(leaving[0])
    return model.hemisphere(state.picked).radiance(light, sky)


@dataclass(frozen=True, eq=False)
class DomeReading:
    """The rendering equation at the picked patch, in numbers, RGB.

    Attributes
    ----------
    radiance : ndarray (R, S, 3)
        L_i of each cell, W/(m² sr).
    running : ndarray (R + 1, 3)
        Σ L_i cos θ dω from the normal to each θ, W/m².
    along : ndarray (3,)
        L_i along ω_i.
    so_far : ndarray (3,)
        The sum up to the θ of ω_i, W/m².
    irradiance : ndarray (3,)
        H over the whole dome, W/m².
    solved : ndarray (3,)
        H as the solver has it, by the patch's row of form factors.
    reflectance : ndarray (3,)
    emission : ndarray (3,)
        Of this light, W/m².
    outgoing : ndarray (3,)
        L_o = ρ H / π (and, of all light, L_e), W/(m² sr).
    ahead : int
        Patch seen along ω_i.
    """

    radiance: FloatArray
    running: FloatArray
    along: FloatArray
    so_far: FloatArray
    irradiance: FloatArray
    solved: FloatArray
    reflectance: FloatArray
    emission: FloatArray
    outgoing: FloatArray
    ahead: int

    @classmethod
    def of(cls, model: Model, series: Series, state: ViewState) -> DomeReading:
        """Read the hemisphere of the picked patch."""
        solution = model.lit(state.changes)[0]
        patch, view = state.picked, model.hemisphere(state.picked)
        radiance = arriving(model, series, state)
        running = view.running_sum(radiance)
        rings, sectors = view.seen.shape
        ring = min(int(state.dome.theta / 90.0 * rings), rings - 1)
        reflectance = np.asarray(display.as_rgb(solution.patches.reflectance[patch]), dtype=np.float64)
        emission = np.asarray(display.as_rgb(solution.emission[patch]), dtype=np.float64)
        k, single = state.order, state.dome.single
        own = np.zeros(3) if single and k else emission
        reflected = (series.orders if single else series.sums)[k, patch] - own
        solved = np.divide(reflected, reflectance, out=np.zeros(3), where=reflectance > 0.0)
        return cls(
            radiance=radiance,
            running=running,
            along=radiance[ring, int(state.dome.azimuth / 360.0 * sectors) % sectors],
            so_far=running[round(state.dome.theta / 90.0 * rings)],
            irradiance=running[-1],
            solved=solved,
            reflectance=reflectance,
            emission=own,
            outgoing=(own + reflectance * running[-1]) / np.pi,
            ahead=model.ahead(state),
        )


def dome_pictures(reading: DomeReading, series: Series, state: ViewState) -> tuple[ByteArray, ByteArray]:
    """Colours of the cells of the dome and of its floor, (R, S, 3) each, on the exposure that the panes have.

    On the floor, the dome is seen from straight above: there the cosine is in the area, so that it shows L_i and its
    mean is H / π (Nusselt's construction).
    """
    rings = len(reading.radiance)
    theta = (np.arange(rings) + 0.5) * (np.pi / 2.0 / rings)
    pane: Pane = "order" if state.dome.single else "sum"
    shown = state.at(state.order - 1) if state.dome.single and state.order else state
    light = (np.pi * reading.radiance).astype(np.float32)
    floor = coloured(series, shown, pane, light)
    if state.dome.stage == "radiance":
        return floor, floor
    dome = coloured(series, shown, pane, light * np.cos(theta).astype(np.float32)[:, None, None])
    if state.dome.stage == "sum":
        beyond = np.degrees(theta) > state.dome.theta
        dome[beyond] = dome[beyond] // 5 + DIM
        floor[beyond] = floor[beyond] // 5 + DIM
    return dome, floor
