"""Flat pairs of triangles are quads again, and what is not flat stays apart."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import radiosity as rad
from radiosity.errors import GeometryError, GeometryWarning
from radiosity.faces import encloses, source_faces
from radiosity.geometry import cross

CUBE = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=float)
INWARD = np.array([[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]])[:, ::-1]
GREY = rad.Material(0.5)


def scene(*parts, **kwargs):
    surfaces = [rad.Surface(f"part {i}", np.asarray(v, float), f, GREY) for i, (v, f) in enumerate(parts)]
    return rad.Scene(surfaces, **kwargs)


def triangles(quads):
    return np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])


def quad(height=0.0, corner=(1.0, 1.0)):
    return [[0, 0, 0], [1, 0, 0], [*corner, height], [0, 1, 0]]


def test_triangles_of_a_cube_become_its_squares():
    faces = source_faces(scene((CUBE, triangles(INWARD))))
    assert len(faces) == 6 and faces.quad.all()
    assert faces.area == pytest.approx(np.ones(6), rel=1e-15)
    outwards = np.einsum("fx,fx->f", faces.normal, faces.corners.mean(axis=1) - 0.5)
    assert (outwards < 0).all(), "orientation survives the pairing"


def test_duplicate_vertices_do_not_keep_triangles_apart():
    points = CUBE[triangles(INWARD)].reshape(-1, 3)
    faces = source_faces(scene((points, np.arange(36).reshape(12, 3))))
    assert len(faces) == 6 and faces.quad.all()


@pytest.mark.parametrize(("degrees", "kept"), [(0.05, True), (0.2, False)])
def test_a_quad_is_flat_within_a_tenth_of_a_degree(degrees, kept):
    # The fold along the diagonal bends by twice the tilt of either triangle, height √2 from the diagonal / √2.
    height = np.deg2rad(degrees) / np.sqrt(2)
    for faces in ([[0, 1, 2, 3]], [[0, 1, 3], [1, 2, 3]]):
        found = source_faces(scene((quad(height), faces)))
        assert found.quad.tolist() == ([True] if kept else [False, False])
        assert found.area.sum() == pytest.approx(1.0, rel=1e-5)


def test_concave_quads_are_cut_along_the_diagonal_inside():
    dart = quad(corner=(0.2, 0.2))
    faces = source_faces(scene((dart, [[0, 1, 2, 3]])))
    assert not faces.quad.any() and len(faces) == 2
    assert faces.area.sum() == pytest.approx(0.2, rel=1e-14)
    assert (faces.normal[:, 2] > 0).all()


def test_a_quad_that_crosses_itself_is_refused_by_name():
    for end in (1.0, 0.5):
        bow_tie = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [end, 1, 0]]
        with pytest.raises(GeometryError, match="part 0.*quad 0 cross over"):
            source_faces(scene((bow_tie, [[0, 1, 2, 3]])))


def test_faces_without_area_are_left_out_and_said():
    points = [*quad(), [0.5, 0, 0]]
    with pytest.warns(GeometryWarning, match="1 of 2 faces have no area"):
        faces = source_faces(scene((points, [[0, 1, 2], [0, 4, 1]])))
    assert len(faces) == 1
    for flat in ([[0, 4, 1]], [[0, 4, 1, 4]]):
        with pytest.warns(GeometryWarning), pytest.raises(GeometryError, match="leave the surface out"):
            source_faces(scene((points, flat)))


@given(st.integers(0, 2**32 - 1), st.integers(3, 40))
def test_pairing_keeps_every_surface_and_its_area(seed, count):
    """Random soup with many coplanar neighbours: a bumpy height field of few levels."""
    rng = np.random.default_rng(seed)
    side = int(np.ceil(np.sqrt(count))) + 1
    x, y = np.meshgrid(np.arange(side), np.arange(side), indexing="ij")
    points = np.stack([x, y, rng.integers(0, 2, x.shape)], axis=-1).reshape(-1, 3).astype(float)
    corner = (np.arange(side - 1)[:, None] * side + np.arange(side - 1)).ravel()
    quads = np.stack([corner, corner + side, corner + side + 1, corner + 1], axis=1)
    tris = triangles(quads)[rng.permutation(2 * len(quads))]
    faces = source_faces(scene((points, tris)))
    whole = points[tris]
    vector = 0.5 * np.cross(whole[:, 1] - whole[:, 0], whole[:, 2] - whole[:, 0])
    assert faces.area.sum() == pytest.approx(np.linalg.norm(vector, axis=1).sum(), rel=1e-12)
    assert np.allclose((faces.normal * faces.area[:, None]).sum(axis=0), vector.sum(axis=0))


def test_a_room_encloses_and_what_stands_in_it_changes_nothing():
    block = (0.3 + 0.2 * CUBE, INWARD[:, ::-1])
    assert encloses(source_faces(scene((CUBE, INWARD))))
    assert encloses(source_faces(scene((CUBE, INWARD), block)))


def test_what_does_not_enclose():
    assert not encloses(source_faces(scene((CUBE, INWARD[:5])))), "a hole"
    assert not encloses(source_faces(scene((CUBE, INWARD[:, ::-1])))), "seen from outside"
    assert not encloses(source_faces(scene((CUBE, INWARD), (2 + CUBE, INWARD[:, ::-1])))), "a block outside"


def test_products_of_vectors_are_those_of_numpy():
    a, b = np.random.default_rng(4).normal(size=(2, 7, 4, 3))
    assert cross(a, b).tobytes() == np.cross(a, b).tobytes()
