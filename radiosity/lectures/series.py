"""Why the series converges: the furnace, the albedo, ρ → 1; and what falls when the norm falls.

A lecture is this file: copy it, change words, add a `Step`, and run it with ``radiosity lecture FILE.py``.
"""

from typing import Any

import numpy as np

import radiosity as rad
from radiosity.display import luminance
from radiosity.lectures import Lecture, Step, bounces, legend, mean, plot

ALBEDOS = (0.5, 0.8, 0.9, 0.95)
BOUNCES = 40


def solve(patch_count: int = 4_000) -> dict[str, rad.Solution]:
    """Furnaces of several albedos, and the Cornell box."""
    furnace = rad.solve(rad.scenes.furnace(0.5), patch_count=600, estimator=rad.MonteCarlo(rays=256), bounces=BOUNCES)
    N = len(furnace.patches)
    furnaces = {f"furnace {rho:g}": furnace.relight(reflectance=np.full((N, 1), rho)) for rho in ALBEDOS}
    box = rad.solve(rad.scenes.cornell_box(), patch_count=patch_count, estimator=rad.MonteCarlo(rays=1024), bounces=14)
    return {**furnaces, "box": box}


def missing(solution: rad.Solution, rho: float) -> np.ndarray:
    """Share of all light that the sum up to each bounce lacks, in a furnace of emission 1 W/m²."""
    return 1.0 - np.cumsum(bounces(solution)[:, 0, 0]) * (1.0 - rho)


def furnace_plot(solved: dict[str, rad.Solution]) -> Any:
    """What is missing after each bounce."""
    figure, axes = plot("bounces summed", "share of the light still missing", log="y")
    for rho in ALBEDOS:
        axes.plot(np.maximum(missing(solved[f"furnace {rho:g}"], rho), 1e-16), "o-", markersize=3, label=f"ρ = {rho:g}")
    axes.axhline(0.01, color="#9aa3ae", linewidth=1, linestyle="--")
    axes.annotate("1 %", (BOUNCES - 2, 0.0125), color="#9aa3ae")
    axes.set_ylim(1e-5, 1.3)
    legend(axes, "lower left")
    return figure


def norms(box: rad.Solution) -> np.ndarray:
    """Area-weighted L2 norm of each order, luminance."""
    return np.array([np.sqrt(np.sum(box.patches.area * luminance(order) ** 2)) for order in bounces(box)])


def norm_plot(solved: dict[str, rad.Solution]) -> Any:
    """Norm of each order of the box, and its power."""
    box = solved["box"]
    figure, axes = plot("bounce k", "against order 1", log="y")
    sizes, power = norms(box), np.einsum("n,knc->k", box.patches.area, bounces(box))
    axes.plot(range(1, len(sizes)), sizes[1:] / sizes[1], "o-", label="norm of $T^k L_e$")
    axes.plot(range(1, len(power)), power[1:] / power[1], "s-", label="power of $T^k L_e$")
    axes.plot([1, 14], [1, (sizes[-1] / sizes[-2]) ** 13], "--", color="#9aa3ae", label="the last ratio, all the way")
    legend(axes, "lower left")
    return figure


def numbers(solved: dict[str, rad.Solution]) -> dict[str, Any]:
    """What furnace and box show."""
    box = solved["box"]
    one, two = luminance(bounces(box)[1]), luminance(bounces(box)[2])
    sizes = norms(box)
    half, bright = solved["furnace 0.5"], solved["furnace 0.95"]
    grows = two > one
    return {
        "sum_half": half.radiosity[0, 0],
        "missing_half": missing(half, 0.5)[10],
        "missing_bright": missing(bright, 0.95)[10],
        "limit_bright": 1 / (1 - 0.95),
        "need_half": int(np.ceil(np.log(0.01) / np.log(0.5))) - 1,
        "need_bright": int(np.ceil(np.log(0.01) / np.log(0.95))) - 1,
        "need_999": int(np.ceil(np.log(0.01) / np.log(0.999))) - 1,
        "grows": np.mean(grows),
        "grows_area": box.patches.area[grows].sum() / box.patches.area.sum(),
        "ratio_2": sizes[2] / sizes[1],
        "ratio_last": sizes[-1] / sizes[-2],
        "rho_mean": mean(box, box.patches.reflectance).mean(),
        "escaped": float(box.balance.to_sky.sum() / box.balance.put_in.sum()),
    }


