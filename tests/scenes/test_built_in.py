"""Built-in scenes are what their docstrings say: closed or open, cut where something stands, of the stated size."""

import itertools

import numpy as np
import pytest

from radiosity import scenes
from radiosity.errors import ParameterError
from radiosity.scenes.build import sphere

from .areas import enclosed_volume, triangles, vector_areas

VOLUME = {
    "red_rug": 4 * 2.6 * 4,
    "furnace": 1.0,
    "hidden_lamp": 4 * 2.6 * 4 - 2.0 * 1.6 * 0.1 - 0.6 * 0.8,  # board, chest (its footprint by the shoelace formula)
    "two_rooms": 8 * 2.6 * 4,
    "corridor": 16 * 2.6 * 4,
}


def surface(scene, name):
    return scene.surfaces[scene.surface_names.index(name)]


def area(scene, name):
    return float(np.linalg.norm(vector_areas(surface(scene, name)), axis=1).sum())


def one_sided(scene):
    return [s for s in scene.surfaces if not s.material.two_sided]


@pytest.mark.parametrize("name", scenes.BUILT_IN)
def test_scene_is_named_lit_and_the_same_every_time(name):
    one, other = scenes.BUILT_IN[name](), scenes.BUILT_IN[name]()
    assert one.name == name
    assert one.closed is not None
    assert one.sky.any() or any(s.material.emission.any() for s in one.surfaces)
    for a, b in zip(one.surfaces, other.surfaces, strict=True):
        assert a.vertices.tobytes() == b.vertices.tobytes()
        assert a.faces.tobytes() == b.faces.tobytes()


@pytest.mark.parametrize("name", [n for n, make in scenes.BUILT_IN.items() if make().closed])
def test_closed_scenes_close(name):
    """Area vectors of a closed mesh add up to nothing; a missing or doubled face shows at once."""
    scene = scenes.BUILT_IN[name]()
    volume, total = enclosed_volume(one_sided(scene))
    assert np.abs(total).max() < 1e-12
    assert volume < 0  # normals point inwards
    if name in VOLUME:
        assert -volume == pytest.approx(VOLUME[name], rel=1e-12)


@pytest.mark.parametrize("name", sorted(set(scenes.BUILT_IN) - {"integrating_sphere", "lit_sphere", "uniform_dome"}))
def test_no_two_faces_lie_in_each_other(name):
    """No triangle's middle lies in another triangle of the same plane: nothing is covered, nothing fights for depth."""
    corners = np.concatenate([triangles(s) for s in scenes.BUILT_IN[name]().surfaces])
    a, b, c = np.moveaxis(corners, 1, 0)
    normal = np.cross(b - a, c - a)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    middle = corners.mean(axis=1)
    away = np.einsum("mnx,nx->mn", middle[:, None] - a, normal)  # middle m from the plane of triangle n
    inside = np.abs(away) < 1e-9
    for p, q in ((a, b), (b, c), (c, a)):
        inside &= np.einsum("mnx,nx->mn", np.cross((q - p)[None], middle[:, None] - p), normal) > 0
    np.fill_diagonal(inside, False)
    assert not inside.any()


def test_parallel_plates_face_each_other():
    scene = scenes.parallel_plates(reflectance=[0.1, 0.9], emission=2.0, size=2.0, distance=0.25)
    assert np.allclose(vector_areas(surface(scene, "lower")).sum(axis=0), [0, 4, 0])
    assert np.allclose(vector_areas(surface(scene, "upper")).sum(axis=0), [0, -4, 0])
    assert (surface(scene, "upper").vertices[:, 1] == 0.25).all()
    assert np.array_equal(surface(scene, "lower").material.emission, [2.0, 2.0])
    assert not surface(scene, "upper").material.emission.any()


def test_open_rug_stands_on_the_edge():
    scene = scenes.open_rug()
    assert np.allclose(vector_areas(surface(scene, "floor")).sum(axis=0), [0, 16, 0])
    assert np.allclose(vector_areas(surface(scene, "red_wall")).sum(axis=0), [8, 0, 0])
    assert (surface(scene, "red_wall").vertices[:, 0] == 0).all()
    assert np.array_equal(scene.sky, [1, 1, 1])


def test_spheres_are_round():
    for subdivisions, facing in itertools.product(range(4), (1, -1)):
        vertices, faces = sphere((1, 2, 3), 2.0, subdivisions, facing)
        assert len(faces) == 20 * 4**subdivisions
        assert len(vertices) == len(faces) // 2 + 2  # Euler's formula: closed, and no corner twice
        assert np.allclose(np.linalg.norm(vertices - [1, 2, 3], axis=1), 2.0, rtol=1e-14)
        corners = vertices[faces]
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        assert (facing * np.einsum("nx,nx->n", normal, corners.mean(axis=1) - [1, 2, 3]) > 0).all()


def test_integrating_sphere_is_whole():
    scene = scenes.integrating_sphere(radius=0.5)
    whole, _ = enclosed_volume(scene.surfaces)
    assert -whole == pytest.approx(4 / 3 * np.pi * 0.125, rel=0.01)
    share = area(scene, "lamp") / (area(scene, "lamp") + area(scene, "wall"))
    assert share == pytest.approx((1 - np.cos(np.deg2rad(25))) / 2, rel=0.1)


