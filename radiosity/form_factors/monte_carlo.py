"""Form factors by Monte Carlo: cosine-distributed rays from points spread over each patch."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numba
import numpy as np
from numpy.typing import NDArray

from ..errors import ParameterError
from ..parallel import blocks, ordered_map
from ..patches import Patches
from ..progress import Progress, quiet
from ..rays import Tracer, patch_point
from ..sequences import BITS_TO_UNIT, high_bits, key, seed_key, sobol_points
from .assembly import RowBlock, Rows, count_hits, stack_rows

BATCH = 1 << 16  # rays at a time: their arrays stay in cache, and calls into Embree are few


@dataclass(frozen=True)
class MonteCarlo:
    """Form factors by counting where rays land.

    A ray leaves a point of patch i, uniform in area, in a direction distributed as cos θ / π about the normal. The share
    of rays that first meet patch j estimates F_ij without bias, and every row adds up to 1 exactly:
    each ray ends somewhere.

    Parameters
    ----------
    rays : int
        Rays per patch, over all replicates. A power of two times `replicates` serves Sobol points best.
    seed : int
    sampling : {"sobol", "random"}
        One scrambled four-dimensional Sobol sequence for position and direction, shifted for each patch; or
        independent random numbers, whose error falls as 1/√rays, for teaching.
    replicates : int
        Independent estimates among which the rays are shared; their spread gives standard errors.

    Notes
    -----
    Malley's method: a uniform point of the disk, projected up to the hemisphere, is cosine-distributed (Cohen &
    Wallace 1993, §4.4; Pharr, Jakob & Humphreys 2023, §A.5.3).
    """

    rays: int = 256
    seed: int = 0
    sampling: Literal["sobol", "random"] = "sobol"
    replicates: int = 1

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

    @property
    def binomial_rays(self) -> int | None:
        """Number of independent rays, where hits are binomial; None where they are not independent."""
        return self.rays if self.sampling == "random" else None

    def estimate(
        self,
        patches: Patches,
        tracer: Tracer,
        dtype: type[np.float32] | type[np.float64],
        threads: int | None = None,
        progress: Progress = quiet,
    ) -> list[Rows]:
        """One matrix for each replicate."""
        each = self.rays // self.replicates
        runs = []
        for replicate in range(self.replicates):

            def told(rows: int, before: int = replicate * len(patches)) -> None:
                progress("form factors", before + rows, self.replicates * len(patches))

            runs.append(
                stack_rows(
                    ordered_map(
                        _BlockOfRows(self, patches, tracer, replicate),
                        blocks(len(patches), max(1, BATCH // each)),
                        threads,
                    ),
                    len(patches),
                    len(patches) * min(each, len(patches)),
                    each,
                    dtype,
                    told,
                )
            )
        return runs


class _BlockOfRows:
    """Trace the rays of patches begin … end and count their hits."""

    def __init__(self, method: MonteCarlo, patches: Patches, tracer: Tracer, replicate: int) -> None:
        self.patches, self.tracer = patches, tracer
        self.rays = method.rays // method.replicates
        self.run = seed_key(method.seed, replicate)
        if method.sampling == "sobol":
            self.points = sobol_points(self.rays, 4, int(self.run))
        else:
            self.points = np.empty((0, 4), dtype=np.uint32)

    def __call__(self, block: tuple[int, int]) -> RowBlock:
        begin, end = block
        origins = np.empty(((end - begin) * self.rays, 3), dtype=np.float32)
        directions = np.empty_like(origins)
        grid = self.patches.grid
        cosine_rays(
            self.tracer.table,
            self.patches.face,
            self.patches.side,
            grid.front,
            grid.back,
            begin,
            end,
            self.rays,
            self.points,
            self.run,
            origins,
            directions,
        )
        return RowBlock(begin, *count_hits(self.tracer.run(origins, directions), end - begin, len(self.patches)))


@numba.njit(nogil=True, cache=True)
def cosine_rays(table, face, side, front, back, begin, end, rays, points, run, origins, directions):  # type: ignore[no-untyped-def]
    """Fill origins and directions ((end - begin) × rays, 3) of the patches begin … end.

    With `points` (rays, 4) uint32, each patch shifts them by a key of (run, patch); without, numbers are hashed
    from (run, patch, ray).
    """
    shifted = points.shape[0] > 0
    sample = np.empty(4)
    point = np.empty(3)
    shift = np.empty(4, dtype=np.uint32)
    for i in range(begin, end):
        f = face[i]
        up = np.float64(side[i])
        cell = i - (front[f] if up > 0 else back[f])
        n0, n1, n2 = up * table.normal[f, 0], up * table.normal[f, 1], up * table.normal[f, 2]
        t0, t1, t2 = table.tangent[f, 0], table.tangent[f, 1], table.tangent[f, 2]
        b0, b1, b2 = n1 * t2 - n2 * t1, n2 * t0 - n0 * t2, n0 * t1 - n1 * t0
        patch = key(np.uint64(run), np.uint64(i))
        for d in range(4):
            shift[d] = high_bits(key(patch, d))
        for r in range(rays):
            q = (i - begin) * rays + r
            if shifted:
                for d in range(4):
                    sample[d] = (points[r, d] ^ shift[d]) * BITS_TO_UNIT
            else:
                ray = key(patch, r + 4)
                for d in range(4):
                    sample[d] = high_bits(key(ray, d)) * BITS_TO_UNIT
            patch_point(table, f, cell, up, sample[0], sample[1], point)
            radius, angle = np.sqrt(sample[2]), 2.0 * np.pi * sample[3]
            x, y, z = radius * np.cos(angle), radius * np.sin(angle), np.sqrt(1.0 - sample[2])
            origins[q, 0], origins[q, 1], origins[q, 2] = point[0], point[1], point[2]
            directions[q, 0] = x * t0 + y * b0 + z * n0
            directions[q, 1] = x * t1 + y * b1 + z * n1
            directions[q, 2] = x * t2 + y * b2 + z * n2
