"""What can be asked of `read_scene` beyond the file, and what it refuses before looking into it."""

import warnings

import numpy as np
import pytest

import radiosity
from radiosity.errors import (
    FileFormatError,
    GeometryError,
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


def test_a_unit_that_is_refused(obj):
    with pytest.raises(ParameterError, match="unit is 'furlong'; known are m, cm, mm, in, ft"):
        read_scene(obj, unit="furlong")


def test_a_gltf_in_millimetres_is_not_what_its_specification_says_but_exists(tmp_path):
    write_scene(red_rug(), tmp_path / "rug.glb")
    as_said = read_scene(tmp_path / "rug.glb", unit="mm").surfaces[0].vertices
    assert np.array_equal(as_said, 1e-3 * red_rug().surfaces[0].vertices)


def test_a_kilometre_without_a_unit_is_asked_about(obj):
    obj.write_text(obj.read_text().replace("10", "1010"))
    with pytest.warns(GeometryWarning, match=r"the scene is 1,010 m long if it is in metres.*--unit mm"):
        large = read_scene(obj)
    assert read_scene(obj, unit="m").surfaces[0].vertices.max() == large.surfaces[0].vertices.max() == 1010.0
    assert read_scene(obj, unit="mm").surfaces[0].vertices.max() == pytest.approx(1.01, rel=1e-15)


def test_surfaces_that_are_turned_by_name(obj):
    plain = read_scene(obj)
    by_surface, by_material = read_scene(obj, turn=["wall"]), read_scene(obj, turn=["paint"])
    assert np.array_equal(by_surface.surfaces[0].faces, plain.surfaces[0].turned().faces)
    assert np.array_equal(by_surface.surfaces[1].faces, plain.surfaces[1].faces)
    for turned, there in zip(by_material.surfaces, plain.surfaces, strict=True):
        assert np.array_equal(turned.faces, there.turned().faces)
    with pytest.raises(ParameterError, match="turn: no surface or material is named 'door'; there are 'wall'"):
        read_scene(obj, turn=["door"])


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


@pytest.mark.parametrize(
    ("content", "what"),
    [
        (b"PK\x03\x04scene.obj", "a ZIP archive; unpack it"),
        (b"\x1f\x8b\x08\x00", r"compressed \(gzip\); unpack it first"),
        (b"version https://git-lfs.github.com/spec/v1\noid sha256:0\n", "a pointer of Git LFS"),
        (b"\x89PNG\r\n", "a picture"),
        (b"BLENDER-v300", "a Blender file; export it as glTF"),
        (b"<?xml version='1.0'?><COLLADA>", "XML .*export it as glTF"),
        (b"\xef\xbb\xbf  <HTML>", "a web page"),
    ],
)
def test_what_a_file_is_instead_of_a_scene(tmp_path, content, what):
    for suffix in (".glb", ".obj", ".stl"):
        path = tmp_path / f"scene{suffix}"
        path.write_bytes(content)
        with pytest.raises(FileFormatError, match=what):
            read_scene(path)


@pytest.mark.parametrize("suffix", [".obj", ".off", ".mtl"])
def test_text_is_utf_8_but_for_comments(tmp_path, suffix):
    text = {".obj": OBJ, ".mtl": MTL, ".off": "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"}[suffix]
    path = tmp_path / ("scene.obj" if suffix == ".mtl" else f"scene{suffix}")
    path.write_text("mtllib scene.mtl\n" + OBJ if suffix != ".off" else text)
    (tmp_path / "scene.mtl").write_text(MTL)
    damaged = tmp_path / f"scene{suffix}"
    lines = damaged.read_bytes().split(b"\n")
    damaged.write_bytes(b"\n".join([*lines[:2], lines[2] + b" # Stra\xdfe", *lines[3:]]))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        assert read_scene(path).surfaces
    for bad in (b"\xff\xfe", b"\0"):
        damaged.write_bytes(b"\n".join([*lines[:2], lines[2] + bad, *lines[3:]]))
        with pytest.raises(FileFormatError, match="line 3 is not UTF-8 text.*save it as UTF-8"):
            read_scene(path)


def test_coordinates_beyond_reckoning(obj):
    text = obj.read_text()
    obj.write_text(text.replace("v 10 0 0", "v 1e80 0 0"))
    with pytest.raises(GeometryError, match="coordinates reach 1e\\+80 m, at most 1e\\+75"):
        read_scene(obj)
    obj.write_text(text.replace("v 10 0 0", "v 1e400 0 0"))
    with pytest.raises(FileFormatError, match="line 3 is 'v 1e400 0 0': expected numbers"):
        read_scene(obj)
    obj.write_text(text.replace("v 10 0 0", "v 1_0 0 0"))
    with pytest.raises(FileFormatError, match="line 3"):
        read_scene(obj)


def test_a_named_pipe_does_not_block(tmp_path):
    """A material library or a picture that nobody writes to."""
    import os

    path = tmp_path / "scene.obj"
    path.write_text("mtllib scene.mtl\n" + OBJ)
    os.mkfifo(tmp_path / "wood.png")
    (tmp_path / "scene.mtl").write_text(MTL + "map_Kd wood.png\n")
    with pytest.warns(RadiosityWarning, match="it is no file"):
        read_scene(path)
    (tmp_path / "scene.mtl").unlink()
    os.mkfifo(tmp_path / "scene.mtl")
    with pytest.warns(RadiosityWarning, match=r"'scene\.mtl' is not beside the file"):
        read_scene(path)


def test_pictures_take_no_more_memory_than_they_may():
    """Many small files of large pictures: those that are not at hand are read again."""
    from radiosity.files import textures

    album = textures.Album()
    loaded = []

    def load(k):
        loaded.append(k)
        return np.zeros((textures.HELD // 8, 3, 3), dtype=np.uint8)  # 3/8 of what may be held

    for k in (0, 1, 2, 1, 0):
        assert album.picture(k, lambda k=k: load(k)) is not None
    assert loaded == [0, 1, 2, 0]
    assert len(album._pages) == 2


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
