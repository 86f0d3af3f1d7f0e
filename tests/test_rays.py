"""Rays find the right patch at any scale and place, and sample points are uniform in area."""

from __future__ import annotations

import numpy as np
import pytest

import radiosity as rad
from radiosity.face_points import OFFSET, cell_at, patch_point, patch_points
from radiosity.patches import locate
from radiosity.rays import BACK, MISS, Tracer

from .test_patches import bilinear_coordinates, soup


def moved(scene, scale=1.0, shift=0.0):
    surfaces = [rad.Surface(s.name, s.vertices * scale + shift, s.faces, s.material) for s in scene.surfaces]
    return rad.Scene(surfaces, closed=scene.closed)


def points_of(tracer, patches, i, count, seed=0):
    """Sample points of patch i in unit coordinates, lifted."""
    rng = np.random.default_rng(seed)
    f = patches.face[i]
    first = patches.grid.front[f] if patches.side[i] > 0 else patches.grid.back[f]
    out = np.empty((count, 3))
    for row, (s, t) in zip(out, rng.random((count, 2)), strict=True):
        patch_point(tracer.table, f, i - first, float(patches.side[i]), s, t, row)
    return out


def test_sample_points_lie_on_their_patch_and_lifted_to_its_side():
    patches = rad.subdivide(soup(2), patch_count=200)
    tracer = Tracer(patches.grid)
    for i in range(0, len(patches), 7):
        points = points_of(tracer, patches, i, 50)
        lift = (points - tracer.to_unit(patches.centroid[i])) @ patches.normal[i]
        assert lift == pytest.approx(np.full(50, OFFSET), rel=1e-6)
        face = np.full(50, patches.face[i])
        faces = patches.grid.faces
        flat = (points - OFFSET * patches.normal[i]) / tracer.scale + tracer.centre
        u, v = bilinear_coordinates(faces.corners[face], faces.quad[face], flat)
        assert (locate(patches.grid, face, u, v, np.full(50, patches.side[i] < 0)) == i).all()


def test_many_points_at_once_are_the_same_points():
    patches = rad.subdivide(soup(3), patch_count=300)
    table = Tracer(patches.grid).table
    s, t = np.random.default_rng(0).random((2, 20))
    for i in range(len(patches)):
        f, up = patches.face[i], float(patches.side[i])
        cell = i - (patches.grid.front[f] if up > 0 else patches.grid.back[f])
        one_by_one, together = np.empty((20, 3)), np.empty((20, 3), dtype=np.float32)
        for row, (a, b) in zip(one_by_one, zip(s, t, strict=True), strict=True):
            patch_point(table, f, cell, up, a, b, row)
        patch_points(table, f, cell, up, s, t, together)
        assert together == pytest.approx(one_by_one, abs=1e-7)


@pytest.mark.parametrize("seed", [0, 1])
def test_sample_points_are_uniform_in_area(seed):
    """Their mean is the patch's centre of area: within 4 standard errors in each coordinate."""
    patches = rad.subdivide(soup(seed))
    tracer = Tracer(patches.grid)
    for i in range(len(patches)):
        points = points_of(tracer, patches, i, 4000, seed) - OFFSET * patches.normal[i]
        error = points.std(axis=0) / np.sqrt(len(points)) + 1e-9
        assert (np.abs(points.mean(axis=0) - tracer.to_unit(patches.centroid[i])) < 4 * error).all()


def test_a_bent_quads_points_lie_on_the_triangles_that_rays_meet():
    corner = [[0, 0, 0], [1, 0, 0], [1, 1, 1e-3], [0, 1, 0]]  # 0.08°, flat enough to stay one quad
    patches = rad.subdivide(rad.Scene([rad.Surface("bent", corner, [[0, 1, 2, 3]], rad.Material(0.5))]))
    assert patches.grid.faces.quad.all()
    tracer = Tracer(patches.grid)
    points = points_of(tracer, patches, 0, 1000) / tracer.scale + tracer.centre
    x, y, z = points.T
    on_triangles = 1e-3 * np.maximum(0.0, x + y - 1.0)
    assert z - on_triangles == pytest.approx(np.full(1000, OFFSET / tracer.scale), rel=1e-2)


