"""Two rooms and a pinhole: light that arrives late, slow modes, and solvers that race, by products and by the clock.

A lecture is this file: copy it, change words, add a `Step`, and run it with ``radiosity lecture FILE.py``.
"""

from dataclasses import replace
from functools import cache
from itertools import islice
from time import perf_counter
from typing import Any, NamedTuple

import numpy as np

import radiosity as rad
from radiosity.lectures import Lecture, Step, bounces, legend, plot, with_orders

HOLE = 0.3  # m, the side of the square hole
BOUNCES = 60
GOAL = 1e-6  # error at which the race ends
SOLVERS = (rad.Neumann, rad.Shooting, rad.GaussSeidel, rad.ConjugateGradient)
SEEN = rad.Camera("both rooms", (4.0, 9.0, 13.5), (4.0, 0.8, 2.0), fov=33.0)


def solve(patch_count: int = 2_500) -> dict[str, rad.Solution]:
    """Two rooms joined by a door, and by a small hole, with walls of ρ = 0.9."""

    def rooms(door: Any) -> rad.Solution:
        scene = rad.scenes.two_rooms(door, reflectance=0.9)
        raw = rad.solve(scene, patch_count=patch_count, estimator=rad.MonteCarlo(rays=1024), bounces=0)
        closed = replace(raw, factors=raw.factors.conserved())  # no power is lost or won between patches
        T = rad.TransportOperator(closed.factors, closed.patches)
        return with_orders(closed, T.orders(closed.emission, count=BOUNCES), f"{BOUNCES} bounces")

    return {"door": rooms((0.9, 2.0)), "hole": rooms(HOLE)}


def power(solution: rad.Solution) -> np.ndarray:
    """Power of each order in the first and in the second room, W, (2, K + 1)."""
    inside = solution.patches.centroid + 0.01 * solution.patches.normal  # the wall between belongs to the room it faces
    first = inside[:, 0] < 4.0
    watts = solution.patches.area * bounces(solution)[:, :, 0]
    return np.array([watts[:, first].sum(axis=1), watts[:, ~first].sum(axis=1)])


def room_plot(solved: dict[str, rad.Solution]) -> Any:
    """Power by bounce in both rooms."""
    figure, axes = plot("bounce k", "power of the bounce, W", log="y")
    for name, style in (("door", "--"), ("hole", "-")):
        for room, (watts, colour) in enumerate(zip(power(solved[name]), ("#5b8def", "#ff7043"), strict=True)):
            lit = np.flatnonzero(watts > 0)
            axes.plot(lit, watts[lit], style, color=colour, label=f"room {room + 1}, {name}", linewidth=1.8)
    legend(axes, "lower left")
    return figure


class Run(NamedTuple):
    """Products with T, seconds, and error, after each step of a solver."""

    products: np.ndarray
    seconds: np.ndarray
    error: np.ndarray


@cache
def races(solution: rad.Solution) -> dict[str, Run]:
    """Every solver from the lamp to the goal, on the same conserved factors."""
    T, lamp = rad.TransportOperator(solution.factors, solution.patches), solution.emission
    truth = rad.ConjugateGradient(rtol=1e-12).solve(T, lamp).radiosity
    return {solver.__name__: race(solver(rtol=0.0), T, lamp, truth) for solver in SOLVERS}


def race(solver: Any, T: rad.TransportOperator, lamp: np.ndarray, truth: np.ndarray) -> Run:
    """One solver. A product reads all of T once; as many shots as there are patches count as one, too."""
    list(islice(solver.iterate(T, lamp), 2))  # compiles its loops
    problem = solver.pose(T, lamp, None, None)
    steps = solver.steps(problem)
    seconds = 0.0
    points: list[tuple[float, float, float]] = []
    while not points or points[-1][2] > GOAL:
        began = perf_counter()
        step = next(steps)
        seconds += perf_counter() - began
        done = problem.statistics
        products = done.get("solver/products", 0) + done.get("solver/shots", 0) / len(lamp)
        error = T.norm(step.radiosity - truth)[0] / T.norm(truth - lamp)[0]
        points.append((products, seconds, error))
    return Run(*np.array(points).T)


def race_plot(solved: dict[str, rad.Solution], clock: bool = False) -> Any:
    """The race, by products or by the clock."""
    figure, axes = plot("seconds on this machine" if clock else "products with T", "error of the light", log="xy")
    for name, run in races(solved["hole"]).items():
        axes.plot(run.seconds if clock else run.products, run.error, ".-", label=name, linewidth=1.6, markersize=4)
    axes.axhline(GOAL, color="#9aa3ae", linewidth=1, linestyle="--")
    axes.set_ylim(GOAL / 1e3, 3)
    legend(axes, "lower left")
    return figure


