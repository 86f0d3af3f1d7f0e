"""Solutions saved and read back: the same to the last bit, readable by others, and nothing else passes."""

import io
import json
import os
import zipfile
from dataclasses import dataclass, fields, replace

import numpy as np
import pytest

import radiosity as rad
from radiosity.errors import FileFormatError, MissingFileError, RadiosityError, RadiosityWarning
from radiosity.files.solution_npz import ESTIMATORS, SOLVERS, VERSION
from radiosity.files.solutions import read_solution, write_solution
from radiosity.solvers import Solver

from .damage import put, rewritten, say, swap
from .same import assert_same_bits, assert_same_scene

QUAD = [[0, 0, 0], [0, 0, 1], [1, 0, 1], [1, 0, 0]]


def odd_scene():
    """Quads, padded triangles, shared vertices, absorptance, a two-sided sheet, names in Unicode, a sky, 2 channels."""
    corners = np.array([*QUAD, *(np.array(QUAD) + [0, 1, 0])]) * np.pi
    white = rad.Material(absorptance=[1e-12, 0.1], emission=[0.0, 1 / 3], name="weiß")
    sheet = rad.Material(reflectance=0.7, two_sided=True)
    return rad.Scene(
        [
            rad.Surface("Fußboden ▲", corners, [[0, 1, 2, 3]], white),
            rad.Surface("sheet", corners, [[4, 5, 6, -1], [4, 6, 7, -1]], sheet),
            rad.Surface("sail", corners + 0.1, [[4, 1, 6]], sheet),
        ],
        sky=[0.1, 1e-300],
        name="eins/zwei",
    )


def solved(scene=None, **settings):
    settings = {"patch_count": 60, "estimator": rad.MonteCarlo(rays=64, seed=7), "bounces": 4, **settings}
    return rad.solve(scene or rad.scenes.cornell_box(), **settings)


@pytest.fixture(scope="module")
def box():
    return solved()


@pytest.fixture(scope="module")
def saved(box, tmp_path_factory):
    path = tmp_path_factory.mktemp("solution") / "box.npz"
    box.save(path)
    return path


def assert_same_arrays(found, expected):
    for field in fields(expected):
        one, other = getattr(found, field.name), getattr(expected, field.name)
        if isinstance(other, np.ndarray):
            assert_same_bits(one, other, field.name)
        elif field.name not in ("grid", "faces", "matrix", "replicates"):
            assert one == other, field.name


def assert_same_factors(found, expected):
    for name in ("data", "indices", "indptr"):
        assert_same_bits(getattr(found.matrix, name), getattr(expected.matrix, name), name)
    assert_same_arrays(found, expected)
    assert len(found.replicates) == len(expected.replicates)
    for one, other in zip(found.replicates, expected.replicates, strict=True):
        assert_same_factors(one, other)


def assert_same_solution(found, expected):
    assert_same_scene(found.scene, expected.scene)
    assert_same_arrays(found.patches, expected.patches)
    assert_same_arrays(found.patches.grid, expected.patches.grid)
    assert_same_arrays(found.patches.grid.faces, expected.patches.grid.faces)
    assert_same_factors(found.factors, expected.factors)
    assert_same_arrays(found.result, expected.result)
    for name in ("solver", "bounces", "settings", "statistics"):
        assert getattr(found, name) == getattr(expected, name), name
    assert str(found) == str(expected)


@pytest.mark.parametrize(
    "settings",
    [
        {},
        {"scene": odd_scene(), "patch_count": None, "patch_size": 1.0},
        {"scene": rad.scenes.cornell_box(spectral=True), "bounces": None},
        {"estimator": rad.Hemicube(resolution=8), "dtype": np.float64},
        {"estimator": rad.MonteCarlo(rays=64, replicates=2, sampling="random")},
        {"scene": rad.scenes.furnace(), "estimator": rad.Analytic(), "solver": rad.Neumann(rtol=1e-3), "bounces": None},
        {"bounces": None, "solver": rad.Neumann(rtol=1e-2, maxiter=3, tail=True)},
        {"scene": rad.scenes.furnace(reflectance=0.0), "bounces": 3},
    ],
    ids=["box", "odd", "spectral", "hemicube", "replicates", "analytic", "tail", "black"],
)
def test_written_and_read_it_is_the_same(settings, tmp_path):
    solution = solved(**settings)
    solution.save(tmp_path / "a.npz")
    again = rad.read_solution(tmp_path / "a.npz")

    assert_same_solution(again, solution)
    # What is read can be worked with: traced, gathered, relit, written again.
    assert_same_bits(again.irradiance, solution.irradiance, "irradiance")
    relit = [one.relight(sky=np.ones(one.patches.channels)) for one in (again, solution)]
    assert_same_bits(relit[0].radiosity, relit[1].radiosity, "relit")
    points = solution.patches.centroid[:2], solution.patches.normal[:2]
    assert_same_bits(again.irradiance_at(*points, rays=64), solution.irradiance_at(*points, rays=64), "points")
    again.save(tmp_path / "b.npz")
    assert (tmp_path / "a.npz").read_bytes() == (tmp_path / "b.npz").read_bytes()


