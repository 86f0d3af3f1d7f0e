"""Each rule of what is cut where: what was taken from which surface, and what is seen there afterwards."""

from __future__ import annotations

import numpy as np
import pytest

from radiosity.contacts import Kind, remove_contacts
from radiosity.geometry import triangle_vector_areas
from radiosity.overlaps import overlaps, scene_triangles
from radiosity.scene import Material, Scene, Surface
from radiosity.scenes.build import block, frame, panel, room

ONE, TWO = Material(0.5), Material(0.5, two_sided=True)
FOOTPRINT = np.array([[1, 1], [2, 1], [2, 2], [1, 2]], dtype=float)
UNDER = (1.3, 1.6)  # a place under the block: x, z


def walls(material=ONE):
    return room((0, 0, 0), (4, 3, 4), material)


def box(material=ONE, name="box", bottom=0.0, top=1.0, footprint=FOOTPRINT, closed=True, without_top=False):
    vertices, faces = block(footprint, bottom, top, closed)
    return Surface(name, vertices, faces[1:] if without_top else faces, material)


def rug(material=ONE, facing=1, name="rug"):
    return Surface(name, *panel((0.5, 0, 0.5), (2.5, 0, 2.5), facing), material)


def areas(scene):
    corners, surface, _ = scene_triangles(scene)
    found = np.bincount(surface, np.linalg.norm(triangle_vector_areas(corners), axis=1))
    return dict(zip(scene.surface_names, found, strict=True))


def seen(scene, height, up):
    """What a vertical ray from (UNDER, height) meets first: names of all surfaces there, and the side each shows."""
    corners, surface, _ = scene_triangles(scene)
    a, b, c = (corners[:, k][:, [0, 2]] for k in range(3))
    point = np.array(UNDER)

    def turn(p, q):
        return (q - p)[:, 0] * (point - p)[:, 1] - (q - p)[:, 1] * (point - p)[:, 0]

    sides = np.stack([turn(a, b), turn(b, c), turn(c, a)], axis=1)
    hit = (sides > 0).all(axis=1) | (sides < 0).all(axis=1)
    level = corners[:, :, 1].mean(axis=1)
    ahead = hit & ((level > height) if up else (level < height))
    if not ahead.any():
        return set()
    first = level[ahead].min() if up else level[ahead].max()
    facing = triangle_vector_areas(corners)[:, 1] * (-1 if up else 1) > 0
    return {
        f"{scene.surface_names[surface[t]]} {'front' if facing[t] else 'back'}"
        for t in np.flatnonzero(ahead & (level == first))
    }


def cut(*surfaces):
    scene = Scene(surfaces)
    result, report = remove_contacts(scene)
    before, after = areas(scene), areas(result)
    lost = {name: before[name] - after.get(name, 0.0) for name in before}
    assert report.removed == pytest.approx({name: area for name, area in lost.items() if area > 1e-12})
    again, nothing = remove_contacts(result)
    assert again is result, str(nothing)
    return result, report


def only(report):
    (contact,) = report.contacts
    return contact


def test_box_on_a_floor_both_one_sided():
    """Both are cut, and the box closes the hole: from above and below, only backs are seen."""
    scene, report = cut(*walls(), box())
    assert report.removed == pytest.approx({"floor": 1.0, "box": 1.0})
    assert only(report).kind is Kind.TOUCH
    assert str(report) == "'floor' and 'box' touch over 1 m²: cut out of both"
    assert seen(scene, 2.0, up=False) == {"box front"}
    assert seen(scene, 0.5, up=False) == set()
    assert seen(scene, -1.0, up=True) == {"box back"}
    assert overlaps(scene) == []


@pytest.mark.parametrize(("floor", "thing"), [(ONE, TWO), (TWO, ONE), (TWO, TWO)])
def test_box_on_a_floor_one_of_them_two_sided(floor, thing):
    """The floor stays, for it may be seen from below; it is divided, so that no patch lies half under the box."""
    scene, report = cut(*walls(floor), box(thing))
    assert report.removed == pytest.approx({"box": 1.0})
    assert only(report).divided == ("floor",)
    assert "cut out of 'box', 'floor' divided along it" in str(report)
    assert seen(scene, -1.0, up=True) == {"floor back"}
    assert seen(scene, 0.5, up=False) == {"floor front"}
    part = {s.name: s for s in scene.surfaces}["floor"]
    outlines = part.vertices[np.where(part.faces < 0, part.faces[:, :1], part.faces)]
    under = (outlines[:, :, [0, 2]] >= 1).all(axis=(1, 2)) & (outlines[:, :, [0, 2]] <= 2).all(axis=(1, 2))
    assert areas(Scene([Surface("under", part.vertices, part.faces[under], ONE)]))["under"] == pytest.approx(1.0)