def numbers(solved: dict[str, rad.Solution]) -> dict[str, Any]:
    """When the light arrives, how slowly it goes, who wins."""
    door, hole = power(solved["door"]), power(solved["hole"])
    race = races(solved["hole"])
    total = hole.sum(axis=1)
    return {
        "patches": len(solved["hole"].patches),
        "peak_2": int(np.argmax(hole[1])),
        "peak_2_door": int(np.argmax(door[1])),
        "mean_1": hole[0] @ np.arange(BOUNCES + 1) / total[0],
        "mean_2": hole[1] @ np.arange(BOUNCES + 1) / total[1],
        "share_2": total[1] / total.sum(),
        "share_2_door": door[1].sum() / door.sum(),
        "late_1": hole[0, -1] / hole[0, -2],
        "late_2": hole[1, -1] / hole[1, -2],
        **{name: run.products[-1] for name, run in race.items()},
        "fewer": race["Neumann"].products[-1] / race["ConjugateGradient"].products[-1],
        "sooner": race["Neumann"].seconds[-1] / race["ConjugateGradient"].seconds[-1],
        "bounces": BOUNCES,
        "hole": HOLE,
    }


LECTURE = Lecture(
    name="pinhole",
    title="Two rooms and a pinhole",
    solve=solve,
    numbers=numbers,
    steps=(
        Step(
            title="One lamp, two rooms",
            text="""
                Two white rooms, ρ = 0.9, seen as a doll's house. The lamp is in the ceiling of the left one. In the
                wall between them is a door.
            """,
            show={"scene": "door", "order": 1, "camera": SEEN},
            question="After which bounce does the second room have most light?",
            answer="""A little later than the first: bounce {peak_2_door} is its brightest. Through the door it gets
                {share_2_door:.0%} of all the light that surfaces send out.""",
            reveal={"scene": "door", "order": 7},
            minutes=3,
        ),
        Step(
            title="Close the door, leave a hole",
            text="""
                Now only a hole of {hole:g} m square in the middle of the wall. A camera obscura, with a dull lamp
                instead of a landscape.
            """,
            show={"scene": "hole", "order": 1, "camera": SEEN},
            question="On the common exposure the second room stays dark. When is its brightest bounce now?",
            answer="""Bounce {peak_2}; the left picture shows it on its own exposure. Light fills the second room
                slowly and lingers: within {bounces} bounces the mean light there has bounced {mean_2:.1f} times, in
                the first room {mean_1:.1f} times.""",
            reveal={"order": 8, "normalised": True},
            minutes=4,
        ),
        Step(
            title="Slow modes",
            text="""
                Follow the power of each bounce in either room, for the door (dashed) and the hole (solid).
            """,
            show={"scene": "hole", "order": 20, "normalised": True, "camera": SEEN},
            question="In the second room light fades by less than ρ = 0.9 would say. How can that be?",
            answer="""It is still being filled. At bounce {bounces} the first room shrinks by {late_1:.3f} a bounce,
                the second by {late_2:.3f}. Only when both rooms hold the same light do both shrink by 0.9: that is
                the slowest mode of T. The next mode, one room against the other, has an eigenvalue almost as large,
                and the smaller the hole, the closer: it takes that long to settle.""",
            reveal={"figure": room_plot},
            minutes=5,
        ),
        Step(
            title="What a solver has to do",
            text="""
                A solver that passes light on bounce by bounce must wait until the slow modes have died out.
                Gauss-Seidel uses each new value at once. Conjugate gradients remember where they have been, and take
                all modes of equal eigenvalue in one step.
            """,
            show={"scene": "hole", "order": 60, "camera": SEEN},
            question="{patches} patches, error one millionth. How often does each have to read the whole matrix?",
            answer="""Neumann: {Neumann:.0f} products. Shooting: {Shooting:.0f}. Gauss-Seidel: {GaussSeidel:.0f}.
                Conjugate gradients: {ConjugateGradient:.0f}; they find the two rooms first, and take that mode out
                before they begin. Checking oneself is counted: half of the products of Shooting and Gauss-Seidel.""",
            reveal={"figure": race_plot},
            minutes=5,
        ),
        Step(
            title="By the clock",
            text="""
                Products are what the theory counts. A class waits for seconds, and not every product costs the same:
                a bounce can be shared out among all processors, a sweep or a shot has to wait for the one before.
            """,
            show={"scene": "hole", "order": 60, "camera": SEEN},
            question="Conjugate gradients need {fewer:.0f} times fewer products than Neumann. Are they as much sooner?",
            answer="""{sooner:.1f} times sooner, on the machine that wrote this. The order of the others may change:
                the same curves, against the clock.""",
            reveal={"figure": lambda solved: race_plot(solved, clock=True)},
            minutes=3,
        ),
        Step(
            title="Why it matters",
            text="""
                White rooms joined by small openings: museums, tunnels, light traps, integrating spheres, ovens. There
                the series needs hundreds of terms, a path tracer hundreds of segments a path, and "a few bounces are
                enough" is wrong by a factor. The second room has {share_2:.1%} of the light, nearly all of it late.
            """,
            show={"scene": "hole", "order": 60, "normalised": False, "camera": SEEN, "exposure": 2.0},
            minutes=2,
        ),
    ),
)