def test_conserved_factors(box, tmp_path):
    conserved = replace(box, factors=box.factors.conserved())
    write_solution(conserved, tmp_path / "a.npz")
    assert_same_bits(read_solution(tmp_path / "a.npz").irradiance, conserved.irradiance, "irradiance")


def test_without_orders(box, tmp_path):
    write_solution(replace(box, result=replace(box.result, orders=None)), tmp_path / "a.npz")
    again = read_solution(tmp_path / "a.npz")
    assert again.orders is None
    assert_same_bits(again.radiosity, box.radiosity, "radiosity")


def test_numpy_alone_reads_it(box, saved):
    with np.load(saved, allow_pickle=False) as file:
        header = json.loads(bytes(file["header"]))
        assert_same_bits(file["result/orders"], box.orders, "orders")
    assert (header["format"], header["version"]) == ("radiosity solution", VERSION)
    assert header["written_by"] == f"radiosity {rad.__version__}"
    assert header["settings"]["seed"] == 7
    assert header["statistics"]["rays/traced"] == 64 * len(box.patches)


def test_every_public_method_can_come_back():
    """A new estimator or solver must be known to the reader."""
    public = {name for name in rad.__all__ if isinstance(getattr(rad, name), type)}
    estimators = {name for name in public if hasattr(getattr(rad, name), "estimate")}
    solvers = {name for name in public if issubclass(getattr(rad, name), Solver)}
    assert estimators <= set(ESTIMATORS)
    assert solvers <= set(SOLVERS)


@dataclass(frozen=True)
class Stranger(rad.Neumann):
    """A user's own solver."""


def test_a_strangers_method_is_named_and_the_light_is_read(box, tmp_path):
    write_solution(replace(box, solver=Stranger()), tmp_path / "a.npz")
    with pytest.warns(RadiosityWarning, match="solver 'Stranger', which is not part of radiosity"):
        again = read_solution(tmp_path / "a.npz")
    assert again.solver == rad.Neumann()
    assert_same_bits(again.radiosity, box.radiosity, "radiosity")


