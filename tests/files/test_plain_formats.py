"""PLY, STL, OFF: shape, colours where the format has them, and a named error for what is damaged."""

import struct

import numpy as np
import pytest
import trimesh

from radiosity.errors import FileFormatError, GeometryError, RadiosityError, RadiosityWarning, SceneError
from radiosity.files import read_scene

from .same import triangle_soup

SQUARE_AND_TRIANGLE = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 0.5, 0]]


def area(scene):
    soup = np.concatenate([triangle_soup(s) for s in scene.surfaces])
    return np.linalg.norm(np.cross(soup[:, 1] - soup[:, 0], soup[:, 2] - soup[:, 0]), axis=1).sum() / 2


def read(path, content):
    if isinstance(content, bytes):
        path.write_bytes(content)
    else:
        path.write_text(content)
    return read_scene(path)


def read_grey(path, content):
    with pytest.warns(UserWarning, match=r"gets a grey of reflectance 0\.5"):
        scene = read(path, content)
    assert all(np.array_equal(s.material.reflectance, [0.5] * 3) for s in scene.surfaces)
    return scene


PLY = """\
ply
format ascii 1.0
comment two faces of unlike size, which a general loader puts into another order
element vertex 5
property float x
property float y
property float z
element face 2
property list uchar int vertex_indices
property uchar red
property uchar green
property uchar blue
end_header
0 0 0
1 0 0
1 1 0
0 1 0
2 0.5 0
4 0 1 2 3 255 0 0
3 1 4 2 0 0 188
"""


def binary_ply(order, mark):
    header = PLY.split("end_header\n")[0].replace("ascii", f"binary_{order}_endian").encode() + b"end_header\n"
    body = b"".join(struct.pack(f"{mark}3f", *v) for v in SQUARE_AND_TRIANGLE)
    body += struct.pack(f"{mark}B4i3B", 4, 0, 1, 2, 3, 255, 0, 0)
    return header + body + struct.pack(f"{mark}B3i3B", 3, 1, 4, 2, 0, 0, 188)


@pytest.mark.parametrize(
    "content", [PLY, binary_ply("little", "<"), binary_ply("big", ">")], ids=["ascii", "little", "big"]
)
def test_ply_faces_keep_their_own_colours(tmp_path, content):
    scene = read(tmp_path / "two.ply", content)
    parts = {s.name: s for s in scene.surfaces}
    assert set(parts) == {"two_ff0000", "two_0000bc"}
    square, triangle = parts["two_ff0000"], parts["two_0000bc"]
    assert square.faces.shape == (1, 4)
    assert triangle.faces.shape == (1, 3)
    assert np.array_equal(square.material.reflectance, [1, 0, 0])
    assert triangle.material.reflectance == pytest.approx([0, 0, 0.5029], abs=1e-4)  # sRGB 188 is linear 0.503
    assert np.array_equal(triangle.vertices[triangle.faces[0]], np.array(SQUARE_AND_TRIANGLE)[[1, 4, 2]])


def test_ply_with_colours_of_vertices(tmp_path):
    """A face has the mean of its corners, in linear light."""
    mesh = trimesh.Trimesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], process=False)
    mesh.visual.vertex_colors = [[255, 0, 0, 255], [255, 255, 0, 255], [255, 0, 0, 255]]
    scene = read(tmp_path / "v.ply", mesh.export(file_type="ply"))
    assert scene.surfaces[0].material.reflectance == pytest.approx([1, 1 / 3, 0], rel=1e-12)


def test_ply_of_a_closed_mesh_without_colours(tmp_path):
    mesh = trimesh.creation.icosphere(subdivisions=2)
    scene = read_grey(tmp_path / "ball.ply", mesh.export(file_type="ply"))
    assert scene.surface_names == ("ball",)
    assert area(scene) == pytest.approx(mesh.area, rel=1e-6)


