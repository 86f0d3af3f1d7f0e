"""What is shown, as a value: the state of the viewer, its transitions, and the picture as a function of it.

Nothing here knows a window. The window, the page and the figures hold a `Series` and a `ViewState` and draw
`picture(series, state, pane)`; keys and sliders only replace the state by another.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from .. import display
from ..errors import ParameterError
from .changes import Changes
from .dome import Dome
from .titles import caption as caption
from .titles import formula as formula
from .titles import in_words as in_words
from .titles import mathtext as mathtext

if TYPE_CHECKING:
    from ..solution import Solution

Pane = Literal["order", "sum"]
PANES: tuple[Pane, ...] = ("order", "sum")
Left = Literal["order", "factors", "hemicube", "matrix", "hemisphere", "solvers", "wrong"]
LEFTS: tuple[Left, ...] = ("order", "factors", "hemicube", "matrix", "hemisphere", "solvers", "wrong")
CYCLE = LEFTS[:4]  # what one key goes through; the others have keys of their own
OF_A_PATCH = ("factors", "hemicube")  # need a picked patch
EXPOSURES = (-6.0, 12.0)  # EV that the slider reaches, about the automatic exposure
EXPOSURE_STEP = 0.5
ORDERS_WHEN_NONE = 10  # bounces to compute where the solver kept none
FALSE_COLOUR_DECADES = 2
FRAMES = 60  # of gathering against shooting


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
    left : {"order", "factors", "hemicube", "matrix", "hemisphere", "solvers", "wrong"}
        What the left pane shows: the bounce; the picked patch's form factors; what it sees; the operator T; the
        hemisphere at the picked patch; gathering, while the right pane shows shooting; a shortcut, wrong on purpose.
    dome : Dome
        What is shown of the hemisphere.
    work : int
        Frame of gathering against shooting.
    changes : Changes
        Light and paint that differ from the scene as it was solved.
    wrong : int
        Which of `radiosity.shortcuts.ALL`.
    difference : bool
        Of a shortcut, show how far off it is.
    verdict : bool
        Say how wrong the light can be.
    photometric : bool
        The channels hold lumens: numbers are lux instead of W/m² (see `radiosity.photometry`).
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
    dome: Dome = field(default_factory=Dome)
    work: int = 0
    changes: Changes = field(default_factory=Changes)
    wrong: int = 0
    difference: bool = False
    verdict: bool = False
    photometric: bool = False
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
        object.__setattr__(self, "work", int(np.clip(self.work, 0, FRAMES - 1)))

    def at(self, order: float) -> ViewState:
        """The state at the nearest order that there is."""
        return replace(self, order=round(order))

    @property
    def reel(self) -> tuple[int, int]:
        """What arrow keys, the first slider and the animation move: bounces, or frames of the solvers; and its end."""
        return (self.work, FRAMES - 1) if self.left == "solvers" else (self.order, self.last)

    def moved_to(self, place: float) -> ViewState:
        """The state at another place of what is being moved through."""
        return replace(self, work=round(place)) if self.left == "solvers" else self.at(place)

    def step(self, places: int = 1) -> ViewState:
        """Some bounces on, or back; or frames of the solvers."""
        return self.moved_to(self.reel[0] + places)

    def tick(self) -> ViewState:
        """One step of the animation: the next bounce or frame, from the last to the first; or the sum over the dome."""
        if self.left == "hemisphere" and self.dome.stage == "sum":
            return replace(self, dome=self.dome.swept_on())
        place, end = self.reel
        return self.moved_to(0 if place == end else place + 1)

    def exposed(self, ev: float) -> ViewState:
        """The state at another exposure."""
        return replace(self, exposure=ev)

    def brighter(self, steps: int = 1) -> ViewState:
        """Some steps of exposure up, or down."""
        return self.exposed(self.exposure + steps * EXPOSURE_STEP)

    def toned(self) -> ViewState:
        """The next tone operator."""
        return replace(self, tone=display.TONES[(display.TONES.index(self.tone) + 1) % len(display.TONES)])

    def marked(self) -> ViewState:
        """The state that marks what the linear operator clips, which is the one it then has; or not."""
        return replace(self, mark_clipped=not self.mark_clipped, tone=self.tone if self.mark_clipped else "linear")

    def pick(self, patch: int) -> ViewState:
        """The state with a patch picked, or with none; a path begins anew, and the sliders go to its surface."""
        left = "order" if patch < 0 and self.left in OF_A_PATCH else self.left
        dome, changes = replace(self.dome, path=()), self.changes.on("")
        return replace(self, picked=patch, other=-1, left=left, dome=dome, changes=changes)

    def walk(self, patch: int) -> ViewState:
        """Open the hemisphere of a patch that the picked one sees: one step of the recursion.

        Light of one bounce was light of the bounce before it where it came from; there is nothing before the lamps.
        """
        if patch < 0 or self.picked < 0 or (self.dome.single and self.order == 0):
            return self
        dome = replace(self.dome, path=(*self.dome.path, (self.picked, self.order)))
        return replace(self, picked=patch, other=-1, dome=dome, order=self.order - self.dome.single)

    def walk_back(self) -> ViewState:
        """To the hemisphere that one came from, and its bounce."""
        if not self.dome.path:
            return self
        patch, order = self.dome.path[-1]
        return replace(self, picked=patch, other=-1, order=order, dome=replace(self.dome, path=self.dome.path[:-1]))

    def showing(self, left: Left) -> ViewState:
        """The state with something in the left pane, or with the bounces again where that is there already."""
        return replace(self, left="order" if self.left == left else left)

    def pick_other(self, patch: int) -> ViewState:
        """The state with a second patch picked beside the first."""
        return replace(self, other=patch if patch != self.picked else -1) if self.picked >= 0 else self.pick(patch)

    def next_left(self) -> ViewState:
        """The next thing to show in the left pane, leaving out what needs a patch if none is picked."""
        possible = [left for left in CYCLE if self.picked >= 0 or left not in OF_A_PATCH]
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
        Exposure factor. By default the one that shows the middle lit patch of the whole reflected light as mid-grey.
    """

    orders: NDArray[np.float32]
    sums: NDArray[np.float32]
    area: NDArray[np.float64]
    power: NDArray[np.float64]
    common: float = 0.0

    def __post_init__(self) -> None:
        if self.common > 0.0:
            return
        reflected = self.sums[-1] - self.orders[0]
        shown = reflected if reflected.any() else self.sums[-1]
        object.__setattr__(self, "common", display.automatic_factor(shown, self.area))

    @functools.cached_property
    def own(self) -> NDArray[np.float64]:
        """By which factor each order is brightened beyond `common` when it is shown by itself, (K + 1,); 1 if black."""
        factors = [display.automatic_factor(order, self.area) if order.any() else self.common for order in self.orders]
        return np.array(factors) / self.common

    @classmethod
    def of(cls, solution: Solution, common: float = 0.0) -> Series:
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
            common=common,
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
