"""What stands above a pane: the term of the series, what it is in words, its exposure; and the units of numbers."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from .. import display

if TYPE_CHECKING:
    from .state import Pane, Series, ViewState


class Units(NamedTuple):
    """What numbers are in: light per area, per area and direction, and altogether."""

    density: str
    radiance: str
    power: str


def units(photometric: bool) -> Units:
    """Units of light, or of light as the eye counts it where the channels hold lumens (see `radiosity.photometry`)."""
    return Units("lux", "cd/m²", "lm") if photometric else Units("W/m²", "W/(m² sr)", "W")


SUBSCRIPTS = str.maketrans("0123456789", "₀₁₂₃₄₅₆₇₈₉")


def formula(order: int, pane: Pane) -> str:
    """The term of the series that a pane shows, in plain Unicode.

    >>> formula(12, "order"), formula(3, "sum")
    ('T¹² Lₑ', 'Σ₀…₃ Tʲ Lₑ')
    """
    if pane == "order":
        return f"T{str(order).translate(display.SUPERSCRIPTS)} Lₑ"
    return f"Σ₀…{str(order).translate(SUBSCRIPTS)} Tʲ Lₑ"


def mathtext(order: int, pane: Pane) -> str:
    """The same for typesetting by matplotlib."""
    if pane == "order":
        return rf"$T^{{{order}}} L_e$"
    return rf"$\sum_{{j=0}}^{{{order}}} T^j L_e$"


def in_words(order: int) -> str:
    """What an order of light is.

    >>> in_words(1)
    'direct light'
    """
    names = {0: "light the lamps emit", 1: "direct light", 2: "bounced twice"}
    return names.get(order, f"bounced {order} times")


def caption(series: Series, state: ViewState, pane: Pane) -> str:
    """What to know about a pane beside its formula: exposure, factor, unit."""
    if state.false_colour:
        return f"luminance of radiosity B, {units(state.photometric).density}"
    parts = []
    if pane == "order" and not series.orders[state.order].any():
        return "no light of this order"
    if state.normalised and pane == "order":
        parts.append(display.factor_text(float(series.own[state.order])))
    if state.exposure:
        parts.append(f"exposure {state.exposure:+.1f} EV".replace("-", "−"))
    elif not parts:
        parts.append("common exposure")
    return " · ".join(parts)
