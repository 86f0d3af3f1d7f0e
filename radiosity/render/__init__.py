"""Pictures of a solution as a camera would take them: final gather, pixel by pixel."""

from .picture import render

__all__ = ["render"]