def test_ply_of_many_colours_reflects_as_much_on_the_whole(tmp_path):
    """At most 256 surfaces; the area-weighted mean of the reflectance stays."""
    mesh = trimesh.creation.icosphere(subdivisions=3)
    colours = np.random.default_rng(0).integers(0, 256, (len(mesh.faces), 4)).astype(np.uint8)
    colours[:, 3] = 255
    mesh.visual.face_colors = colours
    with pytest.warns(UserWarning, match="1280 colours; similar ones are put together"):
        scene = read(tmp_path / "confetti.ply", mesh.export(file_type="ply"))
    assert 20 < len(scene.surfaces) <= 256
    codes = colours[:, :3] / 255
    linear = np.where(codes <= 0.04045, codes / 12.92, ((codes + 0.055) / 1.055) ** 2.4)
    expected = mesh.area_faces @ linear / mesh.area
    areas = [np.linalg.norm(np.cross(t[:, 1] - t[:, 0], t[:, 2] - t[:, 0]), axis=1).sum() / 2
             for t in map(triangle_soup, scene.surfaces)]  # fmt: skip
    found = areas @ np.array([s.material.reflectance for s in scene.surfaces]) / np.sum(areas)
    assert found == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (("ply\n", "polygons\n"), "does not begin with a PLY header"),
        (("format ascii 1.0", "format text 1.0"), "line 2 of the PLY header is 'format text 1.0'"),
        (("element vertex 5", "element vertex 5000000000"), "promises 5000000000 of 'vertex'"),
        (("element vertex 5", "element vertex -5"), "promises -5 of 'vertex'"),
        (("element vertex 5", "element vertex 6"), "vertex 5 of the PLY is '4 0 1 2 3 255 0 0': damaged"),
        (("element face 2", "element face 3"), "promises 3 of 'face' and has 2: truncated"),
        (("property float z", "property float w"), "no vertex property 'z'"),
        (("3 1 4 2 0 0 188", "3 1 7 2 0 0 188"), "face 1 names vertex 7; there are 5"),
        (("3 1 4 2 0 0 188", "3 1 4"), "face 1 of the PLY is '3 1 4': damaged"),
        (("3 1 4 2 0 0 188", "3 1 4 2 0 0 999"), "PLY colours reach 0 … 999"),
        (("1 1 0\n", "1 eins 0\n"), "vertex 2 of the PLY is '1 eins 0': damaged"),
        (("property list uchar int", "property list float"), "line 9 of the PLY header"),
        (("property list uchar int", "property list float int"), "line 9 of the PLY header"),
        (("property list uchar int", "property list uchar float"), "line 9 of the PLY header"),
        (("property uchar blue", "property uchar red"), "line 12 of the PLY header"),
        (("element face 2", "element face 1"), "goes on behind the last element"),
        (("element face 2", "element vertex 2"), "line 8 of the PLY header"),
        (("0 1 0\n", "0 1_0 0\n"), "vertex 3 of the PLY is '0 1_0 0': damaged"),
    ],
)
def test_damaged_ply_is_named(tmp_path, change, message):
    assert change[0] in PLY
    with pytest.raises(FileFormatError) as caught:
        read(tmp_path / "two.ply", PLY.replace(*change))
    assert message in str(caught.value)


def test_truncated_binary_ply(tmp_path):
    whole = binary_ply("little", "<")
    body = whole.index(b"end_header") + 11
    for length in range(body, len(whole)):
        with pytest.raises(FileFormatError, match="truncated"):
            read(tmp_path / "two.ply", whole[:length])


def test_a_binary_ply_that_goes_on_and_a_list_of_negative_length(tmp_path):
    whole = binary_ply("little", "<")
    with pytest.raises(FileFormatError, match="13 bytes more than its header promises"):
        read(tmp_path / "two.ply", whole + whole[-13:])
    signed = whole.replace(b"list uchar", b"list char")
    with pytest.raises(FileFormatError, match="a list there has a wrong length"):
        read(tmp_path / "two.ply", signed.replace(b"\x04\x00\x00\x00\x00\x01", b"\xff\x00\x00\x00\x00\x01"))


