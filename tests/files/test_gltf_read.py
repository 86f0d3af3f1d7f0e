"""The glTF reader on files that it did not write: what they say, or a named error with the place."""

import json
import struct
import warnings
from io import BytesIO

import numpy as np
import pytest

from radiosity.errors import FileFormatError, GeometryError, RadiosityError, SceneError, UnusedFeatureWarning
from radiosity.files import read_scene, write_scene
from radiosity.scenes import cornell_box

from .gltf_by_hand import TRIANGLE, Gltf, one_triangle
from .same import triangle_soup


@pytest.fixture
def read(tmp_path):
    def write_and_read(gltf, suffix=".gltf"):
        return read_scene(gltf.write(tmp_path / f"scene{suffix}"))

    return write_and_read


def normal(surface):
    corners = triangle_soup(surface)
    return np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 2


@pytest.mark.parametrize("suffix", [".gltf", ".glb"])
def test_a_plain_triangle(read, suffix):
    scene = read(one_triangle(), suffix)
    (thing,) = scene.surfaces
    assert scene.name == "scene"
    assert scene.closed is None
    assert thing.name == "thing"
    assert np.array_equal(thing.material.reflectance, [0.5, 0.25, 0.125])
    assert thing.material.name == "red"
    assert not thing.material.two_sided
    assert np.array_equal(thing.vertices, TRIANGLE)


def test_radiance_is_factor_times_strength(read):
    gltf = Gltf()
    lamp = gltf.material(
        emissiveFactor=[1, 0.5, 0.25],
        extensions={"KHR_materials_emissive_strength": {"emissiveStrength": 8}},
        doubleSided=True,
        pbrMetallicRoughness={"metallicFactor": 0},
    )
    gltf.primitive(material=lamp)
    material = read(gltf).surfaces[0].material
    assert material.emission == pytest.approx(np.pi * np.array([8, 4, 2]), rel=1e-15)
    assert np.array_equal(material.reflectance, [1, 1, 1])  # glTF's default, where there is a material
    assert material.two_sided


def test_external_buffer(tmp_path):
    gltf = one_triangle()
    path = gltf.write(tmp_path / "scene.gltf")
    document = json.loads(path.read_text())
    document["buffers"][0]["uri"] = "sub%20folder/data.bin"
    (tmp_path / "sub folder").mkdir()
    (tmp_path / "sub folder" / "data.bin").write_bytes(gltf.binary)
    path.write_text(json.dumps(document))
    assert np.array_equal(read_scene(path).surfaces[0].vertices, TRIANGLE)


@pytest.mark.parametrize(
    "uri",
    ["../data.bin", "/etc/passwd", "file:///etc/passwd", "http://example.org/a.bin", "..%2Fdata.bin", "C:\\a.bin"],
)
def test_nothing_outside_the_folder_is_read(tmp_path, uri):
    folder = tmp_path / "folder"
    folder.mkdir()
    gltf = one_triangle()
    (tmp_path / "data.bin").write_bytes(gltf.binary)
    path = gltf.write(folder / "scene.gltf")
    document = json.loads(path.read_text())
    document["buffers"][0]["uri"] = uri
    path.write_text(json.dumps(document))
    with pytest.raises(FileFormatError, match="only files in the folder of the scene are read"):
        read_scene(path)


def test_transforms_of_parents_and_mirrors(read):
    """Child's scale first, then its rotation, then the parent's mirror; a mirrored front stays a front."""
    gltf = one_triangle()
    quarter = [0, 0, float(np.sqrt(0.5)), float(np.sqrt(0.5))]  # +90° about z: x → y, y → -x
    gltf.document["nodes"] = [
        {"children": [1], "matrix": [-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 10, 0, 0, 1]},
        {"mesh": 0, "name": "thing", "rotation": quarter, "scale": [2, 3, 1], "translation": [0, 0, 5]},
    ]
    (thing,) = read(gltf).surfaces
    # (1, 0, 0) → (2, 0, 0) → (0, 2, 5) → (10, 2, 5); (0, 1, 0) → (0, 3, 0) → (-3, 0, 5) → (13, 0, 5)
    assert thing.vertices == pytest.approx(np.array([[10, 0, 5], [10, 2, 5], [13, 0, 5]]), abs=1e-12)
    assert normal(thing) == pytest.approx(np.array([[0, 0, 3]]), abs=1e-12)  # was +z, and is mirrored in x only


