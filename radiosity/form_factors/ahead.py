"""The kernels of direct light, compiled ahead while this process is busy with those of rays."""

from __future__ import annotations

import numpy as np

from ..ahead import Ahead
from ..patches import Patches, subdivide
from ..rays import Tracer
from ..scenes import cornell_box
from ..sequences import seed_key
from .assembly import RowBlock
from .direct_light import DirectLight, IntArray, _Seen, worthwhile_emitters
from .exchange_kernels import apart_rows

PATCHES, ROWS = 4000, 16  # of the scene that kernels are tried on


class _Unseen(DirectLight):
    """Direct light without rays: their kernels are the other process's work."""

    def _look(self, pairs: IntArray, count: int, corners: bool = False) -> _Seen:  # noqa: ARG002
        return _Seen(np.full((len(pairs), count), -1, dtype=np.int32), np.zeros((len(pairs), count)))


def compile_direct_light() -> None:
    """Call the kernels of direct light once, with arguments as they always have.

    A few patches, as small as patches usually are: no polygons are so near that other kernels would be called.
    """
    patches: Patches = subdivide(cornell_box(), patch_count=PATCHES)
    emitters = worthwhile_emitters(patches, 64, 64)
    assert emitters is not None
    direct = _Unseen(patches, Tracer(patches.grid), emitters, 64, seed_key(0), "sobol")
    none = np.empty(0, dtype=np.int32)
    block = RowBlock(0, np.zeros(ROWS, np.int64), none, none, np.full(ROWS, 64), np.zeros(ROWS, np.int64))
    direct.put_into(block, np.arange(ROWS), 64)


DIRECT_LIGHT = Ahead(__name__, compile_direct_light.__name__, apart_rows)
