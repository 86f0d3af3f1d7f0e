"""Faces that lie in each other are found, with the area they share; faces that only touch are not."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from radiosity import scenes
from radiosity.overlaps import overlaps
from radiosity.scene import Material, Scene, Surface

GREY = Material(0.5)
FLOOR = Surface("floor", [[0, 0, 0], [0, 0, 4], [4, 0, 4], [4, 0, 0]], [[0, 1, 2, 3]], GREY)


def slab(x, z, width, depth, y=0.0, up=False, name="slab"):
    faces = [[0, 1, 2, 3]] if up else [[3, 2, 1, 0]]
    return Surface(name, [[x, y, z], [x, y, z + depth], [x + width, y, z + depth], [x + width, y, z]], faces, GREY)


def turned(scene, seed):
    """The scene in any position: turned, scaled, shifted."""
    rng = np.random.default_rng(seed)
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    factor, shift = 10 ** rng.uniform(-6, 6), rng.normal(size=3)
    surfaces = [Surface(s.name, factor * (s.vertices @ turn.T + shift), s.faces, s.material) for s in scene.surfaces]
    return Scene(surfaces), factor


@given(st.floats(-1, 4), st.floats(-1, 4), st.booleans(), st.integers(0, 1000))
def test_shared_area_of_rectangles_in_any_position(x, z, up, seed):
    scene, factor = turned(Scene([FLOOR, slab(x, z, 1, 1.5, up=up)]), seed)
    expected = max(0.0, min(4, x + 1) - max(0, x)) * max(0.0, min(4, z + 1.5) - max(0, z))
    if 0 < expected < 0.01:
        return  # at the border of what counts
    found = overlaps(scene)
    if expected == 0:
        assert found == []
    else:
        (overlap,) = found
        assert (overlap.first, overlap.second) == (0, 1)
        assert overlap.area / factor**2 == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize(("height", "count"), [(0.0, 1), (1e-7, 1), (1e-3, 0)])
def test_how_close_is_one_plane(height, count):
    assert len(overlaps(Scene([FLOOR, slab(1, 1, 1, 1, y=height)]))) == count


def test_neighbours_and_crossing_planes_do_not_overlap():
    wall = Surface("wall", [[2, -1, 0], [2, -1, 4], [2, 1, 4], [2, 1, 0]], [[0, 1, 2, 3]], GREY)
    assert overlaps(Scene([FLOOR, slab(4, 0, 2, 4), slab(0, -3, 4, 3, name="other"), wall])) == []


def test_doubled_faces_of_one_surface():
    both = Surface("leaf", [[0, 0, 0], [1, 0, 0], [0, 0, 2]], [[0, 1, 2], [2, 1, 0]], GREY)
    (overlap,) = overlaps(Scene([both]))
    assert (overlap.first, overlap.second, overlap.area) == (0, 0, pytest.approx(1.0))


def test_many_faces_on_one_floor():
    """A finely divided floor under one box: the sum over all its triangles."""
    n = 40
    grid = np.stack(np.meshgrid(np.linspace(0, 4, n + 1), [0.0], np.linspace(0, 4, n + 1), indexing="ij"), axis=-1)
    i, j = (a.ravel() for a in np.meshgrid(np.arange(n), np.arange(n), indexing="ij"))
    a = i * (n + 1) + j
    faces = np.concatenate([np.column_stack([a, a + 1, a + n + 2]), np.column_stack([a, a + n + 2, a + n + 1])])
    floor = Surface("floor", grid.reshape(-1, 3), faces, GREY)
    (overlap,) = overlaps(Scene([floor, slab(0.33, 1.7, 1.1, 0.9)]))
    assert overlap.area == pytest.approx(1.1 * 0.9, rel=1e-9)


@pytest.mark.parametrize("name", scenes.BUILT_IN)
def test_built_in_scenes_have_none(name):
    assert overlaps(scenes.BUILT_IN[name]()) == []
