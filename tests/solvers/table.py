"""One table of solvers: every solver test runs through it."""

from __future__ import annotations

import pytest

from radiosity.solvers import ConjugateGradient, Direct, GaussSeidel, Neumann, Shooting

SOLVERS = {
    "neumann": Neumann,
    "gauss-seidel": GaussSeidel,
    "shooting": Shooting,
    "conjugate-gradient": ConjugateGradient,
    "direct": Direct,
}
ITERATIVE = {name: solver for name, solver in SOLVERS.items() if name != "direct"}
RAW = {name: solver for name, solver in SOLVERS.items() if name != "conjugate-gradient"}  # factors as sampled
STIFF = {name: solver for name, solver in SOLVERS.items() if name in ("conjugate-gradient", "direct")}


def each(solvers):
    """Parametrise a test over a table."""
    return pytest.mark.parametrize("solver", list(solvers.values()), ids=list(solvers))
