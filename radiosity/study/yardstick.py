"""The independent yardstick: whether random walks, which know no form factors, find the same light.

A reference may be wrong in ways that its own replicates do not show. Random walks share its rays and patches, but
assemble nothing and solve nothing. What is between the two, less what the walks' standard errors explain, is

    excess² = ‖B_walks - B‖² - Σ A σ²,        relative to ‖B - E‖,

whose own standard error follows from the same errors; more than three of these is a disagreement.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

import radiosity as rad

from ..patches import Patches
from .closed_forms import sphere_light
from .measures import FloatArray, Light, norm, relative_l2
from .methods import BOUNCES
from .reference import Reference

SEED = 2_000_001
SIGMAS = 3.0


class Check(NamedTuple):
    """A reference against something independent; all relative to B - E.

    found : what lies between the two.
    expected : how much of that standard errors (of both) explain.
    excess : the rest, √(found² - expected²), or minus √(expected² - found²).
    agrees : whether the rest is within three standard errors of nought; None where no error is known.
    """

    what: str
    found: float
    expected: float
    excess: float
    agrees: bool | None


def checks(patches: Patches, reference: Reference, paths: int, threads: int | None = None) -> list[Check]:
    """Walks between patches against `discrete`, over whole surfaces against `continuous`; a sphere's known light."""
    pairs = [
        ("patches", reference.discrete, reference.discrete_error, "path tracer, patches, against the reference"),
        (
            "continuous",
            reference.continuous,
            reference.continuous_error,
            "path tracer, undivided surfaces, against finer patches",
        ),
    ]
    found = []
    for transport, light, own, what in pairs:
        walks = rad.PathTracer(
            paths,
            SEED,
            next_event=True,
            transport=transport,  # type: ignore[arg-type]
            bounces=BOUNCES,
            tail=True,
        ).solve(patches, threads=threads)
        found.append(_check(f"{what}, {paths} paths", walks, light, own, patches.area))
    sphere = sphere_light(patches)
    if sphere is not None:
        gap = relative_l2(reference.discrete.radiosity, sphere.radiosity, patches.area, sphere.orders[0])
        found.append(Check("flat facets against the closed form of the round sphere", gap, 0.0, gap, None))
    return found


def _check(what: str, walks: rad.WalkedLight, light: Light, own: float, area: FloatArray) -> Check:
    """Compare the sum of all orders."""
    size = norm(light.radiosity - light.orders[0], area)
    if size == 0.0:
        return Check(what, 0.0, 0.0, 0.0, None)
    gap = norm(walks.radiosity - light.radiosity, area) / size
    noise = float(np.hypot(norm(walks.radiosity_error, area) / size, own))
    # Σ A δ² of independent normal δ has the variance 2 Σ A² σ⁴.
    fourth = np.sqrt(2.0 * np.sum((area[:, None] * walks.radiosity_error**2) ** 2)) / size**2
    square = gap**2 - noise**2
    spread = float(np.hypot(fourth, 2.0 * noise * own))
    return Check(
        what, gap, noise, float(np.sign(square) * np.sqrt(abs(square))), bool(abs(square) <= SIGMAS * spread + 1e-24)
    )
