"""Pictures of a solution as a camera would take them: final gather, pixel by pixel."""

from .picture import render
from .write import write_picture

__all__ = ["render", "write_picture"]
