"""Faces that share area are found among others, however they lie, and what they share is measured."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from radiosity import coplanar, face_points
from radiosity.coplanar import areas, common_shapes, coplanar_pairs


def clipped_area(one, other):
    """Area that two convex polygons (n, 2), counter-clockwise, have in common: one pair, corner by corner."""
    shape = [tuple(p) for p in other]
    for a, b in zip(one, np.roll(one, -1, axis=0), strict=True):
        depth = [(b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]) for p in shape]
        kept = []
        for k, p in enumerate(shape):
            q, here, after = shape[(k + 1) % len(shape)], depth[k], depth[(k + 1) % len(shape)]
            if here >= 0:
                kept.append(p)
            if (here >= 0) != (after >= 0):
                share = here / (here - after)
                kept.append((p[0] + share * (q[0] - p[0]), p[1] + share * (q[1] - p[1])))
        shape = kept
        if not shape:
            return 0.0
    x, y = np.array(shape).T
    return 0.5 * float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))


def anywhere(seed):
    """A turn, a scale and a shift to apply to points (…, 3)."""
    rng = np.random.default_rng(seed)
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    scale, shift = 10 ** rng.uniform(-9, 9), rng.normal(size=3)
    return (lambda points: scale * (points @ turn.T + shift)), scale


def triangles(rng, count, size=1.0):
    """Flat triangles, counter-clockwise, (n, 3, 2)."""
    corners = rng.uniform(0, 3, (count, 1, 2)) + size * rng.uniform(-1, 1, (count, 3, 2))
    a, b = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    clockwise = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0] < 0
    corners[clockwise] = corners[clockwise][:, ::-1]
    return corners


@given(st.integers(0, 10_000))
def test_every_pair_of_random_triangles_is_found_with_its_area(seed):
    """Three planes, one of them seen from both sides, against all pairs taken one by one."""
    rng = np.random.default_rng(seed)
    flat = triangles(rng, 30)
    level = rng.choice([0.0, 1e-3, 1.0], 30)
    owner = rng.integers(0, 3, 30)
    down = rng.random(30) < 0.5
    solid = np.concatenate([flat, np.broadcast_to(level[:, None, None], (30, 3, 1))], axis=2)
    solid[down] = solid[down][:, ::-1]
    place, scale = anywhere(seed)
    found = coplanar_pairs(place(solid), owner)
    areas = {(a, b): area / scale**2 for a, b, area in zip(found.first, found.second, found.area, strict=True)}
    for i in range(30):
        for j in range(i + 1, 30):
            expected = clipped_area(flat[i], flat[j]) if level[i] == level[j] else 0.0
            if expected > 1e-4:
                assert areas.pop((i, j)) == pytest.approx(expected, rel=1e-6, abs=1e-9)
            else:
                assert areas.pop((i, j), 0.0) == pytest.approx(expected, abs=2e-6)
    assert not areas
    assert (found.alike == (down[found.first] == down[found.second])).all()


def test_common_areas_of_many_pairs_against_one_by_one():
    rng = np.random.default_rng(1)
    one, other = triangles(rng, 500), triangles(rng, 500)
    up = np.broadcast_to([0.0, 0.0, 1.0], (500, 3))
    lifted = [np.concatenate([shape, np.zeros((500, 3, 1))], axis=2) for shape in (one, other)]
    found = areas(common_shapes(*lifted, up))
    expected = [clipped_area(a, b) for a, b in zip(one, other, strict=True)]
    assert np.count_nonzero(expected) > 50
    assert found == pytest.approx(expected, rel=1e-12, abs=1e-15)


@pytest.mark.parametrize(("gap", "count"), [(0.0, 1), (0.9e-5, 1), (1.1e-5, 0), (1e-3, 0)])
def test_one_plane_is_what_rays_cannot_tell_apart(gap, count):
    assert coplanar.DEPTH == face_points.OFFSET
    square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], dtype=float)
    diagonal = np.sqrt(2)
    faces = np.stack([square, 0.5 * square + [0.2, 0.2, gap * diagonal]])
    assert len(coplanar_pairs(faces, np.array([0, 1])).area) == count


@pytest.mark.parametrize("shift", [1.0, 1.0 - 1e-9, 1.0 - 1e-7])
def test_neighbours_share_no_area(shift):
    square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], dtype=float)
    assert len(coplanar_pairs(np.stack([square, square + [shift, 0, 0]]), np.array([0, 1])).area) == 0


def test_small_faces_with_rounded_corners_on_a_large_one():
    """Float32 corners turn the normals of small faces: a disc of a thousand thin triangles on a slanting floor."""
    angle = np.linspace(0, 2 * np.pi, 1001)
    rim = 0.01 * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    fan = np.stack([np.zeros((1000, 2)), rim[1:], rim[:-1]], axis=1)  # facing down
    disc = np.concatenate([fan + 0.3, np.zeros((1000, 3, 1))], axis=2)
    floor = np.array([[[0, 0, 0], [1, 0, 0], [1, 1, 0]], [[0, 0, 0], [1, 1, 0], [0, 1, 0]]], dtype=float)
    turn, _ = np.linalg.qr(np.random.default_rng(0).normal(size=(3, 3)))
    faces = (np.concatenate([floor, disc]) @ turn.T + 0.3).astype(np.float32).astype(np.float64)
    found = coplanar_pairs(faces, np.array([0, 0, *[1] * 1000]))
    assert found.area.sum() == pytest.approx(500 * 1e-4 * np.sin(2 * np.pi / 1000), rel=1e-3)
    assert not found.alike.any()


def grid(n, height=0.0):
    """The unit square as 2 n² triangles facing up, (2 n², 3, 3)."""
    x, y = (a.ravel() / n for a in np.meshgrid(np.arange(n), np.arange(n), indexing="ij"))
    step = np.array([[0, 0, 1, 0, 1, 1], [0, 0, 1, 1, 0, 1]]).reshape(2, 3, 2) / n
    flat = (np.stack([x, y], axis=1)[:, None, None] + step).reshape(-1, 3, 2)
    return np.concatenate([flat, np.full((len(flat), 3, 1), height)], axis=2)


def test_fine_meshes_in_one_plane():
    """Two meshes that share no corner: the areas add up to that of the smaller."""
    small = 0.37 * grid(31)[:, ::-1] + [0.2, 0.4, 0.0]
    floor = grid(60)
    found = coplanar_pairs(np.concatenate([floor, small]), np.repeat([0, 1], [len(floor), len(small)]))
    assert found.area.sum() == pytest.approx(0.37**2, rel=1e-9)
    assert (found.first < len(floor)).all()
    assert (found.second >= len(floor)).all()


def test_equal_faces_of_one_owner_are_found_however_small():
    mesh = grid(100)
    found = coplanar_pairs(np.concatenate([mesh, mesh[777][None, [1, 2, 0]]]), np.zeros(len(mesh) + 1, dtype=int))
    assert (found.first.tolist(), found.second.tolist()) == ([777], [len(mesh)])
    assert found.alike.all()


def test_faces_without_area_share_none():
    faces = [[[0, 0, 0], [1, 0, 0], [2, 0, 0]], [[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[1, 1, 1]] * 3]
    assert len(coplanar_pairs(np.array(faces, dtype=float), np.array([0, 1, 2])).area) == 0
