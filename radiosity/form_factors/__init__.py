"""Form factors: what share of the light that leaves one patch arrives at another."""

from .analytic import Analytic
from .estimate import form_factors
from .factors import FormFactors
from .hemicube import Hemicube
from .monte_carlo import MonteCarlo
from .two_level import TwoLevel

__all__ = ["Analytic", "FormFactors", "Hemicube", "MonteCarlo", "TwoLevel", "form_factors"]
