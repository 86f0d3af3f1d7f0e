"""Lectures: talks that run in the viewer, each in a short file that a teacher can copy and change."""

from __future__ import annotations

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