BOX_AREA = 2 * (1 * 2 + 2 * 3 + 3 * 1)


@pytest.mark.parametrize("form", ["stl", "stl_ascii"])
def test_stl_of_other_software(tmp_path, form):
    mesh = trimesh.creation.box((1, 2, 3))
    scene = read_grey(tmp_path / "box.stl", mesh.export(file_type=form))
    (box,) = scene.surfaces
    assert box.name == "box"
    assert len(box.vertices) == 8  # equal corners are made one
    assert len(box.faces) == 12
    assert area(scene) == pytest.approx(BOX_AREA, rel=1e-12)
    soup = triangle_soup(box)
    assert np.einsum("nx,nx->", soup[:, 0], np.cross(soup[:, 1], soup[:, 2])) / 6 == pytest.approx(6, rel=1e-12)


def test_stl_cut_anywhere_is_refused(tmp_path):
    """A general loader reads two thirds of such files as if they were whole."""
    for form in ("stl", "stl_ascii"):
        whole = trimesh.creation.box((1, 2, 3)).export(file_type=form)
        whole = whole.encode() if isinstance(whole, str) else whole
        for length in np.random.default_rng(0).integers(1, len(whole) - 10, 60):
            with pytest.raises(RadiosityError):
                read(tmp_path / "box.stl", whole[:length])


def test_stl_without_triangles_or_with_numbers_that_are_none(tmp_path):
    with pytest.raises(SceneError, match="no surfaces"):
        read(tmp_path / "none.stl", b"\0" * 84)
    triangle = struct.pack("<12fH", 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, float("nan"), 0, 0)
    with pytest.raises(GeometryError, match="not finite"):
        read(tmp_path / "nan.stl", b"\0" * 80 + struct.pack("<I", 1) + triangle)


OFF = """\
OFF # made by hand
# a comment

6 2 0
0 0 0
3 0 0
3 2 0
1 0.5 0
0 2 0
0 0 1
5 0 1 2 3 4
3 0 5 1 255 0 0
"""


def test_off_with_a_concave_polygon(tmp_path):
    """A fan from the first corner would give 4.25 in place of 3.75 for the pentagon."""
    with pytest.warns(RadiosityWarning) as caught:
        scene = read(tmp_path / "shape.off", OFF)
    messages = [str(w.message) for w in caught]
    assert len(messages) == 2
    assert any("gets a grey of reflectance 0.5" in m for m in messages)
    assert any("colours of an OFF file" in m for m in messages)
    assert area(scene) == pytest.approx(3.75 + 1.5, rel=1e-12)


def test_off_of_other_software(tmp_path):
    mesh = trimesh.creation.icosphere(subdivisions=1)
    scene = read_grey(tmp_path / "ball.off", mesh.export(file_type="off"))
    assert area(scene) == pytest.approx(mesh.area, rel=1e-6)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (("OFF #", "STL #"), "does not begin with OFF"),
        (("OFF #", "4OFF #"), "other than three dimensions"),
        (("6 2 0\n", "BINARY\n"), "binary OFF is not read"),
        (("6 2 0\n", "6 1 0\n"), "promises 6 vertices and 1 faces, but line 12 follows"),
        (("6 2 0\n", "6 9 0\n"), "promises 6 vertices and 9 faces and has 8 lines: truncated"),
        (("3 2 0\n", "3 zwei 0\n"), "line 7 is '3 zwei 0'; expected a vertex"),
        (("5 0 1 2 3 4", "5 0 1 2 3"), "line 11 is '5 0 1 2 3'; expected a face"),
        (("5 0 1 2 3 4", "5 0 1 2 3 9"), "face 0 names vertex 9; there are 6"),
        (("3 0 5 1", "2 0 5 1"), "line 12 is '2 0 5 1 255 0 0'; expected a face"),
    ],
)
def test_damaged_off_is_named(tmp_path, change, message):
    assert change[0] in OFF
    with pytest.raises(FileFormatError) as caught:
        read(tmp_path / "shape.off", OFF.replace(*change))
    assert message in str(caught.value)
