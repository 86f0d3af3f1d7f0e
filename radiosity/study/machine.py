"""What figures of time were taken on: processor, memory, system, versions."""

from __future__ import annotations

import os
import platform
from importlib import metadata
from pathlib import Path

from .._version import __version__
from ..parallel import thread_count

LIBRARIES = ("numpy", "scipy", "numba", "embreex")


def machine() -> dict[str, str]:
    """The machine and the versions, as words.

    >>> sorted(machine())[:3]
    ['embreex', 'memory', 'numba']
    """
    known = {
        "processor": f"{_processor()}, {thread_count()} of {os.cpu_count()} threads",
        "memory": _memory(),
        "system": f"{platform.system()} {platform.release()}",
        "python": platform.python_version(),
        "radiosity": __version__,
    }
    return known | {name: metadata.version(name) for name in LIBRARIES}


def _processor() -> str:
    """Its name, where the system tells it."""
    info = Path("/proc/cpuinfo")
    if info.is_file():
        for line in info.read_text(encoding="utf-8", errors="replace").splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    return platform.processor() or platform.machine()


def _memory() -> str:
    if not hasattr(os, "sysconf"):
        return "unknown"
    return f"{os.sysconf('SC_PAGE_SIZE') * os.sysconf('SC_PHYS_PAGES') / 1e9:.1f} GB"
