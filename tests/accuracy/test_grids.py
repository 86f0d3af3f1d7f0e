"""Grids of patches that go together in groups: what the gap between the two says of an error, and where nothing."""

from __future__ import annotations

import numpy as np
import pytest

import radiosity as rad
from radiosity.accuracy.grids import first_grid, halved, other_grids, ratios, says_enough
from radiosity.faces import source_faces
from radiosity.nested import finer, parents
from radiosity.patches import cut, grid_of
from tests.benchmarks.bench_gaps import errors_over_gap

SCENES = ["cornell_box", "hidden_lamp", "cluttered_room", "integrating_sphere", "open_rug"]


@pytest.mark.parametrize("name", SCENES)
@pytest.mark.parametrize("count", [50, 700])
def test_a_first_grid_has_groups_that_say_enough(name, count):
    faces = source_faces(rad.scenes.BUILT_IN[name]())
    grid = first_grid(faces, count)
    assert grid.patch_count >= count
    assert says_enough(grid, halved(grid))
    for steps in (grid.columns, grid.rows):
        assert np.all((steps == 1) | (steps % 2 == 0))
    assert halved(grid).patch_count < grid.patch_count


def test_every_patch_lies_in_a_group_of_one_two_or_four():
    scene = rad.scenes.cluttered_room()
    grid = first_grid(source_faces(scene), 700)
    members = np.bincount(parents(cut(scene, grid), halved(grid)))
    assert set(members) == {1, 2, 4}
    assert len(members) == halved(grid).patch_count


def test_other_grids_are_coarser_and_finer_and_their_error_is_foretold_to_fall():
    grid = first_grid(source_faces(rad.scenes.cornell_box()), 300)
    counts, growths = zip(*((count, growth) for _, count, growth in other_grids(grid)), strict=True)
    assert counts[0] < grid.patch_count < counts[-1]
    assert 8 * grid.patch_count < counts[-1] < 12 * grid.patch_count
    assert growths[0] > 1.0 > growths[-1]
    by_area = (grid.patch_count / counts[-1]) ** 0.6
    assert growths[-1] == pytest.approx(by_area, rel=0.15)  # all faces are cut there, and of one size


@pytest.mark.parametrize("name", ["cornell_box", "red_rug", "corridor", "hidden_lamp"])
def test_ratios_are_those_of_the_true_errors(name):
    """Within what `grids` says of nine scenes in ten, two-sided."""
    scene = rad.scenes.BUILT_IN[name]()
    grid = first_grid(source_faces(scene), 400)
    told = ratios(grid, halved(grid))
    true = errors_over_gap(scene, grid, halved(grid))
    assert 0.45 < true[0] / told[0] < 1.4
    assert 0.85 < true[1] / told[1] < 1.2


def test_groups_as_large_as_walls_say_nothing_and_are_not_trusted():
    """Behind a screen, walls that are one group each differ from their halves by a twentieth of the true error."""
    scene = rad.scenes.hidden_lamp()
    faces = source_faces(scene)
    whole, halves = grid_of(faces), grid_of(faces, 55)
    assert not says_enough(halves, whole)
    assert ratios(halves, whole)[0] > 1.5 * ratios(finer(halves, 4), finer(halves, 2))[0]
    coarse = first_grid(faces, 55)
    assert says_enough(coarse, halved(coarse))


def test_what_is_not_cut_at_all_adds_to_the_ratio():
    faces = source_faces(rad.scenes.integrating_sphere())
    whole = grid_of(faces)
    assert not says_enough(whole, whole)
    assert ratios(whole, whole)[0] > 3.0
    assert ratios(finer(whole, 2), whole)[0] < 1.0
