"""What a patch sees: form factors, the hemicube, and what must be true of them.

A lecture is this file: copy it, change words, add a `Step`, and run it with ``radiosity lecture FILE.py``.
"""

from functools import cache
from typing import Any

import numpy as np

import radiosity as rad
from radiosity.lectures import Lecture, Step, nearest, on, plot
from radiosity.rays import Tracer
from radiosity.viewer.inspect import HemicubeView

FLOOR = (0.42, 0.0, 0.12)  # towards the red wall
SHADOW = (0.16, 0.0, 0.04)  # before the short block
CEILING = (0.48, 0.5488, 0.30)
RESOLUTIONS = (8, 12, 16, 24, 32, 48, 64, 96)
FINE = 320


def solve(patch_count: int = 4_000) -> rad.Solution:
    """The Cornell box."""
    return rad.solve(rad.scenes.cornell_box(), patch_count=patch_count, estimator=rad.MonteCarlo(rays=1024), bounces=8)


def row(box: rad.Solution, patch: int, resolution: int = FINE) -> np.ndarray:
    """Form factors of a patch by a hemicube on its middle, (N,)."""
    return HemicubeView.of(box.patches, patch, resolution, tracer(box.patches)).row(len(box.patches))


@cache
def tracer(patches: rad.Patches) -> Tracer:
    """What finds the patch that a ray meets, made once."""
    return Tracer(patches.grid)


@cache
def lamp_error(box: rad.Solution, resolution: int) -> float:
    """Relative error of the form factor to the lamp, mean over some patches of the floor, against a fine one."""
    lamp = on(box, "lamp")
    return float(np.mean([abs(row(box, i, resolution)[lamp].sum() / row(box, i)[lamp].sum() - 1) for i in spots(box)]))


