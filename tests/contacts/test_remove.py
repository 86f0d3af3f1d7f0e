"""What `remove_contacts` leaves alone, and that where and how large a scene is does not matter."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from radiosity import scenes
from radiosity.contacts import remove_contacts
from radiosity.faces import source_faces
from radiosity.geometry import triangle_vector_areas
from radiosity.overlaps import overlaps, scene_triangles
from radiosity.scene import Material, Scene, Surface
from radiosity.scenes import cornell_data
from radiosity.scenes.build import block, panel, room

GREY = Material(0.5)


def areas(scene):
    corners, surface, _ = scene_triangles(scene)
    found = np.bincount(surface, np.linalg.norm(triangle_vector_areas(corners), axis=1))
    return dict(zip(scene.surface_names, found, strict=True))


def measured_cornell_box():
    """The Cornell box as its data has it: the lamp in the plane of the ceiling, blocks without bottoms on the floor."""
    box = scenes.cornell_box()
    whole = {name: np.array(cornell_data.GEOMETRY[name], dtype=float) / 1000 for name in ("floor", "ceiling")}

    def raw(surface):
        if surface.name not in whole:
            return surface
        return replace(surface, vertices=whole[surface.name].reshape(-1, 3), faces=np.array([[0, 1, 2, 3]]))

    return replace(box, surfaces=tuple(raw(surface) for surface in box.surfaces))


def test_the_measured_cornell_box_becomes_the_built_in_one():
    """The built-in scene was cut by hand; the areas are those, surface by surface."""
    raw, built_in = measured_cornell_box(), scenes.cornell_box()
    scene, report = remove_contacts(raw)
    assert areas(scene) == pytest.approx(areas(built_in), rel=1e-13)
    before = areas(raw)
    expected = {name: before[name] - area for name, area in areas(built_in).items() if before[name] - area > 1e-9}
    assert report.removed == pytest.approx(expected, rel=1e-10)
    assert str(report) == (
        "0.0276 m² of 'floor' under 'short_block': cut away; 0.0276 m² of 'floor' under 'tall_block': cut away; "
        "'lamp' lies in the plane of 'ceiling' over 0.0137 m² and is taken to lie on top: cut out of 'ceiling'"
    )
    for name in ("short_block", "lamp", "red_wall"):
        old, new = (next(s for s in one.surfaces if s.name == name) for one in (raw, scene))
        assert new is old


@pytest.mark.parametrize("name", scenes.BUILT_IN)
def test_built_in_scenes_have_no_contacts(name):
    scene = scenes.BUILT_IN[name]()
    same, report = remove_contacts(scene)
    assert same is scene
    assert report.contacts == ()


def moved(scene, seed, float32=False):
    """A scene turned, scaled and shifted, and the scale."""
    rng = np.random.default_rng(seed)
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    turn *= np.sign(np.linalg.det(turn))  # no mirror image: fronts stay fronts
    scale, shift = 10 ** rng.uniform(-9, 9), rng.normal(size=3)

    def there(points):
        place = scale * (points @ turn.T + shift)
        return place.astype(np.float32).astype(np.float64) if float32 else place

    return replace(scene, surfaces=tuple(replace(s, vertices=there(s.vertices)) for s in scene.surfaces)), scale


@given(st.integers(0, 1000), st.booleans())
def test_wherever_a_scene_lies(seed, float32):
    """A floor of many triangles, a lamp in the ceiling, a box on the floor, a block without a bottom against a wall."""
    n = 7
    x, z = (a.ravel() for a in np.meshgrid(np.linspace(0, 4, n + 1), np.linspace(0, 4, n + 1), indexing="ij"))
    i, j = (a.ravel() for a in np.meshgrid(np.arange(n), np.arange(n), indexing="ij"))
    first = i * (n + 1) + j
    faces = np.column_stack([first, first + 1, first + n + 2, first + n + 1])
    floor = Surface("floor", np.column_stack([x, 0 * x, z]), faces, GREY)
    angle = 0.4 + seed
    square = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * 0.5
    turned = square @ [[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]] + [1.5, 1.7]
    things = [
        Surface("box", *block(turned, 0, 1, True), GREY),
        Surface("block", *block([[3, 2], [4, 2], [4, 3.2], [3, 3.2]], 0, 2, False), GREY),
        Surface("lamp", *panel((1, 3, 1), (2, 3, 1.5), -1), Material(0.2, emission=3.0)),
    ]
    walls = room((0, 0, 0), (4, 3, 4), GREY, leave_out=("floor",))
    scene, scale = moved(Scene([floor, *walls, *things]), seed, float32)
    before = {name: area / scale**2 for name, area in areas(scene).items()}
    result, report = remove_contacts(scene)
    after = {name: area / scale**2 for name, area in areas(result).items()}
    lost = {name: before[name] - after[name] for name in before if abs(before[name] - after[name]) > 1e-5}
    near = 3e-5 if float32 else 1e-9
    assert lost == pytest.approx({"floor": 2.2, "ceiling": 0.5, "right_wall": 2.4, "box": 1.0, "block": 2.4}, abs=near)
    assert {n: area / scale**2 for n, area in report.removed.items()} == pytest.approx(lost, abs=1e-7)
    assert overlaps(result) == []
    assert len(source_faces(result)) < 200
    again, _ = remove_contacts(result)
    assert again is result


def test_the_order_of_surfaces_does_not_matter():
    rng = np.random.default_rng(0)
    parts = [
        *room((0, 0, 0), (4, 3, 4), GREY),
        Surface("box", *block([[1, 1], [2, 1], [2, 2], [1, 2]], 0, 1, True), GREY),
    ]
    parts += [Surface("rug", *panel((0.5, 0, 0.5), (3, 0, 3), 1), GREY)]
    expected = areas(remove_contacts(Scene(parts))[0])
    for _ in range(5):
        order = rng.permutation(len(parts))
        found = areas(remove_contacts(Scene([parts[k] for k in order]))[0])
        assert found == pytest.approx(expected, rel=1e-12)


def test_shared_vertices_and_untouched_faces_stay():
    """A wall and a floor in one surface: only the floor's faces are new."""
    vertices = np.array([[0, 0, 0], [0, 0, 4], [4, 0, 4], [4, 0, 0], [0, 3, 0], [4, 3, 0]], dtype=float)
    both = Surface("both", vertices, [[0, 1, 2, 3], [0, 3, 5, 4]], GREY)
    box = Surface("box", *block([[1, 1], [2, 1], [2, 2], [1, 2]], 0, 1, True), GREY)
    scene, _ = remove_contacts(Scene([both, box]))
    part = scene.surfaces[0]
    corners = part.vertices[part.faces]
    assert (corners[0] == vertices[[0, 3, 5, 4]]).all()
    assert areas(scene)["both"] == pytest.approx(12 + 15)
    floor = {tuple(corner) for corner in corners[1:].reshape(-1, 3).tolist()}
    bottom = {tuple(corner) for corner in box.vertices[box.vertices[:, 1] == 0].tolist()}
    assert bottom <= floor  # bit by bit


