"""Direct light apart: form factors to what emits are worth more than rays that happen to find it.

Most of the error of a radiosity solution is that of its first order: a small lamp is met by few of a patch's rays. So
the columns of F that belong to emitters are computed another way,

    F_ij = exact factor, nothing being in between  ×  visibility,        visibility = Σ k_s V_s / Σ k_s,    Eq. (16)

over shadow rays s between points spread over the patch and over the emitter, each weighted by the kernel
k = cos θ cos θ' / r² of the light that would go along it, V_s = 1 where nothing is in the way. Where the first
few agree, and the rays from corner to corner with them, the patch is in full light or in full shadow, and the factor is
exact; many are sent where they do not. The rest of the row stays as it was sampled, scaled to close it. Nothing of
this depends on how strong the emitters are: F stays purely geometric, and right for any other light.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..compiled import kernel
from ..face_points import FaceTable, whole_faces
from ..patches import Patches
from ..rays import Tracer
from ..sequences import keys, sobol_points
from .assembly import RowBlock
from .contour import exchange_area_matrix
from .starts import numbers, starts

FloatArray = NDArray[np.float64]
Float32Array = NDArray[np.float32]
IntArray = NDArray[np.int64]
Entries = tuple[IntArray, NDArray[np.int32], FloatArray]

FIRST = 16  # shadow rays sent first, to see whether they agree, or one in so many if that is more
CORNER_RAYS = 16  # sent first, too: a shadow's edge between two quads parts their corners, …
CORNER = 1 << 20  # … each so much of 2³² inside: at the rim of an emitter a ray may meet the face next to it
COSTLY = 4.0  # first shadow rays over the larger of the budgets, above which emitters are too many to look at each
NEGLIGIBLE = 1e-14  # a form factor that is rounding
SMALL_EMITTER = 1e-3  # of the scene's diagonal: an emitter's edge below which rays are aimed off its rim …
AIM = 4e-7  # … by so much, the rounding of Embree's coordinates: they would pass by


@dataclass(frozen=True, eq=False)
class Emitters:
    """Faces that emit, one side each: all patches of a face emit alike, so that one polygon stands for them.

    Attributes
    ----------
    face, side : ndarray (M,)
        Source face, and 1 or -1 for its front or back.
    corners : ndarray (M, 4, 3)
        Counter-clockwise seen from the emitting side, m.
    of_patch : ndarray of int32 (N,)
        Which of these faces each patch is on, -1 if none.
    place : ndarray of int32 (N,)
        Number of each patch among those on these faces, -1 if it is on none.
    """

    face: NDArray[np.int32]
    side: NDArray[np.int8]
    corners: FloatArray
    of_patch: NDArray[np.int32]
    place: NDArray[np.int32]

    def __len__(self) -> int:
        """Number of emitting faces M."""
        return len(self.face)

    @property
    def columns(self) -> NDArray[np.bool_]:
        """Patches on these faces, (N,)."""
        return self.of_patch >= 0


def first_rays(light_rays: int) -> int:
    """How many shadow rays are sent first, of `light_rays`."""
    return max(min(light_rays, FIRST), light_rays // FIRST)


def worthwhile_emitters(patches: Patches, rays: int, light_rays: int) -> Emitters | None:
    """The emitters whose columns are worth shadow rays, or None.

    None where nothing emits; where all of a closed scene does, so that rows would have nothing else to give way; and
    where emitters are so many that the first shadow rays alone would be more than `COSTLY` times either budget. They
    count together or not at all.

    Parameters
    ----------
    patches : Patches
    rays, light_rays : int
        Sampling rays per patch; shadow rays per pair of a patch and an emitting face.
    """
    lit = np.flatnonzero((patches.emission > 0).any(axis=1))
    if light_rays == 0 or not lit.size or (patches.closed and lit.size == len(patches)):
        return None
    (face, side), number = np.unique(np.stack([patches.face, patches.side])[:, lit], axis=1, return_inverse=True)
    if len(face) * (first_rays(light_rays) + CORNER_RAYS) > COSTLY * max(rays, light_rays):
        return None
    of_patch, place = np.full((2, len(patches)), -1, dtype=np.int32)
    of_patch[lit], place[lit] = number.ravel(), np.arange(lit.size)
    faces = patches.grid.faces
    forward = np.where(faces.quad[face, None], [0, 1, 2, 3], [0, 1, 2, 2])
    reverse = np.where(faces.quad[face, None], [0, 3, 2, 1], [0, 2, 1, 1])
    order = np.where(side[:, None] > 0, forward, reverse)
    corners = np.take_along_axis(faces.corners[face], order[:, :, None], axis=1)
    return Emitters(face.astype(np.int32), side.astype(np.int8), corners, of_patch, place)


class _Seen(NamedTuple):
    """Shadow rays of pairs (pairs, count): patch of the emitter met, -1 if something else was, and kernel."""

    met: NDArray[np.int32]
    kernel: FloatArray


class _Counted(NamedTuple):
    """Rows as sampled: lengths (rows,), indices and hits (Σ lengths,)."""

    lengths: IntArray
    indices: NDArray[np.int32]
    hits: NDArray[np.int32] | NDArray[np.floating[Any]]


class _Places(NamedTuple):
    """`Emitters.of_patch` and `Emitters.place` (N,), and the patches that emit, in order."""

    of_patch: NDArray[np.int32]
    place: NDArray[np.int32]
    emitting: NDArray[np.int32]


class _Row(NamedTuple):
    """Being made: what each emitting patch gets (M,), whether it is known, and whether any of 64 are: few of all."""

    share: FloatArray
    known: NDArray[np.bool_]
    run: NDArray[np.bool_]


class DirectLight:
    """Factors from patches to emitters.

    Parameters
    ----------
    patches : Patches
    tracer : Tracer
    emitters : Emitters
    light_rays : int
        Shadow rays between a patch and an emitting face, where the first few disagree.
    run : uint64
        Key of the random numbers.
    sampling : {"sobol", "random"}
    """

    def __init__(
        self, patches: Patches, tracer: Tracer, emitters: Emitters, light_rays: int, run: np.uint64, sampling: str
    ) -> None:
        self.patches, self.tracer, self.emitters, self.run = patches, tracer, emitters, run
        self.light_rays = light_rays
        self.columns = emitters.columns
        self.emitting = np.flatnonzero(self.columns).astype(np.int32)
        self.ground = _Ground(
            tracer.table,
            whole_faces(_aimed_at(tracer.table)),
            patches.face,
            patches.side,
            np.where(patches.side > 0, patches.grid.front[patches.face], patches.grid.back[patches.face]),
            emitters.face,
            emitters.side,
            emitters.of_patch,
        )
        self.points = np.empty((4, 0), dtype=np.uint32)
        if sampling == "sobol":
            self.points = np.ascontiguousarray(sobol_points(light_rays, 4, int(run)).T)

    def put_into(self, block: RowBlock, patch: IntArray, rays: int) -> RowBlock:
        """The rows of these patches with the columns of emitters put in, as shares instead of counts."""
        _, lengths, indices, counts, to_sky, to_backs, _ = block
        entries, traced = self._entries(patch, _Counted(lengths, indices, counts))
        merged = _merge(lengths, indices, counts, to_sky, to_backs, rays, self.columns, *entries)
        return RowBlock(block.begin, *merged)._replace(shadow_rays=traced)

    def entries(self, patch: IntArray) -> tuple[Entries, int]:
        """Emitters' columns of the rows of these patches by shadow rays alone, as `_entries`."""
        none = _Counted(np.zeros(len(patch), np.int64), np.empty(0, np.int32), np.empty(0, np.int32))
        return self._entries(patch, none)

    def _entries(self, patch: IntArray, counted: _Counted) -> tuple[Entries, int]:
        """Emitters' columns of the rows of these patches: lengths, indices, weights. And how many shadow rays."""
        faces = self.patches.faces[patch]
        corners = self.patches.vertices[np.where(faces < 0, faces[:, [0, 1, 2, 2]], faces)]
        exchange = exchange_area_matrix(corners, self.emitters.corners, threads=1)
        factors = exchange / self.patches.area[patch, None]
        row, emitter = (np.ascontiguousarray(index) for index in np.nonzero(factors > NEGLIGIBLE))
        pairs = np.stack([patch[row], emitter], axis=1)
        first = self._look(pairs, first_rays(self.light_rays))
        at_corners = self._look(pairs, CORNER_RAYS, corners=True)
        undecided = _disagree(np.hstack([first.met, at_corners.met]), np.hstack([first.kernel, at_corners.kernel]))
        more = self._look(pairs[undecided], self.light_rays)
        places = _Places(self.emitters.of_patch, self.emitters.place, self.emitting)
        entries = _collect(row, emitter, factors[row, emitter], undecided, first, more, counted, places)
        return entries, first.met.size + at_corners.met.size + more.met.size

    def _look(self, pairs: IntArray, count: int, corners: bool = False) -> _Seen:
        """Send `count` shadow rays for each pair, between points spread over both polygons or between their corners."""
        origins = np.empty((len(pairs) * count, 3), dtype=np.float32)
        directions = np.empty_like(origins)
        weight = np.empty((len(pairs), count))
        points = _corner_points() if corners else self.points
        _shadow_rays(self.ground, pairs, points, not corners, self.run, origins, directions, weight)
        met = self.tracer.run(origins, directions).reshape(weight.shape)
        _only_emitters(self.ground, pairs, met)
        return _Seen(met, weight)


