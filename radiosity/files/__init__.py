"""Scenes in and out, and the only place where untrusted input is handled."""

from __future__ import annotations

from .builtin import write_builtin_scenes
from .read import read_scene
from .write import write_scene

__all__ = ["read_scene", "write_builtin_scenes", "write_scene"]
