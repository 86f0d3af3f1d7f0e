"""Every solver beside scipy's, to one accuracy, in one run.

Example: python tests/benchmarks/bench_solvers.py --patches 10000 --rays 256

Time to a residual of 1e-6 on the Cornell box and on two closed rooms of reflectance 0.99; products as the
absorptance falls to 1e-12 (the bounces that the series would need are computed, not run); and relighting.
All on the same conserved factors; scipy's solvers (and pyamg's, where it is installed) get `T.system(c)`, one channel
after the other. The error is against elimination without subtraction where the system is small, else against the
tightest of our own solutions, in the area-weighted relative L2 of B - E.
"""

from __future__ import annotations

import argparse
import time
import warnings
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from scipy.sparse.linalg import LinearOperator, bicgstab, gmres

import radiosity as rad
from radiosity.errors import FormFactorWarning

SMALL = 2000  # patches up to which elimination gives the truth
AFFORDABLE = 20_000  # bounces that are run


class Row(NamedTuple):
    """One line of a table."""

    name: str
    products: float
    seconds: float
    error: float
    note: str = ""


def relative_error(T: rad.TransportOperator, found: np.ndarray, true: np.ndarray, emission: np.ndarray) -> float:
    """Area-weighted relative L2 of B - E over patches and channels."""
    return float(np.linalg.norm(T.norm(found - true)) / np.linalg.norm(T.norm(true - emission)))


def foreign(name: str, method: Callable[..., Any], T: rad.TransportOperator, E: np.ndarray, true: np.ndarray) -> Row:
    """A solver of scipy's kind, channel by channel."""
    products, found, failed = 0, np.empty_like(E), 0
    begin = time.perf_counter()
    for c in range(T.channels):
        system = T.system(c)

        def counted(x: np.ndarray, system: LinearOperator = system) -> np.ndarray:
            nonlocal products
            products += 1
            return system @ x

        operator = LinearOperator(T.shape, matvec=counted, dtype=np.float64)
        found[:, c], info = method(operator, E[:, c])
        failed += info != 0
    seconds = time.perf_counter() - begin
    note = f"{failed} of {T.channels} channels not converged" if failed else "one channel a product"
    return Row(name, products, seconds, relative_error(T, found, true, E), note)


def others() -> Iterator[tuple[str, Callable[..., Any]]]:
    """Solvers of other libraries."""
    yield "scipy gmres", lambda A, b: gmres(A, b, rtol=1e-6, restart=50, maxiter=40)
    yield "scipy bicgstab", lambda A, b: bicgstab(A, b, rtol=1e-6, maxiter=2000)
    try:
        from pyamg.krylov import fgmres
    except ImportError:
        return
    yield "pyamg fgmres", lambda A, b: fgmres(A, b, tol=1e-6, restart=50, maxiter=40)


def ours(solver: Any, T: rad.TransportOperator, E: np.ndarray, true: np.ndarray) -> Row:
    """One of our solvers, all channels at once; the first, short run compiles and finds the rooms."""
    replace(solver, maxiter=2).solve(T, E)
    begin = time.perf_counter()
    result = solver.solve(T, E)
    seconds = time.perf_counter() - begin
    note = "" if result.converged else "not converged"
    products = result.statistics["solver/products"]
    return Row(type(solver).__name__, products, seconds, relative_error(T, result.radiosity, true, E), note)


def show(title: str, rows: list[Row]) -> None:
    """Print a table."""
    print(f"\n{title}\n{'solver':<20}{'products':>12}{'seconds':>10}{'error':>10}")
    for row in rows:
        print(f"{row.name:<20}{row.products:>12.4g}{row.seconds:>10.3f}{row.error:>10.1e}  {row.note}")


def truth(T: rad.TransportOperator, E: np.ndarray) -> np.ndarray:
    """The solution, as exactly as we can."""
    solver = rad.Direct() if T.shape[0] <= SMALL else rad.ConjugateGradient(rtol=1e-12)
    return solver.solve(T, E).radiosity


def factors_of(scene: rad.Scene, options: argparse.Namespace) -> tuple[rad.Patches, rad.FormFactors]:
    """Patches and conserved factors."""
    patches = rad.subdivide(scene, patch_count=options.patches)
    raw = rad.form_factors(patches, rad.MonteCarlo(rays=options.rays))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", FormFactorWarning)
        return patches, raw.conserved()


