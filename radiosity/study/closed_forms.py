"""Light that is known without any form factors, where a scene's shape and materials allow it."""

from __future__ import annotations

import numpy as np

from ..patches import Patches
from .measures import FloatArray, Light
from .methods import BOUNCES

ALIKE = 1e-12
ROUND = 1e-9  # of the radius: how far corners may be from a sphere


def closed_form(patches: Patches) -> tuple[Light, str] | None:
    """Light in closed form that holds exactly on any patches, and its name; None if there is none."""
    if _is_furnace(patches):
        return furnace_light(patches), "closed form: a furnace, B_k = ρ^k E"
    if _is_lone_convex_body(patches):
        return lone_body_light(patches), "closed form: a convex body under an even sky, B = E + ρ π L"
    return None


def furnace_light(patches: Patches) -> Light:
    """B_k = ρ^k E, whatever the form factors of a closed room whose walls are all alike."""
    rho, emission = patches.reflectance, patches.emission
    return Light(emission / patches.absorptance, np.stack([rho**k * emission for k in range(BOUNCES + 1)]))


def lone_body_light(patches: Patches) -> Light:
    """Of a convex body every patch sees the sky alone: ρ π L at order 1, and nothing after it."""
    first = patches.reflectance * np.pi * patches.sky
    orders = np.zeros((BOUNCES + 1, *patches.emission.shape))
    orders[0], orders[1] = patches.emission, first
    return Light(patches.emission + first, orders)


def sphere_light(patches: Patches) -> Light | None:
    """Light in a hollow sphere, if the patches are facets of one: F_ij = A_j / ΣA, so B = E + ρ <E> / (1 - <ρ>).

    Right in the limit of many facets, for any materials (D. G. Goebel, Applied Optics 6 (1967),
    doi:10.1364/AO.6.000125).
    """
    if not _is_hollow_sphere(patches):
        return None
    share = patches.area / patches.area.sum()
    rho, emission = patches.reflectance, patches.emission
    orders = [emission]
    for _ in range(BOUNCES):
        orders.append(rho * (share @ orders[-1]))
    return Light(emission + rho * (share @ emission) / (share @ patches.absorptance), np.stack(orders))


def _is_furnace(patches: Patches) -> bool:
    def alike(values: FloatArray) -> bool:
        return bool(np.all(np.ptp(values, axis=0) <= ALIKE * values.max(axis=0)))

    lossy = bool((patches.absorptance > 0).all())
    return patches.closed and lossy and all(map(alike, (patches.absorptance, patches.emission)))


def _is_lone_convex_body(patches: Patches) -> bool:
    """Whether no corner of any face stands in front of any other face, up to rounding."""
    faces = patches.grid.faces
    if patches.closed or faces.two_sided.any():
        return False
    size = float(np.ptp(faces.bounds, axis=0).max())
    points = faces.corners.reshape(-1, 3)
    offset = np.einsum("fx,fx->f", faces.corners[:, 0], faces.normal)
    return all(
        (points @ normal).max() <= level + ROUND * size for normal, level in zip(faces.normal, offset, strict=True)
    )


def _is_hollow_sphere(patches: Patches) -> bool:
    """Whether all corners are equally far from their middle, and the faces look inwards."""
    faces = patches.grid.faces
    corners = faces.corners.reshape(-1, 3)
    centre = faces.bounds.mean(axis=0)
    away = np.linalg.norm(corners - centre, axis=1)
    inwards = np.einsum("fx,fx->f", faces.corners.mean(axis=1) - centre, faces.normal) < 0
    return patches.closed and len(faces) >= 20 and bool(inwards.all()) and float(np.ptp(away)) <= ROUND * away.max()
