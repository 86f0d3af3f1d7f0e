"""Write → read is the same scene, to the last bit; the plain glTF part is right for other software."""

import json
import struct
import warnings

import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st

from radiosity import scenes
from radiosity.errors import FileFormatError, GeometryWarning, MissingFileError
from radiosity.files import read_scene, write_scene
from radiosity.scene import Material, Scene, Surface

from .same import assert_same_scene, triangle_soup

COORDINATE = st.floats(-1e30, 1e30, width=64)
LIGHT = st.floats(0, 1e300)
SHARE = st.floats(0, 1)
NAME = st.text(max_size=8)


@st.composite
def materials(draw, channels):
    size = draw(st.sampled_from([1, channels]))
    values = draw(st.lists(SHARE, min_size=size, max_size=size))
    emission = draw(st.lists(LIGHT, min_size=channels, max_size=channels))
    given = draw(st.sampled_from(["reflectance", "absorptance"]))
    return Material(**{given: values}, emission=emission, two_sided=draw(st.booleans()), name=draw(NAME))


@st.composite
def surfaces(draw, channels, name):
    count = draw(st.integers(3, 7))
    vertices = draw(st.lists(st.tuples(COORDINATE, COORDINATE, COORDINATE), min_size=count, max_size=count))
    columns = draw(st.sampled_from([3, 4]))
    index = st.integers(0, count - 1)
    last = st.integers(-1, count - 1) if columns == 4 else index
    faces = draw(st.lists(st.tuples(*[index] * (columns - 1), last), min_size=1, max_size=4))
    return Surface(name, vertices, faces, draw(materials(channels)))


@st.composite
def any_scene(draw):
    channels = draw(st.sampled_from([1, 2, 3, 5]))
    names = draw(st.lists(st.text(min_size=1, max_size=8), min_size=1, max_size=3, unique=True))
    return Scene(
        [draw(surfaces(channels, name)) for name in names],
        sky=draw(st.lists(LIGHT, min_size=channels, max_size=channels)),
        name=draw(NAME),
        closed=draw(st.sampled_from([None, True, False])),
    )


@given(any_scene(), st.sampled_from([".glb", ".gltf"]))
def test_write_then_read_is_the_same_scene(tmp_path_factory, scene, suffix):
    path = tmp_path_factory.getbasetemp() / f"any{suffix}"
    write_scene(scene, path)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", GeometryWarning)  # faces drawn at random lie in each other now and then
        assert_same_scene(read_scene(path), scene)


@pytest.mark.parametrize(
    "scene",
    [
        scenes.cornell_box(),
        scenes.cornell_box(spectral=True),
        scenes.furnace(absorptance=1e-12),
        scenes.red_rug(),
    ],
    ids=lambda s: s.name,
)
def test_built_in_scenes_survive(tmp_path, scene):
    write_scene(scene, tmp_path / "scene.glb")
    assert_same_scene(read_scene(tmp_path / "scene.glb"), scene)


def test_plain_part_is_right_for_other_software(tmp_path):
    """Other software knows nothing of our extras: triangles, colours (8 bits) and sides must be right without them."""
    scene = scenes.cornell_box()
    write_scene(scene, tmp_path / "box.glb")
    loaded = trimesh.load(tmp_path / "box.glb", process=False)
    assert set(loaded.graph.nodes_geometry) == set(scene.surface_names)
    for surface in scene.surfaces:
        transform, geometry = loaded.graph[surface.name]
        mesh = loaded.geometry[geometry]
        assert np.array_equal(transform, np.eye(4))
        assert np.array_equal(mesh.triangles, triangle_soup(surface).astype(np.float32).astype(np.float64))
        seen = mesh.visual.material
        assert seen.baseColorFactor[:3] == pytest.approx(255 * surface.material.reflectance, abs=0.51)
        assert bool(seen.doubleSided) is False


def glb_document(path):
    content = path.read_bytes()
    length = struct.unpack_from("<I", content, 12)[0]
    return json.loads(content[20 : 20 + length])


def test_plain_light_is_radiance(tmp_path):
    """Emissive factor × strength is radiance: (17, 12, 4) for the lamp of the Cornell box."""
    write_scene(scenes.cornell_box(), tmp_path / "box.glb")
    document = glb_document(tmp_path / "box.glb")
    (lamp,) = [m for m in document["materials"] if m["name"] == "lamp"]
    strength = lamp["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"]
    assert np.multiply(lamp["emissiveFactor"], strength) == pytest.approx([17, 12, 4], rel=1e-15)
    assert max(lamp["emissiveFactor"]) == 1
    assert document["extensionsUsed"] == ["KHR_materials_emissive_strength"]


def test_equal_arrays_and_materials_are_written_once(tmp_path):
    vertices = np.random.default_rng(0).random((6, 3))
    grey = Material([0.5, 0.5, 0.5])
    scene = Scene([Surface(f"part {k}", vertices, [[k, k + 1, k + 2]], grey) for k in range(4)])
    write_scene(scene, tmp_path / "shared.glb")
    document = glb_document(tmp_path / "shared.glb")
    assert len(document["materials"]) == 1
    assert len({n["extras"]["radiosity"]["vertices"]["bufferView"] for n in document["nodes"]}) == 1
    assert_same_scene(read_scene(tmp_path / "shared.glb"), scene)


def edited(path, change):
    """The .gltf at `path` with its JSON changed as another program would."""
    document = json.loads(path.read_text())
    change(document)
    path.write_text(json.dumps(document))
    return path


def test_stale_exact_material_gives_way_with_a_warning(tmp_path):
    def recolour(document):
        document["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] = [0.1, 0.2, 0.3, 1.0]

    write_scene(scenes.furnace(reflectance=[0.5, 0.5, 0.5]), tmp_path / "scene.gltf")
    with pytest.warns(UserWarning, match="was changed"):
        scene = read_scene(edited(tmp_path / "scene.gltf", recolour))
    assert np.array_equal(scene.surfaces[0].material.reflectance, [0.1, 0.2, 0.3])


def test_stale_exact_mesh_gives_way_with_a_warning(tmp_path):
    def move(document):
        document["nodes"][0]["translation"] = [0, -1, 0]

    write_scene(scenes.furnace(), tmp_path / "scene.gltf")
    with pytest.warns(UserWarning, match="'floor' was changed"):
        scene = read_scene(edited(tmp_path / "scene.gltf", move))
    assert (scene.surfaces[0].vertices[:, 1] == -1).all()


def test_failed_write_leaves_the_old_file_and_no_rubbish(tmp_path):
    path = tmp_path / "scene.glb"
    write_scene(scenes.furnace(), path)
    before = path.read_bytes()
    far = Scene([Surface("far", [[0, 0, 0], [1e39, 0, 0], [0, 1e39, 0]], [[0, 1, 2]], Material(0.5))])
    with pytest.raises(FileFormatError, match=r"'far' reaches 1e\+39 m"):
        write_scene(far, path)
    assert path.read_bytes() == before
    assert [p.name for p in tmp_path.iterdir()] == ["scene.glb"]


def test_where_it_cannot_be_written(tmp_path):
    with pytest.raises(MissingFileError, match="make it first"):
        write_scene(scenes.furnace(), tmp_path / "nowhere" / "scene.glb")
    with pytest.raises(FileFormatError, match=r"choose \.glb or \.gltf"):
        write_scene(scenes.furnace(), tmp_path / "scene.obj")


def test_reading_is_silent_where_nothing_is_lost(tmp_path):
    write_scene(scenes.red_rug(), tmp_path / "scene.glb")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        read_scene(tmp_path / "scene.glb")
