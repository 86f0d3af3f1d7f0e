"""The red rug: lamp → rug → wall, and a ceiling that only the rug lights red.

A lecture is this file: copy it, change words, add a `Step`, and run it with ``radiosity lecture FILE.py``.
"""

from typing import Any

import numpy as np

import radiosity as rad
from radiosity.lectures import Lecture, Step, bounces, mean, on, plot
from radiosity.lectures.plots import legend


def solve(patch_count: int = 5_000) -> dict[str, rad.Solution]:
    """The room with its red rug, and the same room with a rug as white as the walls."""
    red = rad.solve(rad.scenes.red_rug(), patch_count=patch_count, estimator=rad.MonteCarlo(rays=1024), bounces=12)
    return {"red": red, "white": red.relight(reflectance={"rug": [0.8] * 3})}


def redness(light: np.ndarray) -> np.ndarray:
    """Red over blue."""
    return light[..., 0] / light[..., 2]


def by_order(solved: dict[str, rad.Solution]) -> Any:
    """How red the light of each bounce is, against the lamp's."""
    room = solved["red"]
    figure, axes = plot("bounce k", "red / blue of this bounce, of the lamp's", log="y")
    lamp = redness(mean(room, bounces(room)[0], "lamp"))
    for name, label in (("rug", "rug"), ("ceiling", "ceiling"), ("back_wall", "back wall")):
        light = np.array([mean(room, order, name) for order in bounces(room)])
        lit = light[:, 2] > 0
        axes.plot(np.flatnonzero(lit)[:9], redness(light[lit])[:9] / lamp, "o-", label=label)
    axes.axhline(1.0, color="#9aa3ae", linewidth=1, linestyle="--")
    axes.set_xticks(range(9))
    legend(axes, "upper left")
    return figure


def numbers(solved: dict[str, rad.Solution]) -> dict[str, Any]:
    """Who lights whom, and how red."""
    room, white = solved["red"], solved["white"]
    T = rad.TransportOperator(room.factors, room.patches)
    lamp = redness(mean(room, bounces(room)[0], "lamp"))
    from_rug = T @ np.where(on(room, "rug")[:, None], bounces(room)[1], 0.0)
    rest = ("floor", "ceiling", "back_wall", "front_wall", "left_wall", "right_wall")
    ceiling, ceiling_white = (mean(s, s.radiosity, "ceiling") for s in (room, white))
    return {
        "direct_ceiling": bounces(room)[1][on(room, "ceiling")].max(),
        "wall_1": redness(mean(room, bounces(room)[1], "back_wall")) / lamp,
        "ceiling_2": redness(mean(room, bounces(room)[2], "ceiling")) / lamp,
        "wall_2": redness(mean(room, bounces(room)[2], "back_wall")) / lamp,
        "to_ceiling": mean(room, from_rug, "ceiling")[0],
        "to_wall": mean(room, from_rug, "back_wall")[0],
        "rug_red": mean(room, from_rug, "ceiling")[0] / mean(room, bounces(room)[2], "ceiling")[0],
        "rug_blue": mean(room, from_rug, "ceiling")[2] / mean(room, bounces(room)[2], "ceiling")[2],
        "rho_red": mean(room, room.patches.reflectance, "rug")[0],
        "rho_blue": mean(room, room.patches.reflectance, "rug")[2],
        "sum_ceiling": redness(ceiling) / lamp,
        "sum_wall": redness(mean(room, room.radiosity, "back_wall")) / lamp,
        "white_ceiling": redness(ceiling_white) / lamp,
        "brighter_red": ceiling_white[0] / ceiling[0] - 1,
        "brighter_blue": ceiling_white[2] / ceiling[2] - 1,
        "everywhere": mean(white, white.radiosity, *rest).sum() / mean(room, room.radiosity, *rest).sum() - 1,
    }


