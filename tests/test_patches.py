"""Patches tile their faces, and a point of a face finds its patch by arithmetic."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import radiosity as rad
from radiosity.errors import GeometryWarning, ParameterError
from radiosity.geometry import quad_vector_areas, triangle_vector_areas, unit
from radiosity.patches import locate


def soup(seed, count=12, two_sided=True):
    """Random triangles and random planar convex quads, half of them two-sided."""
    rng = np.random.default_rng(seed)
    surfaces = []
    for k in range(count):
        origin, along, across = rng.normal(size=(3, 3))
        if k % 2:
            g, h = rng.uniform(0.7, 1.5, 2)
            points = np.stack([origin, origin + along, origin + g * along + h * across, origin + across])
            faces = [[0, 1, 2, 3]]
        else:
            points, faces = np.stack([origin, origin + along, origin + across]), [[0, 1, 2]]
        material = rad.Material(rng.uniform(0, 1, 3), emission=rng.uniform(0, 1, 3), two_sided=two_sided and k % 4 < 2)
        surfaces.append(rad.Surface(f"face {k}", points, faces, material))
    return rad.Scene(surfaces)


@given(st.integers(0, 2**32 - 1), st.floats(0.02, 2.0))
def test_patches_tile_their_faces(seed, size):
    patches = rad.subdivide(soup(seed), patch_size=max(size, 0.1))
    faces = patches.grid.faces
    total = np.bincount(patches.face, patches.area, len(faces))
    assert total == pytest.approx(faces.area * (1 + faces.two_sided), rel=1e-12)
    corners = patches.corners
    triangle = patches.faces[:, 3] < 0
    vector = np.where(triangle[:, None], triangle_vector_areas(corners[:, :3]), quad_vector_areas(corners))
    assert np.linalg.norm(vector, axis=1) == pytest.approx(patches.area, rel=1e-9)
    assert np.allclose(unit(vector), patches.normal, atol=1e-9)


@given(st.integers(0, 2**32 - 1), st.integers(50, 2000))
def test_a_point_of_a_patch_finds_it_again(seed, count):
    patches = rad.subdivide(soup(seed), patch_count=count)
    faces = patches.grid.faces
    rng = np.random.default_rng(seed)
    weights = rng.dirichlet(np.ones(4), len(patches))
    weights[patches.faces[:, 3] < 0, 3] = 0.0
    weights /= weights.sum(axis=1, keepdims=True)
    points = np.einsum("nk,nkx->nx", weights, patches.corners)
    u, v = bilinear_coordinates(faces.corners[patches.face], faces.quad[patches.face], points)
    found = locate(patches.grid, patches.face, u, v, patches.side < 0)
    assert (found == np.arange(len(patches))).all()


def bilinear_coordinates(corners, quad, points):
    """(u, v) of points on planar faces by Newton's method; an affine face takes one step."""
    u, v = np.full((2, len(points)), 0.3)
    a, b = corners[:, 1] - corners[:, 0], np.where(quad[:, None], corners[:, 3], corners[:, 2]) - corners[:, 0]
    twist = np.where(quad[:, None], corners[:, 2] - corners[:, 0] - a - b, 0.0)
    for _ in range(30):
        rest = points - corners[:, 0] - u[:, None] * a - v[:, None] * b - (u * v)[:, None] * twist
        slope = np.stack([a + v[:, None] * twist, b + u[:, None] * twist], axis=2)
        step = np.einsum("nij,nj->ni", np.linalg.pinv(slope), rest)
        u, v = u + step[:, 0], v + step[:, 1]
    return u, v


def test_a_black_back_is_no_patch():
    patches = rad.subdivide(soup(1, two_sided=False), patch_count=100)
    face = np.zeros(3, dtype=int)
    assert locate(patches.grid, face, np.full(3, 0.1), np.full(3, 0.2), np.ones(3, dtype=bool)).tolist() == [-1] * 3


@pytest.mark.parametrize("count", [600, 2_000, 10_000, 50_000])
def test_the_count_is_met_within_15_percent(count):
    for scene in (rad.scenes.cornell_box(), rad.scenes.furnace(), rad.scenes.red_rug(), soup(3)):
        assert abs(len(rad.subdivide(scene, patch_count=count)) / count - 1) < 0.15


def test_patch_size_bounds_the_longest_edge():
    patches = rad.subdivide(rad.scenes.cornell_box(), patch_size=0.07)
    corners = patches.corners
    edges = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2)
    assert 0.06 < edges.max() <= 0.07 * (1 + 1e-9)


def test_faces_are_kept_when_there_are_more_than_asked_for():
    with pytest.warns(GeometryWarning, match="18 faces .* patch_count 10"):
        patches = rad.subdivide(soup(0), patch_count=10)
    assert len(patches) == 18  # 12 faces, 6 of them two-sided


def test_two_sides_of_a_face_face_apart():
    patches = rad.subdivide(soup(5), patch_count=300)
    lit = np.flatnonzero(patches.side < 0)
    front = lit - patches.grid.back[patches.face[lit]] + patches.grid.front[patches.face[lit]]
    assert (patches.normal[lit] == -patches.normal[front]).all()
    assert (patches.centroid[lit] == patches.centroid[front]).all()
    assert (patches.emission[lit] == patches.emission[front]).all()


@pytest.mark.parametrize(
    ("kwargs", "message"),
    [
        ({"patch_count": 10, "patch_size": 1.0}, "not both"),
        ({"patch_count": 0}, "patch_count is 0"),
        ({"patch_size": 0.0}, "patch_size is 0"),
        ({"patch_size": np.nan}, "patch_size is nan"),
        ({"patch_size": 1e-9}, "steps"),
    ],
)
def test_sizes_that_make_no_patches(kwargs, message):
    with pytest.raises(ParameterError, match=message):
        rad.subdivide(soup(0), **kwargs)
