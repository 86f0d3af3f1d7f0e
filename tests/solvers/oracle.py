"""The same system at 50 digits, from the entries as they are stored."""

from __future__ import annotations

import mpmath
import numpy as np


def fifty_digits(T, source, channel=0):
    """B (N,) of one channel; the diagonal is α + ρ (Σ_{j≠i} F_ij + outside), as rows close."""
    with mpmath.workdps(50):
        F, count = T.factors.matrix.toarray(), T.shape[0]
        system = mpmath.zeros(count, count)
        for i in range(count):
            alpha = mpmath.mpf(float(T.absorptance[i, channel]))
            rho = 1 - alpha
            leaving = mpmath.mpf(float(T.to_outside[i]))
            for j in range(count):
                if i != j:
                    share = mpmath.mpf(float(F[i, j]))
                    system[i, j] = -rho * share
                    leaving += share
            system[i, i] = alpha + rho * leaving
        right = mpmath.matrix([mpmath.mpf(float(e)) for e in source[:, channel]])
        return np.array([float(b) for b in mpmath.lu_solve(system, right)])
