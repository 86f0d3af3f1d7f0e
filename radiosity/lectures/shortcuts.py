"""Shortcuts that wreck an image: each beside the truth, and by how much it is off.

A lecture is this file: copy it, change words, add a `Step`, and run it with ``radiosity lecture FILE.py``.
"""

from typing import Any

import numpy as np

import radiosity as rad
from radiosity.display import as_rgb, luminance
from radiosity.lectures import Lecture, Step, mean, on
from radiosity.shortcuts import ALL, NoCosine

DIRECT, AMBIENT, OCCLUSION, NO_COSINE, NO_VISIBILITY, CUT = range(6)  # places in `radiosity.shortcuts.ALL`


def solve(patch_count: int = 4_000) -> rad.Solution:
    """The Cornell box."""
    return rad.solve(rad.scenes.cornell_box(), patch_count=patch_count, estimator=rad.MonteCarlo(rays=1024), bounces=12)


def numbers(box: rad.Solution) -> dict[str, Any]:
    """How far each shortcut is off, and where it shows."""
    truth = luminance(as_rgb(box.radiosity))
    wrong = [luminance(as_rgb(one.radiosity(box.patches, box.factors, box.radiosity))) for one in ALL]
    off = [float(mean(box, np.abs(light - truth) / truth)) for light in wrong]
    corner = on(box, "floor") & (truth < np.quantile(truth[on(box, "floor")], 0.05))
    exchange = NoCosine(rays=64).exchange(box.patches)
    white = np.full((len(box.patches), 1), 0.6)
    return {
        "direct": off[DIRECT],
        "black": float(mean(box, wrong[DIRECT] <= 0)),
        "missing": 1 - float(mean(box, wrong[DIRECT]) / mean(box, truth)),
        "ambient": off[AMBIENT],
        "ambient_mean": float(mean(box, wrong[AMBIENT]) / mean(box, truth)),
        "ambient_dark": float(wrong[AMBIENT][corner].mean() / truth[corner].mean()),
        "ceiling": float(mean(box, wrong[AMBIENT], "ceiling") / mean(box, truth, "ceiling")),
        "occlusion": off[OCCLUSION],
        "no_cosine": off[NO_COSINE],
        "row_sum": float(np.median(exchange.row_sums)),
        "radius": float(exchange.spectral_radius(white)[0]),
        "no_visibility": off[NO_VISIBILITY],
        "shadow": float(np.max(wrong[NO_VISIBILITY] / truth)),
        "cut": off[CUT],
        "cut_missing": 1 - float(mean(box, wrong[CUT]) / mean(box, truth)),
    }


LECTURE = Lecture(
    name="shortcuts",
    title="Shortcuts that wreck an image",
    solve=solve,
    numbers=numbers,
    steps=(
        Step(
            title="The truth",
            text="""
                The Cornell box with all its light. Films and games have left out parts of the equation for decades,
                because each part costs. Let us leave out one at a time, and look.

                In what follows the right picture is true and the left one WRONG, on purpose.
            """,
            show={"order": 12},
            minutes=2,
        ),
        Step(
            title="Direct light only",
            text="""
                The oldest shortcut: light stops at the first surface, so the recursion is gone.
            """,
            show={"order": 12, "left": "wrong", "wrong": DIRECT},
            question="How much of the light do we lose?",
            answer="""{missing:.0%} of the light that leaves the surfaces, and {black:.0%} of the area is black. The
                difference picture is blue all over: too dark. Off by {direct:.0%} on average.""",
            reveal={"difference": True},
            minutes=3,
        ),
        Step(
            title="Direct light and a constant",
            text="""
                "Ambient light": one constant for all that is missing. We are generous and choose the best one, so
                that the mean over the room is exactly right ({ambient_mean:.3f} of the truth).
            """,
            show={"order": 12, "left": "wrong", "wrong": AMBIENT},
            question="The mean is right. Where is the picture wrong?",
            answer="""In dark corners of the floor it is {ambient_dark:.1f} times too bright, on the ceiling
                {ceiling:.2f} of the truth. And there is no red on the white block: a constant knows no neighbours.
                Off by {ambient:.0%} on average.""",
            reveal={"difference": True},
            minutes=4,
        ),
        Step(
            title="Ambient occlusion",
            text="""
                Then dim the constant where something is near, as corners are often dark. It looks convincing.
            """,
            show={"order": 12, "left": "wrong", "wrong": OCCLUSION},
            question="Corners are darkened because they are corners. When is that false?",
            answer="""Where light gathers: a corner of two lit white walls is brighter than the middle of either.
                Occlusion asks what is near, not whether it shines. Off by {occlusion:.0%}.""",
            reveal={"difference": True},
            minutes=3,
        ),
        Step(
            title="The cosine forgotten",
            text="""
                A beginner's bug, and worth making on purpose. Light that grazes counts in full: ∫ dω = 2π instead of
                ∫ cos θ dω = π.
            """,
            show={"order": 12, "left": "wrong", "wrong": NO_COSINE},
            question="What will the rows of the form factors add up to?",
            answer="""To {row_sum:.2f} instead of 1: each bounce makes light out of nothing. In this box, with ρ = 0.6
                all over, a bounce would multiply light by {radius:.2f}, and the series need not converge: the picture
                shows four bounces of it. Off by {no_cosine:.0%}.""",
            reveal={"difference": True},
            minutes=4,
        ),
        Step(
            title="Visibility forgotten",
            text="""
                Form factors as if nothing stood in between. Much cheaper: no ray is traced.
            """,
            show={"order": 12, "left": "wrong", "wrong": NO_VISIBILITY},
            question="Shadows vanish. Is the picture only too bright?",
            answer="""Too bright wherever something should hide the lamp, up to {shadow:.0f} times, and lamps shine
                through blocks. The blocks seem to float, for it is the shadow that tells us where a thing stands. Off
                by {no_visibility:.0%}.""",
            reveal={"difference": True},
            minutes=3,
        ),
        Step(
            title="Recursion cut off",
            text="""
                The honest shortcut: the right terms, but only the first ones, here two bounces.
            """,
            show={"order": 12, "left": "wrong", "wrong": CUT},
            question="Is the error of a cut series of one sign?",
            answer="""Yes: every missing bounce was light, so it is too dark everywhere, here by {cut_missing:.0%} of
                the light. And it is the only shortcut of the six that gets right if one does more of it. Off by
                {cut:.0%}.""",
            reveal={"difference": True},
            minutes=3,
        ),
        Step(
            title="Kin",
            text="""
                Others of the family: light probes are an ambient that depends on the place. Shadow maps are
                visibility for the first bounce alone, at the map's resolution. Screen-space reflections gather only
                from what the camera sees, so light vanishes when its source leaves the picture.

                None of them is a sin. But whoever takes one should know which term of the equation it strikes out.
            """,
            show={"order": 12, "smooth": True},
            minutes=3,
        ),
    ),
)