def test_lit_sphere_gets_pi_watts_where_the_light_is_straight():
    """Irradiance of the middle of the ball by the lamp's solid angle: E = L A cos cos / d²."""
    scene = scenes.lit_sphere()
    lamp = surface(scene, "lamp")
    middle = lamp.vertices.mean(axis=0)
    towards = middle / np.linalg.norm(middle)
    facing = vector_areas(lamp).sum(axis=0)
    assert facing / np.linalg.norm(facing) == pytest.approx(-towards, abs=1e-12)
    irradiance = lamp.material.emission[0] / np.pi * np.linalg.norm(facing) / (np.linalg.norm(middle) - 1) ** 2
    assert irradiance == pytest.approx(np.pi, rel=1e-12)


def test_hidden_lamp_shines_up_and_nothing_else_is_above_it_but_walls_and_ceiling():
    scene = scenes.hidden_lamp()
    lamp = surface(scene, "lamp")
    assert (lamp.vertices[lamp.faces][..., 1] == 1.9).all()
    assert (vector_areas(lamp)[:, 1] > 0).all()
    for s in scene.surfaces:
        heights = s.vertices[np.unique(s.faces), 1]
        if s.name != "ceiling" and not s.name.endswith("_above"):
            assert heights.max() <= 1.9, s.name


def test_window_is_an_opening():
    scene = scenes.window_room()
    assert area(scene, "left_wall") == pytest.approx(2.7 * 4 - 1.3 * 1.6, rel=1e-12)
    assert scene.closed is False
    assert scene.sky.all()


@pytest.mark.parametrize(("door", "opening"), [((0.9, 2.0), 1.8), (1.0, 1.0), (1e-4, 1e-8), ((0.01, 2.6), 0.026)])
def test_partition_has_its_opening(door, opening):
    scene = scenes.two_rooms(door=door)
    partition = surface(scene, "partition_1")
    assert partition.material.two_sided
    assert 2.6 * 4 - area(scene, "partition_1") == pytest.approx(opening, abs=1e-14, rel=1e-12)


def test_opening_as_large_as_the_wall_leaves_no_wall():
    assert "partition_1" not in scenes.two_rooms(door=(4.0, 2.6)).surface_names


@pytest.mark.parametrize("door", [0.0, -1.0, 3.0, (4.1, 2.0), (0.9, 2.7), (1, 2, 3), float("nan")])
def test_doors_that_do_not_fit_are_refused(door):
    with pytest.raises(ParameterError, match="door is"):
        scenes.two_rooms(door=door)


def test_no_straight_line_passes_three_doors_of_the_corridor():
    """Doors alternate: the second is beyond the line through the first and third."""
    scene = scenes.corridor(rooms=5)
    doors = []
    for k in range(1, 5):
        z = np.unique(surface(scene, f"partition_{k}").vertices[:, 2])
        doors.append((z[1], z[2]))
    for first, second, third in zip(doors, doors[1:], doors[2:], strict=False):
        reach = [(a + b) / 2 for a in first for b in third]
        assert max(reach) < second[0] or min(reach) > second[1]
    with pytest.raises(ParameterError, match="at least 1"):
        scenes.corridor(rooms=0)


def test_stiff_rooms_keep_their_absorptance():
    for scene in (scenes.two_rooms(absorptance=1e-10), scenes.corridor(absorptance=1e-10)):
        for s in scene.surfaces:
            assert s.material.given == "absorptance"
            assert s.material.absorptance == 1e-10


@pytest.mark.parametrize(("objects", "seed"), [(0, 0), (1, 1), (30, 0), (30, 1), (120, 7)])
def test_clutter_stands_apart_inside_the_room(objects, seed):
    scene = scenes.cluttered_room(objects=objects, seed=seed)
    boxes = [s for s in scene.surfaces if s.name.startswith("box_")]
    assert len(boxes) == objects
    _, total = enclosed_volume(scene.surfaces)
    assert np.abs(total).max() < 1e-11
    prints = [s.vertices[:4][:, [0, 2]] for s in boxes]
    for p in prints:
        assert p.min() > 0
        assert p.max() < 6
    for p, q in itertools.combinations(prints, 2):
        assert apart(p, q)
    footprints = sum(enclosed_volume([s])[1][1] for s in boxes)  # the tops that no bottom cancels
    assert area(scene, "floor") == pytest.approx(36 - footprints, rel=1e-12)


def apart(p, q):
    """Separating axis: some edge normal of one rectangle has the other wholly beyond it."""
    for one, other in ((p, q), (q, p)):
        for k in range(4):
            edge = one[(k + 1) % 4] - one[k]
            normal = np.array([edge[1], -edge[0]])
            span = (one @ normal).min(), (one @ normal).max()
            if (other @ normal).min() > span[1] or (other @ normal).max() < span[0]:
                return True
    return False


def test_clutter_depends_on_its_seed_alone():
    one, same, other = (scenes.cluttered_room(5, seed) for seed in (1, 1, 2))
    assert one.surfaces[-1].vertices.tobytes() == same.surfaces[-1].vertices.tobytes()
    assert one.surfaces[-1].vertices.tobytes() != other.surfaces[-1].vertices.tobytes()
    with pytest.raises(ParameterError, match="0 or more"):
        scenes.cluttered_room(-1)
