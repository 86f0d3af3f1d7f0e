"""OBJ and MTL as other software writes them, with its traps."""

import warnings

import numpy as np
import pytest

from radiosity.errors import FileFormatError, MaterialError, SceneError, UnusedFeatureWarning
from radiosity.files import read_scene

from .same import triangle_soup

CUBE = """\
v 0 0 0
v 1 0 0
v 1 1 0
v 0 1 0
"""


def read(folder, obj, mtl=None):
    (folder / "scene.obj").write_text(obj)
    if mtl is not None:
        (folder / "scene.mtl").write_text(mtl)
    return read_scene(folder / "scene.obj")


def area(surface):
    a, b, c = np.moveaxis(triangle_soup(surface), 1, 0)
    return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2)


def test_groups_materials_and_negative_indices(tmp_path):
    """Materials stay across groups, `usemtl` may come before `g`, indices count back from the line they stand in."""
    obj = """\
        mtllib scene.mtl
        usemtl white
        g floor
        v 0 0 0
        v 0 0 2
        v 2 0 2
        v 2 0 0
        f -4 -3 -2 -1
        usemtl lamp
        g lamp
        v\t0.5  1.9   0.5
        v 1.5 1.9 0.5
        v 1.5 1.9 1.5
        f -3 -2 \\
          -1
        g shelf
        v 0 5 0
        v 1 5 0
        v 0 5 1
        v 1 6 1
        usemtl white
        f 8 9 10
        usemtl dark
        f 8 9 11
        """
    mtl = """\
        # a comment
        newmtl white
        Ka 0.7 0.7 0.7
        Kd 0.725 0.71 0.68 # not the whole truth
        newmtl lamp
          Kd 0.78
          Ke 17 12 4
        newmtl dark
        Kd\t0.1 0.1 0.1
        """
    scene = read(tmp_path, obj, mtl)
    assert scene.surface_names == ("floor", "lamp", "shelf_white", "shelf_dark")
    floor, lamp, shelf, dark = scene.surfaces
    assert np.array_equal(floor.material.reflectance, [0.725, 0.71, 0.68])
    assert floor.faces.shape == (1, 4)
    assert area(floor) == 4
    assert np.array_equal(lamp.material.reflectance, [0.78, 0.78, 0.78])
    assert np.array_equal(lamp.material.emission, np.pi * np.array([17.0, 12.0, 4.0]))
    assert np.array_equal(lamp.vertices[lamp.faces[0]], [[0.5, 1.9, 0.5], [1.5, 1.9, 0.5], [1.5, 1.9, 1.5]])
    assert shelf.material.name == "white"
    assert dark.material.name == "dark"
    assert not scene.surfaces[0].material.two_sided


def test_objects_as_blender_writes_them(tmp_path):
    obj = (
        CUBE
        + "v 0 0 9\nv 9 9 9\nvt 0 0\nvn 0 0 1\ns 0\no Wall\nf 1/1/1 2/1/1 3/1/1 4/1/1\n"
        + "o Door\nf 1//1 2//1 5//1\no Bare\nf 1/1 2/1 6/1\n"
    )
    with pytest.warns(UserWarning, match="no material"):
        scene = read(tmp_path, obj)
    assert scene.surface_names == ("Wall", "Door", "Bare")
    assert np.array_equal(scene.surfaces[0].material.reflectance, [0.5, 0.5, 0.5])


@pytest.mark.parametrize("first", range(5))
def test_concave_pentagon_has_its_area_from_any_first_corner(tmp_path, first):
    """A fan from the first corner gives 3.5, 5.5 or 2.5 for this one."""
    pentagon = [(0, 0), (3, 0), (3, 2), (1, 0.5), (0, 2)]
    obj = "".join(f"v {x} {y} 7\n" for x, y in pentagon)
    corners = " ".join(str((first + k) % 5 + 1) for k in range(5))
    with pytest.warns(UserWarning, match="no material"):
        scene = read(tmp_path, f"{obj}f {corners}\n")
    assert area(scene.surfaces[0]) == pytest.approx(3.75, rel=1e-12)
    soup = triangle_soup(scene.surfaces[0])
    assert (np.cross(soup[:, 1] - soup[:, 0], soup[:, 2] - soup[:, 0])[:, 2] > 0).all()


