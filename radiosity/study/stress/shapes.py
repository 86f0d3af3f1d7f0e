"""Shapes and sizes: slivers, specks, gaps, far places, doubled faces."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache, partial
from itertools import pairwise

import numpy as np

import radiosity as rad

from ...form_factors import closed_forms
from ...overlaps import overlaps
from .case import Case, Got, case, refuses, truth, within
from .systems import moved, plate

GROUP = "shapes"
GREY = rad.Material(0.5)
SHINING = rad.Material(0.5, emission=1.0)


def cases() -> Iterator[Case]:
    """All of this file."""
    for exponent in (-9, -3, 3, 9):
        name = f"the red rug's room at 1e{exponent} times its size"
        yield Case(name, "the same light within 1e-3", partial(_elsewhere, 10.0**exponent, 0.0), GROUP)
    for shift in (1e3, 1e6):
        name = f"the red rug's room {shift:g} m from the origin"
        yield Case(name, "the same light within 1e-3", partial(_elsewhere, 1.0, shift), GROUP)
    for gap in (1e-1, 1e-3, 1e-4, 2e-5):
        name = f"plates {gap:g} of their width apart, by rays"
        yield Case(name, "closed form within sampling error", partial(_close_by_rays, gap), GROUP)
    for gap in (1e-2, 1e-5, 1e-8):
        name = f"plates {gap:g} of their width apart, exact factors"
        yield Case(name, "closed form within 1e-9", partial(_close_exactly, gap), GROUP)
    for aspect in (1e2, 1e4, 1e6):
        name = f"a wall of strips, {aspect:g} times as long as wide"
        yield Case(name, "exact factors close within 1e-9, rays within 5 sigma", partial(_slivers, aspect), GROUP)
    for name in ("furnace", "red_rug", "hidden_lamp", "two_rooms", "corridor", "cluttered_room", "integrating_sphere"):
        yield Case(f"leaks of {name}", "no ray of a million gets out", partial(_leaks, name), GROUP)
    yield from (gap_refused, speck, coincident, doubled, one_patch, ball, open_sky, flat_triangle)


@cache
def _room_light() -> np.ndarray:
    return _light(rad.scenes.red_rug())


def _light(scene: rad.Scene) -> np.ndarray:
    return rad.solve(scene, patch_count=400, estimator=rad.MonteCarlo(256)).radiosity


def _elsewhere(scale: float, shift: float) -> Got:
    """The rays are the same up to rounding, which a few of 100 000 feel."""
    found, true = _light(moved(rad.scenes.red_rug(), scale, shift)), _room_light()
    error = float(np.linalg.norm(found - true) / np.linalg.norm(true))
    return truth(error <= 1e-3, f"{error:.1e} apart, relative L2")


def _close_by_rays(gap: float) -> Got:
    """The share that escapes is 4 gap or so; where rays see nothing of it, the gap's whole share is the error."""
    patches = rad.subdivide(rad.scenes.parallel_plates(distance=gap), patch_count=128)
    rays = 4096
    factors = rad.form_factors(patches, rad.MonteCarlo(rays, light_rays=0))
    found = np.average(factors.to_sky, weights=factors.area)
    true = 1.0 - closed_forms.parallel_rectangles(1, 1, gap)
    sigma = np.sqrt(true * (1 - true) / (rays * len(patches)))
    edge = 1e-5 * np.sqrt(2.0) * 2  # points of a patch are pulled inside by so much
    return truth(abs(found - true) <= 5 * sigma + edge, f"{found:.3e} escapes, closed form {true:.3e}, σ {sigma:.0e}")


def _close_exactly(gap: float) -> Got:
    patches = rad.subdivide(rad.scenes.parallel_plates(distance=gap), patch_count=32)
    factors = rad.form_factors(patches, rad.Analytic(), dtype=np.float64)
    lower = patches.surface == 0
    exchange = factors.exchange_area().toarray()[np.ix_(lower, ~lower)].sum()
    return within(exchange, closed_forms.parallel_rectangles(1, 1, gap), 1e-9)


def _slivers(aspect: float) -> Got:
    """Two facing walls, one of them in 100 strips of which all but one are of this aspect; the last takes the rest."""
    width = 1.0 / aspect
    cuts = np.append(np.arange(100) * width, 1.0)
    corners = [[[a, 1, 1], [a, 1, 0], [b, 1, 0], [b, 1, 1]] for a, b in pairwise(cuts)]
    strips = [plate(f"strip_{k}", corner, GREY) for k, corner in enumerate(corners)]
    floor = plate("floor", [[0, 0, 0], [0, 0, 1], [1, 0, 1], [1, 0, 0]], SHINING)
    patches = rad.subdivide(rad.Scene([floor, *strips], closed=False))
    true = closed_forms.parallel_rectangles(1, 1, 1)
    exact = rad.form_factors(patches, rad.Analytic(), dtype=np.float64).row(0)[1:].sum()
    rays = 1 << 18
    sampled = rad.form_factors(patches, rad.MonteCarlo(rays, light_rays=0)).row(0)[1:].sum()
    sigma = np.sqrt(true * (1 - true) / rays)
    good = abs(exact - true) <= 1e-9 and abs(sampled - true) <= 5 * sigma
    return truth(good, f"exact off by {abs(exact - true):.1e}, rays by {abs(sampled - true) / sigma:.1f} σ")


