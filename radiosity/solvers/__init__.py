"""Methods that solve B = E + T B, one a file."""

from .base import Solver
from .conjugate_gradient import ConjugateGradient
from .direct import Direct
from .gauss_seidel import GaussSeidel
from .neumann import Neumann
from .shooting import Shooting

__all__ = ["ConjugateGradient", "Direct", "GaussSeidel", "Neumann", "Shooting", "Solver"]