@pytest.mark.parametrize("scale", [1e-9, 1e-3, 1.0, 1e3, 1e9])
@pytest.mark.parametrize("shift", [0.0, 1e6])
def test_hits_are_right_at_any_scale_and_place(scale, shift):
    """Rays from inside a convex room: the wall met is known from the directions alone."""
    room = moved(rad.scenes.furnace(), scale, scale * shift)
    patches = rad.subdivide(room, patch_count=600)
    tracer = Tracer(patches.grid)
    rng = np.random.default_rng(0)
    target = rng.integers(0, len(patches), 20_000)
    weights = rng.dirichlet(np.full(4, 2.0), len(target))
    points = np.einsum("nk,nkx->nx", weights, tracer.to_unit(patches.corners[target]))
    origins = rng.uniform(-0.1, 0.1, (len(target), 3))
    found = tracer.run(origins.astype(np.float32), (points - origins).astype(np.float32))
    assert (found >= 0).all()
    wrong = np.flatnonzero(found != target)
    assert (patches.face[found[wrong]] == patches.face[target[wrong]]).all()
    near_an_edge = weights[wrong].min(axis=1) < 1e-3
    assert near_an_edge.all(), "only rounding at a patch's edge may move a hit to its neighbour"


def test_no_self_hits_and_no_leaks_from_patches_of_a_closed_room():
    patches = rad.subdivide(rad.scenes.furnace(), patch_count=600)
    factors = rad.form_factors(patches, rad.MonteCarlo(rays=1024))
    assert factors.statistics["rays/leaked"] == 0
    assert factors.statistics["rays/to backs"] == 0
    wall = patches.face
    same_wall = factors.matrix.tocoo()
    assert (wall[same_wall.coords[0]] != wall[same_wall.coords[1]]).all(), "a flat wall does not see itself"


def test_misses_and_backs_are_told_apart():
    square = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
    patches = rad.subdivide(rad.Scene([rad.Surface("square", square, [[0, 1, 2, 3]], rad.Material(0.5))]))
    origins = np.array([[0.1, 0.1, 0.5], [0.1, 0.1, -0.5], [9, 9, 9]], dtype=np.float32)
    directions = np.array([[0, 0, -1], [0, 0, 1], [0, 0, 1]], dtype=np.float32)
    assert Tracer(patches.grid).run(origins, directions).tolist() == [0, BACK, MISS]


def test_the_kernel_and_its_readable_twin_agree_on_two_sided_soup():
    patches = rad.subdivide(soup(4), patch_count=500)
    tracer = Tracer(patches.grid)
    whole = rad.subdivide(soup(4))
    rng = np.random.default_rng(3)
    aims = tracer.to_unit(patches.centroid)[rng.integers(0, len(patches), 50_000)] + rng.normal(0, 0.05, (50_000, 3))
    origins = rng.uniform(-0.6, 0.6, (50_000, 3)).astype(np.float32)
    directions = (aims - origins).astype(np.float32)
    found = tracer.run(origins, directions)
    side = Tracer(whole.grid).run(origins, directions)  # one patch for each side of each face
    assert ((found < 0) == (side < 0)).all()
    hit = found >= 0
    assert 5_000 < hit.sum() < 50_000
    assert (patches.face[found[hit]] == whole.face[side[hit]]).all()
    assert (patches.side[found[hit]] == whole.side[side[hit]]).all()
    centre, normal = tracer.to_unit(patches.centroid[found[hit]]), patches.normal[found[hit]]
    origin, direction = origins[hit].astype(float), directions[hit].astype(float)
    along = np.einsum("nx,nx->n", centre - origin, normal) / np.einsum("nx,nx->n", direction, normal)
    points = (origin + along[:, None] * direction) / tracer.scale + tracer.centre
    face = patches.face[found[hit]]
    u, v = bilinear_coordinates(patches.grid.faces.corners[face], patches.grid.faces.quad[face], points)
    twin = locate(patches.grid, face, u, v, patches.side[found[hit]] < 0)
    assert np.mean(twin == found[hit]) > 0.9995, "differences only by float32 rounding at edges of patches"


def test_a_hit_that_rounding_puts_past_an_edge_is_in_the_cell_at_that_edge():
    """On the long edge of a triangle the last cell of each row has no second half; and corners lie in cells, too."""
    corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]
    face = rad.Surface("face", corners, [[0, 1, 2]], rad.Material(reflectance=0.5))
    patches = rad.subdivide(rad.Scene([face]), patch_size=0.3)
    table, columns = Tracer(patches.grid).table, int(patches.grid.columns[0])
    assert columns > 3
    along = np.concatenate([(np.arange(columns) + 0.5) / columns, np.linspace(0.0, 1.0, 50)])
    for past in (-1e-6, 1e-6):
        a, b = along, 1.0 - along + past
        cells = np.array([cell_at(table, 0, *place) for place in zip(a, b, strict=True)])
        first = np.zeros(len(a), dtype=int)
        assert np.array_equal(cells, locate(patches.grid, first, a, b, first < 0))
        assert cells.min() >= 0 and cells.max() < len(patches)
        inside = (along > 0.02) & (along < 0.98)
        assert np.abs(patches.centroid[cells[inside], :2].sum(axis=1) - 1.0).max() < 1.0 / columns
