"""Reading files whose faces lie in each other: cut, kept, or read back as they were written."""

from __future__ import annotations

import warnings
from pathlib import Path

import numpy as np
import pytest

from radiosity.errors import GeometryWarning, ParameterError
from radiosity.files import read_scene, write_scene
from radiosity.scene import Material, Scene, Surface
from radiosity.scenes.build import block, panel, room

from .same import assert_same_scene

MESHES = Path(__file__).resolve().parents[2] / "meshes"
GREY = Material([0.5, 0.5, 0.5])
BOX = Surface("box", *block([[1, 1], [2, 1], [2, 2], [1, 2]], 0, 1, True), GREY)
ROOM = room((0, 0, 0), (4, 3, 4), GREY)


def write_obj(scene, path):
    """A scene as other programs write it."""
    lines, start = ["mtllib grey.mtl", "usemtl grey"], 1
    for surface in scene.surfaces:
        lines.append(f"o {surface.name}")
        lines += ["v " + " ".join(map(repr, vertex)) for vertex in surface.vertices.tolist()]
        lines += ["f " + " ".join(str(k + start) for k in face) for face in surface.faces.tolist()]
        start += len(surface.vertices)
    path.write_text("\n".join(lines) + "\n")
    (path.parent / "grey.mtl").write_text("newmtl grey\nKd 0.5 0.5 0.5\n")
    return path


@pytest.fixture
def obj(tmp_path):
    return write_obj(Scene([*ROOM, BOX]), tmp_path / "room.obj")


def quietly(path, **settings):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return read_scene(path, **settings)


def test_contacts_are_cut_and_said(obj):
    with pytest.warns(
        GeometryWarning, match=r"room\.obj: .* were cut .*: 'floor' and 'box' touch over 1 m²: cut out of"
    ):
        scene = read_scene(obj)
    assert scene.surface_names == Scene([*ROOM, BOX]).surface_names
    assert scene.closed is True
    assert len(scene.surfaces[-1].faces) == 5
    cut = quietly(obj, contacts="cut")
    assert_same_scene(cut, scene)


def test_contacts_can_be_kept_and_are_named(obj):
    with pytest.warns(GeometryWarning, match=r"lie in each other: 'floor' and 'box' over 1 m²; .*contacts='cut'"):
        scene = read_scene(obj, contacts="keep")
    assert scene.closed is None
    assert [len(s.faces) for s in scene.surfaces] == [1] * 6 + [6]
    with pytest.raises(ParameterError, match="contacts is 'mend'; give 'cut' or 'keep'"):
        read_scene(obj, contacts="mend")


def test_what_cannot_be_mended_is_said(tmp_path):
    next_door = [Surface(f"next_{s.name}", s.vertices + [4, 0, 0], s.faces, GREY) for s in ROOM]
    path = write_obj(Scene([*ROOM, *next_door]), tmp_path / "rooms.obj")
    with pytest.warns(GeometryWarning, match="back to back, over 12 m².*leave a gap"):
        scene = read_scene(path)
    assert [len(s.faces) for s in scene.surfaces] == [1] * 12


@pytest.mark.parametrize("suffix", [".glb", ".gltf"])
def test_files_of_our_own_come_back_as_they_were_written(tmp_path, suffix):
    scene = Scene([*ROOM, BOX], name="room")
    write_scene(scene, tmp_path / f"room{suffix}")
    with pytest.warns(GeometryWarning, match="'floor' and 'box' over 1 m²"):
        back = read_scene(tmp_path / f"room{suffix}")
    assert_same_scene(back, scene)
    cut = quietly(tmp_path / f"room{suffix}", contacts="cut")
    assert [len(s.faces) for s in cut.surfaces][-1] == 5
    write_scene(cut, tmp_path / f"cut{suffix}")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert_same_scene(read_scene(tmp_path / f"cut{suffix}", contacts="cut"), cut)


def test_a_file_of_our_own_that_others_changed_is_theirs(tmp_path):
    """The box is moved down into the floor's plane by a node's translation, as an editor would write it."""
    import json

    lifted = Surface("box", BOX.vertices + [0, 0.25, 0], BOX.faces, GREY)
    write_scene(Scene([*ROOM, lifted]), tmp_path / "room.gltf")
    document = json.loads((tmp_path / "room.gltf").read_text())
    document["nodes"][-1]["translation"] = [0.0, -0.25, 0.0]
    (tmp_path / "room.gltf").write_text(json.dumps(document))
    scene = quietly(tmp_path / "room.gltf")
    assert sum(len(s.faces) for s in scene.surfaces if s.name == "box") < 12


def test_lamps_and_materials_are_given_by_names_in_the_file(tmp_path):
    """Also to surfaces of which nothing is left."""
    vertices, faces = block([[1, 1], [2, 1], [2, 2], [1, 2]], 0, 1, True)
    sides = [Surface(f"side{k}", vertices, faces[[k]], GREY) for k in range(6)]
    path = write_obj(Scene([*ROOM, *sides]), tmp_path / "room.obj")
    scene = quietly(
        path, materials={"side5": Material([0.1] * 3), "side0": Material([0.2] * 3)}, lamps={"ceiling": 1.0}
    )
    assert "side5" not in scene.surface_names
    found = {s.name: s.material for s in scene.surfaces}
    assert found["side0"].reflectance[0] == 0.2
    assert found["ceiling"].emission[0] == 1.0


def test_flush_lamp_of_a_file(tmp_path):
    lamp = Surface("lamp", *panel((1, 3, 1), (2, 3, 2), -1), GREY)
    path = write_obj(Scene([*ROOM, lamp]), tmp_path / "room.obj")
    with pytest.warns(
        GeometryWarning, match="'lamp' lies in the plane of 'ceiling' over 1 m² and is taken to lie on top"
    ):
        scene = read_scene(path)
    ceiling = next(s for s in scene.surfaces if s.name == "ceiling")
    assert len(ceiling.faces) == 4


def test_studio_as_blender_exports_it():
    """Two-sided throughout: the crate loses its bottom, the floor is divided along it."""
    with pytest.warns(GeometryWarning, match=r"touch over 0\.63 m²: cut out of 'Crate', 'Floor' divided along it"):
        scene = read_scene(MESHES / "studio.glb")
    parts = {s.name: s for s in scene.surfaces}
    crate = parts["Crate"].vertices[parts["Crate"].faces]
    assert np.ptp(crate[..., 1], axis=1).min() == 0.0  # its top
    assert (np.ptp(crate[..., 1], axis=1) == 0).sum() == 2
