"""Built-in scenes, each a function that returns a `Scene`.

Metres, y up, unless a scene says otherwise.
"""

from __future__ import annotations

from .cornell import cornell_box
from .rooms import furnace, red_rug

__all__ = ["cornell_box", "furnace", "red_rug"]
