"""What is shown, as a value: the state of the viewer, its transitions, and the picture as a function of it.

Nothing here knows a window. The window, the page and the figures hold a `Series` and a `ViewState` and draw
`picture(series, state, pane)`; keys and sliders only replace the state by another.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from .. import display
from ..errors import ParameterError

if TYPE_CHECKING:
    from ..solution import Solution

Pane = Literal["order", "sum"]
PANES: tuple[Pane, ...] = ("order", "sum")
Left = Literal["order", "factors", "hemicube", "matrix", "wrong"]
LEFTS: tuple[Left, ...] = ("order", "factors", "hemicube", "matrix", "wrong")
OF_A_PATCH = ("factors", "hemicube")  # need a picked patch
EXPOSURES = (-6.0, 12.0)  # EV that the slider reaches, about the automatic exposure
EXPOSURE_STEP = 0.5
ORDERS_WHEN_NONE = 10  # bounces to compute where the solver kept none
FALSE_COLOUR_DECADES = 2


@dataclass(frozen=True)
class ViewState:
    """What the viewer shows.

    Attributes
    ----------
    last : int
        Highest order K there is.
    order : int
        Bounce k in 0 … K.
    exposure : float
        EV added to the automatic exposure.
    tone : {"reinhard", "linear"}
    normalised : bool
        Show T^k L_e on its own exposure rather than the common one.
    mark_clipped : bool
        With the linear tone operator, show in magenta what it cannot show.
    false_colour : bool
        Show luminance as numbers on a scale instead of colours.
    smooth : bool
        Interpolate between patches; flat is what was computed.
    wireframe : bool
        Show the edges of the patches.
    backs : bool
        Show the black backs of one-sided faces in a signal colour, to check normals.
    preset : int
        Which camera preset, counted up.
    picked, other : int
        Picked patch, and the one that its exchange is looked at with; -1 for none.
    left : {"order", "factors", "hemicube", "matrix", "wrong"}
        What the left pane shows: the bounce; the picked patch's form factors; what it sees; the operator T; a
        shortcut, wrong on purpose.
    wrong : int
        Which of `radiosity.shortcuts.ALL`.
    difference : bool
        Of a shortcut, show how far off it is.
    verdict : bool
        Say how wrong the light can be.
    playing, help, projector : bool
        Bounces advance by themselves; the list of keys is open; large type.
    """

    last: int
    order: int = 0
    exposure: float = 0.0
    tone: display.Tone = "reinhard"
    normalised: bool = False
    mark_clipped: bool = False
    false_colour: bool = False
    smooth: bool = False
    wireframe: bool = False
    backs: bool = False
    preset: int = 0
    picked: int = -1
    other: int = -1
    left: Left = "order"
    wrong: int = 0
    difference: bool = False
    verdict: bool = False
    playing: bool = False
    help: bool = False
    projector: bool = False

    def __post_init__(self) -> None:
        if self.tone not in display.TONES:
            raise ParameterError(f"tone {self.tone!r} is unknown; choose from {', '.join(display.TONES)}")
        if self.left not in LEFTS:
            raise ParameterError(f"the left pane cannot show {self.left!r}; choose from {', '.join(LEFTS)}")
        object.__setattr__(self, "order", int(np.clip(self.order, 0, self.last)))
        object.__setattr__(self, "exposure", float(np.clip(self.exposure, *EXPOSURES)))

    def at(self, order: float) -> ViewState:
        """The state at the nearest order that there is."""
        return replace(self, order=round(order))

    def step(self, bounces: int = 1) -> ViewState:
        """Some bounces on, or back."""
        return self.at(self.order + bounces)

    def tick(self) -> ViewState:
        """One step of the animation: the next bounce, and after the last the lamps alone."""
        return self.at(0 if self.order == self.last else self.order + 1)

    def exposed(self, ev: float) -> ViewState:
        """The state at another exposure."""
        return replace(self, exposure=ev)

    def brighter(self, steps: int = 1) -> ViewState:
        """Some steps of exposure up, or down."""
        return self.exposed(self.exposure + steps * EXPOSURE_STEP)

    def toned(self) -> ViewState:
        """The next tone operator."""
        return replace(self, tone=display.TONES[(display.TONES.index(self.tone) + 1) % len(display.TONES)])

    def pick(self, patch: int) -> ViewState:
        """The state with a patch picked, or with none."""
        left = "order" if patch < 0 and self.left in OF_A_PATCH else self.left
        return replace(self, picked=patch, other=-1, left=left)

    def pick_other(self, patch: int) -> ViewState:
        """The state with a second patch picked beside the first."""
        return replace(self, other=patch if patch != self.picked else -1) if self.picked >= 0 else self.pick(patch)

    def next_left(self) -> ViewState:
        """The next thing to show in the left pane, leaving out what needs a patch if none is picked."""
        possible = [left for left in LEFTS[:-1] if self.picked >= 0 or left not in OF_A_PATCH]
        if self.left not in possible:
            return replace(self, left="order")
        return replace(self, left=possible[(possible.index(self.left) + 1) % len(possible)])

    def next_wrong(self) -> ViewState:
        """The next shortcut beside all the light there is; after the last one, the bounces again."""
        from ..shortcuts import ALL

        if self.left != "wrong":
            return replace(self, left="wrong", wrong=0, order=self.last)
        if self.wrong + 1 == len(ALL):
            return replace(self, left="order")
        return replace(self, wrong=self.wrong + 1)

    def toggled(self, switch: str) -> ViewState:
        """The state with one of its switches turned."""
        if not isinstance(value := getattr(self, switch), bool):
            raise ParameterError(f"{switch} of the view is {value!r}, not a switch")
        change: dict[str, Any] = {switch: not value}
        return replace(self, **change)


@dataclass(frozen=True)
class Command:
    """A key and what it does to the state."""

    keys: tuple[str, ...]  # as VTK names them
    shown: str  # how a person names them
    does: str
    change: Callable[[ViewState], ViewState]


COMMANDS = (
    Command(("Right",), "→", "next bounce", lambda state: state.step(1)),
    Command(("Left",), "←", "previous bounce", lambda state: state.step(-1)),
    Command(("Home",), "Home", "lamps alone, k = 0", lambda state: state.at(0)),
    Command(("End",), "End", "last bounce", lambda state: state.at(state.last)),
    Command(("space",), "space", "play / pause", lambda state: state.toggled("playing")),
    Command(("Up",), "↑", "brighter by ½ EV", lambda state: state.brighter(1)),
    Command(("Down",), "↓", "darker by ½ EV", lambda state: state.brighter(-1)),
    Command(("0",), "0", "automatic exposure", lambda state: state.exposed(0.0)),
    Command(("n", "N"), "n", "each bounce on its own exposure", lambda state: state.toggled("normalised")),
    Command(("t", "T"), "t", "tone operator: Reinhard / linear", lambda state: state.toned()),
    Command(("m", "M"), "m", "mark what linear clips", lambda state: state.toggled("mark_clipped")),
    Command(("f", "F"), "f", "false colour of luminance", lambda state: state.toggled("false_colour")),
    Command(("s", "S"), "s", "smooth / flat patches", lambda state: state.toggled("smooth")),
    Command(("w", "W"), "w", "edges of the patches", lambda state: state.toggled("wireframe")),
    Command(("b", "B"), "b", "backs of one-sided faces", lambda state: state.toggled("backs")),
    Command(("g", "G"), "g", "left: bounce / F of a patch / hemicube / T", lambda state: state.next_left()),
    Command(("x", "X"), "x", "left: shortcuts, wrong on purpose", lambda state: state.next_wrong()),
    Command(("d", "D"), "d", "difference of a shortcut to the truth", lambda state: state.toggled("difference")),
    Command(("v", "V"), "v", "verdict: how wrong this can be", lambda state: state.toggled("verdict")),
    Command(("c", "C"), "c", "next camera", lambda state: replace(state, preset=state.preset + 1)),
    Command(("p", "P"), "p", "projector: large type", lambda state: state.toggled("projector")),
    Command(("question", "h", "H"), "?", "this list", lambda state: state.toggled("help")),
)


@dataclass(frozen=True, eq=False)
class Series:
    """The light of a solution by order, ready to be shown.

    Attributes
    ----------
    orders, sums : ndarray of float32 (K + 1, N, 3)
        T^k E and its partial sums as RGB, W/m².
    area : ndarray (N,)
        m².
    power : ndarray (K + 1, C)
        Power that leaves the surfaces with each order, W.
    common : float
        Exposure factor that shows the middle lit patch of the whole reflected light as mid-grey.
    own : ndarray (K + 1,)
        By which factor each order is brightened beyond `common` when it is shown by itself; 1 where it is black.
    """

    orders: NDArray[np.float32]
    sums: NDArray[np.float32]
    area: NDArray[np.float64]
    power: NDArray[np.float64]
    common: float = field(init=False)
    own: NDArray[np.float64] = field(init=False)

    def __post_init__(self) -> None:
        reflected = self.sums[-1] - self.orders[0]
        shown = reflected if reflected.any() else self.sums[-1]
        object.__setattr__(self, "common", display.automatic_factor(shown, self.area))
        factors = [display.automatic_factor(order, self.area) if order.any() else self.common for order in self.orders]
        object.__setattr__(self, "own", np.array(factors) / self.common)

    @classmethod
    def of(cls, solution: Solution) -> Series:
        """The orders of a solution; where its solver kept none, they are computed again from its factors."""
        kept = solution.orders
        if kept is None:
            from ..transport import TransportOperator

            operator = TransportOperator(solution.factors, solution.patches)
            kept = operator.orders(solution.emission, sky=solution.sky, count=ORDERS_WHEN_NONE)
        orders = display.as_rgb(np.asarray(kept))
        area = np.asarray(solution.patches.area, dtype=np.float64)
        return cls(
            orders=orders.astype(np.float32),
            sums=np.cumsum(orders, axis=0).astype(np.float32),
            area=area,
            power=np.einsum("n,knc->kc", area, kept),
        )

    @property
    def last(self) -> int:
        """Highest order K."""
        return len(self.orders) - 1

    def light(self, state: ViewState, pane: Pane) -> NDArray[np.float32]:
        """T^k E or the partial sum, (N, 3) in W/m²."""
        return (self.orders if pane == "order" else self.sums)[state.order]

    def factor(self, state: ViewState, pane: Pane) -> float:
        """Exposure factor of a pane, from W/m² to what the tone operator takes."""
        own = float(self.own[state.order]) if state.normalised and pane == "order" else 1.0
        return self.common * display.exposure_factor(state.exposure) * own

    def scale(self, state: ViewState, pane: Pane) -> tuple[float, float]:
        """Ends of the logarithmic false-colour scale of a pane, W/m².

        The upper end is a round number above all reflected light (lamps may pass it), the lower one two decades below.
        """
        if state.normalised and pane == "order":
            shown = self.orders[state.order]
        else:
            shown = self.sums[-1] - self.orders[0] if self.last else self.sums[-1]
        brightest = float(display.luminance(shown).max(initial=0.0))
        high = display.round_up(brightest) if brightest > 0.0 else 1.0
        return high / 10.0**FALSE_COLOUR_DECADES, high


def picture(series: Series, state: ViewState, pane: Pane) -> NDArray[np.uint8]:
    """Colours of the patches: sRGB bytes (N, 3)."""
    return coloured(series, state, pane, series.light(state, pane))


def coloured(series: Series, state: ViewState, pane: Pane, light: NDArray[Any]) -> NDArray[np.uint8]:
    """Colours of any light, at patches or between them, on the exposure or scale of a pane: (…, 3)."""
    if state.false_colour:
        low, high = series.scale(state, pane)
        return display.false_colour(display.luminance(light), low, high, logarithmic=True)
    return display.tone_map(light, series.factor(state, pane), state.tone, mark_clipped=state.mark_clipped)


SUPERSCRIPTS = str.maketrans("0123456789", "⁰¹²³⁴⁵⁶⁷⁸⁹")
SUBSCRIPTS = str.maketrans("0123456789", "₀₁₂₃₄₅₆₇₈₉")


def formula(order: int, pane: Pane) -> str:
    """The term of the series that a pane shows, in plain Unicode.

    >>> formula(12, "order"), formula(3, "sum")
    ('T¹² Lₑ', 'Σ₀…₃ Tʲ Lₑ')
    """
    if pane == "order":
        return f"T{str(order).translate(SUPERSCRIPTS)} Lₑ"
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
        return "luminance of radiosity B, W/m²"
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


def start(series: Series, **settings: Any) -> ViewState:
    """The state a viewer opens with.

    Raises
    ------
    ParameterError
        A setting that the state does not have.
    """
    known = {name for name in ViewState.__dataclass_fields__ if name != "last"}
    if unknown := sorted(set(settings) - known):
        raise ParameterError(f"the view has no setting {', '.join(unknown)}; it has {', '.join(sorted(known))}")
    for name in ("picked", "other"):
        if settings.get(name, -1) >= len(series.area):
            raise ParameterError(f"{name} is patch {settings[name]}; there are {len(series.area)}")
    return ViewState(last=series.last, **{"order": 1, **settings})
