"""Light in scenes whose contacts were cut: as in scenes without any, and not as in those that were left."""

from __future__ import annotations

import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import radiosity as rad
from radiosity.contacts import remove_contacts
from radiosity.scene import Material, Scene, Surface
from radiosity.scenes.build import block, panel, room

from .test_remove import measured_cornell_box

MESHES = Path(__file__).resolve().parents[2] / "meshes"
SEEDS = range(4)


def uncut_floor():
    """The built-in Cornell box on the whole floor of the data."""
    raw = {surface.name: surface for surface in measured_cornell_box().surfaces}
    box = rad.scenes.cornell_box()
    return replace(box, surfaces=tuple(raw["floor"] if s.name == "floor" else s for s in box.surfaces))


def solutions(scene, count=1200):
    return [rad.solve(scene, patch_count=count, estimator=rad.MonteCarlo(rays=256, seed=seed)) for seed in SEEDS]


def surface_means(solved):
    """Mean radiosity of each surface, (surfaces, C), and its standard error over the seeds."""
    means = []
    for solution in solved:
        patches, count = solution.patches, len(solution.patches.surface_names)
        area = np.bincount(patches.surface, patches.area, minlength=count)
        power = [np.bincount(patches.surface, patches.area * b, minlength=count) for b in solution.radiosity.T]
        means.append((np.array(power) / area).T)
    return np.mean(means, axis=0), np.std(means, axis=0, ddof=1) / np.sqrt(len(means))


def near_the_blocks(solution, distance=0.01):
    """Mean red radiosity of the floor's patches at points that far in front of the blocks' walls."""
    points = []
    for name in ("short_block", "tall_block"):
        block_surface = next(s for s in solution.scene.surfaces if s.name == name)
        bottom = block_surface.vertices[block_surface.vertices[:, 1] == 0][:, [0, 2]]
        corners = np.unique(bottom.round(9), axis=0)
        middle = corners.mean(axis=0)
        corners = corners[np.argsort(np.arctan2(*(corners - middle).T))]
        for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True):
            out = np.array([(b - a)[1], -(b - a)[0]]) / np.linalg.norm(b - a)
            out *= np.sign(out @ (a - middle))
            points += [a + share * (b - a) + distance * out for share in np.linspace(0.05, 0.95, 19)]
    patches = solution.patches
    floor = np.flatnonzero(patches.surface == patches.surface_names.index("floor"))
    shapes = patches.corners[floor][:, :, [0, 2]]
    edges = np.roll(shapes, -1, axis=1) - shapes
    found = []
    for point in points:
        away = point - shapes
        side = edges[..., 0] * away[..., 1] - edges[..., 1] * away[..., 0]
        holds = (side >= 0).all(axis=1) | (side <= 0).all(axis=1)
        found.append(solution.radiosity[floor[holds], 0].mean())
    return float(np.mean(found))


@pytest.fixture(scope="module")
def built_in():
    return solutions(rad.scenes.cornell_box())


@pytest.fixture(scope="module")
def cut():
    return solutions(remove_contacts(uncut_floor())[0])


@pytest.fixture(scope="module")
def uncut():
    return solutions(uncut_floor())


def deviations(one, other):
    """Differences of the surfaces' mean radiosities in standard errors, the lamp's counted in what it reflects."""
    (a, error_a), (b, error_b) = surface_means(one), surface_means(other)
    return (a - b) / np.hypot(np.hypot(error_a, error_b), 1e-3 * np.minimum(a, b))  # 0.1 %: the patches differ


def test_light_is_that_of_the_box_that_was_cut_by_hand(cut, built_in):
    """Also of the measured data as they are, with the lamp in the plane of the ceiling."""
    assert np.abs(deviations(cut, built_in)).max() < 5
    measured = solutions(remove_contacts(measured_cornell_box())[0])
    assert np.abs(deviations(measured, built_in)).max() < 5


def test_left_uncut_the_floor_near_the_blocks_is_too_dark(cut, uncut, built_in):
    """The negative control of the one above: what is mended is there, and is seen by this measure."""
    assert deviations(uncut, built_in).min() < -10
    expected, mended, left = (np.array([near_the_blocks(s) for s in solved]) for solved in (built_in, cut, uncut))
    error = np.sqrt((expected.var(ddof=1) + mended.var(ddof=1)) / len(SEEDS))
    assert mended.mean() == pytest.approx(expected.mean(), abs=5 * error + 0.04 * expected.mean())
    assert left.mean() < 0.8 * expected.mean()


