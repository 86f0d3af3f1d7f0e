"""Normals of closed shells are mended, those of open ones are left alone, and it is said."""

from __future__ import annotations

import numpy as np
import pytest

import radiosity as rad
from radiosity.errors import GeometryWarning
from radiosity.faces import encloses, source_faces
from radiosity.inspection import findings

from .test_findings import CUBE, INWARD, LAMP, OUTWARD, room, scene, small

MESSAGE = "were turned round, so that closed shells face the right way"


def triangles(quads):
    return np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])


def outward_share(surface, middle):
    """Share of a surface's faces that look away from a point."""
    corners = surface.vertices[surface.faces[:, :3]]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return float((np.einsum("nx,nx->n", normal, corners[:, 0] - middle) > 0).mean())


@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize("cut", [False, True], ids=["quads", "triangles"])
def test_any_faces_of_a_room_and_a_box_turned(seed, cut):
    """However the faces are mixed up, the room faces inwards and the box in it outwards."""
    rng = np.random.default_rng(seed)

    def mixed(faces):
        faces = triangles(faces) if cut else faces.copy()
        wrong = rng.random(len(faces)) < rng.choice([0.2, 0.5, 0.9])
        faces[wrong] = faces[wrong][:, ::-1]
        return faces

    made = scene(("room", CUBE, mixed(INWARD), LAMP), ("box", small(), mixed(OUTWARD)), sky=0.0)
    if seed == 0 and cut:
        assert any(one.kind == "flipped normals" for one in findings(made))
    with pytest.warns(GeometryWarning, match=MESSAGE):
        fixed = made.fixed_normals()
    assert outward_share(fixed.surfaces[0], 0.5) == 0.0
    assert outward_share(fixed.surfaces[1], 0.5) == 1.0
    assert encloses(source_faces(fixed))
    assert not findings(fixed)
    assert np.array_equal(np.sort(fixed.surfaces[0].faces, axis=1), np.sort(made.surfaces[0].faces, axis=1))
    assert fixed.fixed_normals() is fixed


def test_padded_triangles_among_quads_keep_their_pads():
    mixed = np.array(
        [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, -1], [0, 6, 4, -1], [1, 5, 7, 3]]
    )
    inward = np.where(mixed < 0, -1, mixed)
    inward = np.array([[*row[::-1]] if row[3] >= 0 else [row[2], row[1], row[0], -1] for row in mixed])
    inward[[2, 4]] = mixed[[2, 4]]  # a quad and a triangle the wrong way
    with pytest.warns(GeometryWarning, match=f"2 of 7 faces {MESSAGE}: 'room'"):
        fixed = scene(("room", CUBE, inward, LAMP), sky=0.0).fixed_normals()
    assert outward_share(fixed.surfaces[0], 0.5) == 0.0
    assert ((fixed.surfaces[0].faces == -1) == (mixed == -1)).all()
    assert encloses(source_faces(fixed))


def test_walls_of_different_surfaces_are_one_room():
    walls = [(f"wall {k}", CUBE, face[None, :: -1 if k == 2 else 1], LAMP) for k, face in enumerate(INWARD)]
    with pytest.warns(GeometryWarning, match="'wall 2'"):
        fixed = scene(*walls, sky=0.0).fixed_normals()
    assert encloses(source_faces(fixed))


def test_a_turned_room_gives_the_light_of_a_right_one():
    """The furnace with half its walls turned leaks light into black backs; mended it has B = E / (1 - ρ)."""
    furnace = rad.scenes.furnace()
    turned = rad.Scene(
        [rad.Surface(s.name, s.vertices, s.faces[:, ::-1] if k % 2 else s.faces, s.material)
         for k, s in enumerate(furnace.surfaces)]
    )  # fmt: skip
    with pytest.warns(GeometryWarning, match=MESSAGE):
        solution = rad.solve(turned.fixed_normals(), patch_count=96)
    assert solution.radiosity == pytest.approx(2.0, rel=1e-5)


@pytest.mark.parametrize(
    "made",
    [
        scene(("bowl", CUBE, np.concatenate([OUTWARD[:4], INWARD[4:5]]), LAMP)),
        scene(("cube under a sky", CUBE, OUTWARD, LAMP)),
        scene(("room under a sky", CUBE, INWARD, LAMP)),
        room(("sheet", small()[:4], [[0, 1, 3, 2]])),
        room(("bag", small(), INWARD, rad.Material(0.5, two_sided=True))),
    ],
    ids=["open", "body under a sky", "room under a sky", "sheet", "two-sided"],
)
def test_what_may_be_meant_is_left(made):
    assert made.fixed_normals() is made


def test_a_body_turned_in_an_open_room_is_known_by_its_darkness():
    """Nothing tells the side of an open room; but a closed box that shows its inside, with no lamp in it, is a slip."""
    floor = ("floor", 4 * CUBE[[0, 1, 3, 2]] - 1.5, [[0, 2, 3, 1]])
    lamp = ("lamp", CUBE[[0, 1, 3, 2]] + [0, 0, 3.0], [[0, 1, 2, 3]], LAMP)
    turned = scene(floor, ("box", small(), INWARD), lamp, sky=0.0)
    assert [one.surfaces for one in findings(turned) if one.kind == "inside out"] == [("box",)]
    with pytest.warns(GeometryWarning, match=f"6 of 8 faces {MESSAGE}: 'box'"):
        fixed = turned.fixed_normals()
    assert outward_share(fixed.surfaces[1], small().mean(axis=0)) == 1.0
    assert fixed.fixed_normals() is fixed
    reaching_in = ("lamp", small()[:4] + [0, 0, 0.1], [[0, 1, 3, 2]], LAMP)  # a lamp that may light it from inside
    kept = scene(floor, ("box", small(), INWARD), reaching_in, sky=0.0)
    assert kept.fixed_normals() is kept


def test_a_moebius_strip_has_no_right_side():
    n = 12
    turn = 2 * np.pi * np.arange(n) / n
    across = np.stack([np.cos(turn / 2) * np.cos(turn), np.cos(turn / 2) * np.sin(turn), np.sin(turn / 2)], 1)
    ring = np.stack([np.cos(turn), np.sin(turn), 0 * turn], 1)
    points = np.concatenate([ring - 0.3 * across, ring + 0.3 * across])
    k = np.arange(n - 1)
    faces = np.stack([k, k + 1, k + 1 + n, k + n], 1)
    faces = np.concatenate([faces, [[n - 1, n, 0, 2 * n - 1]]])
    made = scene(("strip", points, faces, LAMP))
    assert made.fixed_normals() is made
    assert "flipped normals" not in {one.kind for one in findings(made)}