def test_one_mesh_in_two_nodes_and_two_primitives(read):
    gltf = one_triangle()
    gltf.primitive(np.add(TRIANGLE, [0, 0, 1]), [0, 2, 1], material=0)
    gltf.document["nodes"] = [{"mesh": 0, "name": "chair"}, {"mesh": 0, "name": "chair", "translation": [0, 0, 9]}]
    gltf.document["scenes"] = [{"nodes": [0, 1], "name": "Scene"}]
    with pytest.warns(UserWarning, match="'chair_1' × 2"):
        scene = read(gltf)
    assert scene.surface_names == ("chair_1", "chair_2", "chair_1_2", "chair_2_2")
    assert scene.name == "scene"  # the file's


def test_only_the_chosen_scene_is_read(read):
    gltf = one_triangle()
    gltf.document["nodes"] = [{"mesh": 0, "name": "a"}, {"mesh": 0, "name": "b", "translation": [0, 0, 1]}]
    gltf.document["scenes"] = [{"nodes": [0]}, {"nodes": [1]}]
    gltf.document["scene"] = 1
    assert read(gltf).surface_names == ("b",)
    del gltf.document["scenes"], gltf.document["scene"]
    assert read(gltf).surface_names == ("a", "b")


SQUARE = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]]


@pytest.mark.parametrize(("mode", "order"), [(5, [0, 1, 2, 3]), (6, [0, 1, 3, 2]), (4, [0, 1, 2, 2, 1, 3])])
def test_strips_and_fans_face_the_same_way(read, mode, order):
    gltf = Gltf()
    gltf.primitive(SQUARE, order, mode=mode, material=gltf.material())
    assert normal(read(gltf).surfaces[0]) == pytest.approx(np.array([[0, 0, 0.5]] * 2))


def test_quantised_interleaved_and_sparse_corners(read):
    """Normalised shorts with a stride, of which a sparse accessor moves one."""
    gltf = Gltf()
    rows = np.zeros(4, dtype=[("position", "<i2", 3), ("pad", "<i2", 3)])
    rows["position"] = np.array(SQUARE) * 32767
    rows["pad"] = -77
    gltf.document["accessors"].append(
        {
            "bufferView": gltf.view(rows.tobytes(), byteStride=12),
            "componentType": 5122,
            "normalized": True,
            "count": 4,
            "type": "VEC3",
            "sparse": {
                "count": 1,
                "indices": {"bufferView": gltf.view(np.array([3], "<u1").tobytes()), "componentType": 5121},
                "values": {"bufferView": gltf.view(np.array([[16384, 32767, -32768]], "<i2").tobytes())},
            },
        }
    )
    gltf.document["meshes"][0]["primitives"] = [
        {"attributes": {"POSITION": 0}, "indices": gltf.accessor([0, 1, 3], "u1"), "material": gltf.material()}
    ]
    gltf.document["extensionsRequired"] = ["KHR_mesh_quantization"]
    vertices = read(gltf).surfaces[0].vertices
    assert vertices[:3] == pytest.approx(np.array(SQUARE[:3], dtype=float))
    assert vertices[3] == pytest.approx([16384 / 32767, 1.0, -1.0])


