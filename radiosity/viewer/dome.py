"""The hemisphere at the picked patch, as a value: where ω_i and ω_o point, what is summed, which way one came.

Toolkit-free, as `state` is. Angles are in degrees: θ from the normal, azimuths as in `radiosity.hemisphere`.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ..errors import ParameterError

FloatArray = NDArray[np.float64]

Stage = Literal["radiance", "cosine", "sum"]
STAGES: tuple[Stage, ...] = ("radiance", "cosine", "sum")
HORIZON = 90.0
THETA_STEP, AZIMUTH_STEP = 5.0, 10.0
SHININESS = 24.0  # of the glossy lobe that is shown for comparison


@dataclass(frozen=True)
class Dome:
    """What is shown of the hemisphere at the picked patch.

    Attributes
    ----------
    stage : {"radiance", "cosine", "sum"}
        Colour of the dome: L_i; L_i cos θ; or that, only as far from the normal as the sum has come.
    theta, azimuth : float
        ω_i, where the light that one looks at comes from. The sum reaches from the normal to θ.
    theta_out, azimuth_out : float
        ω_o, where it goes.
    single : bool
        Light of one bounce, which arrives as bounce k - 1, instead of all light up to it.
    glossy : bool
        Show a glossy lobe beside Lambert's; it is not solved.
    path : tuple of (int, int)
        Patches and bounces that one came from, the oldest first: the recursion, walked by hand.
    """

    stage: Stage = "radiance"
    theta: float = 40.0
    azimuth: float = 60.0
    theta_out: float = 50.0
    azimuth_out: float = 200.0
    single: bool = False
    glossy: bool = False
    path: tuple[tuple[int, int], ...] = ()

    def __post_init__(self) -> None:
        if self.stage not in STAGES:
            raise ParameterError(f"the dome cannot show {self.stage!r}; choose from {', '.join(STAGES)}")
        for name in ("theta", "theta_out"):
            object.__setattr__(self, name, float(np.clip(getattr(self, name), 0.0, HORIZON)))
        for name in ("azimuth", "azimuth_out"):
            object.__setattr__(self, name, float(getattr(self, name)) % 360.0)

    def aimed(self, theta: float, azimuth: float) -> Dome:
        """With ω_i elsewhere."""
        return replace(self, theta=theta, azimuth=azimuth)

    def looked_from(self, theta: float, azimuth: float) -> Dome:
        """With ω_o elsewhere."""
        return replace(self, theta_out=theta, azimuth_out=azimuth)

    def turned(self, theta: float = 0.0, azimuth: float = 0.0) -> Dome:
        """With ω_i moved by some degrees."""
        return self.aimed(self.theta + theta, self.azimuth + azimuth)

    def next_stage(self) -> Dome:
        """The next thing to colour the dome by. The sum begins at the normal."""
        stage = STAGES[(STAGES.index(self.stage) + 1) % len(STAGES)]
        return replace(self, stage=stage, theta=0.0 if stage == "sum" else self.theta or 40.0)

    def other_light(self) -> Dome:
        """All light, or that of one bounce."""
        return replace(self, single=not self.single)

    def other_lobe(self) -> Dome:
        """With the glossy lobe, or without."""
        return replace(self, glossy=not self.glossy)

    def swept_on(self) -> Dome:
        """One step of the animation: a ring more in the sum, and after the horizon from the normal again."""
        return replace(self, theta=0.0 if self.theta >= HORIZON else self.theta + THETA_STEP)


def on_dome(theta: float, azimuth: float) -> FloatArray:
    """Point (3,) of the unit dome, z along the normal."""
    t, a = np.radians([theta, azimuth])
    return np.array([np.sin(t) * np.cos(a), np.sin(t) * np.sin(a), np.cos(t)])


def angles(direction: FloatArray) -> tuple[float, float]:
    """θ and azimuth of a direction (3,) of any length; what lies below the horizon is lifted to it."""
    x, y, z = direction
    return float(np.degrees(np.arctan2(np.hypot(x, y), max(z, 0.0)))), float(np.degrees(np.arctan2(y, x)) % 360.0)


def direction_under(eye: FloatArray, towards: FloatArray, near: FloatArray | None = None) -> tuple[float, float] | None:
    """Direction of the dome that a ray from the eye points at, as it is drawn; None if it misses.

    The dome is open towards the eye. From above, rays end on its floor, where each direction stands as far from the
    middle as the sine of its θ; else inside on its far half.

    Parameters
    ----------
    eye, towards : ndarray (3,)
        In coordinates of the dome: radius 1, z along the normal.
    near : ndarray (3,), optional
        Point of the dome that is being dragged. Then the floor is no hindrance, the nearer of both halves is taken,
        and beside the dome its outline.
    """
    d = towards / np.linalg.norm(towards)
    along = -float(eye @ d)
    closest = eye + along * d
    inside = 1.0 - float(closest @ closest)
    if near is not None:
        half = np.sqrt(max(inside, 0.0))
        points = [closest - half * d, closest + half * d]
        possible = [p for p in points if p[2] >= 0.0] or points
        return angles(min(possible, key=lambda p: float(np.linalg.norm(p - near))))
    if eye[2] > 0.0 > d[2]:
        floor = eye - (eye[2] / d[2]) * d
        radius = float(np.hypot(floor[0], floor[1]))
        if radius <= 1.0:
            return angles(np.array([floor[0], floor[1], np.sqrt(1.0 - radius**2)]))
    far = closest + np.sqrt(max(inside, 0.0)) * d
    return angles(far) if inside >= 0.0 and far[2] >= 0.0 else None


def lobe(outgoing: FloatArray, incoming: FloatArray, reflectance: float, *, glossy: bool = False) -> FloatArray:
    """How far a lobe reaches in directions (…, 3): π f_r of Lambert, which is ρ everywhere; or the shape of Phong's.

    Phong's (cos of the angle to the mirror direction, to a power) is drawn as high as Lambert's at its peak: its
    shape counts, and nothing here is computed with it.
    """
    if not glossy:
        return np.full(outgoing.shape[:-1], reflectance)
    mirror = incoming * np.array([-1.0, -1.0, 1.0])
    return reflectance * np.clip(outgoing @ mirror, 0.0, 1.0) ** SHININESS