def test_polygon_with_a_hole_by_a_slit(tmp_path):
    """A frame as one polygon of ten corners: the slit between outline and hole is walked both ways."""
    corners = [(0, 0), (3, 0), (3, 3), (0, 3), (0, 0), (1, 1), (1, 2), (2, 2), (2, 1), (1, 1)]
    obj = "".join(f"v {x} {y} 0\n" for x, y in corners) + "f 1 2 3 4 5 6 7 8 9 10\n"
    with pytest.warns(UserWarning, match="no material"):
        assert area(read(tmp_path, obj).surfaces[0]) == pytest.approx(8, rel=1e-12)


def test_what_is_not_used_is_named_in_one_warning(tmp_path):
    mtl = """\
newmtl gloss
Kd 0.5 0.5 0.5
Ks 0.5 0.5 0.5
newmtl mirror
Kd 0 0 0
Ks 0.725 0.71 0.68
newmtl glass
Kd 0.5 0.5 0.5
d 0.3
map_Bump bumps.png
"""
    obj = "mtllib scene.mtl\n" + CUBE + "usemtl gloss\nf 1 2 3\nusemtl mirror\nf 1 3 4\n"
    obj += "usemtl glass\nv 0 0 9\nf 2 3 5\nl 1 2\n"
    with pytest.warns(UnusedFeatureWarning) as caught:
        scene = read(tmp_path, obj, mtl)
    assert len(caught) == 1
    message = str(caught[0].message)
    for part in (
        "glossy reflection (Ks) (gloss)",
        "glossy reflection (Ks) without Kd, so black here (mirror)",
        "transparency (alpha) (glass)",
        "normal map (glass)",
        "points and lines",
    ):
        assert part in message
    assert (scene.surfaces[1].material.reflectance == 0).all()


def test_materials_by_argument(tmp_path):
    (tmp_path / "scene.obj").write_text(CUBE + "o wall\nf 1 2 3 4\n")
    from radiosity.scene import Material

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        scene = read_scene(tmp_path / "scene.obj", unit="mm", materials={"wall": Material(absorptance=[0.1] * 3)})
    assert scene.surfaces[0].material.given == "absorptance"
    assert scene.surfaces[0].vertices.max() == 1e-3


@pytest.mark.parametrize(
    ("obj", "message"),
    [
        (CUBE + "f 1 2 5\n", "line 5: vertex 5 does not exist; 4 come before"),
        (CUBE + "f 1 2 -5\n", "line 5: vertex -5 does not exist"),
        (CUBE + "f 1 2 0\n", "line 5: vertex 0 does not exist"),
        (CUBE + "f 1 2\n", "line 5: a face of 2 corners"),
        (CUBE + "f 1/7 2/7 3/7\n", "line 5: texture vertex 7 does not exist"),
        (CUBE + "f 1 2 3.5\n", "line 5 is 'f 1 2 3.5': expected numbers"),
        (CUBE + "f 1 2 x\n", "line 5 is 'f 1 2 x': expected numbers"),
        ("v 1 2\n", "line 1: a vertex of 2 numbers"),
        ("v 1 2 zwei\n", "line 1 is 'v 1 2 zwei': expected numbers"),
        ("solid cube\n", "line 1 is 'solid cube', no OBJ statement"),
        (CUBE + "v 2 2 0\nf 1 1 1 1 1\n", "line 6: a polygon of 5 corners without area"),
        (CUBE + "v 2 2 0\nf 1 3 2 4 5\n", "line 6: a polygon is flat or crosses itself"),
        ("mtllib ../secret.mtl\n" + CUBE, "only files in the folder of the scene"),
        ("mtllib /etc/secret.mtl\n" + CUBE, "only files in the folder of the scene"),
        ("mtllib C:\\secret.mtl\n" + CUBE, "only files in the folder of the scene"),
    ],
)
def test_damage_is_named_with_its_line(tmp_path, obj, message):
    with pytest.raises(FileFormatError) as caught:
        read(tmp_path, obj)
    assert message in str(caught.value)
    assert "scene.obj" in str(caught.value)


def test_signs_of_a_file_cut_off(tmp_path):
    with pytest.warns(UserWarning, match=r"the last line has no end.*1 of 4 vertices belong to no face"):
        read(tmp_path, CUBE + "f 1 2 3")