def compare(title: str, T: rad.TransportOperator, E: np.ndarray) -> None:
    """Time to 1e-6."""
    true = truth(T, E)
    solvers: list[Any] = [
        rad.Neumann(maxiter=AFFORDABLE, keep_bytes=0),
        rad.GaussSeidel(maxiter=AFFORDABLE),
        rad.Shooting(maxiter=AFFORDABLE if T.shape[0] <= SMALL else 60),
        rad.ConjugateGradient(),
    ]
    if T.shape[0] <= SMALL:
        solvers.append(rad.Direct())
    rows = [ours(solver, T, E, true) for solver in solvers]
    show(title, rows + [foreign(name, method, T, E, true) for name, method in others()])


def stiff(factors: rad.FormFactors, E: np.ndarray) -> None:
    """Products as the absorptance falls."""
    print(f"\ntwo closed rooms, {len(factors)} patches, residual 1e-10: products (error)")
    print(f"{'absorptance':<14}{'ConjugateGradient':>24}{'scipy gmres':>24}{'Neumann, computed':>20}")
    for absorptance in 10.0 ** -np.array([1, 2, 3, 4, 6, 8, 10, 12]):
        T = rad.TransportOperator(factors, absorptance=absorptance)
        true = truth(T, E)
        row = ours(rad.ConjugateGradient(rtol=1e-10), T, E, true)
        other = foreign("", lambda A, b: gmres(A, b, rtol=1e-10, restart=100, maxiter=10), T, E, true)
        bounces = np.log(1e-10) / np.log1p(-absorptance)
        cells = [f"{r.products:.0f} ({r.error:.0e})" for r in (row, other)]
        print(f"{absorptance:<14.0e}{cells[0]:>24}{cells[1]:>24}{bounces:>20.3g}")


def relight(T: rad.TransportOperator, patches: rad.Patches, rtol: float) -> None:
    """New light on the same factors, and many lights at once."""
    E, solver = patches.emission, rad.Neumann(rtol=rtol)
    before = solver.solve(T, E).radiosity
    begin = time.perf_counter()
    again = rad.TransportOperator(T.factors, patches)
    cold = solver.solve(again, 1.5 * E)
    middle = time.perf_counter()
    warm = solver.solve(again, 1.5 * E, x0=before)
    end = time.perf_counter()
    bounces = [result.statistics["solver/steps"] for result in (cold, warm)]
    print(
        f"\nrelight {len(patches)} patches to {rtol:g}: {1e3 * (middle - begin):.0f} ms in {bounces[0]} bounces; "
        f"from the last light {1e3 * (end - middle):.0f} ms in {bounces[1]}"
    )
    many = np.random.default_rng(0).random((*E.shape, 100))
    begin = time.perf_counter()
    for s in range(10):
        rad.Neumann(rtol=rtol, keep_bytes=0).solve(T, many[..., s])
    middle = time.perf_counter()
    rad.Neumann(rtol=rtol, keep_bytes=0).solve(T, many)
    end = time.perf_counter()
    one_by_one, together = 10.0 * (middle - begin), end - middle
    print(
        f"100 emissions: one by one {one_by_one:.2f} s, at once {together:.2f} s, {one_by_one / together:.1f} × faster"
    )


def sliders(options: argparse.Namespace) -> None:
    """Medians of ten calls of `Solution.relight`, as a slider makes them."""
    solution = rad.solve(rad.scenes.cornell_box(), patch_count=options.patches, estimator=rad.MonteCarlo(options.rays))
    for name, change in {
        "a lamp": lambda k: {"emission": {"lamp": [12.0 + k, 9.0, 4.0]}},
        "a wall": lambda k: {"reflectance": {"red_wall": [0.6, 0.05 + 0.01 * k, 0.05]}},
    }.items():
        seconds = []
        for k in range(10):
            begin = time.perf_counter()
            again = solution.relight(**change(k))
            seconds.append(time.perf_counter() - begin)
        print(
            f"Solution.relight, {name} of {len(solution.patches)} patches to 1e-6: "
            f"{1e3 * np.median(seconds):.0f} ms ({1e3 * min(seconds):.0f} … {1e3 * max(seconds):.0f}), {again.status}"
        )


def main() -> None:
    """Print all tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--patches", type=int, default=10_000)
    parser.add_argument("--rays", type=int, default=256)
    options = parser.parse_args()
    patches, cornell = factors_of(rad.scenes.cornell_box(), options)
    T = rad.TransportOperator(cornell, patches)
    compare(f"Cornell box, {len(patches)} patches, residual 1e-6", T, patches.emission)
    relight(T, patches, 1e-3)
    sliders(options)
    patches, rooms = factors_of(rad.scenes.two_rooms(door=0.3), options)
    T = rad.TransportOperator(rooms, reflectance=0.99)
    compare(f"two rooms of reflectance 0.99, {len(patches)} patches, residual 1e-6", T, patches.emission[:, :1])
    stiff(rooms, patches.emission[:, :1])


if __name__ == "__main__":
    main()
