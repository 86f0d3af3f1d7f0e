"""Keys, and what each does to the state. The window, the tests and the docs' table read this one list."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from .changes import next_surface
from .dome import AZIMUTH_STEP, THETA_STEP, Dome
from .state import ViewState

if TYPE_CHECKING:
    from .model import Model


@dataclass(frozen=True)
class Command:
    """A key and what it does to the state.

    Attributes
    ----------
    keys : tuple of str
        As VTK names them.
    shown : str
        As a person names them.
    does : str
    change : callable (ViewState, Model) -> ViewState
        Some need to know what there is to show: which patch a direction sees, how far a slider reaches.
    """

    keys: tuple[str, ...]
    shown: str
    does: str
    change: Callable[[ViewState, Model], ViewState]


def _dome(state: ViewState, change: Callable[[Dome], Dome]) -> ViewState:
    """The hemisphere changed, and open."""
    return replace(state, left="hemisphere", dome=change(state.dome))


def brighter_surface(state: ViewState, model: Model, steps: int) -> ViewState:
    """Emission of the sliders' surface, by steps."""
    return replace(state, changes=model.sliders(state).brighter(state.changes, steps))


def lighter_surface(state: ViewState, model: Model, steps: int) -> ViewState:
    """Reflectance of the sliders' surface, by steps."""
    return replace(state, changes=model.sliders(state).lighter(state.changes, steps))


def other_surface(state: ViewState, model: Model) -> ViewState:
    """Sliders of the next surface."""
    return replace(state, changes=next_surface(model.solution.scene, model.held(state)))


BOUNCES = (
    Command(("Right",), "→", "next bounce (or step of the solvers)", lambda s, _: s.step(1)),
    Command(("Left",), "←", "previous bounce", lambda s, _: s.step(-1)),
    Command(("Home",), "Home", "lamps alone, k = 0", lambda s, _: s.moved_to(0)),
    Command(("End",), "End", "last bounce", lambda s, _: s.moved_to(s.reel[1])),
    Command(("space",), "space", "play / pause", lambda s, _: s.toggled("playing")),
)
LIGHT = (
    Command(("Up",), "↑", "brighter by ½ EV", lambda s, _: s.brighter(1)),
    Command(("Down",), "↓", "darker by ½ EV", lambda s, _: s.brighter(-1)),
    Command(("0",), "0", "automatic exposure", lambda s, _: s.exposed(0.0)),
    Command(("n", "N"), "n", "each bounce on its own exposure", lambda s, _: s.toggled("normalised")),
    Command(("t", "T"), "t", "tone operator: Reinhard / linear", lambda s, _: s.toned()),
    Command(("m", "M"), "m", "linear, and mark what it clips", lambda s, _: s.marked()),
    Command(("f", "F"), "f", "false colour of luminance", lambda s, _: s.toggled("false_colour")),
    Command(("z", "Z"), "z", "unit: W/m² / lux", lambda s, _: s.toggled("photometric")),
)
SCENE = (
    Command(("s", "S"), "s", "smooth / flat patches", lambda s, _: s.toggled("smooth")),
    Command(("w", "W"), "w", "edges of the patches", lambda s, _: s.toggled("wireframe")),
    Command(("b", "B"), "b", "backs of one-sided faces", lambda s, _: s.toggled("backs")),
    Command(("c", "C"), "c", "next camera", lambda s, _: replace(s, preset=s.preset + 1)),
)
LEFT_PANE = (
    Command(("g", "G"), "g", "left: bounce / F of a patch / hemicube / T", lambda s, _: s.next_left()),
    Command(("x", "X"), "x", "left: shortcuts, wrong on purpose", lambda s, _: s.next_wrong()),
    Command(("d", "D"), "d", "difference of a shortcut to the truth", lambda s, _: s.toggled("difference")),
    Command(("y", "Y"), "y", "gathering against shooting", lambda s, _: s.showing("solvers")),
)
HEMISPHERE = (
    Command(("o", "O"), "o", "hemisphere at the picked patch", lambda s, _: s.showing("hemisphere")),
    Command(("a", "A"), "a", "its colour: Lᵢ / Lᵢ cos θ / the sum", lambda s, _: _dome(s, Dome.next_stage)),
    Command(("k", "K"), "k", "light of one bounce / all light", lambda s, _: _dome(s, Dome.other_light)),
    Command(("l", "L"), "l", "glossy lobe for comparison", lambda s, _: _dome(s, Dome.other_lobe)),
    Command(("comma",), ",", "ωᵢ towards the normal", lambda s, _: _dome(s, lambda d: d.turned(-THETA_STEP))),
    Command(("period",), ".", "ωᵢ towards the horizon", lambda s, _: _dome(s, lambda d: d.turned(THETA_STEP))),
    Command(("less",), "<", "ωᵢ round to the left", lambda s, _: _dome(s, lambda d: d.turned(0, AZIMUTH_STEP))),
    Command(("greater",), ">", "ωᵢ round to the right", lambda s, _: _dome(s, lambda d: d.turned(0, -AZIMUTH_STEP))),
    Command(("j", "J"), "j", "jump to what ωᵢ sees", lambda s, model: s.walk(model.ahead(s))),
    Command(("u", "U"), "u", "back along the path", lambda s, _: s.walk_back()),
)
PLAY = (
    Command(("e", "E"), "e", "sliders of E and ρ: next surface", other_surface),
    Command(("bracketright",), "]", "more emission", lambda s, model: brighter_surface(s, model, 1)),
    Command(("bracketleft",), "[", "less emission", lambda s, model: brighter_surface(s, model, -1)),
    Command(("braceright",), "}", "more reflectance", lambda s, model: lighter_surface(s, model, 1)),
    Command(("braceleft",), "{", "less reflectance", lambda s, model: lighter_surface(s, model, -1)),
    Command(("r", "R"), "r", "light and paint as they were", lambda s, _: replace(s, changes=s.changes.undone())),
)
WINDOW = (
    Command(("v", "V"), "v", "verdict: how wrong this can be", lambda s, _: s.toggled("verdict")),
    Command(("p", "P"), "p", "projector: large type, high contrast", lambda s, _: s.toggled("projector")),
    Command(("question", "h", "H"), "?", "this list", lambda s, _: s.toggled("help")),
)
GROUPS: dict[str, tuple[Command, ...]] = {
    "bounces": BOUNCES,
    "light": LIGHT,
    "scene": SCENE,
    "left pane": LEFT_PANE,
    "the hemisphere": HEMISPHERE,
    "play with light": PLAY,
    "window": WINDOW,
}
COMMANDS = tuple(command for group in GROUPS.values() for command in group)
MOUSE = (
    ("drag", "turn"),
    ("shift drag", "move"),
    ("wheel", "nearer / farther"),
    ("click", "pick a patch; on the dome: go there"),
    ("ctrl click", "a second patch"),
    ("drag ωᵢ, ωₒ", "another direction"),
    ("q", "quit"),
)
