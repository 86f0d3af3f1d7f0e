"""Files that are written whole or not at all: `radiosity.atomic`, where those who write files look for it."""

from __future__ import annotations

from ..atomic import replacing, write_bytes

__all__ = ["replacing", "write_bytes"]
