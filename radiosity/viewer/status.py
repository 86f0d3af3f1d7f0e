"""What the dashboard says in words, by what the state shows."""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING, Any

import numpy as np

from .. import display
from .changes import in_words as changes_in_words
from .inspect import numbers, patch_lines
from .titles import in_words, units

if TYPE_CHECKING:
    from ..balance import PowerBalance
    from ..form_factors import FormFactors
    from ..solution import Solution
    from .dome_reading import DomeReading
    from .window import Window


def lines(window: Window) -> list[str]:
    """The words of a window."""
    state = window.state
    if window.complaint:
        return [window.complaint]
    if state.verdict:
        return str(window.solution.certificate).splitlines()
    if state.left == "wrong":
        return window.inspector.compare.lines()
    if state.left == "solvers":
        return window.inspector.race.lines()
    if window.inspector.reading is not None:
        return dome_lines(window, window.inspector.reading)
    if state.picked >= 0:
        picked = state.picked, state.other
        return patch_lines(window.solution, window.series, state.order, *picked, window.inspector.exchange())
    return overview(window)


def overview(window: Window) -> list[str]:
    """The bounce, where all power goes, how sure that is, and how it is shown."""
    state, series, solution = window.state, window.series, window.solution
    total = float(series.power[: state.order + 1].sum())
    given, called = put_in(solution)
    shown = [
        "Reinhard" if state.tone == "reinhard" else "linear",
        "smooth" if state.smooth else "flat",
        *(name for name, on in (("false colour", state.false_colour), ("backs shown", state.backs)) if on),
        *(
            [f"{clipped_share(window):.1%} of the area clipped"]
            if state.mark_clipped and state.tone == "linear"
            else []
        ),
        *(["playing"] if state.playing else []),
    ]
    changed = [f"changed: {changes_in_words(state.changes)}"] if state.changes else []
    return [
        f"k = {state.order}: {in_words(state.order)}, {watts(series.power[state.order], state.photometric)}",
        f"all so far: {total / (given or 1.0):.3f} × {called}",
        balance_line(solution),
        *verdict_lines(window),
        *changed,
        f"{len(solution.patches):,} patches · {' · '.join(shown)} · ? lists the keys",
    ]


@functools.lru_cache(maxsize=2)
def balance_of(solution: Solution) -> PowerBalance:
    """Where all the power goes; worked out once."""
    return solution.balance


def put_in(solution: Solution) -> tuple[float, str]:
    """Power of all lamps, and of the sky where it reaches the scene, W, and what to call it."""
    balance = balance_of(solution)
    name = "the power put in" if balance.from_sky.any() else "the emitted power"
    return float(balance.put_in.sum()), name


def balance_line(solution: Solution) -> str:
    """Where all the power goes, in words."""
    balance = balance_of(solution)
    given = put_in(solution)[0] or 1.0
    kept, gone = float(balance.absorbed.sum()) / given, float(balance.to_sky.sum()) / given
    behind = float(balance.to_backs.sum()) / given
    lost = f", on black backs {behind:.1%}" if behind >= 0.0005 else ""
    return f"absorbed {kept:.1%}, escaped {gone:.1%}{lost}, energy defect {balance.defect:+.2%}".replace("-", "−")


def verdict_lines(window: Window) -> list[str]:
    """How well the form factors close, and the verdict of the certificate; it is worked out in the background."""
    closure = largest_closure_defect(window.solution.factors)
    certificate = window.certificate()
    verdict = "verdict: being worked out …" if certificate is None else str(certificate).splitlines()[0]
    return [f"closure defect {closure:.1g} at most", verdict]


@functools.lru_cache(maxsize=2)
def largest_closure_defect(factors: FormFactors) -> float:
    """By how much a row of form factors fails to close, at most."""
    return float(np.abs(factors.closure_defect).max(initial=0.0))


def dome_lines(window: Window, reading: DomeReading) -> list[str]:
    """The rendering equation at the picked patch, in numbers."""
    state, patches = window.state, window.solution.patches
    unit = units(state.photometric)
    walked = [*(patch for patch, _ in state.dome.path), state.picked]
    names = [patches.surface_names[patches.surface[patch]] for patch in walked[-4:]]
    path = ("… → " if len(walked) > 4 else "") + " → ".join(names)
    sees = f"sees patch {reading.ahead} of {patches.surface_names[patches.surface[reading.ahead]]}"
    if reading.ahead < 0:
        sees = "sees no patch"
    own = f"Lₑ = {numbers(reading.emission / np.pi)}, " if reading.emission.any() else ""
    part = [f"Σ up to θ = {state.dome.theta:.0f}°: {numbers(reading.so_far)}"] if state.dome.stage == "sum" else []
    return [
        f"path: {path} (patch {state.picked})",
        f"ωᵢ: θ = {state.dome.theta:.0f}°, cos θ = {np.cos(np.radians(state.dome.theta)):.3f}, {sees}",
        f"Lᵢ along ωᵢ = {numbers(reading.along)} {unit.radiance}",
        *part,
        f"H = Σ Lᵢ cos θ Δω = {numbers(reading.irradiance)} {unit.density}",
        f"H by the solver's row of F = {numbers(reading.solved)}",
        f"{own}Lₒ = {'Lₑ + ' if own else ''}ρ H / π = {numbers(reading.outgoing)} {unit.radiance}, for every ωₒ",
    ]


def clipped_share(window: Window) -> float:
    """Share of the area, in the right pane, that the linear operator does not show."""
    state, series = window.state, window.series
    over = display.clipped(series.light(state, "sum") * np.float32(series.factor(state, "sum")))
    return float(series.area[over].sum() / series.area.sum())


def watts(power: Any, photometric: bool = False) -> str:
    """Power of each channel, to three digits.

    >>> watts([7.3, 0.5149, 0.0172])
    '7.3 / 0.515 / 0.0172 W'
    """
    values = np.atleast_1d(power)
    unit = units(photometric).power
    if len(values) > 3:
        return f"{float(values.sum()):.3g} {unit}"
    return " / ".join(f"{float(value):.3g}" for value in values) + f" {unit}"
