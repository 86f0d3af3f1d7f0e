"""Walls that absorb next to nothing, nothing at all, or everything."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from functools import partial

import numpy as np

import radiosity as rad

from .case import Case, Got, case, refuses, truth, warns, within
from .systems import all_alike, conserved, energy_defect, lamp, light_in_a_sphere, operator

GROUP = "albedo"
STIFF = (1e-1, 1e-3, 1e-6, 1e-9, 1e-12)


def cases() -> Iterator[Case]:
    """All of this file."""
    for alpha in STIFF:
        yield Case(f"furnace, α = {alpha:g}", "B = E / α within 1e-9", partial(_furnace, alpha), GROUP)
    for alpha in STIFF[2:]:
        name = f"lit room with conserved factors, α = {alpha:g}"
        yield Case(name, "as much absorbed as emitted, within 1e-9", partial(_balance, alpha), GROUP)
    for solver in (rad.ConjugateGradient(rtol=1e-12), rad.Direct()):
        name = f"α from 1e-12 to 1 at random, {type(solver).__name__}"
        yield Case(name, "closed form of the sphere within 1e-9", partial(_mixed, solver), GROUP)
    yield from (
        slow_series,
        checkerboard,
        black,
        unlit,
        closed_mirror,
        rounded_to_one,
        dark_mirror,
        leaky_mirror,
        colours,
    )


def _furnace(alpha: float) -> Got:
    patches, factors = conserved("furnace", 600)
    T = operator(factors, absorptance=alpha)
    result = rad.ConjugateGradient(rtol=1e-12).solve(T, patches.emission)
    return within(result.radiosity * alpha, patches.emission, 1e-9)


def _balance(alpha: float) -> Got:
    patches, factors = conserved("red_rug", 800)
    T = operator(factors, absorptance=np.full_like(patches.absorptance, alpha))
    result = rad.ConjugateGradient(rtol=1e-12).solve(T, patches.emission)
    defect = energy_defect(T, patches.emission, result.radiosity)
    return truth(result.converged and defect <= 1e-9, f"off by {defect:.2g}; {result.status}")


def _mixed(solver: rad.ConjugateGradient | rad.Direct) -> Got:
    factors = all_alike(250)
    rng = np.random.default_rng(3)
    alpha, emission = 1e-12 ** rng.random((250, 3)), rng.random((250, 3))
    found = solver.solve(operator(factors, absorptance=alpha), emission).radiosity
    return within(found, light_in_a_sphere(factors, alpha, emission), 1e-9)


@case("the series at α = 1e-8, 500 bounces", "says that it has not converged, and what would", GROUP)
def slow_series() -> Got:
    """An answer that is 2e5 times too dark must not be called one."""
    patches, factors = conserved("furnace", 600)
    T = operator(factors, absorptance=1e-8)
    result = rad.Neumann(maxiter=500, keep_bytes=0).solve(T, patches.emission)
    return truth(not result.converged and "ConjugateGradient" in result.status, result.status)


@case("checkerboard of reflectance 0 and 1", "series and elimination agree within 1e-9, energy balances", GROUP)
def checkerboard() -> Got:
    """Half of the patches keep nothing, the other half lose nothing."""
    patches, factors = conserved("furnace", 600)
    board = (np.floor(10 * patches.centroid + 1e-9).astype(int).sum(axis=1) % 2)[:, None].astype(float)
    T = operator(factors, reflectance=board)
    emission = lamp(len(patches))
    series = rad.Neumann(rtol=1e-12, maxiter=10_000).solve(T, emission).radiosity
    direct = rad.Direct().solve(T, emission).radiosity
    good, words = within(series, direct, 1e-9)
    defect = energy_defect(T, emission, direct)
    both = 0.2 < board.mean() < 0.8
    return truth(
        good and both and defect <= 1e-12, f"{words}; balance off by {defect:.2g}; {board.mean():.0%} are white"
    )


@case("black walls", "B = E to the last bit, with every solver", GROUP)
def black() -> Got:
    """Nothing to bounce."""
    patches, factors = conserved("red_rug", 800)
    T = operator(factors, reflectance=np.zeros_like(patches.reflectance))
    found = {type(solver).__name__: solver.solve(T, patches.emission).radiosity for solver in _solvers()}
    wrong = [name for name, light in found.items() if not np.array_equal(light, patches.emission)]
    return truth(not wrong, f"wrong: {', '.join(wrong)}" if wrong else f"the same from {', '.join(found)}")


@case("a scene without light", "warns, then gives black", GROUP)
def unlit() -> Got:
    """A fair answer, but seldom what was wanted."""
    scene = rad.scenes.furnace(emission=0.0)
    good, words = warns(rad.errors.UnlitSceneWarning, lambda: _small(scene), "--lamp")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        dark = not _small(scene).radiosity.any()
    return truth(good and dark, words)


@case("ρ = 1 everywhere, closed and lit", "NoSteadyState with the watts and the remedy", GROUP)
def closed_mirror() -> Got:
    """Light that nobody takes grows for ever."""
    return refuses(rad.errors.NoSteadyState, lambda: _small(rad.scenes.furnace(reflectance=1.0)), "6 W", "absorptance")


@case("ρ = float32(1 - 1e-8)", "NoSteadyState: it is 1", GROUP)
def rounded_to_one() -> Got:
    """What rounding makes of a wall that absorbs a little."""
    rho = float(np.float32(1.0 - 1e-8))
    return refuses(rad.errors.NoSteadyState, lambda: _small(rad.scenes.furnace(reflectance=rho)), "float32")


@case("a room of ρ = 1 that no light reaches, beside a lit one", "black there, right here, and a note", GROUP)
def dark_mirror() -> Got:
    """Separate enclosures do not spoil each other."""
    factors = rad.FormFactors.from_matrix(np.kron(np.eye(2), [[0.0, 1.0], [1.0, 0.0]]), np.ones(4))
    T = operator(factors, reflectance=[0.5, 0.5, 1.0, 1.0])
    result = rad.Neumann(rtol=1e-13).solve(T, [1.0, 1.0, 0.0, 0.0])
    good, words = within(result.radiosity, [2.0, 2.0, 0.0, 0.0], 1e-12)
    return truth(good and "given 0" in result.status, f"{words}; {result.status}")


@case("ρ = 1 with a way out to the sky", "what is emitted escapes, within 1e-9", GROUP)
def leaky_mirror() -> Got:
    """Two mirrors face to face: all light ends in the sky, after many bounces."""
    scene = rad.scenes.parallel_plates(reflectance=1.0, distance=0.1)
    patches = rad.subdivide(scene, patch_count=128)
    factors = rad.form_factors(patches, rad.Analytic(), dtype=np.float64)
    T = rad.TransportOperator(factors, patches)
    found = rad.Direct().solve(T, patches.emission).radiosity
    return within(T.power(factors.to_sky[:, None] * found), T.power(patches.emission), 1e-9)


@case("one channel of ρ = 1 among three", "NoSteadyState names the channel", GROUP)
def colours() -> Got:
    """Red would go on for ever; green and blue would not."""
    scene = rad.scenes.furnace(reflectance=[0.5, 1.0, 0.5])
    return refuses(rad.errors.NoSteadyState, lambda: _small(scene), "channel 1")


def _small(scene: rad.Scene) -> rad.Solution:
    return rad.solve(scene, patch_count=96, estimator=rad.MonteCarlo(64))


def _solvers() -> list[rad.Neumann | rad.GaussSeidel | rad.Shooting | rad.ConjugateGradient | rad.Direct]:
    return [rad.Neumann(), rad.GaussSeidel(), rad.Shooting(), rad.ConjugateGradient(), rad.Direct()]
