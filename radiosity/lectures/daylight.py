"""A room lit by one window: the sky as the lamp, daylight factors, and what white walls are worth.

A lecture is this file: copy it, change words, add a `Step`, and run it with ``radiosity lecture FILE.py``.
"""

from typing import Any

import numpy as np

import radiosity as rad
from radiosity.lectures import Lecture, Step, bounces, legend, mean, nearest, on, plot

DESK = 0.85  # m above the floor
BY_THE_WINDOW, FAR = (0.6, 0.0, 2.0), (4.5, 0.0, 2.6)


def solve(patch_count: int = 4_000) -> dict[str, rad.Solution]:
    """The room, and the same room with dark walls."""
    room = rad.solve(rad.scenes.window_room(), patch_count=patch_count, estimator=rad.MonteCarlo(rays=1024), bounces=12)
    walls = ("ceiling", "back_wall", "front_wall", "left_wall", "right_wall")
    return {"white": room, "dark": room.relight(reflectance={wall: [0.2] * 3 for wall in walls})}


def desks(solution: rad.Solution) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Distance from the window, m; daylight factor on desks in the middle of the room, and without any bounce."""
    x = np.linspace(0.3, 4.7, 23)
    points = np.column_stack([x, np.full_like(x, DESK), np.full_like(x, 2.0)])
    outdoors = np.pi * solution.sky  # what a free horizontal plane under the whole sky would get
    arriving = solution.irradiance_at(points, (0.0, 1.0, 0.0), rays=4096)
    alone = solution.relight(reflectance=np.zeros_like(solution.patches.reflectance))
    direct = alone.irradiance_at(points, (0.0, 1.0, 0.0), rays=4096)
    return x, (arriving / outdoors).mean(axis=1), (direct / outdoors).mean(axis=1)


def desk_plot(solved: dict[str, rad.Solution]) -> Any:
    """Daylight factor against the distance from the window."""
    figure, axes = plot("distance from the window, m", "daylight factor on desks, %", log="y")
    x, white, direct = desks(solved["white"])
    axes.plot(x, 100 * white, "o-", markersize=4, label="white walls")
    axes.plot(x, 100 * desks(solved["dark"])[1], "o-", markersize=4, label="dark walls")
    axes.plot(x, 100 * direct, "--", color="#9aa3ae", label="the sky alone")
    legend(axes, "upper right")
    return figure


def numbers(solved: dict[str, rad.Solution]) -> dict[str, Any]:
    """What reaches the desks, by which way."""
    room, dark = solved["white"], solved["dark"]
    x, white_desk, direct = desks(room)
    _, dark_desk, _ = desks(dark)
    near, far = (nearest(room, place) for place in (BY_THE_WINDOW, FAR))
    back = x > 4.0
    return {
        "sky": room.sky[1],
        "near_direct": bounces(room)[1, near].sum() / room.radiosity[near].sum(),
        "far_direct": bounces(room)[1, far].sum() / room.radiosity[far].sum(),
        "ceiling_1": mean(room, bounces(room)[1], "ceiling").sum() / mean(room, room.radiosity, "ceiling").sum(),
        "near_desk": white_desk[np.argmin(np.abs(x - 1.0))],
        "far_desk": white_desk[back].mean(),
        "far_sky": direct[back].mean(),
        "gain": white_desk[back].mean() / direct[back].mean(),
        "dark_desk": dark_desk[back].mean(),
        "paint_gain": white_desk[back].mean() / dark_desk[back].mean(),
        "escaped": float(room.balance.to_sky.sum() / room.balance.put_in.sum()),
        "escaped_dark": float(dark.balance.to_sky.sum() / dark.balance.put_in.sum()),
        "chest": mean(room, room.radiosity, "chest")[0] / mean(room, room.radiosity, "chest")[2],
        "seen": room.factors.to_sky[near],
        "seen_far": room.factors.to_sky[far],
        "dark_patches": float(np.mean(bounces(room)[1][on(room, "left_wall")].sum(axis=1) == 0)),
    }


LECTURE = Lecture(
    name="daylight",
    title="A room lit by one window",
    solve=solve,
    numbers=numbers,
    steps=(
        Step(
            title="No lamp at all",
            text="""
                A room with one window, an orange chest, an overcast sky outside. Nothing in the room emits: order 0
                is black. The sky is not a surface; it is what a ray meets that meets nothing, with L = {sky:g} W/(m²
                sr) in green.
            """,
            show={"scene": "white", "order": 0},
            question="Which surfaces will the first bounce leave black?",
            answer="""Those that have no sky in their hemisphere: the whole wall in which the window is
                ({dark_patches:.0%} of its patches), and what hides behind the chest. The ceiling sees a little sky,
                low over the horizon.""",
            reveal={"order": 1},
            minutes=3,
        ),
        Step(
            title="How much sky does a spot see?",
            text="""
                A spot near the window sees {seen:.1%} sky, weighted by the cosine, a spot in the back {seen_far:.1%}.
                Left: its hemicube. The window is the dark opening; all else is room.
            """,
            show={"scene": "white", "order": 12, "pick": BY_THE_WINDOW, "left": "hemicube"},
            question="Near the window, {near_direct:.0%} of the light comes straight from the sky. And in the back?",
            answer="""{far_direct:.0%}. The back of a room is lit by its walls, and by bounces that have been there
                before. Light from a window does not reach far; light from walls does.""",
            reveal={"pick": FAR},
            minutes=4,
        ),
        Step(
            title="Who lights the ceiling?",
            text="""
                Of the ceiling's light {ceiling_1:.0%} comes straight from outside, from ground that is as bright as
                the sky in this scene: snow. The rest has met the room first, most of it the floor, the lamp of every
                room with a window; its colour is on the ceiling.
            """,
            show={"scene": "white", "order": 2},
            minutes=2,
        ),
        Step(
            title="The daylight factor",
            text="""
                Lighting people give the light on a desk as a share of what it would be outdoors under the same sky: H
                / (π L(sky)). Rules for offices ask for 2 % or so.
            """,
            show={"scene": "white", "order": 12},
            question="A metre from the window it is {near_desk:.1%}. And four metres from it?",
            answer="""{far_desk:.1%}, of which the sky alone gives {far_sky:.2%}: bounces bring {gain:.1f} times what
                one computes with direct light only.""",
            reveal={"figure": desk_plot},
            minutes=4,
        ),
        Step(
            title="What white paint is worth",
            text="""
                The same room with walls and ceiling of ρ = 0.2 at the left, of 0.8 at the right, on the same
                exposure.
            """,
            show={"scene": "white", "beside": "dark", "order": 12, "titles": ("dark walls", "white walls")},
            question="By how much does white paint brighten the desks in the back?",
            answer="""{paint_gain:.1f} times: {dark_desk:.1%} become {far_desk:.1%}. No lamp is as cheap. And
                {escaped:.0%} of the light that came in leaves by the window again; with dark walls
                {escaped_dark:.0%}.""",
            minutes=4,
        ),
        Step(
            title="Numbers instead of colours",
            text="""
                The same light as an engineer reads it, in false colour of W/m² with a scale. Two decades: the eye,
                which adapts, would not believe how steeply light falls off from a window.
            """,
            show={"scene": "white", "order": 12, "false_colour": True},
            minutes=2,
        ),
    ),
)