def test_what_is_not_used_is_named_in_one_warning(read):
    gltf = Gltf()
    full = gltf.material(
        name="chrome",
        pbrMetallicRoughness={"metallicFactor": 1, "baseColorFactor": [1, 1, 1, 0.5], "metallicRoughnessTexture": {}},
        normalTexture={},
        alphaMode="BLEND",
        extensions={"KHR_materials_clearcoat": {}, "KHR_materials_unlit": {}},
    )
    plain = gltf.material(name="paint", pbrMetallicRoughness={"metallicFactor": 0}, alphaMode="OPAQUE")
    gltf.primitive(material=full)
    gltf.primitive(material=plain, mode=1)
    gltf.document["animations"] = [{}]
    gltf.document["nodes"].append({"name": "sun", "extensions": {"KHR_lights_punctual": {"light": 0}}})
    gltf.document["scenes"][0]["nodes"] = [0, 1]
    with pytest.warns(UnusedFeatureWarning) as caught:
        read(gltf)
    assert len(caught) == 1
    message = str(caught[0].message)
    for feature in ("metallic reflection (chrome)", "transparency", "normal texture", "clear coat", "unlit",
                    "metallicRoughness texture", "punctual light (sun)", "animation", "points and lines"):  # fmt: skip
        assert feature in message
    assert "paint" not in message


def test_absent_and_trivial_values_are_not_warned_of(read):
    gltf = Gltf()
    gltf.primitive(material=gltf.material(pbrMetallicRoughness={}, alphaMode="BLEND"))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        read(gltf)


def test_no_material_is_grey_and_said(read):
    gltf = Gltf()
    gltf.primitive()
    with pytest.warns(UserWarning, match=r"'thing' has no material; it gets a grey of reflectance 0\.5"):
        scene = read(gltf)
    assert np.array_equal(scene.surfaces[0].material.reflectance, [0.5] * 3)


def picture(pixels):
    image = pytest.importorskip("PIL.Image")
    stream = BytesIO()
    image.fromarray(np.array(pixels, dtype=np.uint8)).save(stream, "png")
    return stream.getvalue()


def textured(pixels, coordinates=((0, 0), (1, 0), (0, 1), (1, 1)), **info):
    """A square of two triangles with a picture on it."""
    gltf = Gltf()
    gltf.document["images"] = [{"bufferView": gltf.view(picture(pixels)), "mimeType": "image/png"}]
    gltf.document["textures"] = [{"source": 0}]
    material = gltf.material(
        name="wood",
        pbrMetallicRoughness={"baseColorTexture": {"index": 0} | info, "baseColorFactor": [0.5, 1, 1, 1]},
    )
    uv = gltf.accessor(coordinates, "f4")
    gltf.primitive(SQUARE, [0, 1, 2, 2, 1, 3], material=material, attributes={"TEXCOORD_0": uv})
    return gltf


def test_texture_counts_by_its_mean_over_the_face(read):
    """A picture half black, half white (both the same in sRGB and linear), cut by the square's diagonal."""
    scene = read(textured([[[0] * 3, [255] * 3]] * 2))
    assert len(scene.surfaces) == 2
    by_side = sorted(s.material.reflectance[1] for s in scene.surfaces)
    # the triangle on the black side has a quarter of its area in the white half
    assert by_side == pytest.approx([0.25, 0.75], abs=2e-3)
    for s in scene.surfaces:
        assert s.material.reflectance[0] == pytest.approx(0.5 * s.material.reflectance[1], rel=1e-12)
        assert s.name.startswith("thing_")
        assert s.material.name == "wood"


def test_texture_colours_are_linear_means_not_means_of_codes(read):
    (surface,) = read(textured([[[188] * 3]])).surfaces
    assert surface.name == "thing"
    assert surface.material.reflectance[1] == pytest.approx(0.5029, abs=1e-4)  # sRGB 188


def test_texture_transform(read):
    """Shrunk to the left half, everything is black; turned by 90°, the halves lie above each other."""
    halves = [[[0] * 3, [255] * 3]] * 2
    left = textured(halves, extensions={"KHR_texture_transform": {"scale": [0.5, 1]}})
    assert [s.material.reflectance[1] for s in read(left).surfaces] == [0]
    turned = textured(halves, extensions={"KHR_texture_transform": {"rotation": np.pi / 2}})
    # rotated by 90° u' = v: the triangle with small v, the first, is the dark one
    by_side = sorted(s.material.reflectance[1] for s in read(turned).surfaces)
    assert by_side == pytest.approx([0.25, 0.75], abs=2e-3)


