"""What can be asked of `read_scene` beyond the file, and what it refuses before looking into it."""

import numpy as np
import pytest

import radiosity
from radiosity.errors import (
    FileFormatError,
    GeometryWarning,
    MissingFileError,
    ParameterError,
    RadiosityError,
    RadiosityWarning,
    SceneError,
)
from radiosity.files import read_scene, write_scene
from radiosity.scene import Material
from radiosity.scenes import red_rug

OBJ = "v 0 0 0\nv 10 0 0\nv 0 10 0\nv 0 0 10\nusemtl paint\no wall\nf 1 2 3\no shelf\nf 1 4 2\n"
MTL = "newmtl paint\nKd 0.5 0.5 0.5\nKe 1 1 1\n"


@pytest.fixture
def obj(tmp_path):
    (tmp_path / "scene.obj").write_text("mtllib scene.mtl\n" + OBJ)
    (tmp_path / "scene.mtl").write_text(MTL)
    return tmp_path / "scene.obj"


@pytest.mark.parametrize(
    ("unit", "metres"), [(None, 10), ("m", 10), ("cm", 0.1), ("mm", 0.01), ("in", 0.254), ("ft", 3.048)]
)
def test_units(obj, unit, metres):
    assert read_scene(obj, unit=unit).surfaces[0].vertices.max() == pytest.approx(metres, rel=1e-15)


def test_units_that_are_refused(obj, tmp_path):
    with pytest.raises(ParameterError, match="unit is 'furlong'; known are m, cm, mm, in, ft"):
        read_scene(obj, unit="furlong")
    write_scene(red_rug(), tmp_path / "rug.glb")
    with pytest.raises(ParameterError, match="glTF is in metres"):
        read_scene(tmp_path / "rug.glb", unit="mm")


def test_materials_by_surface_before_material(obj):
    scene = read_scene(obj, materials={"wall": Material([0.1] * 3, name="new"), "paint": Material([0.2] * 3)})
    assert [s.material.reflectance[0] for s in scene.surfaces] == [0.1, 0.2]
    assert not scene.surfaces[0].material.emission.any()


def test_lamps_keep_the_reflectance(obj):
    scene = read_scene(obj, lamps={"shelf": [1, 2, 3]})
    assert np.array_equal(scene.surfaces[1].material.emission, [1, 2, 3])
    assert np.array_equal(scene.surfaces[1].material.reflectance, [0.5] * 3)
    assert scene.surfaces[1].material.name == "paint"
    assert scene.surfaces[0].material.emission == pytest.approx([np.pi] * 3)
    assert np.array_equal(read_scene(obj, lamps={"paint": 0.0}).surfaces[0].material.emission, [0, 0, 0])


def test_sky_and_name(obj):
    scene = read_scene(obj, sky=[1, 2, 3], name="yard")
    assert np.array_equal(scene.sky, [1, 2, 3])
    assert scene.name == "yard"
    assert read_scene(obj).name == "scene"
    with pytest.raises(SceneError, match="sky"):
        read_scene(obj, sky=-1)


@pytest.mark.parametrize("argument", [{"materials": {"roof": Material(0.5)}}, {"lamps": {"roof": 1.0}}])
def test_names_that_are_not_there(obj, argument):
    with pytest.raises(
        ParameterError, match="no surface or material is named 'roof'; there are 'wall', 'shelf', 'paint'"
    ):
        read_scene(obj, **argument)


def test_what_is_no_scene_file(tmp_path):
    with pytest.raises(MissingFileError, match="there is no file"):
        read_scene(tmp_path / "nothing.glb")
    with pytest.raises(FileNotFoundError):
        read_scene(tmp_path / "nothing.obj")
    with pytest.raises(FileFormatError, match="is a folder"):
        read_scene(tmp_path)
    (tmp_path / "scene.fbx").write_text("Kaydara")
    with pytest.raises(FileFormatError, match=r"suffix '\.fbx' is not read; known are \.glb, \.gltf, \.obj"):
        read_scene(tmp_path / "scene.fbx")


@pytest.mark.parametrize("suffix", [".glb", ".gltf", ".obj", ".ply", ".stl", ".off"])
def test_empty_files_web_pages_and_rubbish(tmp_path, suffix):
    path = tmp_path / f"scene{suffix}"
    path.write_bytes(b"")
    with pytest.raises(FileFormatError, match="is empty"):
        read_scene(path)
    path.write_text("\n<!DOCTYPE html><html><body>404</body></html>")
    with pytest.raises(FileFormatError, match="is a web page"):
        read_scene(path)
    generator = np.random.default_rng(0)
    for size in (1, 30, 100, 1000):
        path.write_bytes(generator.integers(0, 256, size).astype(np.uint8).tobytes())
        with pytest.raises(RadiosityError):
            read_scene(path)


def test_suffixes_in_capitals(tmp_path):
    (tmp_path / "SCENE.OBJ").write_text(OBJ)
    with pytest.warns(UserWarning, match="'paint' is not defined"):
        assert len(read_scene(tmp_path / "SCENE.OBJ").surfaces) == 2


def test_public_names():
    assert radiosity.read_scene is read_scene
    assert radiosity.write_scene is write_scene


def test_normals_of_a_room_that_was_modelled_from_outside(tmp_path):
    """An STL of a room, as modelling programs write solids: outward. A sky says that it is a body instead."""
    import trimesh

    path = tmp_path / "room.stl"
    path.write_bytes(trimesh.creation.box((3, 4, 5)).export(file_type="stl"))
    with pytest.warns(RadiosityWarning) as caught:
        room = read_scene(path, fix_normals=True, lamps={"room": 1.0})
    assert "12 of 12 faces were turned round" in str(caught[1].message)
    assert radiosity.subdivide(room).closed
    with pytest.warns(RadiosityWarning) as caught:
        body = read_scene(path, fix_normals=True, sky=1.0)
    assert not any(issubclass(one.category, GeometryWarning) for one in caught)
    assert not radiosity.subdivide(body).closed
