"""Films and baked scenes hold the light that they show."""

import itertools
import json
import struct
import sys
from pathlib import Path

import numpy as np
import pytest
import trimesh
from PIL import Image

import radiosity as rad
from radiosity import display
from radiosity.errors import FileFormatError, MissingDependencyError
from radiosity.viewer import animation
from radiosity.viewer.baked import write_baked
from radiosity.viewer.exports import export
from radiosity.viewer.state import Series, start


@pytest.fixture(scope="module")
def series(solution: rad.Solution) -> Series:
    return Series.of(solution)


# Films ---------------------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def film(solution: rad.Solution, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("film") / "box.gif"
    return animation.write_animation(solution, path, pane_size=160, seconds=0.5, normalised=True)


@pytest.mark.usefixtures("gl")
def test_a_film_has_a_frame_for_each_order_and_rests_on_the_last(film: Path, series: Series) -> None:
    with Image.open(film) as gif:
        times = []
        for k in range(gif.n_frames):
            gif.seek(k)
            times.append(gif.info["duration"])
        assert gif.info["loop"] == 0
    assert times == [500] * series.last + [2500]


@pytest.mark.usefixtures("gl")
def test_frames_are_the_pictures_of_the_orders(film: Path, solution: rad.Solution, series: Series) -> None:
    """256 colours a frame are close to all of them."""
    drawn = list(animation.frames(solution, series, 160, normalised=True))
    assert len(drawn) == len(series.orders)
    with Image.open(film) as gif:
        for k, frame in enumerate(drawn):
            gif.seek(k)
            stored = np.asarray(gif.convert("RGB")).astype(int)
            assert np.abs(stored - frame).mean() < 4
    changes = [np.abs(a.astype(int) - b).mean() for a, b in itertools.pairwise(drawn)]
    assert min(changes) > 0.3


@pytest.mark.usefixtures("gl")
def test_mp4_holds_the_same_seconds(solution: rad.Solution, series: Series, tmp_path: Path) -> None:
    ffmpeg = pytest.importorskip("imageio_ffmpeg", reason="the optional group 'video' is not installed")
    path = animation.write_animation(solution, tmp_path / "box.mp4", pane_size=160, seconds=0.5)
    count, seconds = ffmpeg.count_frames_and_secs(str(path))
    assert count == 5 * series.last + 25
    assert seconds == pytest.approx(0.5 * series.last + 2.5, abs=0.11)


def test_mp4_without_its_library_says_what_to_install(solution, tmp_path: Path, monkeypatch) -> None:
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    with pytest.raises(MissingDependencyError, match=r"pip install 'radiosity\[video\]'"):
        animation.write_animation(solution, tmp_path / "box.mp4")
    assert not list(tmp_path.iterdir())


# Baked scenes --------------------------------------------------------------------------------------------------------


def chunks(path: Path) -> tuple[dict, bytes]:
    content = path.read_bytes()
    magic, version, length = struct.unpack_from("<III", content)
    assert (magic, version, length) == (0x46546C67, 2, len(content))
    size, kind = struct.unpack_from("<II", content, 12)
    assert kind == 0x4E4F534A
    document = json.loads(content[20 : 20 + size])
    (rest,) = struct.unpack_from("<I", content, 20 + size)
    assert 28 + size + rest == len(content)
    assert document["buffers"][0]["byteLength"] <= rest
    return document, content[28 + size :]


def array(document: dict, binary: bytes, number: int) -> np.ndarray:
    accessor = document["accessors"][number]
    view = document["bufferViews"][accessor["bufferView"]]
    dtype = {5126: "<f4", 5123: "<u2", 5125: "<u4"}[accessor["componentType"]]
    columns = {"SCALAR": 1, "VEC3": 3, "VEC4": 4}[accessor["type"]]
    assert view["byteOffset"] % 4 == 0
    assert view["byteLength"] == accessor["count"] * columns * np.dtype(dtype).itemsize
    return np.frombuffer(binary, dtype, accessor["count"] * columns, view["byteOffset"]).reshape(-1, columns)


