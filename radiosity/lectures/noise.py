"""Path tracing and 1/√N: noise that fades beside the solved answer; random against low-discrepancy.

A lecture is this file: copy it, change words, add a `Step`, and run it with ``radiosity lecture FILE.py``.
"""

from functools import cache
from typing import Any

import numpy as np

import radiosity as rad
from radiosity.lectures import Lecture, Step, legend, on, plot, with_orders

PATHS = (4, 16, 64, 256)
RAYS = (16, 32, 64, 128, 256, 512)
MANY_RAYS = 8_192
BOUNCES = 6


def solve(patch_count: int = 1_200) -> dict[str, rad.Solution]:
    """The Cornell box solved, and walked by more and more random paths per patch."""
    box = rad.solve(
        rad.scenes.cornell_box(), patch_count=patch_count, estimator=rad.MonteCarlo(rays=2048), bounces=BOUNCES
    )
    walked = {}
    for paths in PATHS:
        light = rad.PathTracer(paths=paths, seed=paths, next_event=True, bounces=BOUNCES).solve(box.patches)
        reflected = np.stack([light.orders[0], light.orders[1:].sum(axis=0)])
        walked[f"{paths} paths"] = with_orders(box, reflected, f"{paths} random paths per patch")
    return {"solved": box, **walked}


def error(box: rad.Solution, radiosity: np.ndarray) -> float:
    """Area-weighted relative L2 error of the reflected light."""
    truth, other = (light - box.emission for light in (box.radiosity, radiosity))
    area = box.patches.area[:, None]
    return float(np.sqrt(np.sum(area * (other - truth) ** 2) / np.sum(area * truth**2)))


def spread(box: rad.Solution, radiosity: np.ndarray, surface: str) -> float:
    """The same on one surface."""
    there = on(box, surface)
    area, truth = box.patches.area[there, None], box.radiosity[there]
    return float(np.sqrt(np.sum(area * (radiosity[there] - truth) ** 2) / np.sum(area * truth**2)))


def errors(solved: dict[str, rad.Solution]) -> np.ndarray:
    """Of each number of paths."""
    return np.array([error(solved["solved"], solved[f"{paths} paths"].radiosity) for paths in PATHS])


def slope(counts: Any, values: Any) -> float:
    """Exponent of a power law through points."""
    return float(np.polyfit(np.log(counts), np.log(values), 1)[0])


def path_plot(solved: dict[str, rad.Solution]) -> Any:
    """Error against paths, on 1/√N."""
    found = errors(solved)
    figure, axes = plot("random paths per patch, N", "error of the reflected light", log="xy")
    axes.plot(PATHS, found, "o-", label="path tracing")
    axes.set_xticks(PATHS, [str(paths) for paths in PATHS])
    axes.plot(PATHS, found[0] * np.sqrt(PATHS[0] / np.array(PATHS)), "--", color="#9aa3ae", label="1 / √N")
    legend(axes, "lower left")
    return figure


@cache
def sampled() -> dict[str, np.ndarray]:
    """Error of the light of four bounces for form factors by random and by Sobol rays, without help for the lamp."""
    patches = rad.subdivide(rad.scenes.cornell_box(), patch_count=400)

    def light(**rays: Any) -> np.ndarray:
        factors = rad.form_factors(patches, rad.MonteCarlo(light_rays=0, **rays))
        return rad.TransportOperator(factors, patches).orders(patches.emission, count=4)[1:].sum(axis=0)

    def size(field: np.ndarray) -> float:
        return float(np.sqrt(np.sum(patches.area[:, None] * field**2)))

    truth = light(rays=MANY_RAYS)
    kinds = ("random", "sobol")
    return {
        kind: np.array([size(light(rays=rays, sampling=kind, seed=1) - truth) / size(truth) for rays in RAYS])
        for kind in kinds
    }


def sampling_plot(_solved: dict[str, rad.Solution]) -> Any:
    """Random against low-discrepancy rays."""
    figure, axes = plot("rays per patch, N", "error of the light, bounces 1 to 4", log="xy")
    for sampling, values in sampled().items():
        name = "random" if sampling == "random" else "low-discrepancy (Sobol)"
        axes.plot(RAYS, values, "o-", label=name)
    axes.set_xticks(RAYS, [str(rays) for rays in RAYS])
    legend(axes, "lower left")
    return figure