def test_no_faces_is_an_empty_scene(tmp_path):
    with pytest.raises(SceneError, match="no surfaces"):
        read(tmp_path, CUBE)


def test_missing_library_and_missing_material(tmp_path):
    with pytest.warns(UserWarning, match=r"library 'scene\.mtl' is not beside the file.*'oak' is not defined"):
        read(tmp_path, "mtllib scene.mtl\nusemtl oak\n" + CUBE + "f 1 2 3 4\n")


@pytest.mark.parametrize(
    ("mtl", "error", "message"),
    [
        ("Kd 1 1 1\n", FileFormatError, "line 1: 'Kd' before any newmtl"),
        ("newmtl a\nKd 1 1\n", FileFormatError, "line 2: Kd '1 1' has 2 numbers"),
        ("newmtl a\nKd rot\n", FileFormatError, "line 2: Kd 'rot' holds no numbers"),
        ("newmtl a\nKd spectral a.rfl\n", FileFormatError, "line 2: Kd spectral is not read"),
        ("newmtl a\nKd 1.5 1 1\n", MaterialError, "'a': reflectance 1.5 in channel 0 is outside [0, 1]"),
        ("newmtl a\nKd 1 1 1\nKe -1 0 0\n", MaterialError, "negative"),
        ("newmtl a\nKd nan 1 1\n", FileFormatError, "line 2: Kd 'nan 1 1' holds no numbers"),
        ("newmtl a\nKd 1_0 1 1\n", FileFormatError, "line 2: Kd '1_0 1 1' holds no numbers"),
    ],
)
def test_broken_materials_are_named(tmp_path, mtl, error, message):
    with pytest.raises(error) as caught:
        read(tmp_path, "mtllib scene.mtl\nusemtl a\n" + CUBE + "f 1 2 3 4\n", mtl)
    assert message in str(caught.value)


def test_a_link_out_of_the_folder_is_refused(tmp_path):
    folder = tmp_path / "scene"
    folder.mkdir()
    (tmp_path / "secret.mtl").write_text("newmtl a\n")
    (folder / "scene.mtl").symlink_to(tmp_path / "secret.mtl")
    with pytest.raises(FileFormatError, match="a link out of the folder"):
        read(folder, "mtllib scene.mtl\nusemtl a\n" + CUBE + "f 1 2 3 4\n")


def test_texture_counts_by_its_mean_over_the_face(tmp_path):
    """A picture, white above and black below; OBJ counts v from the bottom, so small v is black."""
    image = pytest.importorskip("PIL.Image")
    image.fromarray(np.array([[[255] * 3] * 2, [[0] * 3] * 2], dtype=np.uint8)).save(tmp_path / "wood grain.png")
    square = CUBE + "vt 0 0\nvt 1 0\nvt 1 0.5\nvt 0 0.5\nvt 0 1\nvt 1 1\nmtllib scene.mtl\nusemtl wood\n"
    obj = square + "o low\nf 1/1 2/2 3/3 4/4\n"
    obj += "v 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\no high\nf 5/4 6/3 7/6 8/5\no bare\nf 1 2 6 5\n"
    mtl = "newmtl wood\nKd 0.5 1 1\nmap_Kd wood grain.png\nmap_Ke -s 1 1 1 missing.png\n"
    with pytest.warns(UserWarning, match=r"map_Ke 'missing\.png' of material 'wood' is not used \(it is not there\)"):
        scene = read(tmp_path, obj, mtl)
    assert scene.surface_names == ("low", "high", "bare")
    found = [s.material.reflectance for s in scene.surfaces]
    assert np.array_equal(found, [[0, 0, 0], [0.5, 1, 1], [0.25, 0.5, 0.5]])
    assert scene.surfaces[0].faces.shape == (1, 4)


def test_pictures_elsewhere_are_not_opened(tmp_path):
    mtl = "newmtl wood\nKd 0.5 0.5 0.5\nmap_Kd C:\\pictures\\wood.png\n"
    with pytest.warns(UserWarning, match="only files in the folder of the scene are read"):
        scene = read(tmp_path, CUBE + "mtllib scene.mtl\nusemtl wood\nf 1 2 3 4\n", mtl)
    assert np.array_equal(scene.surfaces[0].material.reflectance, [0.5] * 3)