LECTURE = Lecture(
    name="series",
    title="Why the series converges",
    solve=solve,
    numbers=numbers,
    steps=(
        Step(
            title="A room where every bounce is known",
            text="""
                The furnace: a closed cube whose six walls are alike. Each wall emits 1 W/m² and reflects ρ = 0.5. By
                symmetry all points have the same light, so each bounce is the one before times ρ:

                B = 1 + ρ + ρ² + ρ³ + …
            """,
            show={"scene": "furnace 0.5", "order": 1},
            question="How bright are the walls when all bounces are added?",
            answer="""1 / (1 − ρ) = 2 W/m². The solver has {sum_half:.6f}. Half of the light one sees is borrowed.""",
            reveal={"order": 40},
            minutes=3,
        ),
        Step(
            title="How many bounces?",
            text="""
                After k bounces the share ρᵏ⁺¹ is still missing. At ρ = 0.5 and ten bounces that is
                {missing_half:.2%}.
            """,
            show={"scene": "furnace 0.5", "order": 10},
            question="And at ρ = 0.95, fresh snow, after ten bounces?",
            answer="""{missing_bright:.0%}: more than half. To be right to 1 % takes {need_half} bounces at 0.5,
                {need_bright} at 0.95, and {need_999} at 0.999.""",
            reveal={"scene": "furnace 0.95", "figure": furnace_plot},
            minutes=4,
        ),
        Step(
            title="ρ → 1",
            text="""
                The whole is 1 / (1 − ρ): {limit_bright:g} W/m² at 0.95, a thousand at 0.999. With ρ = 1 walls pass on
                all they get, light is put in and none is ever taken out, and there is no steady state to compute.

                So convergence is not a trick of the method. The series converges because energy is lost at each
                bounce: α = 1 − ρ to the walls, and what leaves through openings.
            """,
            show={"scene": "furnace 0.95", "order": 40},
            minutes=3,
        ),
        Step(
            title="A real room",
            text="""
                In the Cornell box paint differs from place to place ({rho_mean:.0%} on average), and light can leave
                by the open front ({escaped:.0%} of it does). No single ρ. What replaces it?
            """,
            show={"scene": "box", "order": 1},
            question="From bounce 1 to bounce 2: does every patch get darker?",
            answer="""No! {grows:.0%} of the patches are brighter at order 2 than at order 1: two in five, the ceiling
                among them, which had nothing before. And still the series converges.""",
            reveal={"order": 2},
            minutes=4,
        ),
        Step(
            title="What falls is the norm",
            text="""
                T can make single patches brighter, but not the room as a whole: each bounce hands on at most max ρ of
                its power, whoever gets it. The size of Tᵏ Lₑ over all patches falls to {ratio_2:.2f} from order 1 to
                2.
            """,
            show={"scene": "box", "order": 2},
            question="Is the ratio the same from bounce to bounce?",
            answer="""Not at first; it settles, here at {ratio_last:.2f}. That is the spectral radius of T: the
                brightest colour's eigenvalue. The terms then keep their picture and only shrink, and the tail is a
                geometric series after all.""",
            reveal={"figure": norm_plot},
            minutes=4,
        ),
        Step(
            title="Play: darker paint",
            text="""
                If all paint is made s times as bright, T becomes s T, and the k-th bounce, T applied k times, sᵏ
                times what it was: exactly. In the page for a browser the slider "paint" does this: drag it and watch
                the curves tilt; at 0 only the lamp is left. In the window the slider ρ changes one surface at a time.

                Rooms with white walls are hard for every renderer, and now you know by how much.
            """,
            show={"scene": "box", "order": 14},
            minutes=2,
        ),
    ),
)