def test_faces_of_many_corners_against_many():
    """A disc of 64 slices on a floor of 800 triangles: both are cut, and the areas add up."""
    angle = np.linspace(0, 2 * np.pi, 65)[:-1]
    rim = np.column_stack([2 + np.cos(angle), 0 * angle, 2 + np.sin(angle)])
    vertices = np.concatenate([rim, rim + [0, 1, 0], [[2, 0, 2], [2, 1, 2]]])
    k, after = np.arange(64), (np.arange(64) + 1) % 64
    tin = np.concatenate(
        [
            np.column_stack([k, after, np.full(64, 128)]),
            np.column_stack([after + 64, k + 64, np.full(64, 129)]),
            np.column_stack([k, k + 64, after + 64]),
            np.column_stack([k, after + 64, after]),
        ]
    )
    cylinder = Surface("tin", vertices, tin, GREY)
    n = 20
    x, z = (a.ravel() for a in np.meshgrid(np.linspace(0, 4, n + 1), np.linspace(0, 4, n + 1), indexing="ij"))
    i, j = (a.ravel() for a in np.meshgrid(np.arange(n), np.arange(n), indexing="ij"))
    a = i * (n + 1) + j
    triangles = np.concatenate([np.column_stack([a, a + 1, a + n + 2]), np.column_stack([a, a + n + 2, a + n + 1])])
    floor = Surface("floor", np.column_stack([x, 0 * x, z]), triangles, GREY)
    scene, report = remove_contacts(Scene([floor, cylinder]))
    disc = 32 * np.sin(2 * np.pi / 64)
    assert report.removed == pytest.approx({"floor": disc, "tin": disc}, rel=1e-9)
    assert overlaps(scene) == []
    assert len(scene.surfaces[1].faces) == 192