LECTURE = Lecture(
    name="rug",
    title="The red rug",
    solve=solve,
    numbers=numbers,
    steps=(
        Step(
            title="A white room with a red rug",
            text="""
                White walls, a white ceiling with a lamp in it, a wooden floor, and on it a red rug. The rug reflects
                {rho_red:.0%} of red light and {rho_blue:.0%} of blue.
            """,
            show={"scene": "red", "order": 0},
            question="In the finished picture, which white surface will be the reddest: walls or ceiling?",
            answer="""Keep your answer. We get there bounce by bounce.""",
            minutes=2,
        ),
        Step(
            title="Lamp → rug",
            text="""
                The first bounce. The rug is lit and red, but the walls know nothing of it: their light comes straight
                from the lamp, red / blue {wall_1:.2f} times the lamp's own. The ceiling is black, {direct_ceiling:g}
                W/m² at its brightest patch: the lamp lies in it and shines away.
            """,
            show={"scene": "red", "order": 1},
            minutes=2,
        ),
        Step(
            title="Lamp → rug → wall",
            text="""
                For the second bounce, everything that is lit now is a lamp. The rug is a large red one, on the floor,
                facing up.
            """,
            show={"scene": "red", "order": 1},
            question="Where does the red arrive, and where most?",
            answer="""On walls and ceiling, most on the ceiling, which the rug faces: the rug lights it with
                {to_ceiling:.2f} W/m² of red, the back wall with {to_wall:.2f}. Of the red light that the ceiling has
                now, {rug_red:.0%} comes from the rug; of the blue, {rug_blue:.0%}.""",
            reveal={"order": 2},
            minutes=4,
        ),
        Step(
            title="The ceiling has no other light",
            text="""
                Look at the sum on the right. All the ceiling's light is borrowed, so it shows the colour of the room
                it looks into better than any other surface: after all bounces, red / blue is {sum_ceiling:.2f} times
                the lamp's on the ceiling and {sum_wall:.2f} times on the back wall, which has the lamp's own light
                too.

                Photographers know this: a bounced flash takes the colour of the ceiling, and a portrait on a lawn has
                a green chin.
            """,
            show={"scene": "red", "order": 2, "smooth": True},
            minutes=2,
        ),
        Step(
            title="Colour by bounce",
            text="""
                Colours multiply. Light that met the rug twice has lost its blue twice; light that never met it stays
                as it was. With every bounce more of the light has been there.
            """,
            show={"scene": "red", "order": 3, "normalised": True},
            question="Does the light get redder with every bounce, without end?",
            answer="""Yes, but what is left of it fades faster than it reddens. From some bounce on each term has the
                same shape and is the one before times a number, one for each channel: the dominant eigenvalue of T,
                largest in red. So red / blue grows by the same factor each time: the straight ends of the curves.""",
            reveal={"figure": by_order},
            minutes=4,
        ),
        Step(
            title="Paint the rug white",
            text="""
                Nothing has moved, so the form factors are the same; only ρ of the rug changes, and the light is
                solved again in a moment. Right: a white rug. Left: the red one, on the same exposure.
            """,
            show={"scene": "white", "beside": "red", "order": 12, "titles": ("red rug", "white rug")},
            question="By how much does the ceiling get brighter, in red and in blue?",
            answer="""By {brighter_red:.0%} in red and {brighter_blue:.0%} in blue. The rug's paint changes everything
                that it never touches: the rest of the room sends out {everywhere:.0%} more light. The ceiling, red /
                blue {sum_ceiling:.2f} times the lamp's before, is at {white_ceiling:.2f} now: the wood is left.""",
            minutes=4,
        ),
        Step(
            title="All of it",
            text="""
                The sum of all bounces. A picture with direct light only has a red rug, grey walls and a black
                ceiling; "ambient light" would make the ceiling grey. The pink is what the equation adds.
            """,
            show={"scene": "red", "order": 12, "smooth": True},
            minutes=1,
        ),
    ),
)