def _aimed_at(table: FaceTable) -> FaceTable:
    """The table with small faces shrunk towards their middle, down to a point: a ray that is aimed there meets them."""
    lengths = np.linalg.norm([table.along, table.across], axis=2)
    kept = np.where(lengths < SMALL_EMITTER, np.maximum(0.0, 1.0 - 2.0 * AIM / lengths), 1.0)
    kept = np.where(table.quad, kept, kept.min(axis=0))[:, :, None]
    middle = np.where(table.quad, 0.5, 1.0 / 3.0)[:, None]
    moved = (1.0 - kept[0]) * middle * table.along + (1.0 - kept[1]) * middle * table.across
    return table._replace(origin=table.origin + moved, along=kept[0] * table.along, across=kept[1] * table.across)


def _corner_points() -> NDArray[np.uint32]:
    """Every corner of a patch with every corner of an emitter, as fractions of 32 bits (4, CORNER_RAYS)."""
    far = np.arange(CORNER_RAYS)[None, :] >> np.arange(4)[:, None] & 1
    return np.where(far, (1 << 32) - CORNER, CORNER).astype(np.uint32)


class _Ground(NamedTuple):
    """Patches and emitters; `whole` has every face as one patch, `of_patch` is that of `Emitters`."""

    table: FaceTable
    whole: FaceTable
    face: NDArray[np.int32]
    side: NDArray[np.int8]
    first: NDArray[np.int32]
    emitter_face: NDArray[np.int32]
    emitter_side: NDArray[np.int8]
    of_patch: NDArray[np.int32]


