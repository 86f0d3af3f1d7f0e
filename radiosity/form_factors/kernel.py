"""How the kernels of this folder are compiled, and when what was compiled before is out of date."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

from numba import njit

MODULES = (
    "edge_integrals",
    "exchange_kernels",
    "frames",
    "gauss",
    "kernel",
    "near_kernels",
    "point_to_polygon",
    "polygon_kernels",
)  # whose kernels call each other, or hold each other's constants


def _sources() -> str:
    """A hash of all sources that a compiled kernel is made of; empty where they are not files."""
    try:
        text = b"".join(Path(__file__).with_name(f"{name}.py").read_bytes() for name in MODULES)
    except OSError:
        return ""
    return hashlib.sha256(text).hexdigest()


SOURCES = _sources()


def kernel(function: Callable[..., Any]) -> Any:
    """Compile a function when it is first called, and keep the result on disk.

    Without the interpreter's lock, so that threads run kernels side by side. Division by zero gives infinity, as in
    numpy, instead of a check at each division.

    numba asks only whether the file of a function itself has changed, and would go on using what was compiled with
    older versions of the functions it calls in other files. So the stamp by which it asks is given all sources.
    """
    compiled = njit(cache=True, nogil=True, error_model="numpy")(function)
    index: Any = getattr(getattr(compiled, "_cache", None), "_cache_file", None)
    if hasattr(index, "_source_stamp"):  # another numba may keep it elsewhere, and then asks as it always did
        index._source_stamp = (index._source_stamp, SOURCES)
    return compiled


@kernel
def angle(sine: float, cosine: float) -> float:
    """Angle in [0, π] of a sine > 0 and a cosine that share a factor; a third of the time of atan2."""
    turn = math.pi if cosine < 0.0 else 0.0
    return turn + math.atan(sine / cosine)
