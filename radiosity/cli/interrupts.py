"""Ctrl-C: a clean end within two seconds, whatever is running."""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from typing import Any

from ..atomic import discard_temporaries

INTERRUPTED = 130  # the exit code that shells give a command that Ctrl-C has ended
GRACE = 0.8  # seconds from Ctrl-C until a library that does not listen is left behind


@contextmanager
def interruptible(words: Callable[[], str]) -> Iterator[None]:
    """Have Ctrl-C end the program soon, also while compiled code runs that does not listen.

    Python raises KeyboardInterrupt between two of its own steps; a compiler may not take one for long. What is being
    written is in a temporary file until it is whole, so that leaving is safe.

    Parameters
    ----------
    words : callable
        What to say where the program had to be left.
    """

    def interrupt(*_: Any) -> None:
        leave = threading.Timer(GRACE, lambda: _leave(words()))
        leave.daemon = True
        leave.start()
        raise KeyboardInterrupt

    with _handling(interrupt):
        yield


@contextmanager
def window_open() -> Iterator[None]:
    """Have Ctrl-C close a window: VTK would take a KeyboardInterrupt for a crash of its own."""
    with _handling(lambda *_: _leave()):
        yield


@contextmanager
def _handling(handler: Callable[..., None]) -> Iterator[None]:
    """Handle Ctrl-C for a while, where this is the thread that gets it."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.signal(signal.SIGINT, handler)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


def _leave(words: str = "interrupted") -> None:
    """End the process as it stands, but for files that are half-written."""
    discard_temporaries()
    show_cursor = b"\x1b[?25h" if os.isatty(2) else b""
    with suppress(OSError):
        os.write(2, show_cursor + f"error: {words}\n".encode())
    os._exit(INTERRUPTED)
