"""How much memory there is, and the refusal of work that would need more.

A process that asks for too much is not told so: it is handed pages until the system stops it, or another one. So the
bytes of large work are reckoned before it begins.
"""

from __future__ import annotations

import os
from pathlib import Path

from .errors import MemoryLimitError, ParameterError

SHARE = 0.8  # of the free memory that work may take unless told otherwise: the rest is for what comes after it
MEMINFO = Path("/proc/meminfo")
CONTAINER = Path("/sys/fs/cgroup")  # of Linux's second version of control groups


def available_bytes() -> int | None:
    """Memory that this process could still take, in bytes; None where the system does not say.

    On Linux what is free or can be freed at once, within the limit of the container if there is one; elsewhere all that
    the machine has.
    """
    found = [amount for amount in (_free_on_linux(), _left_in_container()) if amount is not None]
    if found:
        return min(found)
    try:
        return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    except (AttributeError, ValueError, OSError):
        return None


def _free_on_linux() -> int | None:
    try:
        lines = MEMINFO.read_text(encoding="ascii").splitlines()
    except OSError:
        return None
    return next((1024 * int(line.split()[1]) for line in lines if line.startswith("MemAvailable:")), None)


def _left_in_container() -> int | None:
    """What the container's limit leaves; files that it only keeps in memory do not count."""
    try:
        most = int((CONTAINER / "memory.max").read_text(encoding="ascii"))  # or the word "max"
        taken = int((CONTAINER / "memory.current").read_text(encoding="ascii"))
        counters = dict(line.split() for line in (CONTAINER / "memory.stat").read_text(encoding="ascii").splitlines())
    except (OSError, ValueError):
        return None
    return max(0, most - taken + int(counters.get("inactive_file", 0)))


def limit_bytes(memory_limit: float | None = None) -> float:
    """What work may take, in bytes: as told, else `SHARE` of what is available, else without end.

    Raises
    ------
    ParameterError
        A limit that is not a positive number.
    """
    if memory_limit is not None:
        if not memory_limit > 0:
            raise ParameterError(f"memory_limit is {memory_limit!r} bytes; give a positive number, or None")
        return float(memory_limit)
    available = available_bytes()
    return float("inf") if available is None else SHARE * available


def refuse_above(limit: float, needed: float, what: str, ways_out: str, whose: str = "the memory limit is") -> None:
    """Refuse work that needs more than `limit` bytes.

    Parameters
    ----------
    limit, needed : float
        Bytes.
    what : str
        The work, as the beginning of a sentence: "form factors of …".
    ways_out : str
        What to do instead.
    whose : str
        Words before the limit.

    Raises
    ------
    MemoryLimitError
    """
    if needed <= limit:
        return
    raise MemoryLimitError(f"{what} would take {gigabytes(needed)}, and {whose} {gigabytes(limit)}: {ways_out}")


def gigabytes(amount: float) -> str:
    """Bytes in the unit that suits them.

    >>> gigabytes(1.5e9), gigabytes(250e6), gigabytes(20_000)
    ('1.5 GB', '250 MB', '20 kB')
    """
    for size, unit in ((1e12, "TB"), (1e9, "GB"), (1e6, "MB")):
        if amount >= size:
            return f"{amount / size:.3g} {unit}"
    return f"{amount / 1e3:.3g} kB"
