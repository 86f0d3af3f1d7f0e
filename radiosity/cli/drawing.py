"""Finding out whether this machine can draw, while there is other work to do."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Literal


def probe_early(where: Literal["off-screen", "window"]) -> Callable[[], None]:
    """Begin to try it in a process of its own; call what is returned before drawing.

    The viewer asks again then and finds the answer kept. A test picture takes half a second, mostly to load
    libraries, which costs nothing while one processor waits.
    """
    from ..viewer import probe

    trial = threading.Thread(target=probe.can_draw, args=(where,), daemon=True)
    trial.start()
    return trial.join
