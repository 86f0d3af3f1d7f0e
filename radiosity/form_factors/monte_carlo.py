"""Form factors by Monte Carlo: cosine-distributed rays from points spread over each patch."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..compiled import kernel
from ..errors import ParameterError
from ..face_points import FaceTable
from ..patches import Patches
from ..rays import Tracer
from ..sequences import keys, seed_key, sobol_points
from .ahead import DIRECT_LIGHT
from .assembly import RowBlock, RowMaker, count_hits
from .direct_light import DirectLight, worthwhile_emitters
from .starts import numbers, starts

LEAST_LIGHT_RAYS = 256  # by default
DIRECT = 1 << 40  # which of the numbers below a replicate's key are for shadow rays: no patch's
BATCH = 1 << 16  # rays at a time: their arrays stay in cache, and calls into Embree are few


@dataclass(frozen=True)
class MonteCarlo:
    """Form factors by counting where rays land.

    A ray leaves a point of patch i, uniform in area, in a direction distributed as cos θ / π about the normal. The
    share of rays that first meet patch j estimates F_ij without bias, Eq. (13), and every row adds up to 1: each ray
    ends somewhere. Emitters, which cause most of the error, are looked at apart where that pays.

    Parameters
    ----------
    rays : int
        Rays per patch, over all replicates. A power of two times `replicates` serves Sobol points best.
    seed : int
    sampling : {"sobol", "random"}
        One scrambled four-dimensional Sobol sequence for position and direction, shifted for each patch; or
        independent random numbers, whose error falls as 1/√rays, for teaching.
    replicates : int
        Independent estimates among which all rays are shared; their spread gives standard errors.
    light_rays : int, optional
        Shadow rays between a patch and an emitting face, over all replicates, where the first sixteen, or the first
        sixteenth of them, disagree: see `direct_light`, which says when emitters are left to the sampling rays instead.
        0 leaves them to those always, and every row is then a plain count. By default a quarter of the rays and at
        least 256, which makes the errors of direct and indirect light about equal; 0 with random numbers.

    Notes
    -----
    Malley's method: a uniform point of the disk, projected up to the hemisphere, is cosine-distributed (Cohen &
    Wallace 1993, §4.4; Pharr, Jakob & Humphreys 2023, §A.5.3).
    """

    rays: int = 256
    seed: int = 0
    sampling: Literal["sobol", "random"] = "sobol"
    replicates: int = 1
    light_rays: int = None  # type: ignore[assignment]  # always a number once made

    def __post_init__(self) -> None:
        seed_key(self.seed)
        if self.replicates < 1:
            raise ParameterError(f"replicates is {self.replicates}; give at least 1")
        if self.rays < self.replicates or self.rays % self.replicates:
            raise ParameterError(
                f"rays is {self.rays} with {self.replicates} replicates; give a positive multiple of the replicates"
            )
        if self.sampling not in ("sobol", "random"):
            raise ParameterError(f"sampling is {self.sampling!r}; give 'sobol' or 'random'")
        if self.light_rays is None:
            object.__setattr__(self, "light_rays", self._balanced_light_rays() if self.sampling == "sobol" else 0)
        if self.light_rays < 0 or self.light_rays % self.replicates:
            raise ParameterError(
                f"light_rays is {self.light_rays} with {self.replicates} replicates; give 0 or a positive multiple of "
                "the replicates"
            )

    def _balanced_light_rays(self) -> int:
        """The default: a power of two for each replicate."""
        each = max(LEAST_LIGHT_RAYS, self.rays // 4) / self.replicates
        return self.replicates * (1 << math.ceil(math.log2(max(each, 2))))

    @property
    def binomial_rays(self) -> int | None:
        """Number of independent rays, where hits are binomial; None where they are not independent."""
        return self.rays if self.sampling == "random" and not self.light_rays else None

    def rows(self, patches: Patches, tracer: Tracer, replicate: int = 0) -> RowMaker:
        """What makes the rows of one replicate."""
        return MonteCarloRows(self, patches, tracer, replicate)


class MonteCarloRows:
    """Trace the rays of some patches, count their hits, and put in the exact columns of emitters."""

    def __init__(self, method: MonteCarlo, patches: Patches, tracer: Tracer, replicate: int) -> None:
        self.patches, self.tracer = patches, tracer
        self.rays = method.rays // method.replicates
        self.rows_at_once = max(1, BATCH // self.rays)
        self.run = seed_key(method.seed, replicate)
        light_rays = method.light_rays // method.replicates
        emitters = worthwhile_emitters(patches, self.rays, light_rays)
        self.most = self.rays
        self.divisor = float(self.rays)
        self.direct: DirectLight | None = None
        self.exact_columns: NDArray[np.bool_] | None = None
        if emitters is not None:
            DIRECT_LIGHT.begin()
            run = seed_key(method.seed, replicate, DIRECT)
            self.direct = DirectLight(patches, tracer, emitters, light_rays, run, method.sampling)
            self.exact_columns = emitters.columns
            self.most += min(int(emitters.columns.sum()), len(emitters) * light_rays)
            self.divisor = 1.0
        if method.sampling == "sobol":
            self.points = np.ascontiguousarray(sobol_points(self.rays, 4, int(self.run)).T)
        else:
            self.points = np.empty((4, 0), dtype=np.uint32)

    def __call__(self, span: tuple[int, int]) -> RowBlock:
        """The rows begin … end."""
        return self.of(np.arange(*span))._replace(begin=span[0])

    def of(self, patch: NDArray[np.int64]) -> RowBlock:
        """The rows of some patches, numbered from 0: each the same whatever others are made with it."""
        grid = self.patches.grid
        places = Places(self.tracer.table, self.patches.face, self.patches.side, grid.front, grid.back)
        origins, directions = cosine_rays(places, patch, self.rays, self.points, self.run)
        rows = RowBlock(0, *count_hits(self.tracer.run(origins, directions), len(patch), len(self.patches)))
        if self.direct is None:
            return rows
        DIRECT_LIGHT.ready()
        return self.direct.put_into(rows, patch, self.rays)


class Places(NamedTuple):
    """Where patches are, for the kernels: their face and side (N,), and the first patch of each face's sides (F,)."""

    table: FaceTable
    face: NDArray[np.int32]
    side: NDArray[np.int8]
    front: NDArray[np.int32]
    back: NDArray[np.int32]


