"""Memory of a piece of work: the peak of what is resident, above what was there before.

Allocators are asked for more than is touched (rows of form factors are reserved for the worst case), so that what
they count is not what the work needs. Linux counts the pages that are really there and keeps their peak, which can be
set back: that is measured here, after memory that was freed has been given back.
What libraries keep for the next time (some ten megabytes of rays, say) shows in the first run alone that needs it.
"""

from __future__ import annotations

import ctypes
import re
from contextlib import suppress
from functools import cache
from pathlib import Path
from types import TracebackType
from typing import Any

from ..form_factors.cost import predict
from ..patches import Patches

STATUS, CLEAR = Path("/proc/self/status"), Path("/proc/self/clear_refs")
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


@cache
def predicted_bytes(patches: Patches, method: Any) -> int | None:
    """Bytes of the form factors (or a path tracer's tally), foreseen before the work; None where nobody foresees."""
    if hasattr(method, "paths"):
        return int(WALK * len(patches) * patches.channels * (method.bounces + 2))
    return predict(patches, method).bytes if hasattr(method, "rows") else None


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