def spots(box: rad.Solution) -> np.ndarray:
    """Some patches of the floor that have the lamp in sight."""
    lamp = box.factors.matrix[:, np.flatnonzero(on(box, "lamp"))].sum(axis=1)
    seeing = np.flatnonzero(on(box, "floor") & (lamp > 0.5 * lamp[on(box, "floor")].max()))
    return seeing[:: max(1, len(seeing) // 6)]


def resolution_plot(box: rad.Solution) -> Any:
    """Error of the form factor to the lamp against the resolution of the hemicube."""
    figure, axes = plot("pixels along an edge of the hemicube", "error of F to the lamp, %", log="xy")
    axes.plot(RESOLUTIONS, [100 * lamp_error(box, resolution) for resolution in RESOLUTIONS], "o-")
    axes.set_xticks(RESOLUTIONS[::2], [str(resolution) for resolution in RESOLUTIONS[::2]])
    return figure


def numbers(box: rad.Solution) -> dict[str, Any]:
    """Form factors of the picked patches."""
    floor, shadow, ceiling = (nearest(box, place) for place in (FLOOR, SHADOW, CEILING))
    N, area = len(box.patches), box.patches.area
    here, back = row(box, floor), row(box, ceiling)
    shadow_row = box.factors.row(shadow)
    red, block = on(box, "red_wall"), on(box, "short_block")
    return {
        "patches": N,
        "pixels": 3 * 64**2,
        "seen": int(np.count_nonzero(here)),
        "hemicube_sum": here.sum(),
        "solver_sum": box.factors.row(floor).sum(),
        "sky": box.factors.to_sky[floor],
        "lamp": here[on(box, "lamp")].sum(),
        "red_wall": here[red].sum(),
        "shadow_lamp": shadow_row[on(box, "lamp")].sum(),
        "shadow_block": shadow_row[block].sum(),
        "there": here[ceiling],
        "back": back[floor],
        "area_floor": 1e4 * area[floor],
        "area_ceiling": 1e4 * area[ceiling],
        "G": 1e4 * area[floor] * here[ceiling],
        "G_back": 1e4 * area[ceiling] * back[floor],
        "coarse": lamp_error(box, 16),
        "fine": lamp_error(box, 96),
        "closure_defect": np.abs(box.factors.closure_defect).max(),
    }


LECTURE = Lecture(
    name="hemicube",
    title="What a patch sees",
    solve=solve,
    numbers=numbers,
    steps=(
        Step(
            title="Sit on a patch and look around",
            text="""
                The room from a camera, as a visitor sees it. Now sit down on the outlined patch of the floor. Before
                we go there:
            """,
            show={"order": 8, "pick": FLOOR},
            question="Draw what the patch sees: what is in the middle of its picture, what at the rim?",
            answer="""This is its hemicube: half a cube over the patch, with the room painted on its five faces, and
                unfolded. In the middle is what lies straight above: ceiling and lamp. At the rim is the horizon: the
                foot of the walls and the blocks, large, because they are near.""",
            reveal={"left": "hemicube"},
            minutes=4,
        ),
        Step(
            title="Form factors",
            text="""
                Fᵢⱼ is the share of the light leaving patch i that arrives at patch j. Light that leaves at a slant is
                weak by cos θ, so not all pixels count alike: those in the middle count most, those at the rim of the
                sides almost nothing. Add the weights of the pixels that show j, and you have Fᵢⱼ.

                Left: the row of F of our patch, each patch j in the colour of its Fᵢⱼ.
            """,
            show={"order": 8, "pick": FLOOR, "left": "factors"},
            question="The red wall looks huge in the hemicube, the lamp tiny. Which form factors have they?",
            answer="""{red_wall:.3f} for the whole red wall, {lamp:.4f} for the lamp. Form factors know nothing about
                brightness, only about geometry. That is why they can be computed once for any light.""",
            minutes=4,
        ),
        Step(
            title="The row must add up to 1",
            text="""
                Whatever leaves the patch arrives somewhere. By hemicube the patches get {hemicube_sum:.4f}, by the
                solver's rays {solver_sum:.4f}. Missing to 1 is what leaves through the open front, {sky:.4f}.

                In the solver's rows patches, sky and backs add up to 1 within {closure_defect:.0e}: each ray is
                counted once, wherever it ends.
            """,
            show={"order": 8, "pick": FLOOR, "left": "factors"},
            minutes=2,
        ),
        Step(
            title="In the shadow",
            text="""
                A patch before the short block. Whether a patch is lit is a question to its hemicube: is the lamp in
                it?
            """,
            show={"order": 1, "pick": SHADOW},
            question="How much of its view does the block take, and how much is left of the lamp?",
            answer="""The block fills {shadow_block:.0%} of it, and the lamp {shadow_lamp:.2%}. Visibility costs
                nothing extra in a hemicube: the depth buffer of the graphics card does it.""",
            reveal={"left": "hemicube", "order": 8},
            minutes=3,
        ),
        Step(
            title="Two patches see each other",
            text="""
                A patch of the ceiling is picked too. Seen from one another they look different: areas and angles
                differ. From floor to ceiling F = {there:.2e}, back {back:.2e}.
            """,
            show={"order": 8, "pick": FLOOR, "pick_other": CEILING, "left": "hemicube"},
            question="Their areas: {area_floor:.3g} and {area_ceiling:.3g} cm². Which product is the same both ways?",
            answer="""Aᵢ Fᵢⱼ = Aⱼ Fⱼᵢ: {G:.2e} and {G_back:.2e} cm², computed apart, so equal but for pixels and
                because each hemicube stands in the middle of its patch. This is reciprocity: swap lamp and eye, and
                the light between them is the same.""",
            minutes=3,
        ),
        Step(
            title="How many pixels?",
            text="""
                A hemicube of 64 × 64 has {pixels} pixels, and a lamp is only some of them. Whether a pixel at its
                edge counts is all or nothing.
            """,
            show={"order": 1, "pick": FLOOR, "left": "hemicube"},
            question="Double the resolution: is the error of the lamp's form factor halved?",
            answer="""About, on average, with jumps: the edge of the lamp is caught by more pixels, but they stand in
                rows, and so do edges. At 16 pixels the error is {coarse:.1%}, at 96 {fine:.2%} (mean over patches of
                the floor that see the lamp). Rays at random places have no rows to betray them; that is another
                lecture.""",
            reveal={"figure": resolution_plot, "order": 1},
            minutes=4,
        ),
        Step(
            title="All rows together",
            text="""
                The rows of all patches make a matrix of {patches} × {patches}; with each row times its ρ it is T.
                Patches are sorted by surface, so one sees blocks: floor to ceiling, wall to wall, and on the diagonal
                black squares, since a flat surface does not see itself.

                One bounce is one product of this matrix with the light.
            """,
            show={"order": 1, "left": "matrix"},
            minutes=3,
        ),
    ),
)