def _leaks(name: str) -> Got:
    patches = rad.subdivide(getattr(rad.scenes, name)(), patch_count=1000)
    rays = 1 << max(8, int(np.ceil(np.log2(1e6 / len(patches)))))
    factors = rad.form_factors(patches, rad.MonteCarlo(rays, light_rays=0))
    leaked, traced = factors.statistics["rays/leaked"], factors.statistics["rays/traced"]
    return truth(leaked == 0 and traced >= 1e6, f"{leaked} of {traced:,} rays")


@case("plates 5e-6 of their width apart, by rays", "refused: rays cannot tell them apart", GROUP)
def gap_refused() -> Got:
    """Nearer than rays start off their patch, one plate would shine through the other."""
    patches = rad.subdivide(rad.scenes.parallel_plates(distance=5e-6), patch_count=32)
    return refuses(rad.errors.GeometryError, lambda: rad.form_factors(patches, rad.MonteCarlo(64)), "Analytic")


@case("a lamp of 1e-12 of the floor's area", "its light on the floor in closed form, within 1e-6", GROUP)
def speck() -> Got:
    """A square micrometre above a square metre; seen from it, the floor is a rectangle under a point."""
    size = 1e-6
    low, high = 0.5 - size / 2, 0.5 + size / 2
    lamp = plate("lamp", [[low, 1, low], [high, 1, low], [high, 1, high], [low, 1, high]], SHINING)
    floor = plate("floor", [[0, 0, 0], [0, 0, 1], [1, 0, 1], [1, 0, 0]], rad.Material(0.5))
    patches = rad.subdivide(rad.Scene([floor, lamp], closed=False))
    factors = rad.form_factors(patches, rad.MonteCarlo(256), dtype=np.float64)
    return within(factors.row(0)[1] / size**2, 4 * closed_forms.element_to_parallel_rectangle(0.5, 0.5, 1.0), 1e-6)


@case("a box that stands on a floor", "what it covers is found, to 1e-6 of its area", GROUP)
def coincident() -> Got:
    """Two faces in one place, looking at each other."""
    floor = plate("floor", [[0, 0, 0], [0, 0, 4], [4, 0, 4], [4, 0, 0]], GREY)
    bottom = plate("bottom", [[1, 0, 1], [2, 0, 1], [2, 0, 3], [1, 0, 3]], GREY)
    found = overlaps(rad.Scene([floor, bottom], closed=False))
    good = len(found) == 1 and abs(found[0].area - 2.0) < 2e-6
    return truth(good, f"{[round(overlap.area, 9) for overlap in found]} m² shared, 2 expected")


@case("a wall that is there twice", "exact factors are refused: more than all is seen", GROUP)
def doubled() -> Got:
    """Exact factors count both; rays meet one of the two."""
    lower, upper = rad.scenes.parallel_plates(distance=0.1).surfaces
    again = rad.Surface("again", upper.vertices, upper.faces, upper.material)
    patches = rad.subdivide(rad.Scene([lower, upper, again], closed=False))
    return refuses(rad.errors.FormFactorError, lambda: rad.form_factors(patches, rad.Analytic()), "overlap")


@case("one patch under a sky", "B = E + ρ π L within 1e-12", GROUP)
def one_patch() -> Got:
    """The smallest scene there is."""
    floor = plate("floor", [[0, 0, 0], [0, 0, 1], [1, 0, 1], [1, 0, 0]], SHINING)
    found = rad.solve(rad.Scene([floor], sky=2.0), patch_count=1).radiosity
    return truth(found.shape == (1, 1) and abs(found[0, 0] - (1.0 + np.pi)) < 1e-12, f"{found.ravel()} W/m²")


@case("a ball under an even sky", "ρ π L everywhere, within 1e-12", GROUP)
def ball() -> Got:
    """Every ray of a convex body goes to the sky."""
    return within(rad.solve(rad.scenes.uniform_dome(0.5, 1.0)).radiosity, 0.5 * np.pi, 1e-12)


@case("open plates in the void", "what is emitted is absorbed or escapes, within the sampling error", GROUP)
def open_sky() -> Got:
    """Most of the light never comes back."""
    solution = rad.solve(rad.scenes.parallel_plates(), patch_count=128, solver=rad.Neumann(rtol=1e-12))
    defect, spread = solution.balance.defect, solution.certificate.energy_error
    good = spread is not None and abs(defect) <= 5 * spread + 1e-9
    return truth(good, f"{defect:+.1e}, standard error {0.0 if spread is None else spread:.0e}")


@case("a triangle without area among others", "left out, with the light of the rest unchanged", GROUP)
def flat_triangle() -> Got:
    """Exporters write them."""
    corners = np.array([[0, 0, 0], [0, 0, 1], [1, 0, 1], [1, 0, 0], [0.5, 0, 1], [0.25, 0, 1]])
    faces = [[0, 1, 2, 3], [1, 4, 5, -1]]
    scene = rad.Scene([rad.Surface("floor", corners, faces, SHINING)], sky=2.0)
    found = rad.solve(scene, patch_count=16).radiosity
    return within(found, 1.0 + np.pi, 1e-12)
