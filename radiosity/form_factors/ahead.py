"""Kernels compiled ahead, in a second process, on the first run on a machine.

numba compiles one kernel at a time. So a second process compiles the kernels of direct light, and leaves them in
numba's cache on disk, while this one is busy with those of rays. Whatever goes wrong there, nothing is lost but the
head start: numba writes its cache whole or not at all, and this process compiles what it does not find.
"""

from __future__ import annotations

import multiprocessing
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np

from ..parallel import thread_count
from ..patches import Patches, subdivide
from ..rays import Tracer
from ..scenes import cornell_box
from ..sequences import seed_key
from .assembly import RowBlock
from .direct_light import DirectLight, IntArray, _Seen, worthwhile_emitters
from .exchange_kernels import apart_rows

SECONDS = 120.0  # to wait for at most; compiling takes a tenth
PATCHES, ROWS = 4000, 16  # of the scene that kernels are tried on
PROGRAM = """
import sys
sys.path.insert(0, sys.argv[1])
from radiosity.form_factors.ahead import compile_direct_light
compile_direct_light()
"""

_running: list[subprocess.Popen[bytes]] = []
_begun = False


def begin() -> None:
    """Start the second process, once, if kernels are not there yet, and if it has a processor to run on."""
    global _begun
    if _begun:
        return
    _begun = True
    if thread_count() < 2 or multiprocessing.parent_process() is not None or not sys.executable or _found():
        return
    package = Path(__file__).resolve().parents[2]
    silent: dict[str, Any] = dict.fromkeys(("stdin", "stdout", "stderr"), subprocess.DEVNULL)
    try:
        _running.append(subprocess.Popen([sys.executable, "-c", PROGRAM, str(package)], **silent))
    except OSError:
        return


def ready() -> None:
    """Wait for the second process, if there is one."""
    for process in _running[:]:
        try:
            process.wait(SECONDS)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
    _running.clear()


def _found() -> bool:
    """Whether kernels are compiled, or kept on disk; also where numba does not tell."""
    index: Any = getattr(getattr(apart_rows, "_cache", None), "_cache_file", None)
    if getattr(apart_rows, "signatures", True) or not hasattr(index, "_load_index"):
        return True
    try:
        return bool(index._load_index())
    except OSError:
        return False


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
    direct.put_into(block, 64)
