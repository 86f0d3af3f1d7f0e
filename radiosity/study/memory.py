"""Memory of a piece of work: the peak of what is resident, above what was there before.

Allocators are asked for more than is touched (rows of form factors are reserved for the worst case), so that what
they count is not what the work needs. Linux counts the pages that are really there and keeps their peak, which can be
set back: that is measured here, after memory that was freed has been given back.
"""

from __future__ import annotations

import ctypes
import re
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import Any

from ..form_factors import Analytic
from ..patches import Patches

STATUS, CLEAR = Path("/proc/self/status"), Path("/proc/self/clear_refs")
ENTRY = 8  # bytes of a form factor: float32 and its column
WALK = 8 * 5  # bytes of a patch, channel and order in a path tracer's tally: sums and squares, and the results


class PeakMemory:
    """Measure the work inside a ``with``; `bytes` is then its peak, or None where the system does not tell.

    >>> with PeakMemory() as memory:
    ...     _ = bytearray(50_000_000)
    >>> memory.bytes is None or 45e6 < memory.bytes < 80e6
    True
    """

    bytes: int | None = None

    def __enter__(self) -> PeakMemory:
        _give_back()
        self._before = _resident("VmRSS") if _set_back() else None
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        peak = _resident("VmHWM")
        if self._before is not None and peak is not None:
            self.bytes = max(peak - self._before, 0)


def predicted_bytes(patches: Patches, method: Any) -> int:
    """Bytes of the form factors (or of a path tracer's tally) as foreseen before the work: the most there can be."""
    count = len(patches)
    if hasattr(method, "paths"):
        return WALK * count * patches.channels * (method.bounces + 2)
    if isinstance(method, Analytic):
        return (8 + ENTRY) * count**2  # exchange areas are dense
    lit = int((patches.emission > 0).any(axis=1).sum()) if getattr(method, "light_rays", 0) else 0
    return ENTRY * count * min(count, method.rays + lit)


def _give_back() -> None:
    """Give freed memory back to the system, where its C library can."""
    with suppress(OSError, AttributeError):
        ctypes.CDLL(None).malloc_trim(0)


def _set_back() -> bool:
    """Set the peak back to what is resident now."""
    with suppress(OSError):
        CLEAR.write_text("5")
        return True
    return False


def _resident(what: str) -> int | None:
    with suppress(OSError):
        found = re.search(rf"^{what}:\s+(\d+) kB", STATUS.read_text(), re.MULTILINE)
        return int(found[1]) * 1024 if found else None
    return None