def test_a_broken_picture_leaves_the_plain_colour(read):
    gltf = textured([[[0] * 3]])
    gltf.document["images"] = [{"uri": "data:image/png;base64,AAAA"}]
    with pytest.warns(UserWarning, match=r"images\[0\] cannot be read"):
        scene = read(gltf)
    assert np.array_equal(scene.surfaces[0].material.reflectance, [0.5, 1, 1])


def test_vertex_colours_count_by_their_mean(read):
    gltf = Gltf()
    colours = gltf.accessor([[255, 0, 0, 255], [0, 255, 0, 255], [0, 0, 0, 255]], "u1", normalized=True)
    gltf.primitive(attributes={"COLOR_0": colours})
    (surface,) = read(gltf).surfaces
    assert surface.material.reflectance == pytest.approx([1 / 3, 1 / 3, 0], rel=1e-12)


def broken(change):
    gltf = one_triangle()
    change(gltf.document)
    return gltf


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda d: d["asset"].update(version="1.0"), "asset.version is '1.0'"),
        (lambda d: d.update(extensionsRequired=["KHR_draco_mesh_compression"]), "requires KHR_draco_mesh_compression"),
        (lambda d: d["accessors"][0].update(count=4), "accessors[0] needs 48 bytes of a bufferView of 36"),
        (lambda d: d["accessors"][0].update(count=10**12), "accessors[0] needs"),
        (lambda d: d["accessors"][0].update(count=-1), "accessors[0].count is -1"),
        (lambda d: d["accessors"][0].update(componentType=5130), "componentType is 5130"),
        (lambda d: d["accessors"][0].update(type="MAT4"), "accessors[0].type is 'MAT4'; expected VEC3"),
        (lambda d: d["accessors"][0].update(byteOffset=4), "accessors[0] needs 40 bytes"),
        (lambda d: d["accessors"][0].pop("bufferView"), None),  # zeros: a triangle without area, for later
        (lambda d: (d["accessors"][0].pop("bufferView"), d["accessors"][0].update(count=10**9)), "no bufferView"),
        (lambda d: d["accessors"][1].update(componentType=5122), "indices are int16"),
        (lambda d: d["accessors"][1].update(count=2), "2 indices, no multiple of 3"),
        (lambda d: d["bufferViews"][0].update(byteLength=10**9), "bufferViews[0] ends at byte 1000000000"),
        (lambda d: d["bufferViews"][0].update(byteStride=4), "a stride of 4 bytes does not hold elements of 12"),
        (lambda d: d["bufferViews"][0].update(buffer=1), "bufferViews[0].buffer is 1, but the file has 1 buffers"),
        (lambda d: d["nodes"][0].update(mesh=1), "nodes[0].mesh is 1, but the file has 1 meshes"),
        (lambda d: d["nodes"][0].update(mesh="a"), "nodes[0].mesh is 'a'"),
        (lambda d: d["nodes"][0].update(children=[0]), "nodes[0] has two parents or is its own ancestor"),
        (lambda d: d["nodes"][0].update(children=[7]), "children is 7, but the file has 1 nodes"),
        (lambda d: d["nodes"][0].update(rotation=[0, 0, 0, 0]), "a rotation is a unit quaternion"),
        (lambda d: d["nodes"][0].update(scale=[1, 1]), "nodes[0].scale is [1, 1]; expected 3 numbers"),
        (lambda d: d["nodes"][0].update(matrix=[10**400] * 16), "expected finite numbers"),
        (lambda d: d["meshes"][0]["primitives"][0].update(material=3), "but the file has 1 materials"),
        (lambda d: d["meshes"][0]["primitives"][0].update(mode=9), "mode is 9"),
        (lambda d: d["meshes"][0]["primitives"][0].pop("attributes"), "attributes.POSITION is None"),
        (
            lambda d: d["materials"][0]["pbrMetallicRoughness"].update(baseColorFactor=[2, 0, 0, 1]),
            "glTF allows [0, 1]",
        ),
        (lambda d: d["materials"][0].update(emissiveFactor="red"), "emissiveFactor is 'red'; expected 3 numbers"),
        (lambda d: d["materials"][0].update(doubleSided=1), "doubleSided is 1; expected true or false"),
        (lambda d: d.update(meshes=7), "glTF.meshes is 7; expected a list of objects"),
        (lambda d: d.update(scene=2), "scene is 2, but the file has 1 scenes"),
    ],
)
def test_damage_is_named_with_its_place(read, change, message):
    if message is None:
        assert (read(broken(change)).surfaces[0].vertices == 0).all()
        return
    with pytest.raises(FileFormatError) as caught:
        read(broken(change))
    assert message in str(caught.value)
    assert "scene.gltf" in str(caught.value)


