"""Methods that solve B = E + T B, one a file."""

from .base import Solver
from .neumann import Neumann

__all__ = ["Neumann", "Solver"]
