"""Wrong on purpose: what renderers leave out of the equation, and how it looks. For lectures, never for results.

Each shortcut is a small frozen object with a name, the equation with the missing term struck out, one sentence on
what goes wrong, and `radiosity(patches, factors)`: light (N, C) to lay beside the truth. They return bare arrays, and
the exchanges of `NoCosine` and `NoVisibility` are no `FormFactors`: nothing here can end up in a certified solution.

Light probes, shadow maps and screen-space reflections are kin to these: probes are an ambient that depends on the
place, shadow maps a coarse visibility of order 1 alone, screen-space reflections gather from what the camera sees.
"""

from .base import WRONG, Shortcut
from .exchange import NoCosine, NoVisibility, WrongExchange
from .lighting import Ambient, AmbientOcclusion, CutAt, DirectOnly

ALL: tuple[Shortcut, ...] = (
    DirectOnly(),
    Ambient(),
    AmbientOcclusion(),
    NoCosine(),
    NoVisibility(),
    CutAt(),
)
"""Every shortcut with its usual parameters, in the order of a lecture."""

__all__ = [
    "ALL",
    "WRONG",
    "Ambient",
    "AmbientOcclusion",
    "CutAt",
    "DirectOnly",
    "NoCosine",
    "NoVisibility",
    "Shortcut",
    "WrongExchange",
]
