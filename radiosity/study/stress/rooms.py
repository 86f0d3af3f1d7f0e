"""Rooms that light leaves slowly: pinholes, corridors, and light over sixty powers of ten."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import numpy as np

import radiosity as rad

from .case import Case, Got, case, refuses, truth, within
from .systems import chain, conserved, energy_defect, lamp, operator

GROUP = "rooms"


def cases() -> Iterator[Case]:
    """All of this file."""
    for coupling in (1e-2, 1e-6, 1e-9):
        for alpha in (1e-1, 1e-12):
            name = f"two rooms, coupled by {coupling:g}, α = {alpha:g}"
            yield Case(name, "as elimination within 1e-9, few products", partial(_pinhole, coupling, alpha), GROUP)
    for rooms in (5, 30):
        name = f"a corridor of {rooms} rooms, α = 0.5"
        yield Case(name, "light of the last room as elimination's, within 1e-3", partial(_corridor, rooms), GROUP)
    yield from (scene_pinhole, scene_corridor, levels, thousands_of_watts, huge_and_tiny, overflow, underflow)


def _pinhole(coupling: float, alpha: float) -> Got:
    T, emission = operator(chain(2, 150, coupling), absorptance=alpha), lamp(300)
    result = rad.ConjugateGradient(rtol=1e-12).solve(T, emission)
    good, words = within(result.radiosity, rad.Direct().solve(T, emission).radiosity, 1e-9)
    products = result.statistics["solver/products"]
    return truth(good and result.converged and products <= 60, f"{words}, {products} products")


def _corridor(rooms: int) -> Got:
    T, emission = operator(chain(rooms, 20, 1e-2), absorptance=0.5), lamp(20 * rooms)
    true = rad.Direct().solve(T, emission).radiosity
    found = rad.ConjugateGradient(rtol=1e-8).solve(T, emission).radiosity
    good, words = within(found, true, 1e-3)
    return truth(good, f"{words}; the last room has {true[-1, 0]:.1e} W/m²")


@case("two_rooms with a hole of 10 cm, α = 1e-6", "as much absorbed as emitted, within 1e-9", GROUP)
def scene_pinhole() -> Got:
    """From a scene: rays find the hole, or the rooms are separate; energy balances either way."""
    patches, factors = conserved("two_rooms", 1000, 1024, door=0.1)
    T = operator(factors, absorptance=1e-6)
    emission = patches.emission[:, :1]
    result = rad.ConjugateGradient(rtol=1e-12).solve(T, emission)
    defect = energy_defect(T, emission, result.radiosity)
    rooms = result.statistics["solver/rooms"]
    return truth(result.converged and defect <= 1e-9, f"balance off by {defect:.2g}, {rooms} rooms found")


@case("corridor(rooms=6), from lamp to end", "series, sweeps and elimination agree within 1e-6", GROUP)
def scene_corridor() -> Got:
    """Light of the last room is a thousandth of the first one's."""
    patches, factors = conserved("corridor", 1200, rooms=6)
    T = rad.TransportOperator(factors, patches)
    true = rad.Direct().solve(T, patches.emission).radiosity
    solvers = (rad.Neumann(rtol=1e-13, maxiter=10_000, keep_bytes=0), rad.GaussSeidel(rtol=1e-13, maxiter=10_000))
    worst = [within(solver.solve(T, patches.emission).radiosity, true, 1e-6) for solver in solvers]
    return truth(all(got.good for got in worst), "; ".join(got.words for got in worst))


@case("two rooms at α = 1e-12 through a door", "all walls equally bright, within 1e-9", GROUP)
def levels() -> Got:
    """Where nothing is absorbed to speak of, a door evens everything out: B = Φ / (α A)."""
    patches, factors = conserved("two_rooms", 1000, 1024, door=1.0)
    T = operator(factors, absorptance=1e-12)
    emission = patches.emission[:, :1]
    found = rad.ConjugateGradient(rtol=1e-12).solve(T, emission).radiosity
    return within(found, T.power(emission) / (1e-12 * T.area.sum()), 1e-9)


@case("a lamp of 1e30 W/m² and one of 1e-30 in the next, separate room", "both right within 1e-6", GROUP)
def huge_and_tiny() -> Got:
    """A tolerance for both together would be met by the one alone."""
    factors = rad.FormFactors.from_matrix(np.kron(np.eye(2), [[0.0, 1.0], [1.0, 0.0]]), np.ones(4))
    T = operator(factors, reflectance=0.5)
    emission = np.array([1e30, 1e30, 1e-30, 1e-30])
    found = [solver.solve(T, emission).radiosity for solver in (rad.Neumann(), rad.ConjugateGradient(), rad.Shooting())]
    return within(np.array(found), 2.0 * emission, 2e-6)


@case("the same light at 1e30 and at 1e-30 of its strength", "the same but for the factor, within 1e-12", GROUP)
def thousands_of_watts() -> Got:
    """Nothing in the package knows how bright a scene is."""
    patches, factors = conserved("red_rug", 800)
    T = rad.TransportOperator(factors, patches)
    one, great, small = (rad.Neumann().solve(T, scale * patches.emission).radiosity for scale in (1.0, 1e30, 1e-30))
    return within(np.array([great * 1e-30, small * 1e30]), one, 1e-12)


@case("1e300 W/m² at α = 1e-12", "SolverError: more than a float64 holds", GROUP)
def overflow() -> Got:
    """Infinity is no answer."""
    _, factors = conserved("furnace", 600)
    T = operator(factors, absorptance=1e-12)
    return refuses(rad.errors.SolverError, lambda: rad.ConjugateGradient().solve(T, np.full((600, 1), 1e300)), "unit")


@case("1e-290 W/m²", "the furnace's answer within 1e-9", GROUP)
def underflow() -> Got:
    """Squares of such light are zero; its norms must not be."""
    _, factors = conserved("furnace", 600)
    T = operator(factors, reflectance=0.5)
    found = rad.Neumann(rtol=1e-12).solve(T, np.full((600, 1), 1e-290)).radiosity
    return within(found * 1e290, 2.0, 1e-9)
