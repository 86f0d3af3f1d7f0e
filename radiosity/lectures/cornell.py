"""Bounce by bounce in the Cornell box: the Neumann series, seen.

A lecture is this file: copy it, change words, add a `Step`, and run it with ``radiosity lecture FILE.py``.
"""

import radiosity as rad
from radiosity.lectures import Lecture, Step


def solve(patch_count: int = 6_000) -> rad.Solution:
    """The box with red and green walls, ten bounces."""
    return rad.solve(rad.scenes.cornell_box(), patch_count=patch_count, estimator=rad.MonteCarlo(rays=1024), bounces=10)


LECTURE = Lecture(
    name="cornell",
    title="Bounce by bounce in the Cornell box",
    solve=solve,
    steps=(
        Step(
            title="A room and its equation",
            text="""
                This is the Cornell box: white floor, ceiling and back wall, a red wall, a green wall, two white
                blocks, one lamp. All its surfaces are matt.

                The light that leaves a point is what it emits plus what it passes on: L = Lₑ + T L. The transport
                operator T is one bounce: gather all light that arrives, keep the share that the paint reflects.

                Put the equation into itself, again and again: L = Lₑ + T Lₑ + T² Lₑ + … On the left is one term of
                this series, on the right the sum so far.
            """,
            show={"order": 3},
            minutes=3,
        ),
        Step(
            title="No bounce: Lₑ",
            text="""
                The first term is the lamp alone. Nothing has been lit by anything: an emitter in a black room, and so
                the term and the sum are one picture.
            """,
            show={"order": 0},
            minutes=1,
        ),
        Step(
            title="One bounce: direct light",
            text="""
                Now every surface that sees the lamp passes on light once. Shadows appear, with soft edges, because
                the lamp has a size.
            """,
            show={"order": 0},
            question="What will the ceiling look like? Decide before you go on.",
            answer="""Black. The lamp lies in the plane of the ceiling and shines downwards: no point of the ceiling
                sees it. A renderer that stops here has to invent "ambient light" to save the ceiling.""",
            reveal={"order": 1},
            minutes=3,
        ),
        Step(
            title="Two bounces",
            text="""
                Floor and walls are lit now, and they are lamps for the next bounce. Light that left the lamp, met one
                surface and then another, is T² Lₑ.
            """,
            show={"order": 1},
            question="And the ceiling now?",
            answer="""Lit, and brighter than the floor: it faces everything that was lit directly. Two patches in five
                of this room receive more light from the second bounce than from the first.""",
            reveal={"order": 2},
            minutes=3,
        ),
        Step(
            title="Colour moves",
            text="""
                Each picture is now exposed by itself; the factor stands above it. Light that meets the red wall
                leaves it red: T multiplies by the reflectance, channel by channel.
            """,
            show={"order": 1, "normalised": True},
            question="After one more bounce, which faces of the white blocks turn red, which green?",
            answer="""Those that look at the red wall and at the green wall. This is colour bleeding, and a picture of
                direct light alone lacks it.""",
            reveal={"order": 2},
            minutes=2,
        ),
        Step(
            title="Many bounces",
            text="""
                Eight bounces on, little is left, but look what kind of light it is: blue has died out, since neither
                coloured wall reflects it, and what remains is red beside the red wall and green beside the green.

                From here on the terms keep their shape and only shrink, by nearly the same factor each time: the
                straight end of the curves below. That shape is the dominant eigenvector of T, the factor its
                eigenvalue.
            """,
            show={"order": 8, "normalised": True},
            minutes=3,
        ),
        Step(
            title="The same on one exposure",
            text="""
                On the exposure common to all, the eighth bounce is black. Both views are true. The series converges
                because each bounce hands on less than it got.
            """,
            show={"order": 8},
            question="How many bounces would you compute for a picture?",
            answer="""Step with the arrow keys and watch the sum on the right: after five or six bounces the eye sees
                no change, though a light meter would.""",
            reveal={"order": 5},
            minutes=2,
        ),
        Step(
            title="All of it",
            text="""
                The sum, interpolated between patches: smooth, and less honest, because constant light on each patch
                is what was computed. Turn the room with the mouse; press s to see the patches again.
            """,
            show={"order": 10, "smooth": True},
            minutes=2,
        ),
    ),
)