# Damage


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (say("version", value=VERSION + 1), "version 2 of the format.*install the newer"),
        (say("version", value="new"), "header.version"),
        (say("format", value="radiosity scene"), "expected 'radiosity solution'"),
        (say("scene", "surfaces", value=[]), "its scene is none: .*empty"),
        (say("scene", "surfaces", 0, "material", "reflectance", value=[1.5, 0, 0]), r"1\.5 in channel 0"),
        (say("scene", "surfaces", 0, "vertices", value=[0, 1e9]), "vertices is 0 … 1e"),
        (say("scene", "surfaces", 0, "faces", value=[0.5, 1]), "faces is 0.5"),
        (say("scene", "sky", value=[0, 0]), "its scene is none"),
        (say("solver", "parameters", value={"rtol": -1}), "solver Neumann: rtol -1"),
        (say("solver", "parameters", value={"colour": 1}), "solver Neumann"),
        (say("factors", value=[]), "header.factors"),
        (say("bounces", value=-3), "header.bounces"),
        (lambda header, _: header.pop("result"), "header has no 'result'"),
        (lambda header, _: header["result"].pop("orders"), "result has no 'orders'"),
        (lambda _, arrays: arrays.pop("patches/area"), "patches/area is missing"),
        (swap("patches/area", lambda a: a.astype("<f4")), "patches/area is of type <f4; expected <f8"),
        (swap("patches/area", lambda a: a[:-1]), "patches/area has shape"),
        (swap("patches/area", lambda a: a[:, None]), "patches/area has shape .* expected 1 axes"),
        (swap("patches/area", np.negative), "area that no surface can have"),
        (put("patches/area", 3, np.nan), "patches/area holds values that are not finite"),
        (put("patches/centroid", (3, 0), 7.0), "patches/centroid does not agree with patches/vertices"),
        (put("patches/reflectance", (0, 0), 1.001), "reflectance"),
        (put("patches/faces", (0, 0), 1 << 20), "patches/faces reaches"),
        (put("patches/faces", (0, 0), -1), "patches/faces reaches"),
        (put("patches/surface", 0, 99), "patches/surface reaches"),
        (put("patches/face", 0, 5), "do not agree with the grid"),
        (put("patches/side", 0, 0), "patches/side"),
        (put("grid/columns", 0, 0), "do not cut the faces"),
        (swap("grid/columns", lambda a: a + 1), "do not cut the faces"),
        (lambda _, a: a.update({f"grid/{k}": a[f"grid/{k}"] + 1 for k in ("rows", "columns")}), "the grid cuts"),
        (put("grid/front", 0, 1), "without a gap"),
        (swap("faces/quad", np.logical_not), "which faces are triangles"),
        (put("factors/indices", 0, 1 << 20), "factors/indices reaches"),
        (put("factors/indices", 0, -1), "factors/indices reaches"),
        (put("factors/indices", 1, 0), "factors/indices"),
        (put("factors/indptr", 1, -5), "factors/indptr does not divide"),
        (put("factors/indptr", -1, 3), "factors/indptr does not divide"),
        (put("factors/data", 0, -0.5), "is not a share"),
        (put("factors/data", 0, 1.5), "more than 1 leaves"),
        (put("factors/to_sky", 0, 0.9), "more than 1 leaves"),
        (swap("result/radiosity", lambda a: a[:, :1]), "result/radiosity has shape"),
        (swap("result/orders", lambda a: a[:, :-1]), "result/orders has shape"),
        (swap("result/history", lambda a: a.astype(object)), "result/history"),
    ],
)
def test_a_wrong_part_is_named(saved, tmp_path, change, words):
    """Checksums are right in these: somebody made them so. Kernels would read beyond arrays if they passed."""
    path = tmp_path / "wrong.npz"
    rewritten(saved, path, change)
    with pytest.raises(FileFormatError, match=words) as caught:
        read_solution(path)
    assert str(path) in str(caught.value)


def test_the_rewriting_itself_does_no_harm(saved, tmp_path, box):
    """The control of the test above."""
    rewritten(saved, tmp_path / "a.npz", lambda _header, _arrays: None)
    assert_same_solution(read_solution(tmp_path / "a.npz"), box)


@pytest.mark.parametrize("share", [0.0, 0.001, 0.3, 0.9, 0.9999])
def test_a_file_that_was_cut_short(saved, tmp_path, share):
    content = saved.read_bytes()
    path = tmp_path / "short.npz"
    path.write_bytes(content[: int(share * len(content))])
    with pytest.raises(FileFormatError, match="cut short"):
        read_solution(path)


def test_flipped_bits_never_change_the_light(saved, box, tmp_path):
    """Each flip is named, or hits nothing that counts (a date, a flag of the archive's index)."""
    content = saved.read_bytes()
    random = np.random.default_rng(5)
    path = tmp_path / "flipped.npz"
    named = 0
    for _flip in range(120):
        damaged = bytearray(content)
        damaged[random.integers(len(content))] ^= 1 << random.integers(8)
        path.write_bytes(damaged)
        try:
            again = read_solution(path)
        except FileFormatError:
            named += 1
        else:
            assert_same_solution(again, box)
    assert named > 100


def test_things_that_are_no_solution(tmp_path, box):
    (tmp_path / "page.npz").write_text("<!doctype html><html></html>")
    np.savez(tmp_path / "arrays.npz", a=np.arange(3))
    with pytest.raises(FileFormatError, match="no numpy archive"):
        read_solution(tmp_path / "page.npz")
    with pytest.raises(FileFormatError, match="but no solution"):
        read_solution(tmp_path / "arrays.npz")
    with pytest.raises(FileFormatError, match=r"read from \.npz, not from '\.vtp'"):
        read_solution(tmp_path / "box.vtp")
    with pytest.raises(MissingFileError, match="there is no file"):
        read_solution(tmp_path / "none.npz")
    with pytest.raises(MissingFileError, match="there is no folder"):
        box.save(tmp_path / "none" / "box.npz")
    with pytest.raises(FileFormatError, match=r"not written as '\.obj'"):
        write_solution(box, tmp_path / "box.obj")


