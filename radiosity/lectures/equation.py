"""The rendering equation, term by term, at one spot of the Cornell box.

A lecture is this file: copy it, change words, add a `Step`, and run it with ``radiosity lecture FILE.py``.
"""

from typing import Any

import numpy as np

import radiosity as rad
from radiosity.lectures import Lecture, Step, bounces, mean, nearest, on, plot
from radiosity.viewer.dome import Dome

SPOT = (0.42, 0.0, 0.12)  # on the floor, towards the red wall
FRONT = rad.Camera("front", (0.0, 0.4, 6.0), (0.0, 0.0, 0.0), fov=30.0)
RED = 0  # channel


def solve(patch_count: int = 4_000) -> dict[str, rad.Solution]:
    """The box, and a ball that one lamp lights from the right."""
    box = rad.solve(rad.scenes.cornell_box(), patch_count=patch_count, estimator=rad.MonteCarlo(rays=1024), bounces=10)
    ball = rad.solve(rad.scenes.lit_sphere(subdivisions=4 if patch_count >= 2_000 else 3), patch_size=2.0, bounces=2)
    return {"box": box, "ball": ball}


def angles(ball: rad.Solution) -> tuple[np.ndarray, np.ndarray]:
    """Angle between normal and direction to the lamp, degrees, and brightness at equal distance, of the brightest."""
    there = on(ball, "ball")
    towards = mean(ball, ball.patches.centroid, "lamp") - ball.patches.centroid[there]
    distance = np.linalg.norm(towards, axis=1)
    cosine = np.einsum("nx,nx->n", towards, ball.patches.normal[there]) / distance
    light = ball.radiosity[there, 0] * distance**2
    return np.degrees(np.arccos(np.clip(cosine, -1, 1))), light / light.max()


def cosine_plot(solved: dict[str, rad.Solution]) -> Any:
    """Brightness of every patch of the ball against the angle, on Lambert's curve."""
    angle, light = angles(solved["ball"])
    figure, axes = plot("angle between normal and lamp, degrees", "brightness at equal distance")
    axes.plot(angle, light, ".", markersize=3, alpha=0.5, rasterized=True)
    theta = np.linspace(0, 90, 91)
    axes.plot(theta, np.cos(np.radians(theta)), linewidth=1.5)
    axes.annotate("cos θ", (68, 0.56), color="#ff7043", fontsize=14)
    axes.axvline(60, color="#9aa3ae", linewidth=0.8, linestyle="--")
    return figure


def numbers(solved: dict[str, rad.Solution]) -> dict[str, Any]:
    """The equation at the spot, in the red channel, and what the ball shows."""
    box = solved["box"]
    spot = nearest(box, SPOT)
    row = box.factors.row(spot)
    lamp = on(box, "lamp")
    angle, light = angles(solved["ball"])
    arriving = box.irradiance[spot, RED]
    return {
        "rho": box.patches.reflectance[spot, RED],
        "H": arriving,
        "B": box.radiosity[spot, RED],
        "product": box.patches.reflectance[spot, RED] * arriving,
        "L": box.radiance[spot, RED],
        "lamp_share": row[lamp].sum(),
        "lamp_part": row[lamp] @ box.radiosity[lamp, RED] / arriving,
        "row": row.sum(),
        "sky": box.factors.to_sky[spot],
        "closure": row.sum() + box.factors.to_sky[spot] + box.factors.to_backs[spot],
        "seen": int(np.count_nonzero(row)),
        "patches": len(box.patches),
        "at_60": light[np.abs(angle - 60) < 4].mean(),
        "first": bounces(box)[1, spot, RED],
        "direct": bounces(box)[1, spot, RED] / box.radiosity[spot, RED],
    }