def _shadow_rays(ground, pairs, points, shifted, run, origins, directions, weight):  # type: ignore[no-untyped-def]
    """Fill rays from points of patches to points of emitters, and their kernels cos θ cos θ' / r² (0 behind either).

    One kernel a step, not one for all: the compiler then sees loops that it can run eight at once.
    """
    patch, emitter = pairs[:, 0], pairs[:, 1]
    face, side = ground.face[patch].astype(np.int64), ground.side[patch].astype(np.float64)
    other, other_side = ground.emitter_face[emitter].astype(np.int64), ground.emitter_side[emitter].astype(np.float64)
    samples = np.empty((4, len(origins)))
    numbers(keys(keys(run, patch), emitter), points, shifted, weight.shape[1], samples)
    starts(ground.table, face, patch - ground.first[patch], side, samples[0], samples[1], origins)
    # Points of emitters are not lifted: a ray to one ends on its face.
    cell = np.zeros(len(pairs), dtype=np.int64)
    starts(ground.whole, other, cell, np.zeros(len(pairs)), samples[2], samples[3], directions)
    normal = ground.table.normal
    _kernels(side[:, None] * normal[face], other_side[:, None] * normal[other], origins, directions, weight)


@kernel
def _kernels(normal, other_normal, origins, targets, weight):  # type: ignore[no-untyped-def]
    """Turn targets into directions, and weigh them; normals are those of the two sides of each pair."""
    count = weight.shape[1]
    for p in range(weight.shape[0]):
        n, m = normal[p], other_normal[p]
        for r in range(count):
            q = p * count + r
            x, y, z = targets[q, 0] - origins[q, 0], targets[q, 1] - origins[q, 1], targets[q, 2] - origins[q, 2]
            targets[q, 0], targets[q, 1], targets[q, 2] = x, y, z
            cosine = n[0] * x + n[1] * y + n[2] * z
            other = -(m[0] * x + m[1] * y + m[2] * z)
            r2 = np.float64(x) * x + np.float64(y) * y + np.float64(z) * z
            weight[p, r] = cosine * other / (r2 * r2) if cosine > 0.0 and other > 0.0 else 0.0


def _only_emitters(ground: _Ground, pairs: IntArray, met: NDArray[np.int32]) -> None:
    """Put -1 where a shadow ray met anything but the face that it was sent to."""
    met[(met >= 0) & (ground.of_patch[met] != pairs[:, 1:])] = -1


def _disagree(met: NDArray[np.int32], weight: FloatArray) -> NDArray[np.bool_]:
    """Pairs some of whose rays that count got through and some did not, or of which none counts (pairs,)."""
    counts, through = weight > 0.0, met >= 0
    return (counts & through).any(axis=1) == (counts & ~through).any(axis=1)