def archive_with(path, name, content, method=zipfile.ZIP_STORED):
    with zipfile.ZipFile(path, "w", method) as archive:
        archive.writestr(name, content)


def test_nothing_is_allocated_that_the_file_does_not_hold(tmp_path):
    """A header of 100 bytes that announces a petabyte, and one compressed a thousandfold."""
    content = io.BytesIO()
    np.lib.format.write_array_header_1_0(content, {"descr": "|u1", "fortran_order": False, "shape": (1 << 50,)})
    archive_with(tmp_path / "huge.npz", "header.npy", content.getvalue())
    with pytest.raises(FileFormatError, match="1125899906842624 bytes, but holds 0"):
        read_solution(tmp_path / "huge.npz")

    np.lib.format.write_array(zeros := io.BytesIO(), np.zeros(1 << 22, np.uint8))
    archive_with(tmp_path / "bomb.npz", "header.npy", zeros.getvalue(), zipfile.ZIP_DEFLATED)
    with pytest.raises(FileFormatError, match="compressed"):
        read_solution(tmp_path / "bomb.npz")


def test_no_objects_are_unpickled(tmp_path):
    class Trap:
        def __reduce__(self):
            return (os.mkdir, (str(tmp_path / "sprung"),))

    np.savez(tmp_path / "trap.npz", header=np.array([Trap()], dtype=object))
    (tmp_path / "sprung").rmdir() if (tmp_path / "sprung").exists() else None
    with pytest.raises(FileFormatError, match="header holds object"):
        read_solution(tmp_path / "trap.npz")
    assert not (tmp_path / "sprung").exists()


@pytest.mark.parametrize("suffix", [".npz", ".vtp"])
def test_what_fails_leaves_the_old_file(box, tmp_path, suffix, monkeypatch):
    path = tmp_path / f"box{suffix}"
    path.write_text("old")

    def full(*_args):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", lambda _handle: None)
    monkeypatch.setattr(os, "replace", full)
    with pytest.raises(OSError, match="No space left"):
        box.save(path)
    assert path.read_text() == "old"
    assert [file.name for file in tmp_path.iterdir()] == [path.name]


# VTK


def test_vtk_reads_every_array(tmp_path):
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

    solution = solved(odd_scene(), patch_count=None, patch_size=1.0)
    solution.save(tmp_path / "a.vtp")
    reader = vtkXMLPolyDataReader()
    reader.SetFileName(str(tmp_path / "a.vtp"))
    reader.Update()
    data = reader.GetOutput()

    patches = solution.patches
    assert_same_bits(vtk_to_numpy(data.GetPoints().GetData()), patches.vertices, "points")
    assert data.GetNumberOfCells() == len(patches)
    for i, face in enumerate(patches.faces):
        ids = data.GetCell(i).GetPointIds()
        assert [ids.GetId(k) for k in range(ids.GetNumberOfIds())] == [v for v in face if v >= 0]

    cells = data.GetCellData()
    names = [cells.GetArrayName(k) for k in range(cells.GetNumberOfArrays())]
    orders = [f"order_{k:02}" for k in range(5)]
    expected = {
        "radiosity": solution.radiosity,
        "irradiance": solution.irradiance,
        "emission": patches.emission,
        "reflectance": patches.reflectance,
        "area": patches.area,
        "surface": patches.surface,
        **dict(zip(orders, solution.orders, strict=True)),
    }
    assert sorted(names) == sorted(expected)
    assert [name for name in names if name.startswith("order")] == orders
    for name, values in expected.items():
        assert_same_bits(vtk_to_numpy(cells.GetArray(name)), values, name)

    texts = data.GetFieldData()
    found = texts.GetAbstractArray("surface_names")
    assert tuple(found.GetValue(k) for k in range(found.GetNumberOfValues())) == patches.surface_names
    about = json.loads(texts.GetAbstractArray("about").GetValue(0))
    assert about["status"] == solution.status
    assert about["settings"]["bounces"] == 4


def test_damage_is_our_error_whatever_it_is(saved, tmp_path):
    """Also where bytes are replaced wholesale: no exception of anybody else's, and quickly."""
    content = saved.read_bytes()
    random = np.random.default_rng(6)
    path = tmp_path / "spliced.npz"
    for _splice in range(60):
        damaged = bytearray(content)
        at, length = random.integers(len(content)), random.integers(1, 200)
        damaged[at : at + length] = random.bytes(random.integers(0, 200))
        path.write_bytes(damaged)
        try:
            read_solution(path)
        except RadiosityError:
            continue
