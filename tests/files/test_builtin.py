"""`meshes/` holds what the functions say, and an example of other software."""

from pathlib import Path

import numpy as np
import pytest

from radiosity import scenes
from radiosity.errors import GeometryWarning
from radiosity.files import read_scene, write_builtin_scenes

from .same import assert_same_scene, triangle_soup

MESHES = Path(__file__).resolve().parents[2] / "meshes"


@pytest.mark.parametrize("name", scenes.BUILT_IN)
def test_file_in_meshes_is_the_built_in_scene(name):
    """To rounding: sines differ in the last digit between machines. Write them again after changing a scene."""
    found, expected = read_scene(MESHES / f"{name}.glb"), scenes.BUILT_IN[name]()
    assert found.surface_names == expected.surface_names
    assert found.closed is expected.closed
    assert np.array_equal(found.sky, expected.sky)
    for one, other in zip(found.surfaces, expected.surfaces, strict=True):
        assert np.array_equal(one.faces, other.faces), other.name
        assert np.allclose(one.vertices, other.vertices, rtol=0, atol=1e-12), other.name
        assert np.allclose(one.material.reflectance, other.material.reflectance, rtol=1e-14, atol=0), other.name
        assert np.allclose(one.material.emission, other.material.emission, rtol=1e-14, atol=0), other.name


def test_written_scenes_read_back_and_are_listed(tmp_path):
    written = write_builtin_scenes(tmp_path / "new" / "folder")
    assert {p.stem for p in written} == {*scenes.BUILT_IN, "README"}
    readme = (tmp_path / "new" / "folder" / "README.md").read_text()
    for path in written[:-1]:
        assert f"`{path.name}`" in readme
        assert_same_scene(read_scene(path), scenes.BUILT_IN[path.stem]())
    assert "studio" not in readme


def test_readme_in_meshes_is_current(tmp_path):
    write_builtin_scenes(tmp_path)
    made = (tmp_path / "README.md").read_text()
    assert (MESHES / "README.md").read_text().startswith(made)


def test_a_readme_of_somebody_else_is_left_alone(tmp_path):
    (tmp_path / "README.md").write_text("# My project\n")
    written = write_builtin_scenes(tmp_path)
    assert (tmp_path / "README.md").read_text() == "# My project\n"
    assert tmp_path / "README.md" not in written


def test_studio_as_blender_wrote_it():
    """Node transforms with uneven scale, emissive strength, doubleSided, names: values read off in Blender."""
    with pytest.warns(GeometryWarning, match=r"'Floor' and 'Crate' over 0\.63 m²"):  # it stands on it
        scene = read_scene(MESHES / "studio.glb", contacts="keep")
    assert scene.surface_names == (
        "Floor", "Ceiling", "WallBack", "WallFront", "WallLeft", "WallRight", "Rug", "LampPanel", "Suzanne", "Crate",
        "Column", "Ring",
    )  # fmt: skip
    parts = {s.name: s for s in scene.surfaces}
    assert all(s.material.two_sided for s in scene.surfaces)
    assert parts["LampPanel"].material.emission / np.pi == pytest.approx([12.0, 11.16, 9.84], rel=1e-6)
    assert [s.name for s in scene.surfaces if s.material.emission.any()] == ["LampPanel"]
    assert parts["Rug"].material.name == "Red rug"
    assert parts["Rug"].material.reflectance == pytest.approx([0.6, 0.06, 0.05], rel=1e-6)
    assert len(parts["Suzanne"].faces) == 968
    everything = np.concatenate([triangle_soup(s).reshape(-1, 3) for s in scene.surfaces])
    assert everything.min(axis=0) == pytest.approx([-2.5, 0, -3], abs=1e-6)
    assert everything.max(axis=0) == pytest.approx([2.5, 2.7, 3], abs=1e-6)
    crate = triangle_soup(parts["Crate"])
    volume = np.einsum("nx,nx->", crate[:, 0], np.cross(crate[:, 1], crate[:, 2])) / 6
    assert volume == pytest.approx(0.9 * 0.8 * 0.7, rel=1e-6)  # uneven scale, normals outwards
    down = triangle_soup(parts["LampPanel"])
    assert np.cross(down[:, 1] - down[:, 0], down[:, 2] - down[:, 0]).sum(axis=0) / 2 == pytest.approx(
        [0, -1.2 * 0.6, 0], abs=1e-6
    )