def numbers(solved: dict[str, rad.Solution]) -> dict[str, Any]:
    """Errors and the exponents of their fall."""
    box = solved["solved"]
    found = errors(solved)
    rays = sampled()
    few = solved["4 paths"].radiosity
    grain = {name: spread(box, few, name) for name in ("floor", "ceiling")}
    return {
        "patches": len(box.patches),
        "first": found[0],
        "second": found[1],
        "last": found[-1],
        "floor": grain["floor"],
        "ceiling": grain["ceiling"],
        "slope": -slope(PATHS, found),
        "one_percent": PATHS[-1] * (found[-1] / 0.01) ** 2,
        "random": rays["random"][-1],
        "sobol": rays["sobol"][-1],
        "random_slope": -slope(RAYS, rays["random"]),
        "sobol_slope": -slope(RAYS, rays["sobol"]),
        "times": (rays["random"][-1] / rays["sobol"][-1]) ** (1 / max(0.5, -slope(RAYS, rays["random"]))),
        "bounces": BOUNCES,
    }


LECTURE = Lecture(
    name="noise",
    title="Path tracing and 1/√N",
    solve=solve,
    numbers=numbers,
    steps=(
        Step(
            title="Ask one path at a time",
            text="""
                Instead of solving for all light at once one can ask at random: from a patch, follow a ray; where it
                lands, follow another; at each, look at a random point of the lamp, and note what its light is worth
                after all the paint on the way. The mean over many paths is the answer, without any form factor.

                Left: 4 paths for each of the {patches} patches, {bounces} bounces long. Right: the solved answer.
            """,
            show={"beside": "4 paths", "order": 6, "titles": ("4 paths per patch", "solved")},
            question="Floor or ceiling: where is there more noise, and why?",
            answer="""The ceiling: {ceiling:.0%} against {floor:.0%} on the floor. The floor sees the lamp itself, at
                every try. The ceiling gets all its light by detours, and each path takes another one.""",
            minutes=4,
        ),
        Step(
            title="Four times the work",
            text="""
                The error of the left picture is {first:.0%}, as a root mean square against the light. Now take 16
                paths instead of 4.
            """,
            show={"beside": "4 paths", "order": 6, "titles": ("4 paths per patch", "solved")},
            question="By how much will the error fall?",
            answer="""From {first:.0%} to {second:.0%}: about half. The spread of a mean of N independent numbers is
                1/√N of the spread of one.""",
            reveal={"beside": "16 paths", "titles": ("16 paths per patch", "solved")},
            minutes=3,
        ),
        Step(
            title="64, 256, …",
            text="""
                Each of these pictures costs four times the one before and looks twice as clean. The eye finds the
                last one almost good.
            """,
            show={"beside": "64 paths", "order": 6, "titles": ("64 paths per patch", "solved")},
            question="256 paths have an error of {last:.1%}. How many would give 1 %?",
            answer="""About {one_percent:,.0f}. The slope of the curve is −{slope:.2f}, and theory says −½: each
                further digit costs a hundred times the work.""",
            reveal={"beside": "256 paths", "figure": path_plot},
            minutes=4,
        ),
        Step(
            title="Noise, or blur",
            text="""
                256 paths beside the solved answer. Path tracing is wrong by noise and right on average, at any point
                and with any paint. Solving for patches has no noise; it is wrong by what varies inside a patch, and
                only knows matt paint. Two ways to be wrong, and one can tell them apart at a glance.
            """,
            show={"beside": "256 paths", "order": 6, "titles": ("256 paths per patch", "solved")},
            minutes=2,
        ),
        Step(
            title="Need random be random?",
            text="""
                The rays that sample form factors need not be independent. A low-discrepancy sequence fills the square
                evenly: no clumps, no gaps, each new point where there was none.
            """,
            show={"order": 6},
            question="With the same number of rays, can that change the slope of −½?",
            answer="""It does: the error falls as N to the −{sobol_slope:.2f} with Sobol's points and
                −{random_slope:.2f} with random ones. At 512 rays the errors are {sobol:.2%} and {random:.2%}: random
                rays would need about {times:.0f} times as many.""",
            reveal={"figure": sampling_plot},
            minutes=4,
        ),
        Step(
            title="What it is good for",
            text="""
                Random paths share no code with form factors and solver: if both agree within the noise, both are
                likely right. This program's tests do just that. And 1/√N is worth knowing by heart: it tells in
                advance what a clean picture costs.
            """,
            show={"order": 6, "smooth": True},
            minutes=1,
        ),
    ),
)
