"""Results last: files of earlier versions open, newer ones are refused, and what a file says of its origin is true."""

from __future__ import annotations

import hashlib
import json
from dataclasses import replace
from importlib import metadata
from pathlib import Path

import numpy as np
import pytest

import radiosity as rad
from radiosity.errors import FileFormatError
from radiosity.files.provenance import scene_hash

from .same import assert_same_bits, assert_same_scene

KEPT = Path(__file__).parent / "kept"
LIGHT = "0824197519ebc7364e267cf7c53dd37535a37bc22044cc8db77e6c99cfc55d32"  # SHA-256 of the radiosity that was saved


@pytest.mark.parametrize("name", sorted(path.name for path in KEPT.glob("*.npz")))
def test_files_of_earlier_versions_open_to_the_last_bit(name, tmp_path):
    """Written once and never again; a change of the format adds a file here, and takes none away."""
    solution = rad.read_solution(KEPT / name)
    assert hashlib.sha256(solution.radiosity.tobytes()).hexdigest() == LIGHT
    assert_same_scene(solution.scene, rad.scenes.two_rooms())
    assert solution.settings["seed"] == 11
    assert len(solution.factors.replicates) == 2
    assert_same_bits(solution.relight(emission={}).radiosity, solution.radiosity, "solved again")
    solution.save(tmp_path / "again.npz")
    assert_same_bits(rad.read_solution(tmp_path / "again.npz").orders, solution.orders, "orders")


@pytest.fixture(scope="module")
def solution():
    return rad.read_solution(KEPT / "solution_v1.npz")


def about(solution, path):
    """What a file of results says of itself, read by others' libraries."""
    solution.save(path)
    if path.suffix == ".npz":
        with np.load(path, allow_pickle=False) as file:
            return json.loads(bytes(file["header"]))
    if path.suffix == ".vtp":
        from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

        reader = vtkXMLPolyDataReader()
        reader.SetFileName(str(path))
        reader.Update()
        return json.loads(reader.GetOutput().GetFieldData().GetAbstractArray("about").GetValue(0))
    import trimesh

    trimesh.load(path)
    content = path.read_bytes()
    return json.loads(content[20 : 20 + int.from_bytes(content[12:16], "little")])["extras"]["radiosity_baked"]


@pytest.mark.parametrize("suffix", [".npz", ".vtp", ".glb"])
def test_every_result_tells_where_it_comes_from(solution, tmp_path, suffix):
    said = about(solution, tmp_path / f"a{suffix}")
    assert said["written_by"] == f"radiosity {rad.__version__}"
    assert said["versions"]["numpy"] == np.__version__
    assert set(said["versions"]) == {"python", "numpy", "scipy", "numba", "embreex"}
    assert said["versions"]["embreex"] == metadata.version("embreex")
    assert said["scene_sha256"] == scene_hash(rad.scenes.two_rooms())
    assert said["settings"] == solution.settings
    assert said["settings"]["seed"] == 11


def changed_scenes():
    scene = rad.scenes.two_rooms()
    first, *others = scene.surfaces
    moved = first.vertices.copy()
    moved[0, 0] = np.nextafter(moved[0, 0], 9.0)
    material = first.material
    reflectance = np.nextafter(material.reflectance, 0.0)
    yield replace(scene, sky=1e-300)
    yield replace(scene, closed=False)
    yield replace(scene, surfaces=[*others, first])
    yield replace(scene, surfaces=[replace(first, vertices=moved), *others])
    yield replace(scene, surfaces=[replace(first, faces=first.faces[::-1][:, ::-1]), *others])
    yield replace(scene, surfaces=[replace(first, name="other"), *others])
    yield replace(scene, surfaces=[replace(first, material=material.replace(reflectance=reflectance)), *others])
    yield replace(scene, surfaces=[replace(first, material=material.replace(two_sided=True)), *others])
    yield replace(scene, surfaces=[replace(first, material=material.replace(emission=1e-300)), *others])


def test_the_hash_of_a_scene_is_of_its_every_bit():
    hashes = [scene_hash(scene) for scene in (rad.scenes.two_rooms(), *changed_scenes())]
    assert len(set(hashes)) == len(hashes) == 10
    assert scene_hash(rad.scenes.two_rooms()) == hashes[0]


def rewritten(path, change):
    with np.load(KEPT / "solution_v1.npz") as file:
        arrays = {name: file[name].copy() for name in file.files}
    header = json.loads(bytes(arrays["header"]))
    change(header, arrays)
    arrays["header"] = np.frombuffer(json.dumps(header).encode(), np.uint8)
    np.savez(path, **arrays)


def test_a_newer_version_is_refused_by_name(tmp_path):
    rewritten(tmp_path / "new.npz", lambda header, _: header.update(version=2, written_by="radiosity 7.0"))
    with pytest.raises(FileFormatError, match=r"radiosity 7\.0 in version 2 of the format.*install the newer"):
        rad.read_solution(tmp_path / "new.npz")


def test_another_scene_under_the_same_light_is_refused(tmp_path):
    """Checksums of the archive are right; the hash of the scene is not."""
    change = lambda _, arrays: arrays["scene/vertices"].__iadd__(1e-12)  # noqa: E731
    rewritten(tmp_path / "moved.npz", change)
    with pytest.raises(FileFormatError, match="the hash does not fit"):
        rad.read_solution(tmp_path / "moved.npz")
