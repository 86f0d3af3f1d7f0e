"""Where to stop: after how many bounces, by which solver and at which tolerance. On given form factors."""

from __future__ import annotations

import time
import warnings
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np

import radiosity as rad

from ..errors import FormFactorError, FormFactorWarning
from .ledger import Record
from .measures import FloatArray, relative_l2
from .reference import Reference
from .subject import Subject

RAYS = 1024
BOUNCES = (0, 1, 2, 3, 4, 6, 8, 12, 16, 24)
TOLERANCES = (1e-1, 1e-2, 1e-3, 1e-4, 1e-6, 1e-8)
MOST_ELIMINATED = 2500  # patches for `Direct`, whose work grows with their cube
MOST_STEPS = 100_000
SHOTS = 20_000

Named = tuple[str, Callable[[], Record]]


def bounce_runs(subject: Subject, truth: Reference, *, repeats: int, seed: int, threads: int | None) -> Iterator[Named]:
    """The series cut after K bounces, with and without its geometric tail, on form factors of `RAYS` rays."""
    patches, area = subject.patches, subject.patches.area

    @cache
    def prepared(seed: int) -> tuple[rad.TransportOperator, FloatArray]:
        factors = rad.form_factors(patches, rad.MonteCarlo(RAYS, seed), threads=threads)
        operator = rad.TransportOperator(factors, patches, threads=threads)
        return operator, _end(operator, patches)

    for bounces in BOUNCES:
        for tail in (False, True):
            for repeat in range(repeats):

                def work(bounces: int = bounces, tail: bool = tail, seed: int = seed + repeat) -> Record:
                    operator, end = prepared(seed)
                    solver = rad.Neumann(rtol=0.0, maxiter=bounces, tail=tail, keep_bytes=0)
                    begin = time.perf_counter(), time.process_time()
                    found = solver.solve(operator, patches.emission, patches.sky).radiosity
                    return {
                        "part": "bounces",
                        "subject": subject.name,
                        "bounces": bounces,
                        "tail": tail,
                        "seed": seed,
                        "seconds": time.perf_counter() - begin[0],
                        "processor_seconds": time.process_time() - begin[1],
                        "truncation": relative_l2(found, end, area, patches.emission),
                        "sampling": relative_l2(found, truth.discrete.radiosity, area, patches.emission),
                        "total": relative_l2(found, truth.continuous.radiosity, area, patches.emission),
                    }

                yield f"{bounces}|{tail}|{seed + repeat}", work


def _end(operator: rad.TransportOperator, patches: rad.Patches) -> FloatArray:
    """All bounces."""
    solver = rad.Neumann(rtol=1e-12, maxiter=MOST_STEPS, keep_bytes=0)
    return solver.solve(operator, patches.emission, patches.sky).radiosity


def solver_runs(subject: Subject, truth: Reference, *, repeats: int, seed: int, threads: int | None) -> Iterator[Named]:
    """Every solver at every tolerance, all on the same conserved form factors."""
    del truth  # solvers are judged by the system that they solve
    patches = subject.patches

    @cache
    def prepared() -> tuple[rad.TransportOperator, FloatArray]:
        factors = _conserved(rad.form_factors(patches, rad.MonteCarlo(RAYS, seed), threads=threads))
        operator = rad.TransportOperator(factors, patches, threads=threads)
        return operator, _solution(operator, patches)

    for method in solvers(len(patches)):
        for rtol in TOLERANCES if not isinstance(method, rad.Direct) else TOLERANCES[-1:]:
            solver = replace(method, rtol=rtol)
            for repeat in range(repeats):

                def work(solver: Any = solver, repeat: int = repeat) -> Record:
                    operator, true = prepared()
                    return _solver_record(solver, operator, patches, true, subject.name) | {"repeat": repeat}

                yield f"{type(solver).__name__}|{rtol:g}|{repeat}", work


def solvers(count: int) -> list[Any]:
    """Those worth running on that many patches."""
    found: list[Any] = [
        rad.Neumann(maxiter=MOST_STEPS, keep_bytes=0),
        rad.GaussSeidel(maxiter=MOST_STEPS),
        rad.Shooting(maxiter=SHOTS),
        rad.ConjugateGradient(),
    ]
    return [*found, rad.Direct()] if count <= MOST_ELIMINATED else found


def _solver_record(
    solver: Any, operator: rad.TransportOperator, patches: rad.Patches, true: FloatArray, subject: str
) -> Record:
    about: Record = {"part": "solvers", "subject": subject, "solver": type(solver).__name__, "rtol": solver.rtol}
    begin = time.perf_counter(), time.process_time()
    try:
        result = solver.solve(operator, patches.emission, patches.sky)
    except rad.errors.SolverError as error:
        return about | {"refused": str(error)}
    return about | {
        "seconds": time.perf_counter() - begin[0],
        "processor_seconds": time.process_time() - begin[1],
        "products": result.statistics.get("solver/products", 0),
        "converged": result.converged,
        "algebra": relative_l2(result.radiosity, true, patches.area, patches.emission),
    }


def _conserved(factors: rad.FormFactors) -> rad.FormFactors:
    """Conserved factors, so that every solver has the same; raw ones where there is no such scaling."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", FormFactorWarning)
        try:
            return factors.conserved()
        except FormFactorError:
            return factors


def _solution(operator: rad.TransportOperator, patches: rad.Patches) -> FloatArray:
    """Of these factors, as exactly as there is: elimination where the system is small."""
    small = len(patches) <= MOST_ELIMINATED
    solver: Any = rad.Direct() if small else rad.Neumann(rtol=1e-13, maxiter=MOST_STEPS, keep_bytes=0)
    return np.asarray(solver.solve(operator, patches.emission, patches.sky).radiosity)
