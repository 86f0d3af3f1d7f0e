"""Patches that light cannot reach are counted, with the reason."""

from __future__ import annotations

import numpy as np

import radiosity as rad
from radiosity.dark import dark_patches
from radiosity.scene import Material, Scene, Surface
from radiosity.scenes.build import block, panel, room

GREY, TWO = Material(0.5), Material(0.5, two_sided=True)
LAMP = Surface("lamp", *panel((1, 2.5, 1), (2.5, 2.5, 2.5), -1), Material(0.5, emission=1.0))


def found_in(scene, count=400):
    patches = rad.subdivide(scene, patch_count=count)
    factors = rad.form_factors(patches, rad.MonteCarlo(rays=64))
    return patches, dark_patches(patches, factors)


def names(patches, numbers):
    return {patches.surface_names[k] for k in patches.surface[numbers]}


def box(low, high, name, material=GREY):
    (x0, y0, z0), (x1, y1, z1) = low, high
    return Surface(name, *block([[x0, z0], [x1, z0], [x1, z1], [x0, z1]], y0, y1, True), material)


def test_a_lit_room_has_none():
    _, dark = found_in(Scene([*room((0, 0, 0), (4, 3, 4), GREY), LAMP]))
    assert len(dark) == 0
    assert dark.story == ""
    assert "no light was found" not in str(rad.solve(rad.scenes.red_rug(), patch_count=200))


def test_each_reason():
    """Two-sided walls look outside, a box in a box sees backs only, a two-sided box is dark inside."""
    inner, outer = box((1.2, 0.7, 1.2), (1.8, 1.3, 1.8), "inner"), box((1, 0.5, 1), (2, 1.5, 2), "outer")
    sealed = box((3, 0.5, 1), (3.5, 1, 2), "sealed", TWO)
    patches, dark = found_in(Scene([*room((0, 0, 0), (4, 3, 4), TWO), LAMP, inner, outer, sealed]))
    walls = np.isin(patches.surface, range(6))
    assert dark.outside.tolist() == np.flatnonzero(walls & (patches.side < 0)).tolist()
    assert names(patches, dark.covered) == {"inner"}
    assert len(dark.covered) == (patches.surface == 7).sum()
    assert dark.shut_in.tolist() == np.flatnonzero((patches.surface == 9) & (patches.side < 0)).tolist()
    assert dark.story.startswith(
        f"no light was found for {len(dark)} of {len(patches)} patches: {len(dark.outside)} look at"
    )
    assert "see nothing but black backs (inner)" in dark.story
    assert "are shut off (sealed)" in dark.story


def test_under_a_sky_the_outside_is_lit():
    scene = Scene([*room((0, 0, 0), (4, 3, 4), TWO), LAMP], sky=1.0)
    patches, dark = found_in(scene)
    assert len(dark) == 0
    assert (patches.side < 0).any()


def test_a_scene_without_light_says_so_elsewhere():
    _, dark = found_in(Scene(room((0, 0, 0), (4, 3, 4), GREY)))
    assert len(dark) == 0


def test_the_command_line_tells(capsys):
    from radiosity.cli.console import Screen
    from radiosity.cli.report import print_report

    sealed = box((3, 0.5, 1), (3.5, 1, 2), "sealed", TWO)
    solution = rad.solve(Scene([*room((0, 0, 0), (4, 3, 4), GREY), LAMP, sealed]), patch_count=300)
    screen = Screen(quiet=False)
    print_report(solution, screen.out)
    printed = " ".join(capsys.readouterr().out.split())
    assert "are shut off (sealed)" in printed


def test_a_patch_that_sees_a_little_else_is_neither_outside_nor_covered():
    squares = [Surface(name, *panel((x, 0, 0), (x + 1, 0, 1), 1), GREY) for x, name in ((2, "a"), (4, "b"), (6, "c"))]
    patches = rad.subdivide(Scene([LAMP, *squares]))
    factors = rad.FormFactors.from_matrix(
        np.zeros((4, 4)), patches.area, to_sky=[1.0, 1.0, 0.5, 0.0], to_backs=[0.0, 0.0, 0.5, 1.0]
    )
    dark = dark_patches(patches, factors)
    assert (dark.outside.tolist(), dark.shut_in.tolist(), dark.covered.tolist()) == ([1], [2], [3])
