"""What a point sees: a hemisphere of directions, the patch behind each, and the light that comes from there.

The reflected light of the rendering equation, written out. With L_i the radiance that arrives from direction ω,

    H = ∫ L_i cos θ dω,        L_o = ρ H / π.

The hemisphere is cut into cells by rings of the angle θ to the normal and by sectors; a ray through the middle of each
cell says which patch it sees, and the cell's ∫ cos θ dω is exact, so that the cells add up to π.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .errors import ParameterError
from .face_points import OFFSET
from .geometry import unit
from .patches import Patches
from .rays import BACK, MISS, Tracer

FloatArray = NDArray[np.float64]

RINGS, SECTORS = 120, 480  # cells of ¾ of a degree
UPRIGHT = (0.0, 1.0, -0.1)  # where azimuth 90° leans: up, and on level faces to the back


@dataclass(frozen=True, eq=False)
class Hemisphere:
    """The directions about the normal at the middle of a patch, and what is seen there.

    Attributes
    ----------
    patch : int
        Where it stands.
    point : ndarray (3,)
        m.
    frame : ndarray (3, 3)
        Unit vectors as rows: azimuth 0°, azimuth 90°, the normal.
    seen : ndarray of int32 (R, S)
        Patch seen through the middle of each cell, or `MISS`, or `BACK`. Ring r reaches from θ = r · 90°/R to the
        next, sector s from azimuth s · 360°/S to the next.
    """

    patch: int
    point: FloatArray
    frame: FloatArray
    seen: NDArray[np.int32]

    @property
    def weights(self) -> FloatArray:
        """Projected solid angle ∫ cos θ dω of a cell of each ring, (R,), sr; all cells together have π."""
        rings, sectors = self.seen.shape
        edges = np.sin(np.linspace(0.0, np.pi / 2.0, rings + 1)) ** 2
        return np.diff(edges) * (np.pi / sectors)

    def radiance(self, radiosity: ArrayLike, sky: ArrayLike = 0.0) -> FloatArray:
        """Radiance that arrives from each cell, L_i = B / π of the patch seen, W/(m² sr).

        Parameters
        ----------
        radiosity : array_like (N, C)
            B, or any one order of it, W/m².
        sky : array_like (C,), optional
            Radiance where no patch is seen. Black backs send none.

        Returns
        -------
        ndarray (R, S, C)
        """
        given = np.asarray(radiosity, dtype=np.float64) / np.pi
        outside = np.broadcast_to(np.asarray(sky, dtype=np.float64), given.shape[1:])
        assert (MISS, BACK) == (-1, -2)  # they count from the end
        table = np.concatenate([given, np.zeros((1, given.shape[1])), outside[None]])
        return table[self.seen]

    def running_sum(self, radiance: FloatArray) -> FloatArray:
        """Σ L_i cos θ dω over the rings up to each θ, W/m², (R + 1, C); the last entry is the irradiance H."""
        by_ring = self.weights[:, None] * radiance.sum(axis=1)
        return np.concatenate([np.zeros((1, radiance.shape[2])), np.cumsum(by_ring, axis=0)])

    def irradiance(self, radiance: FloatArray) -> FloatArray:
        """H = Σ L_i cos θ dω over all cells, W/m², (C,)."""
        return self.running_sum(radiance)[-1]

    def direction(self, theta: float, azimuth: float) -> FloatArray:
        """Unit vector (3,) at an angle to the normal and an azimuth, degrees."""
        t, a = np.radians([theta, azimuth])
        return np.array([np.sin(t) * np.cos(a), np.sin(t) * np.sin(a), np.cos(t)]) @ self.frame

    def seen_at(self, theta: float, azimuth: float) -> int:
        """Patch seen in a direction, degrees; `MISS` or `BACK` where none is."""
        rings, sectors = self.seen.shape
        ring = min(int(np.clip(theta, 0.0, 90.0) / 90.0 * rings), rings - 1)
        return int(self.seen[ring, int(azimuth % 360.0 / 360.0 * sectors) % sectors])


def hemisphere_at(
    patches: Patches,
    patch: int,
    *,
    rings: int = RINGS,
    sectors: int = SECTORS,
    upright: ArrayLike = UPRIGHT,
    tracer: Tracer | None = None,
) -> Hemisphere:
    """What the middle of a patch sees.

    Parameters
    ----------
    patches : Patches
    patch : int
    rings, sectors : int, optional
        Cells between the normal and the horizon, and around. One ray a cell: what is narrower is seen or missed as
        a whole, so that an edge of a bright patch is off by half a cell at most.
    upright : array_like (3,), optional
        Direction that azimuth 90° leans to as far as it can.
    tracer : Tracer, optional
        Of the same patches, where there is one already.

    Returns
    -------
    Hemisphere

    Raises
    ------
    ParameterError
        No such patch; no cells.

    Examples
    --------
    In a furnace where everything glows with 1 W/m², that is what arrives:

    >>> from radiosity.patches import subdivide
    >>> from radiosity.scenes import furnace
    >>> patches = subdivide(furnace())
    >>> round(float(hemisphere_at(patches, 0).irradiance(hemisphere_at(patches, 0).radiance(np.ones((6, 1))))[0]), 12)
    1.0
    """
    if not 0 <= patch < len(patches):
        raise ParameterError(f"there is no patch {patch}; there are {len(patches)}, counted from 0")
    if rings < 1 or sectors < 1:
        raise ParameterError(f"{rings} rings and {sectors} sectors make no cells; give at least 1 of each")
    tracer = tracer or Tracer(patches.grid)
    normal = patches.normal[patch]
    frame = _frame(normal, np.asarray(upright, dtype=np.float64))
    theta = (np.arange(rings) + 0.5) * (np.pi / 2.0 / rings)
    azimuth = (np.arange(sectors) + 0.5) * (2.0 * np.pi / sectors)
    across = np.sin(theta)[:, None]
    local = np.stack(
        [across * np.cos(azimuth), across * np.sin(azimuth), np.repeat(np.cos(theta)[:, None], sectors, axis=1)], axis=2
    )
    directions = (local.reshape(-1, 3) @ frame).astype(np.float32)
    origin = (tracer.to_unit(patches.centroid[patch]) + OFFSET * normal).astype(np.float32)
    origins = np.ascontiguousarray(np.broadcast_to(origin, directions.shape))
    seen = tracer.run(origins, np.ascontiguousarray(directions)).reshape(rings, sectors)
    return Hemisphere(patch, patches.centroid[patch], frame, seen)


def _frame(normal: FloatArray, upright: FloatArray) -> FloatArray:
    """Azimuth 0°, azimuth 90° and normal as rows; azimuth 90° lies nearest to `upright`, or to z where that is n."""
    possible = np.stack([upright, [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])
    leaning = possible - (possible @ normal)[:, None] * normal
    far_enough = np.linalg.norm(leaning, axis=1) > 1e-6 * np.linalg.norm(possible, axis=1)
    across = unit(leaning[int(np.argmax(far_enough))])
    return np.stack([np.cross(across, normal), across, normal])
