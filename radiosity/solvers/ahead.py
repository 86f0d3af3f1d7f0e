"""The kernels of a bounce, compiled ahead while form factors are still being made."""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_array

from ..ahead import Ahead
from ..form_factors.factors import FormFactors
from ..sparse import _rows_times_columns
from ..transport import TransportOperator
from .neumann import Neumann


def compile_bounces() -> None:
    """Sum the series of two facing walls, in three channels and with weights as they usually are."""
    weights = csr_array(np.array([[0.0, 0.5], [0.5, 0.0]], dtype=np.float32))
    factors = FormFactors(weights, np.full(2, 0.5), np.zeros(2), np.ones(2))
    T = TransportOperator(factors, reflectance=np.full((2, 3), 0.5))
    Neumann().solve(T, np.ones((2, 3)), np.zeros(3))


BOUNCES = Ahead(__name__, compile_bounces.__name__, _rows_times_columns)
