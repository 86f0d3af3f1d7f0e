"""The command `radiosity`: words of the command line turned into calls of the public API."""

from __future__ import annotations

from .main import main

__all__ = ["main"]
