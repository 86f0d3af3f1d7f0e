"""Built-in scenes, each a function that returns a `Scene`.

Metres, y up, as in glTF files; x to the right and z towards the viewer, except in the Cornell box, which keeps its
measured coordinates.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from ..scene import Scene
from .chains import corridor, two_rooms
from .clutter import cluttered_room
from .cornell import cornell_box
from .open import lit_sphere, open_rug, parallel_plates, uniform_dome
from .rooms import furnace, hidden_lamp, integrating_sphere, red_rug, window_room

__all__ = [
    "BUILT_IN",
    "cluttered_room",
    "cornell_box",
    "corridor",
    "furnace",
    "hidden_lamp",
    "integrating_sphere",
    "lit_sphere",
    "open_rug",
    "parallel_plates",
    "red_rug",
    "two_rooms",
    "uniform_dome",
    "window_room",
]

BUILT_IN: dict[str, Callable[[], Scene]] = {
    "cornell_box": cornell_box,
    "cornell_box_spectral": partial(cornell_box, spectral=True),
    "red_rug": red_rug,
    "furnace": furnace,
    "integrating_sphere": integrating_sphere,
    "parallel_plates": parallel_plates,
    "open_rug": open_rug,
    "uniform_dome": uniform_dome,
    "lit_sphere": lit_sphere,
    "window_room": window_room,
    "hidden_lamp": hidden_lamp,
    "two_rooms": two_rooms,
    "corridor": corridor,
    "cluttered_room": cluttered_room,
}
"""Every built-in scene by name, as it is without arguments."""
