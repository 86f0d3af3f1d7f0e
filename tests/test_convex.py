"""First hits in convex rooms by arithmetic: the same patches as through Embree's tree."""

from __future__ import annotations

import numpy as np
import pytest

import radiosity as rad
from radiosity.convex import ConvexTracer, is_convex_room, wall_of
from radiosity.form_factors.monte_carlo import MonteCarlo
from radiosity.rays import Tracer

TENT = [[0, 0, 0], [4, 0, 0], [4, 0, 3], [0, 0, 3], [1, 2, 1.5], [3, 2, 1.5]]  # a hipped roof


def tent():
    """A convex room of triangles and of quads that are no parallelograms."""
    faces = [[3, 2, 1, 0], [0, 1, 5, 4], [2, 3, 4, 5]], [[1, 2, 5], [3, 0, 4]]
    grey = rad.Material(0.5, emission=1.0)
    return rad.Scene([rad.Surface(f"walls {k}", TENT, f, grey) for k, f in enumerate(faces)], name="tent", closed=True)


def convex(scene):
    patches = rad.subdivide(scene)
    return is_convex_room(patches.grid.faces, patches.closed)


@pytest.mark.parametrize("make", [rad.scenes.furnace, rad.scenes.red_rug, tent])
def test_rays_meet_the_same_patches(make):
    patches = rad.subdivide(make(), patch_count=400)
    assert is_convex_room(patches.grid.faces, patches.closed)
    by_tree, by_walls = (
        rad.form_factors(patches, MonteCarlo(1024, light_rays=0), tracer=kind(patches.grid), dtype=np.float64)
        for kind in (Tracer, ConvexTracer)
    )
    moved = abs(by_tree.matrix - by_walls.matrix).sum() / 2 * 1024  # rays that count for another patch
    assert moved < 1e-4 * 1024 * len(patches)
    assert not by_walls.to_sky.any()
    np.testing.assert_allclose(by_walls.closure_defect, 0.0, atol=1e-12)


def test_which_rooms_are_convex():
    assert convex(rad.scenes.furnace())
    assert convex(rad.scenes.red_rug())  # coplanar faces
    assert not convex(rad.scenes.cornell_box())  # open, and blocks in it
    assert not convex(rad.scenes.two_rooms())
    assert not convex(rad.scenes.cluttered_room(3))
    assert not convex(rad.scenes.integrating_sphere())  # more walls than a tree has trouble with


def test_faces_of_one_plane_are_one_wall():
    faces = rad.subdivide(rad.scenes.red_rug()).grid.faces
    assert len(faces) > 6
    assert sorted(set(wall_of(faces).tolist())) == list(range(6))
