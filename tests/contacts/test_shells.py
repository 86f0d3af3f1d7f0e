"""Shells: closed or not, bodies or rooms."""

from __future__ import annotations

import numpy as np
import pytest

from radiosity import scenes
from radiosity.contacts.shells import encloses, open_vertices, shells, weld
from radiosity.faces import encloses as encloses_by_faces
from radiosity.faces import source_faces
from radiosity.overlaps import scene_triangles
from radiosity.scene import Material, Scene, Surface
from radiosity.scenes.build import block, room, sphere

GREY = Material(0.5)
SQUARE = [[1, 1], [2, 1], [2, 2], [1, 2]]


def shells_of(*surfaces):
    corners, _, _ = scene_triangles(Scene(surfaces))
    return shells(corners, weld(corners))


def test_a_box_is_a_body_and_a_room_is_hollow():
    found = shells_of(*room((0, 0, 0), (4, 3, 4), GREY), Surface("box", *block(SQUARE, 0.5, 1, True), GREY))
    assert found.whole.tolist() == [True, True]
    assert found.solid.tolist() == [False, True]
    assert found.hollow.tolist() == [True, False]
    assert len(found.rim) == 0
    assert found.low.tolist() == [[0, 0, 0], [1, 0.5, 1]]
    assert found.high.tolist() == [[4, 3, 4], [2, 1, 2]]


def test_a_box_without_a_bottom_has_a_rim_of_four_edges():
    found = shells_of(Surface("box", *block(SQUARE, 0, 1, False), GREY))
    assert (found.whole.tolist(), found.solid.tolist(), len(found.rim)) == ([False], [False], 4)


def test_a_box_on_a_floor_that_has_its_corners_is_a_shell_of_its_own():
    """Edges of three and four faces join none: what only touches does not hang together."""
    vertices, faces = block(SQUARE, 0, 1, True)
    floor = Surface("floor", [[x, 0, z] for x, z in SQUARE], [[3, 2, 1, 0]], GREY)
    found = shells_of(Surface("box", vertices, faces[:-1], GREY), floor)
    assert found.shell.max() == 0  # the floor closes the box, as nothing else is there
    wide = Surface("wide", [[0, 0, 1], [1, 0, 1], [1, 0, 2], [0, 0, 2]], [[3, 2, 1, 0]], GREY)
    found = shells_of(Surface("box", vertices, faces, GREY), floor, wide)
    assert found.whole.sum() == 0
    assert found.shell.max() > 0


def test_two_faces_run_the_same_way_are_no_closed_shell():
    vertices, faces = block(SQUARE, 0, 1, True)
    faces = faces.copy()
    faces[2] = faces[2][::-1]
    found = shells_of(Surface("box", vertices, faces, GREY))
    assert not found.whole.any()


def test_open_vertices_are_those_of_the_rim():
    vertices, faces = sphere((0, 0, 0), 1, 3, 1)
    assert not open_vertices(faces).any()
    hole = np.delete(faces, [100, 555], axis=0)
    assert set(np.flatnonzero(open_vertices(hole)).tolist()) == set(faces[[100, 555]].ravel().tolist())
    corners = vertices[hole]
    found = shells(corners, weld(corners))
    assert len(found.rim) == 6
    assert not found.whole.any()


def test_corners_count_as_one_bit_by_bit_and_by_group():
    corners = np.array([[[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[1, 0, 0], [-0.0, 0, 0], [0, -1, 0]]], dtype=float)
    together = weld(corners)
    assert together[0, 0] == together[1, 1]
    assert together[0, 1] == together[1, 0]
    assert len(np.unique(together)) == 4
    assert len(np.unique(weld(corners, np.array([0, 1])))) == 6


@pytest.mark.parametrize("name", scenes.BUILT_IN)
def test_closed_scenes_are_found_as_by_their_faces(name):
    scene = scenes.BUILT_IN[name]()
    found = shells_of(*scene.surfaces)
    assert encloses(found.hollow, found.low, found.high) == encloses_by_faces(source_faces(scene))
