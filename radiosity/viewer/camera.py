"""Cameras of the viewer: those that every picture has."""

from __future__ import annotations

from ..camera import Camera, presets

__all__ = ["Camera", "presets"]
