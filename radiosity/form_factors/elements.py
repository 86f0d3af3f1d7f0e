"""What sends light and where it is received, between groups of patches and patches by themselves."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from .groups import Groups

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]


class Senders(NamedTuple):
    """Smooth groups (numbers), then single patches; of_patch (N,) says which of them each patch is, or belongs to."""

    group: IntArray
    patch: IntArray
    of_patch: NDArray[np.int32]

    def __len__(self) -> int:
        return len(self.group) + len(self.patch)

    def means(self, area: FloatArray, dtype: type[np.floating]) -> csr_array:
        """Area-weighted means over the patches of each sender, (S, N)."""
        count = len(self)
        total = np.bincount(self.of_patch, area, count)
        order = np.argsort(self.of_patch, kind="stable")
        weight = (area / total[self.of_patch])[order].astype(dtype)
        ends = np.concatenate([[0], np.cumsum(np.bincount(self.of_patch, minlength=count))])
        arrays = weight, order.astype(np.int32), ends.astype(np.int32)
        return csr_array(arrays, shape=(count, len(area)), copy=False)


def senders_of(groups: Groups, smooth: BoolArray) -> Senders:
    """Senders: groups of which these are smooth, and the patches of the others."""
    group = np.flatnonzero(smooth)
    number = np.full(len(groups), -1, dtype=np.int32)
    number[group] = np.arange(len(group))
    of_patch = number[groups.of_patch]
    patch = np.flatnonzero(of_patch < 0)
    of_patch[patch] = np.arange(len(group), len(group) + len(patch))
    return Senders(group, patch, of_patch)


class Receivers(NamedTuple):
    """Corners of smooth groups, those of most rays first, then single patches.

    point (G,) are lattice points in rising order of which `order` says the receiver; group and corner (G,) are a group
    at whose corner each receiver is; patch as in `Senders`; rays (R,).
    """

    point: IntArray
    order: IntArray
    group: IntArray
    corner: IntArray
    patch: IntArray
    rays: IntArray

    def __len__(self) -> int:
        return len(self.rays)

    @classmethod
    def of(cls, groups: Groups, senders: Senders, least: int, most: int) -> Receivers:
        """Those of the same groups and patches, with the least rays for a patch, the most for a group."""
        corners = groups.corners[senders.group]
        point, first = np.unique(corners, return_index=True)
        group, corner = senders.group[first // 4], first % 4
        worth = least * 2 ** np.ceil(np.log2(np.maximum(groups.patches[group], 1))).astype(np.int64)
        rays = np.minimum(most, worth)
        most_first = np.argsort(-rays, kind="stable")
        order = np.empty(len(point), dtype=np.int64)
        order[most_first] = np.arange(len(point))
        alone = np.full(len(senders.patch), least)
        rays = np.concatenate([rays[most_first], alone])
        return cls(point, order, group[most_first], corner[most_first], senders.patch, rays)

    def entries(self, senders: int) -> int:
        """Entries of their rows over so many senders, at most."""
        return int(np.minimum(self.rays, senders).sum())

    def at(self, point: IntArray) -> IntArray:
        """Receivers at lattice points."""
        return self.order[np.searchsorted(self.point, point)]
