"""What stands in for what a file does not say."""

from __future__ import annotations

import numpy as np

from ..scene import Material

GREY = 0.5
"""Reflectance of what has no material. glTF's own default, 1, would let light bounce for ever."""


def grey(name: str = "") -> Material:
    """The grey, RGB, that stands for a missing material."""
    return Material(np.full(3, GREY), name=name)
