"""One run: light of patches by a method, with what it cost."""

from __future__ import annotations

import time
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

import radiosity as rad

from ..patches import Patches
from .measures import Light
from .memory import PeakMemory, predicted_bytes
from .methods import BOUNCES

RTOL = 1e-6  # far below every sampling error
MOST_BOUNCES = 100_000


class Cost(NamedTuple):
    """Of one run: seconds on the clock (together, form factors, solving), seconds of all processors, bytes, bounces."""

    seconds: float
    factor_seconds: float
    solve_seconds: float
    processor_seconds: float
    bytes_peak: int | None
    bytes_matrix: int
    bytes_predicted: int | None
    bounces: int | None


def run_method(patches: Patches, method: Any, threads: int | None = None) -> tuple[Light, Cost]:
    """Light by an estimator and the Neumann series, or by a path tracer; with what it cost."""
    with PeakMemory() as memory:
        begin = time.perf_counter(), time.process_time()
        if hasattr(method, "paths"):
            walked = method.solve(patches, threads=threads)
            light, parts, matrix, bounces = Light(walked.radiosity, walked.orders), (0.0, 0.0), 0, None
        else:
            light, parts, matrix, bounces = _by_factors(patches, method, threads)
        seconds, processor = time.perf_counter() - begin[0], time.process_time() - begin[1]
    predicted = predicted_bytes(patches, replace(method, seed=0) if hasattr(method, "seed") else method)
    return light, Cost(seconds, *parts, processor, memory.bytes, matrix, predicted, bounces)


def _by_factors(patches: Patches, estimator: Any, threads: int | None) -> tuple[Light, tuple[float, float], int, int]:
    begin = time.perf_counter()
    factors = rad.form_factors(patches, estimator, threads=threads)
    middle = time.perf_counter()
    result = series(factors, patches, threads=threads)
    parts = middle - begin, time.perf_counter() - middle
    steps, matrix = result.statistics["solver/steps"], factors.statistics["matrix/bytes"]
    return light_of(result), parts, matrix, steps


def series(factors: rad.FormFactors, patches: Patches, rtol: float = RTOL, threads: int | None = None) -> rad.Result:
    """The Neumann series to its end, with the orders that are compared and no more."""
    operator = rad.TransportOperator(factors, patches, threads=threads)
    solver = rad.Neumann(rtol=rtol, maxiter=MOST_BOUNCES, keep_bytes=(BOUNCES + 1) * patches.emission.nbytes)
    return solver.solve(operator, patches.emission, patches.sky)


def light_of(result: rad.Result) -> Light:
    """Radiosity and orders of a result; orders that were not needed any more are black."""
    assert result.orders is not None
    orders = np.zeros((BOUNCES + 1, *result.radiosity.shape))
    kept = min(len(result.orders), BOUNCES + 1)
    orders[:kept] = result.orders[:kept]
    return Light(result.radiosity, orders)