@kernel
def _collect(row, emitter, factor, undecided, first, more, counted, places):  # type: ignore[no-untyped-def]
    """Row lengths, columns in order, and weights: each pair's exact factor × visibility over the emitter's patches."""
    rows = counted.lengths.shape[0]
    most = first.met.size + more.met.size + counted.indices.shape[0]
    lengths, indices, weights = np.zeros(rows, np.int64), np.empty(most, np.int32), np.empty(most)
    emitting = len(places.emitting)
    made = _Row(np.zeros(emitting), np.zeros(emitting, np.bool_), np.zeros((emitting >> 6) + 1, np.bool_))
    filled = p = looked = end = 0
    for k in range(rows):
        start, begin, found = filled, end, False
        end += counted.lengths[k]
        while p < row.shape[0] and row[p] == k:
            met, weight = first.met[p], first.kernel[p]
            if undecided[p]:
                met, weight = more.met[looked], more.kernel[looked]
                looked += 1
            if _share_out(met, weight, factor[p], emitter[p], begin, end, counted, places, made):
                found = True
            p += 1
        if found:
            filled = _take(made, places.emitting, indices, weights, filled)
        lengths[k] = filled - start
    return lengths, indices[:filled].copy(), weights[:filled].copy()


@kernel(inline="always")
def _share_out(met, weight, factor, emitter, begin, end, counted, places, made):  # type: ignore[no-untyped-def]
    """Add one pair's factor × visibility to the emitter's patches, if any is seen.

    Which of them gets how much is what the shadow rays that got through and the sampling rays that met the emitter
    say together. Both are right on average; they count as n : C, where n = (Σ k)² / Σ k² is how many rays of equal
    kernels the shadow rays are worth (Kish 1965), and C sampling rays met it: many, if it is large.
    """
    of_patch, place = places.of_patch, places.place
    through, squares, C = 0.0, 0.0, 0
    for r in range(met.shape[0]):
        if met[r] >= 0:
            through += weight[r]
            squares += weight[r] ** 2
    for q in range(begin, end):
        if of_patch[counted.indices[q]] == emitter:
            C += counted.hits[q]
    seen = through > 0.0
    if seen:
        n = through * through / squares
        share = factor * through / weight.sum() / (n + C)
        for r in range(met.shape[0]):
            if met[r] >= 0 and weight[r] > 0.0:
                c = place[met[r]]
                made.share[c] += share * n * weight[r] / through
                made.known[c] = made.run[c >> 6] = True
        for q in range(begin, end):
            if of_patch[counted.indices[q]] == emitter:
                c = place[counted.indices[q]]
                made.share[c] += share * counted.hits[q]
                made.known[c] = made.run[c >> 6] = True
    return seen


@kernel(inline="always")
def _take(made, emitting, indices, weights, filled):  # type: ignore[no-untyped-def]
    """Write what is known of a row, in the order of the patches, and forget it; how much is written by then."""
    share, known, run = made
    for m in range(run.shape[0]):
        if run[m]:
            run[m] = False
            for c in range(64 * m, min(64 * m + 64, known.shape[0])):
                if known[c]:
                    indices[filled], weights[filled] = emitting[c], share[c]
                    share[c], known[c] = 0.0, False
                    filled += 1
    return filled


@kernel
def _merge(lengths, indices, counts, to_sky, to_backs, rays, exact, new_lengths, new_indices, new_weights):  # type: ignore[no-untyped-def]
    """Rows of counts with their exact columns replaced, and all else scaled so that each still adds up to 1.

    A row that has nothing else to scale, or no room for it, stays as it was sampled.
    """
    rows = lengths.shape[0]
    out_lengths = np.empty(rows, dtype=np.int64)
    out_indices = np.empty(indices.shape[0] + new_indices.shape[0], dtype=np.int32)
    out_weights = np.empty(out_indices.shape[0])
    sky, backs = np.empty(rows), np.empty(rows)
    p = q = filled = 0
    for k in range(rows):
        end, new_end = p + lengths[k], q + new_lengths[k]
        others, put_in = rays, 0.0
        for a in range(p, end):
            if exact[indices[a]]:
                others -= counts[a]
        for b in range(q, new_end):
            put_in += new_weights[b]
        replace = others > 0 and put_in < 1.0
        scale = (1.0 - put_in) / others if replace else 1.0 / rays
        begin = filled
        while p < end or (replace and q < new_end):
            if replace and q < new_end and (p == end or new_indices[q] <= indices[p]):
                out_indices[filled], out_weights[filled] = new_indices[q], new_weights[q]
                filled += 1
                q += 1
            else:
                if not (replace and exact[indices[p]]):
                    out_indices[filled], out_weights[filled] = indices[p], counts[p] * scale
                    filled += 1
                p += 1
        q = new_end
        out_lengths[k] = filled - begin
        sky[k], backs[k] = to_sky[k] * scale, to_backs[k] * scale
    return out_lengths, out_indices[:filled].copy(), out_weights[:filled].copy(), sky, backs
