"""What was cut, in words."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from .rules import Kind

SHOWN = 8


@dataclass(frozen=True)
class Contact:
    """Two surfaces that lie in each other.

    Attributes
    ----------
    kind : Kind
        The rule that applies.
    first, second : str
        The surface that carries, or is the larger; and the one that covers it.
    area : float
        m² that they share.
    cut, divided : tuple of str
        Which of them was cut there, and which was divided along the border.
    """

    kind: Kind
    first: str
    second: str
    area: float
    cut: tuple[str, ...]
    divided: tuple[str, ...]

    def __str__(self) -> str:
        a, b, area = repr(self.first), repr(self.second), f"{self.area:.3g} m²"
        cut, divided = " and ".join(map(repr, self.cut)), " and ".join(map(repr, self.divided))
        along = f", {divided} divided along it" if divided else ""
        if self.kind is Kind.TOUCH and a == b:
            return f"faces of {a} touch over {area}: cut out of it{along}"
        if self.kind is Kind.TOUCH:
            return f"{a} and {b} touch over {area}: cut out of {'both' if len(self.cut) == 2 else cut}{along}"
        if self.kind is Kind.FOOTPRINT:
            return f"{area} of {a} under {b}: {'cut away' if cut else 'divided along the border'}"
        if self.kind is Kind.FLUSH:
            return f"{b} lies in the plane of {a} over {area} and is taken to lie on top: cut out of {cut}"
        if self.kind is Kind.TURNED:
            return f"{a} has all its faces twice, once a side, {area}: made two-sided"
        if self.kind is Kind.DOUBLE and self.first == self.second:
            return f"faces of {a} lie in each other over {area}: the first counts"
        if self.kind is Kind.DOUBLE:
            return f"{a} and {b} face the same way in one place over {area}: {b} counts, cut out of {cut}"
        return f"{a} and {b}, back to back, over {area}" if a != b else f"faces of {a}, back to back, over {area}"


@dataclass(frozen=True)
class ContactReport:
    """What `remove_contacts` did.

    Attributes
    ----------
    contacts : tuple of Contact
        Largest first.
    removed : mapping of str to float
        m² that each surface lost.
    gone : tuple of str
        Surfaces of which nothing is left.
    """

    contacts: tuple[Contact, ...] = ()
    removed: Mapping[str, float] = field(default_factory=dict)
    gone: tuple[str, ...] = ()

    @property
    def mended(self) -> tuple[Contact, ...]:
        """Those where something was cut or divided."""
        return tuple(contact for contact in self.contacts if contact.kind is not Kind.UNCLEAR)

    @property
    def unclear(self) -> tuple[Contact, ...]:
        """Those that were left as they are: rays cannot tell their faces apart."""
        return tuple(contact for contact in self.contacts if contact.kind is Kind.UNCLEAR)

    def __str__(self) -> str:
        lines = listed(self.mended)
        if self.gone:
            lines += f"; nothing is left of {', '.join(map(repr, self.gone))}"
        return lines


def listed(contacts: tuple[Contact, ...]) -> str:
    """The largest of them, one sentence each."""
    more = f"; and {len(contacts) - SHOWN} more" if len(contacts) > SHOWN else ""
    return "; ".join(map(str, contacts[:SHOWN])) + more