def test_index_beyond_the_vertices(read):
    gltf = Gltf()
    gltf.primitive(indices=[0, 1, 3], material=gltf.material())
    with pytest.raises(FileFormatError, match="indices reach 3, but there are 3 vertices"):
        read(gltf)


def test_corners_that_are_not_finite(read):
    gltf = Gltf()
    gltf.primitive([[0, 0, 0], [1, 0, 0], [0, float("nan"), 0]], material=gltf.material())
    with pytest.raises(GeometryError, match="'thing': vertices are not finite: 2"):
        read(gltf)


def test_a_million_instances_are_refused_before_they_are_made(read):
    gltf = Gltf()
    gltf.primitive(np.zeros((3000, 3)), material=gltf.material())
    gltf.document["nodes"] = [{"mesh": 0}] * 60_000
    gltf.document["scenes"] = [{"nodes": list(range(60_000))}]
    with pytest.raises(FileFormatError, match="60000000 triangles"):
        read(gltf)


def test_no_triangles_is_an_empty_scene(read):
    gltf = Gltf()
    gltf.document["nodes"] = [{"name": "nothing"}]
    with pytest.raises(SceneError, match="no surfaces"):
        read(gltf)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"glTF", "within the header of a GLB"),
        (struct.pack("<4sIIII", b"glTF", 1, 20, 0, 0), "a GLB of version 1"),
        (struct.pack("<4sIIIII", b"glTF", 2, 20, 0, 0, 0), "the header says 20 bytes, the file has 24: it is damaged"),
        (struct.pack("<4sIIII", b"glTF", 2, 999, 0, 0), "the header says 999 bytes, the file has 20: it is truncated"),
        (struct.pack("<4sIIII", b"glTF", 2, 20, 99, 0), "the chunk at byte 12 says 99 bytes"),
        (struct.pack("<4sIIII", b"glTF", 2, 20, 0, 0), "no JSON chunk"),
        (b"\xff\xfe\x00", "byte 0 is not UTF-8"),
        (b"{", "line 1, column 2 is not JSON"),
        (b'{"asset": {"version": "2.0", "x": NaN}}', "holds NaN"),
        (b"[" * 100_000, "nested too deeply"),
        (b'{"asset": ' + b"9" * 5000 + b"}", "the JSON holds a number that is too long"),
        (b"[]", "it has no 'asset'"),
        (b"{}", "it has no 'asset'"),
    ],
)
def test_what_is_no_gltf(tmp_path, content, message):
    path = tmp_path / "scene.glb"
    path.write_bytes(content)
    with pytest.raises(FileFormatError) as caught:
        read_scene(path)
    assert message in str(caught.value)


def test_cut_and_damaged_files_never_end_in_anything_but_a_named_error(tmp_path):
    """A file cut anywhere is refused; a file with a changed byte gives a scene or a named error."""
    path = tmp_path / "scene.glb"
    write_scene(cornell_box(), path)
    whole = path.read_bytes()
    generator = np.random.default_rng(1)
    for length in generator.integers(1, len(whole), 150):
        path.write_bytes(whole[:length])
        with pytest.raises(RadiosityError):
            read_scene(path)
    refused = 0
    for _ in range(600):
        damaged = bytearray(whole)
        for place in generator.integers(0, len(whole), 3):
            damaged[place] = generator.integers(0, 256)
        path.write_bytes(damaged)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            try:
                read_scene(path)
            except RadiosityError:
                refused += 1
    assert 0 < refused < 600