@pytest.mark.parametrize("material", [ONE, TWO])
def test_block_without_a_bottom(material):
    scene, report = cut(*walls(material), box(material, closed=False))
    assert only(report).kind is Kind.FOOTPRINT
    if material is ONE:
        assert str(report) == "1 m² of 'floor' under 'box': cut away"
        assert report.removed == pytest.approx({"floor": 1.0})
        assert seen(scene, -1.0, up=True) == {"box back"}
    else:
        assert str(report) == "1 m² of 'floor' under 'box': divided along the border"
        assert report.removed == {}
        assert seen(scene, -1.0, up=True) == {"floor back"}


def test_block_of_several_surfaces():
    vertices, faces = block(FOOTPRINT, 0, 1, True)
    sides = [Surface(f"side {k}", vertices, faces[[k]], ONE) for k in range(6)]
    _, report = cut(*walls(), *sides)
    assert report.removed == pytest.approx({"floor": 1.0, "side 5": 1.0})
    assert report.gone == ("side 5",)
    assert "nothing is left of 'side 5'" in str(report)
    _, report = cut(*walls(), *sides[:5])
    assert report.removed == pytest.approx({"floor": 1.0})
    assert only(report).kind is Kind.FOOTPRINT


def test_what_is_open_above_hides_nothing():
    """A ring of walls without a lid: the floor inside is seen from above."""
    scene, report = cut(*walls(), box(closed=False, without_top=True))
    assert report.contacts == ()
    assert seen(scene, 2.0, up=False) == {"floor front"}


@pytest.mark.parametrize("material", [ONE, TWO])
def test_crate_without_a_lid(material):
    """Its bottom is seen from above, so it stays and the floor is cut."""
    scene, report = cut(*walls(material), box(material, without_top=True))
    assert report.removed == pytest.approx({"floor": 1.0})
    assert seen(scene, 2.0, up=False) == {"box back"}


def test_block_without_a_bottom_over_an_edge_hides_nothing():
    """A part of it stands on nothing, and light comes in from below."""
    table = box(name="table", bottom=0.2)
    over = box(bottom=1.0, top=2.0, footprint=FOOTPRINT + 0.5, closed=False)
    _, report = cut(*walls(), table, over)
    assert report.contacts == ()
    _, report = cut(*walls(), table, box(bottom=1.0, top=2.0, footprint=FOOTPRINT + 0.5))
    assert report.removed == pytest.approx({"table": 0.25, "box": 0.25})


def test_column_from_floor_to_ceiling():
    """Open at both ends, each of which stands on something; a lower one is a pipe, open above."""
    scene, report = cut(*walls(), box(top=3.0, closed=False, without_top=True))
    assert report.removed == pytest.approx({"floor": 1.0, "ceiling": 1.0})
    assert {contact.kind for contact in report.contacts} == {Kind.FOOTPRINT}
    assert scene.closed
    _, report = cut(*walls(), box(top=2.0, closed=False, without_top=True))
    assert report.contacts == ()


def test_table_on_a_hollow_leg():
    """Only the leg hides the floor, not the table top above it."""
    vertices, faces = block(FOOTPRINT, 0.8, 1.0, False)
    below, around = frame((1, 0.8, 1), (2, 0.8, 2), -1, ((1.4, 0.8, 1.4), (1.6, 0.8, 1.6)))
    leg, sides = block(0.2 * (FOOTPRINT - 1.5) + 1.5, 0.0, 0.8, False)
    starts = np.cumsum([0, len(vertices), len(below)])
    all_faces = np.concatenate([f + start for f, start in zip((faces, around, sides[1:]), starts, strict=True)])
    _, report = cut(*walls(), Surface("table", np.concatenate([vertices, below, leg]), all_faces, ONE))
    assert report.removed == pytest.approx({"floor": 0.04})
    assert only(report).kind is Kind.FOOTPRINT


def test_stacked_and_touching_boxes():
    other = box(name="other", footprint=FOOTPRINT + [1, 0])
    upper = box(name="upper", bottom=1.0, top=1.5, footprint=FOOTPRINT + [0.5, 0])
    scene, report = cut(*walls(), box(), other, upper)
    assert report.removed == pytest.approx({"floor": 2.0, "box": 1 + 1 + 0.5, "other": 1 + 1 + 0.5, "upper": 1.0})
    assert overlaps(scene) == []


def test_box_in_a_corner_touches_three_walls():
    _, report = cut(*walls(), box(footprint=FOOTPRINT - 1))
    assert report.removed == pytest.approx({"floor": 1, "back_wall": 1, "left_wall": 1, "box": 3})


@pytest.mark.parametrize(("floor", "thing", "facing"), [(ONE, ONE, 1), (ONE, TWO, 1), (TWO, TWO, 1), (TWO, TWO, -1)])
def test_rug_in_the_plane_of_the_floor_lies_on_top(floor, thing, facing):
    for surfaces in ((*walls(floor), rug(thing, facing)), (rug(thing, facing), *walls(floor))):
        scene, report = cut(*surfaces)
        assert only(report).kind is Kind.FLUSH
        assert report.removed == pytest.approx({"floor": 4.0})
        assert seen(scene, 1.0, up=False) == {"rug front" if facing > 0 else "rug back"}


