"""Channels that agree: where all paint is grey in them, one stands for the others but for a factor."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..patches import Patches
from ..result import Result

FloatArray = NDArray[np.float64]

ALIKE = 4 * float(np.finfo(np.float64).eps)  # relative: lamps of one colour that was computed


@dataclass(frozen=True, eq=False)
class Channels:
    """Which channels are solved, and how the light of all follows from them.

    Attributes
    ----------
    solved : ndarray of int (S,)
        Channels that stand for all.
    source : ndarray of int (C,)
        Which of those stands for each channel.
    scale : ndarray (C,)
        By how much its light is multiplied: 1 where the two are the same, so that all bits are.
    """

    solved: NDArray[np.int64]
    source: NDArray[np.int64]
    scale: FloatArray

    @property
    def spared(self) -> int:
        """How many channels need no solving."""
        return len(self.source) - len(self.solved)

    def of(self, patches: Patches) -> Patches:
        """Patches with the channels that are solved."""
        if not self.spared:
            return patches
        fields = {name: getattr(patches, name)[:, self.solved] for name in ("reflectance", "absorptance", "emission")}
        return replace(patches, sky=patches.sky[self.solved], **fields)

    def spread(self, result: Result) -> Result:
        """The result in all channels."""
        if not self.spared:
            return result
        orders = None if result.orders is None else self.spread_light(result.orders)
        return replace(
            result,
            radiosity=self.spread_light(result.radiosity),
            orders=orders,
            history=self.spread_light(result.history),
        )

    def spread_light(self, light: FloatArray) -> FloatArray:
        """Light (…, S) of the channels that are solved, in all channels (…, C)."""
        if not self.spared:
            return light
        return np.ascontiguousarray(light[..., self.source] * self.scale)


def all_channels(count: int) -> Channels:
    """Every channel for itself."""
    return Channels(np.arange(count), np.arange(count), np.ones(count))


def find_alike(patches: Patches) -> Channels:
    """Channels of equal reflectance whose emission and sky are multiples of each other; the brightest stands for them.

    A channel without any light follows from any other, being zero.
    """
    count = patches.channels
    light = np.vstack([patches.emission, patches.sky])
    solved: list[int] = []
    source, scale = np.zeros(count, dtype=np.int64), np.zeros(count)
    for c in np.argsort(-light.max(axis=0), kind="stable"):
        for place, other in enumerate(solved):
            factor = _multiple(patches, light, int(c), other)
            if factor is not None:
                source[c], scale[c] = place, factor
                break
        else:
            source[c], scale[c] = len(solved), 1.0
            solved.append(int(c))
    if len(solved) == count:  # in their own order, as nothing is put together
        return all_channels(count)
    return Channels(np.array(solved), source, scale)


def _multiple(patches: Patches, light: FloatArray, channel: int, other: int) -> float | None:
    """Light of a channel over that of another, if it is that everywhere."""
    if not light[:, channel].any():
        return 0.0
    for share in (patches.reflectance, patches.absorptance):
        if not np.array_equal(share[:, channel], share[:, other]):
            return None
    brightest = int(np.argmax(light[:, other]))
    factor = float(light[brightest, channel] / light[brightest, other])
    alike = np.abs(light[:, channel] - factor * light[:, other]) <= ALIKE * light[:, channel]
    return factor if alike.all() else None
