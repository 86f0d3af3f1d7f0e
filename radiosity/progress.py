"""How long work tells how far it is: a callable, so that nobody below needs to know who listens."""

from __future__ import annotations

from typing import Protocol


class Progress(Protocol):
    """Called with the stage's name, what is done and what there is to do, in the stage's own unit."""

    def __call__(self, stage: str, done: int, total: int) -> None:
        """Take note of it; raise to stop the work."""


def quiet(stage: str, done: int, total: int) -> None:
    """Tell nobody."""