def test_rug_on_a_floor_that_is_divided_as_the_rug_is():
    """Which is smaller is a matter of surfaces, not of their faces."""
    grid = [Surface("floor", *panel((0, 0, 0), (4, 0, 4), 1, [((0.5, 0, 0.5), (2.5, 0, 2.5))]), ONE)]
    hole = Surface("rug", *panel((0.5, 0, 0.5), (2.5, 0, 2.5), 1), Material(0.1))
    v, f = grid[0].vertices, grid[0].faces
    inner, faces = panel((0.5, 0, 0.5), (2.5, 0, 2.5), 1)
    floor = Surface("floor", np.concatenate([v, inner]), np.concatenate([f, faces + len(v)]), ONE)
    scene, report = cut(floor, hole)
    assert report.removed == pytest.approx({"floor": 4.0})
    assert seen(scene, 1.0, up=False) == {"rug front"}


def test_box_on_a_rug_in_the_plane_of_the_floor():
    _, report = cut(*walls(), rug(), box())
    assert report.removed == pytest.approx({"floor": 4.0, "rug": 1.0, "box": 1.0})
    scene, report = cut(*walls(TWO), rug(TWO), box(TWO))
    assert report.removed == pytest.approx({"floor": 4.0, "box": 1.0})
    assert seen(scene, -1.0, up=True) == {"rug back"}


def test_equal_faces_count_once():
    twins = [Surface(name, *panel((0, 0, 0), (1, 0, 1), 1), Material(r)) for name, r in (("a", 0.2), ("b", 0.7))]
    scene, report = cut(*twins)
    assert scene.surface_names == ("a",)
    assert report.gone == ("b",)
    assert only(report).kind is Kind.DOUBLE
    assert "'a' counts, cut out of 'b'" in str(report)
    vertices, faces = panel((0, 0, 0), (1, 0, 1), 1)
    scene, report = cut(Surface("a", vertices, np.concatenate([faces, np.roll(faces, 1, axis=1)]), ONE))
    assert areas(scene) == pytest.approx({"a": 1.0})


def test_faces_once_a_side_make_a_two_sided_surface():
    leaf = Surface("leaf", [[0, 0, 0], [1, 0, 0], [0, 0, 2]], [[0, 1, 2], [2, 1, 0]], Material(absorptance=0.3))
    scene, report = cut(leaf)
    (surface,) = scene.surfaces
    assert only(report).kind is Kind.TURNED
    assert surface.material.two_sided
    assert (surface.material.given, surface.material.absorptance.tolist()) == ("absorptance", [0.3])
    assert len(surface.faces) == 1
    part = Surface("leaf", [*leaf.vertices, [0, 0, -2]], [[0, 1, 2], [2, 1, 0], [0, 3, 1]], ONE)
    same, report = remove_contacts(Scene([part]))
    assert same.surfaces == (part,)  # some faces only: that is for the modeller to decide
    assert only(report).kind is Kind.UNCLEAR


def test_one_sided_faces_back_to_back_are_left():
    """Two rooms with one wall plane between them: each wall is seen from its room."""
    next_door = [Surface(f"next {s.name}", s.vertices + [4, 0, 0], s.faces, ONE) for s in walls()]
    scene = Scene([*walls(), *next_door])
    same, report = remove_contacts(scene)
    assert same is scene
    assert report.mended == ()
    assert {only(report).first, only(report).second} == {"right_wall", "next left_wall"}
    same, report = remove_contacts(Scene([*walls(), rug(facing=-1)]))
    assert [contact.kind for contact in report.contacts] == [Kind.UNCLEAR]


def test_a_body_around_a_room_is_no_body_in_it():
    """A house whose outer skin lies on the walls of its room: inside and outside are both seen."""
    skin = Surface("skin", *block([[0, 0], [4, 0], [4, 4], [0, 4]], 0, 3, True), ONE)
    scene = Scene([*walls(), skin])
    same, report = remove_contacts(scene)
    assert same is scene
    assert len(report.unclear) == 6


def test_all_in_one_surface():
    """As a file without names has it."""
    parts = [*walls(), box()]
    starts = np.cumsum([0] + [len(s.vertices) for s in parts])
    faces = np.concatenate([s.faces + start for s, start in zip(parts, starts, strict=False)])
    scene, report = cut(Surface("all", np.concatenate([s.vertices for s in parts]), faces, ONE))
    assert report.removed == pytest.approx({"all": 2.0})
    assert str(report) == "faces of 'all' touch over 1 m²: cut out of it"
    assert seen(scene, -1.0, up=True) == {"all back"}


@pytest.mark.parametrize("closed", [None, False, True])
def test_closed_stays_closed(closed):
    """A room with a hole where the box stands is as closed as before, though its edges do not show it any more."""
    scene, _ = remove_contacts(Scene([*walls(), box()], closed=closed))
    assert scene.closed is (True if closed is None else closed)
    scene, report = remove_contacts(Scene([*walls()[:5], box()], closed=closed))
    assert report.mended
    assert scene.closed is closed