LECTURE = Lecture(
    name="equation",
    title="The rendering equation, term by term",
    solve=solve,
    numbers=numbers,
    steps=(
        Step(
            title="How bright is this spot?",
            text="""
                Look at the outlined patch of the floor. The light that leaves it, in whatever direction one looks
                from, is

                Lₒ = Lₑ + ∫ ρ/π · Lᵢ · cos θ dω

                Five things stand there: what the spot emits, its paint, the light that arrives, the angle at which it
                arrives, and a sum over all directions. We take them one by one.
            """,
            show={"order": 3, "normalised": True, "pick": SPOT},
            minutes=3,
        ),
        Step(
            title="Lₑ: light of its own",
            text="""
                Nothing but the lamp shines by itself. For every other surface, and so for our spot, Lₑ is zero, and
                all that one sees of it is borrowed.
            """,
            show={"order": 0, "pick": SPOT},
            minutes=1,
        ),
        Step(
            title="Lᵢ: light from all around",
            text="""
                This is what the spot sees of the room: its hemisphere, projected onto half a cube and unfolded.
                Straight above is the middle, the horizon is the rim. Every point of this picture sends light: Lᵢ
                depends on the direction.
            """,
            show={"order": 10, "pick": SPOT, "left": "hemicube"},
            question="The lamp is a small part of the picture. How much of the light that arrives does it bring?",
            answer="""It fills {lamp_share:.1%} of the view (weighted as we shall see) and brings {lamp_part:.0%} of
                the red light. The rest comes from walls: they are large, and they are lit.""",
            reveal={"left": "hemisphere"},
            minutes=3,
        ),
        Step(
            title="cos θ: light that grazes",
            text="""
                Here one lamp lights a white ball. A beam that falls at a slant is spread over more surface, by 1 /
                cos θ, so each square metre gets cos θ of it. That is Lambert's law, and all the shape one sees in
                this picture.
            """,
            show={"scene": "ball", "order": 1, "camera": FRONT},
            question="Where the light comes in at 60° to the normal, how bright is the ball, of its brightest?",
            answer="""Half as bright: cos 60° = 0.5. The patches of the ball near 60° have {at_60:.2f} (at equal
                distance: they are a little farther away, too). At 90° it is zero: there is the edge between day and
                night, and it is soft.""",
            reveal={"figure": cosine_plot},
            minutes=4,
        ),
        Step(
            title="ρ / π: the paint",
            text="""
                Matt paint throws light back evenly to all sides, so its BRDF is one number. Why ρ/π and not ρ? Let
                the same light Lᵢ come from everywhere: then ∫ Lᵢ cos θ dω = π Lᵢ arrives. Of that the share ρ may
                leave, no more, and it leaves spread over the same hemisphere, which again costs a π.

                So keep two things apart. Irradiance H and exitance B are in W/m², and B = ρ H. Radiance, what an eye
                or a camera sees, is L = B/π.

                Our spot, in red: H = {H:.3f} W/m² arrives, ρ = {rho:.2f}, so ρ H = {product:.3f} W/m² leaves, and one
                sees L = {L:.3f} W/(m² sr).
            """,
            show={"order": 10, "pick": SPOT, "left": "hemisphere", "dome": Dome(stage="cosine")},
            minutes=4,
        ),
        Step(
            title="∫ becomes Σ",
            text="""
                A computer cannot take all directions, so it takes patches. The left picture shows the form factors of
                our spot: Fᵢⱼ is the share of its view, weighted by the cosine, that patch j fills. The integral is
                now a sum: Bᵢ = Eᵢ + ρᵢ Σⱼ Fᵢⱼ Bⱼ.
            """,
            show={"order": 10, "pick": SPOT, "left": "factors"},
            question="What must the form factors of one patch add up to?",
            answer="""To 1, with what looks out of the box: whatever leaves must arrive somewhere. Here {row:.4f} goes
                to patches ({seen} of {patches} are seen) and {sky:.4f} out through the open front: {closure:.4f} in
                all. Whoever writes a solver checks this sum first.""",
            minutes=4,
        ),
        Step(
            title="L on both sides",
            text="""
                Lᵢ, the light that arrives, is the Lₒ of some other point. To know our spot one must know all it sees;
                to know those, all that they see, our spot included.

                Go there by hand: click a patch, look at what it sees, click again. The equation is recursive, and
                there is no first patch to begin with.
            """,
            show={"order": 10, "pick": SPOT, "left": "hemicube"},
            minutes=3,
        ),
        Step(
            title="Put it into itself",
            text="""
                Write T for one round of "gather, weigh, reflect", so that L = Lₑ + T L. Now replace the L on the
                right by the whole right side, and again:

                L = Lₑ + T Lₑ + T² Lₑ + …

                The recursion has become a sum over bounces, with the lamp as its beginning. Of the red light of our
                spot, {direct:.0%} comes from the lamp at the first bounce. Step on with the arrow keys: that is the
                next lecture.
            """,
            show={"order": 1, "pick": SPOT},
            minutes=3,
        ),
    ),
)