def baked(path: Path) -> dict[str, tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """Positions, linear colours and triangles of each node."""
    document, binary = chunks(path)
    assert document["extensionsUsed"] == ["KHR_materials_unlit"]
    assert document["materials"][0]["extensions"] == {"KHR_materials_unlit": {}}
    found = {}
    for node in document["nodes"]:
        (primitive,) = document["meshes"][node["mesh"]]["primitives"]
        position, colour = (array(document, binary, primitive["attributes"][name]) for name in ("POSITION", "COLOR_0"))
        bounds = document["accessors"][primitive["attributes"]["POSITION"]]
        assert np.array_equal([bounds["min"], bounds["max"]], [position.min(axis=0), position.max(axis=0)])
        triangles = array(document, binary, primitive["indices"]).reshape(-1, 3)
        assert triangles.max() < len(position)
        found[node["name"]] = position, colour / 65535, triangles
    return found


@pytest.mark.parametrize("tone", display.TONES)
def test_baked_colours_are_linear_and_encode_to_the_picture(solution, series, tmp_path: Path, tone) -> None:
    found = baked(write_baked(solution, tmp_path / "box.glb", order=3, tone=tone, exposure=0.5))
    assert tuple(found) == solution.patches.surface_names
    state = start(series, order=3, tone=tone, exposure=0.5)
    light = series.sums[3].astype(float) * series.factor(state, "sum")
    expected = light / (1 + light) if tone == "reinhard" else np.minimum(light, 1)
    for number, name in enumerate(found):
        mine = np.repeat(expected[solution.patches.surface == number], 4, axis=0)
        np.testing.assert_allclose(found[name][1][:, :3], mine, atol=1e-5)
        assert np.all(found[name][1][:, 3] == 1)


def test_baked_triangles_are_the_patches(solution, tmp_path: Path) -> None:
    """Same area, and the lit side in front."""
    found = baked(write_baked(solution, tmp_path / "box.glb"))
    for number, (position, _, triangles) in enumerate(found.values()):
        mine = solution.patches.surface == number
        corners = position[triangles].astype(float)
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 2
        assert np.linalg.norm(normal, axis=1).sum() == pytest.approx(solution.patches.area[mine].sum(), rel=1e-5)
        expected = (solution.patches.normal * solution.patches.area[:, None])[mine].sum(axis=0)
        np.testing.assert_allclose(normal.sum(axis=0), expected, atol=1e-5)


def test_triangular_patches_are_not_doubled(tmp_path: Path) -> None:
    corners = [[0, 0, 0], [1, 0, 0], [1, 0, -1], [0, 0, -1], [2, 0, 0]]
    floor = rad.Surface("floor", corners, [[0, 1, 2, 3], [1, 4, 2, -1]], rad.Material(0.5))
    solution = rad.solve(rad.Scene([floor], sky=[1.0]), patch_count=2, bounces=1)
    ((_, _, triangles),) = baked(write_baked(solution, tmp_path / "floor.glb")).values()
    assert len(triangles) == 2 * np.sum(solution.patches.faces[:, 3] >= 0) + np.sum(solution.patches.faces[:, 3] < 0)


def test_smooth_colours_differ_within_a_patch(solution, tmp_path: Path) -> None:
    flat, smooth = (baked(write_baked(solution, tmp_path / "box.glb", smooth=on))["floor"][1] for on in (False, True))
    spread = [np.ptp(colour.reshape(-1, 4, 4), axis=1).max() for colour in (flat, smooth)]
    assert spread[0] == 0
    assert spread[1] > 0.01


def test_others_can_read_a_baked_scene(solution, tmp_path: Path) -> None:
    scene = trimesh.load(write_baked(solution, tmp_path / "box.glb"))
    assert set(scene.geometry) == set(solution.patches.surface_names)
    assert scene.area == pytest.approx(solution.patches.area.sum(), rel=1e-4)


# By suffix -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("suffix", [".html", ".glb", ".HTML"])
def test_export_by_suffix(solution, tmp_path: Path, suffix: str) -> None:
    path = export(solution, tmp_path / f"box{suffix}")
    assert path.read_bytes()[:4] in (b"<!do", b"glTF")


def test_unknown_suffixes_are_refused(solution, tmp_path: Path) -> None:
    with pytest.raises(FileFormatError, match=r"'\.jpg'; choose from \.png, \.gif, \.mp4, \.html, \.glb"):
        export(solution, tmp_path / "box.jpg")
