"""One thing that somebody should know about a scene."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]

MOST_PLACES = 200
NAMES_SHOWN = 4


class Severity(IntEnum):
    """How much a finding matters."""

    NOTE = 0
    """Harmless; good to know."""
    WARNING = 1
    """The light may be wrong there."""
    ERROR = 2
    """A solve refuses the scene, or cannot be right."""


@dataclass(frozen=True, eq=False)
class Finding:
    """Something about a scene, where it is, and what to do about it.

    Attributes
    ----------
    kind : str
        What it is, in one or two words: "zero-area faces", "open edges".
    severity : Severity
    surfaces : tuple of str
        Names of the surfaces that it is about.
    count : int
        How many faces, edges or vertices.
    message : str
        What was found, with the number.
    remedy : str
        What to do about it.
    places : ndarray (P, 3)
        Where, m; the worst first, and no more than 200.
    """

    kind: str
    severity: Severity
    surfaces: tuple[str, ...]
    count: int
    message: str
    remedy: str
    places: FloatArray

    @property
    def place(self) -> FloatArray | None:
        """The worst place (3,), m; None for what is everywhere."""
        return self.places[0] if len(self.places) else None

    def __str__(self) -> str:
        at = "" if self.place is None else f" at ({', '.join(f'{x:.4g}' for x in self.place)})"
        return f"{self.severity.name.lower()}: {self.message}{at}; {self.remedy}"


def names(surfaces: Sequence[str]) -> str:
    """Names for a message.

    >>> names(["floor", "wall", "lamp", "door", "shelf"])
    "'floor', 'wall', 'lamp', 'door' and 1 more"
    """
    shown = [repr(name) for name in surfaces[:NAMES_SHOWN]]
    if (more := len(surfaces) - NAMES_SHOWN) > 0:
        return f"{', '.join(shown)} and {more} more"
    return " and ".join([", ".join(shown[:-1]), shown[-1]]) if len(shown) > 1 else "".join(shown)


def counted(number: int, one: str, many: str = "") -> str:
    """A number and what it counts.

    >>> counted(1, "face"), counted(12000, "face")
    ('1 face', '12,000 faces')
    """
    return f"{number:,} {one if number == 1 else many or one + 's'}"


def listed(found: Sequence[Finding]) -> str:
    """All findings, a line each.

    >>> listed([])
    'nothing to remark'
    """
    return "\n".join(map(str, found)) or "nothing to remark"