def cosine_rays(
    places: Places, patch: NDArray[np.int64], rays: int, points: NDArray[np.uint32], run: np.uint64
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Origins and directions (len(patch) × rays, 3) of rays from some patches, in unit coordinates.

    With `points` (4, rays) uint32, each patch shifts them by a key of (run, patch); without, numbers are hashed
    from (run, patch, ray). One kernel a step, not one for all: the compiler then sees loops that it can run eight at
    once.
    """
    origins = np.empty((len(patch) * rays, 3), dtype=np.float32)
    directions = np.empty_like(origins)
    samples = np.empty((4, len(origins)))
    ray_samples(patch, rays, points, run, samples)
    ray_origins(places, patch, samples, origins)
    ray_directions(places, patch, samples, directions)
    return origins, directions


def ray_samples(
    patch: NDArray[np.int64], rays: int, points: NDArray[np.uint32], run: np.uint64, out: NDArray[np.float64]
) -> None:
    """Write to out (4, len(patch) × rays) the numbers in [0, 1) of each ray, see `cosine_rays`."""
    numbers(keys(run, patch), points, True, rays, out)


def ray_origins(
    places: Places, patch: NDArray[np.int64], samples: NDArray[np.float64], out: NDArray[np.float32]
) -> None:
    """Write to out (len(patch) × rays, 3) points on some patches, lifted, at samples[0], samples[1] in [0, 1)."""
    face, up = places.face[patch].astype(np.int64), places.side[patch].astype(np.float64)
    cell = patch - np.where(up > 0.0, places.front[face], places.back[face])
    starts(places.table, face, cell, up, samples[0], samples[1], out)


def ray_directions(
    places: Places, patch: NDArray[np.int64], samples: NDArray[np.float64], out: NDArray[np.float32]
) -> None:
    """Write to out (len(patch) × rays, 3) cosine-distributed directions, at samples[2], samples[3] in [0, 1)."""
    face, up = places.face[patch].astype(np.int64), places.side[patch].astype(np.float64)
    _directions(places.table.tangent, places.table.normal, face, up, samples[2], samples[3], out)


@kernel
def _directions(tangent, normal, face, side, s, t, out):  # type: ignore[no-untyped-def]
    """Fill out (patches × rays, 3) with `cosine_directions` of many patches."""
    rays = s.shape[0] // max(face.shape[0], 1)
    for p in range(face.shape[0]):
        here = slice(p * rays, (p + 1) * rays)
        cosine_directions(tangent[face[p]], normal[face[p]], side[p], s[here], t[here], out[here])


@kernel
def cosine_directions(tangent, normal, up, s, t, out):  # type: ignore[no-untyped-def]
    """Write to out (n, 3) directions about up × normal, cosine-distributed for uniform s and t, Eq. (14).

    sin and cos of the angle 2π t are polynomials in the distance to the nearest quarter turn, at most π/4: right to
    3e-8, which is float32's rounding, and free of calls and branches. Two short loops fit the compiler's eyes.
    """
    x, y = np.empty((2, s.shape[0]))
    for r in range(s.shape[0]):
        quarter = np.floor(4.0 * t[r] + 0.5)  # 0 … 4
        angle = 0.5 * np.pi * (4.0 * t[r] - quarter)
        q = angle * angle
        sine = angle * (1.0 - q * (1.0 / 6.0 - q * (1.0 / 120.0 - q * (1.0 / 5040.0 - q * (1.0 / 362880.0)))))
        cosine = 1.0 - q * (0.5 - q * (1.0 / 24.0 - q * (1.0 / 720.0 - q * (1.0 / 40320.0))))
        odd = abs(quarter - 2.0) == 1.0
        along, across = sine if odd else cosine, cosine if odd else sine
        x[r] = -along if abs(quarter - 1.5) < 1.0 else along
        y[r] = -across if abs(quarter - 2.5) < 1.0 else across
    n0, n1, n2 = up * normal[0], up * normal[1], up * normal[2]
    t0, t1, t2 = tangent[0], tangent[1], tangent[2]
    b0, b1, b2 = n1 * t2 - n2 * t1, n2 * t0 - n0 * t2, n0 * t1 - n1 * t0
    for r in range(s.shape[0]):
        radius, z = np.sqrt(s[r]), np.sqrt(1.0 - s[r])
        along, across = radius * x[r], radius * y[r]
        out[r, 0] = along * t0 + across * b0 + z * n0
        out[r, 1] = along * t1 + across * b1 + z * n1
        out[r, 2] = along * t2 + across * b2 + z * n2