def test_left_uncut_a_lamp_in_the_plane_of_the_ceiling_is_lost():
    """Whether a ray meets lamp or ceiling there is chance."""
    raw, _ = surface_means(solutions(measured_cornell_box(), 600)[:2])
    right, _ = surface_means(solutions(rad.scenes.cornell_box(), 600)[:2])
    assert (raw[0] < 0.5 * right[0]).all()  # the floor


def test_rows_of_the_floor_lose_nothing_under_the_blocks(cut, uncut):
    for solved, most in ((cut, 0.0), (uncut, 1.0)):
        factors, patches = solved[0].factors, solved[0].patches
        floor = patches.surface == patches.surface_names.index("floor")
        assert factors.to_backs[floor].max() == most
        sums = factors.matrix.sum(axis=1)[floor] + factors.to_sky[floor]
        assert sums.min() == pytest.approx(1.0 - most, abs=1e-6)


def closed_room(*things):
    grey = Material(0.5)
    lamp = Surface("lamp", *panel((1, 2.9, 1), (3, 2.9, 3), -1), Material(0.5, emission=1.0))
    return Scene([*room((0, 0, 0), (4, 3, 4), grey), lamp, *things])


def test_nothing_leaks_where_a_box_was_cut_from_a_floor():
    """Turned anywhere, the edges of the hole and of the box meet in rounded points."""
    rng = np.random.default_rng(5)
    angle = 0.3
    square = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * 0.6
    footprint = square @ [[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]] + 1.8
    for closed in (True, False):
        scene = closed_room(Surface("box", *block(footprint, 0, 1, closed), Material(0.5)))
        turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
        turn *= np.sign(np.linalg.det(turn))
        moved = replace(scene, surfaces=tuple(replace(s, vertices=s.vertices @ turn.T) for s in scene.surfaces))
        found, report = remove_contacts(moved)
        assert report.removed["floor"] == pytest.approx(1.44)
        patches = rad.subdivide(found, patch_count=500)
        assert patches.closed
        factors = rad.form_factors(patches, rad.MonteCarlo(rays=4096))
        assert factors.statistics["rays/traced"] > 1.5e6
        assert factors.statistics["rays/leaked"] == 0
        assert np.abs(factors.closure_defect).max() < 1e-6


def test_a_box_whose_contact_was_kept_lies_outside_and_is_no_leak():
    """Its bottom looks out from under the floor: that is said, and no light is missing."""
    scene = closed_room(Surface("box", *block([[1, 1], [2, 1], [2, 2], [1, 2]], 0, 1, True), Material(0.5)))
    solution = rad.solve(scene, patch_count=600)
    bottom = (solution.patches.surface == 7) & (solution.patches.centroid[:, 1] == 0)
    assert bottom.sum() > 3
    assert solution.factors.to_sky[bottom] == pytest.approx(1.0)
    assert solution.factors.to_sky[~bottom].max() == 0.0
    assert solution.statistics["rays/leaked"] == 0
    assert solution.certificate.closure < 1e-6
    assert f"{bottom.sum()} look at nothing but the black surroundings (box)" in str(solution)
    assert "no leaks" in str(solution)
    assert "look at nothing" not in str(rad.solve(remove_contacts(scene)[0], patch_count=600))


def test_a_torn_room_still_leaks():
    """The other side of the above: patches that see a hole and other things besides are inside."""
    parts = closed_room().surfaces
    torn = replace(Scene(parts[:1] + parts[2:]), closed=True)  # without its ceiling
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        solution = rad.solve(torn, patch_count=300)
    assert solution.certificate.leaks > 0.05
    assert solution.factors.to_sky.max() == 0.0


def test_studio_has_no_light_under_the_crate():
    """Two-sided throughout: the crate's inside is dark, and its underside is not seen from below."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        scene = rad.read_scene(MESHES / "studio.glb")
        kept = rad.read_scene(MESHES / "studio.glb", contacts="keep")
    inside = []
    for one in (scene, kept):
        solution = rad.solve(one, patch_count=3000)
        crate = solution.patches.surface == one.surface_names.index("Crate")
        inside.append(solution.radiosity[crate & (solution.patches.side < 0)].max())
    assert inside[0] == 0.0
    assert inside[1] > 1e-4  # rays slip in where the floor and the bottom are one plane
