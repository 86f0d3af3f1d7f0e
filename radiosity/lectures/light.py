"""What lectures ask of a solution: which patches, how bright on average; and light of other origin on its patches."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import ParameterError
from ..result import Result, Step
from ..solution import Solution


def on(solution: Solution, *surfaces: str) -> NDArray[np.bool_]:
    """Which patches lie on some surfaces, (N,).

    Raises
    ------
    ParameterError
        A surface that the scene does not have.
    """
    names = solution.patches.surface_names
    if unknown := [name for name in surfaces if name not in names]:
        raise ParameterError(f"there is no surface {', '.join(unknown)}; there are {', '.join(names)}")
    return np.isin(solution.patches.surface, [names.index(name) for name in surfaces])


def bounces(solution: Solution) -> NDArray[np.float64]:
    """Light by bounce, T^k E, W/m², (K + 1, N, C).

    Raises
    ------
    ParameterError
        The solver kept none.
    """
    if solution.orders is None:
        raise ParameterError("the solver kept no bounces; solve with Neumann, or give `bounces`")
    return solution.orders


def mean(solution: Solution, values: ArrayLike, *surfaces: str) -> NDArray[np.float64]:
    """Mean over the area of some surfaces, of all if none is named.

    Parameters
    ----------
    solution : Solution
    values : array_like (N,) or (N, C)
    *surfaces : str

    Returns
    -------
    ndarray () or (C,)
    """
    there = on(solution, *surfaces) if surfaces else np.ones(len(solution.patches), dtype=bool)
    return np.average(np.asarray(values, dtype=np.float64)[there], axis=0, weights=solution.patches.area[there])


def nearest(solution: Solution, point: ArrayLike) -> int:
    """The patch whose middle is nearest to a point (x, y, z), m: the one that a step picks there."""
    return int(np.argmin(np.linalg.norm(solution.patches.centroid - np.asarray(point, dtype=np.float64), axis=1)))


def with_orders(solution: Solution, orders: ArrayLike, status: str = "") -> Solution:
    """The same scene under light that was computed otherwise.

    Parameters
    ----------
    solution : Solution
    orders : array_like (K + 1, N, C)
        What is added step by step, W/m²; the first is the emission.
    status : str, optional
        How it was computed.

    Returns
    -------
    Solution
        Its radiosity is the sum of the orders.
    """
    terms = np.asarray(orders, dtype=np.float64)
    if terms.ndim != 3 or terms.shape[1:] != solution.radiosity.shape:
        raise ParameterError(
            f"orders have shape {terms.shape}; give (steps, {', '.join(map(str, solution.radiosity.shape))})"
        )
    result = Result(terms.sum(axis=0), terms, status or "given, not solved", converged=False, history=np.zeros((0, 0)))
    return replace(solution, result=result)


def with_steps(solution: Solution, steps: Iterable[Step], status: str = "") -> Solution:
    """The same scene as a solver leaves it after each of its steps: the sums are its iterates.

    Parameters
    ----------
    solution : Solution
    steps : iterable of Step
        ``itertools.islice(solver.iterate(T, emission), 10)``, say.
    status : str, optional
    """
    iterates = [np.asarray(step.radiosity, dtype=np.float64) for step in steps]
    if not iterates:
        raise ParameterError("a solver without steps leaves no light to show")
    return with_orders(solution, np.diff(iterates, axis=0, prepend=np.zeros_like(iterates[:1])), status)
