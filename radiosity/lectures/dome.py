"""Lambert under a uniform dome: irradiance is π Lᵢ, and Lₒ = ρ Lᵢ. And when it is not.

A lecture is this file: copy it, change words, add a `Step`, and run it with ``radiosity lecture FILE.py``.
"""

from typing import Any

import numpy as np

import radiosity as rad
from radiosity.lectures import Lecture, Step, legend, mean, on, plot

SIDE = rad.Camera("side", (6.4, 4.4, 10.6), (1.9, 0.6, 2.0), fov=34.0)


def solve(patch_count: int = 4_000) -> dict[str, rad.Solution]:
    """A grey and a white ball under the same sky, and a white floor beside a red wall."""
    subdivisions = 3 if patch_count >= 1_000 else 2
    balls = {
        name: rad.solve(rad.scenes.uniform_dome(rho, 1.0, subdivisions), patch_size=2.0, bounces=2)
        for name, rho in (("grey", 0.5), ("white", 1.0))
    }
    floor = rad.solve(rad.scenes.open_rug(), patch_count=patch_count, estimator=rad.MonteCarlo(rays=1024), bounces=4)
    return {**balls, "floor": floor}


def beside_the_wall(floor: rad.Solution) -> tuple[np.ndarray, np.ndarray]:
    """Distance from the wall, m, and L_o / (ρ L_i) with L_i the sky's, per channel, along the middle of the floor."""
    patches = floor.patches
    row = on(floor, "floor") & (np.abs(patches.centroid[:, 2] - 2.0) < 0.5)
    share = floor.radiance[row] / (patches.reflectance[row] * patches.sky)
    distance = patches.centroid[row, 0]
    at = np.unique(np.round(distance, 6))
    return at, np.array([share[np.isclose(distance, x)].mean(axis=0) for x in at])


def wall_plot(solved: dict[str, rad.Solution]) -> Any:
    """How far L_o = ρ L_i is off on the floor."""
    distance, share = beside_the_wall(solved["floor"])
    figure, axes = plot("distance from the red wall, m", r"$L_o\,/\,(\rho\,L_{sky})$")
    for channel, colour, name in ((0, "#e4572e", "red"), (1, "#5fb346", "green"), (2, "#5b8def", "blue")):
        axes.plot(distance, share[:, channel], color=colour, label=name, linewidth=2)
    axes.axhline(1.0, color="#9aa3ae", linewidth=1, linestyle="--")
    axes.annotate("ρ times the sky", (2.3, 1.01), color="#9aa3ae", fontsize=11)
    axes.set_ylim(0, 1.12)
    legend(axes, "lower right")
    return figure


def numbers(solved: dict[str, rad.Solution]) -> dict[str, Any]:
    """What the solver found on the balls and on the floor."""
    grey, white, floor = solved["grey"], solved["white"], solved["floor"]
    _, share = beside_the_wall(floor)
    return {
        "patches": len(grey.patches),
        "H": mean(grey, grey.irradiance)[0],
        "B": mean(grey, grey.radiosity)[0],
        "L": mean(grey, grey.radiance)[0],
        "darkest": grey.radiance.min(),
        "brightest": grey.radiance.max(),
        "white_L": mean(white, white.radiance)[0],
        "near_red": share[0, 0],
        "near_blue": share[0, 2],
        "far_red": share[-1, 0],
        "far_blue": share[-1, 2],
    }


LECTURE = Lecture(
    name="dome",
    title="Lambert under a uniform dome",
    solve=solve,
    numbers=numbers,
    steps=(
        Step(
            title="A ball under an even sky",
            text="""
                A matt ball hangs in an overcast that is the same all around, also below: from every direction comes
                the radiance Lᵢ = 1 W/(m² sr). The paint has ρ = 0.5. No lamp, no shadow.
            """,
            show={"scene": "grey", "order": 0},
            question="What will the ball look like? Where is it brightest, where darkest?",
            answer="""A flat disc. Each of its {patches} patches sees half of the same sky and nothing of the ball, so
                all are alike: radiance {darkest:.4f} to {brightest:.4f}. Without differences in the light there is no
                shape to see.""",
            reveal={"order": 1},
            minutes=3,
        ),
        Step(
            title="Irradiance: π Lᵢ, not 2π Lᵢ",
            text="""
                What arrives on a square metre? The hemisphere is 2π sr wide, but light that grazes counts by cos θ:

                H = ∫ Lᵢ cos θ dω = Lᵢ · 2π · ∫ cos θ sin θ dθ = Lᵢ · 2π · ½ = π Lᵢ

                The cosine takes exactly half. The solver, which knows nothing of this integral, has H = {H:.4f} W/m².
            """,
            show={"scene": "grey", "order": 1},
            minutes=3,
        ),
        Step(
            title="What leaves",
            text="""
                Of the irradiance the paint keeps half. The albedo times the irradiance is the exitance: B = ρ H =
                {B:.4f} W/m². It is a power, over all directions together.
            """,
            show={"scene": "grey", "order": 1},
            question="H is 3.14 W/m², ρ is 0.5. Which radiance does a camera see: 1.57, 0.5, or 0.16?",
            answer="""{L:.4f} W/(m² sr). Exitance is π times radiance for a matt surface, so Lₒ = B/π = ρ H/π = ρ Lᵢ.
                "Albedo times irradiance" is 1.57, and off by π: the most frequent mistake in first renderers.""",
            minutes=4,
        ),
        Step(
            title="ρ → 1: the furnace test",
            text="""
                Paint the ball perfectly white. Then Lₒ = Lᵢ = {white_L:.4f}: the ball is exactly as bright as the sky
                behind it, and if the sky were drawn it could not be seen at all.

                People who write renderers use this as a test. A ball that stays visible gains or loses energy
                somewhere: a missing cosine, a π too many, a wrong sampling density.
            """,
            show={"scene": "white", "order": 1},
            minutes=3,
        ),
        Step(
            title="But only under an even sky",
            text="""
                A white floor under the same kind of sky, with a red wall at its side. The wall takes half the sky
                away from the floor at its foot, and puts red light in its place.
            """,
            show={"scene": "floor", "order": 4, "camera": SIDE},
            question="Does Lₒ = ρ Lᵢ still hold near the wall, with Lᵢ the sky's radiance?",
            answer="""No. At the foot of the wall the floor has {near_red:.2f} of ρ L(sky) in red and {near_blue:.2f}
                in blue; far away {far_red:.2f} and {far_blue:.2f}. Lᵢ is not one number any more.""",
            reveal={"figure": wall_plot},
            minutes=4,
        ),
        Step(
            title="What remains true",
            text="""
                Always: B = ρ H, and Lₒ = B/π, for matt surfaces.

                Always: Lₒ = ρ × the mean of Lᵢ over the hemisphere, if the mean is weighted by cos θ. Form factors
                are these weights.

                Only for uniform Lᵢ: Lₒ = ρ Lᵢ. It is a test of a program, not a law to compute rooms with.
            """,
            show={"scene": "floor", "order": 1, "camera": SIDE},
            minutes=2,
        ),
    ),
)
