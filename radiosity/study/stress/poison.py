"""Input that is no scene, no material, no form factors, no parameter: refused by name before any work."""

from __future__ import annotations

import re
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from scipy.sparse import csr_array

import radiosity as rad

from ...errors import (
    FileFormatError,
    FormFactorError,
    GeometryError,
    MaterialError,
    MemoryLimitError,
    MissingFileError,
    OccludedSceneError,
    ParameterError,
    RadiosityError,
    SceneError,
    SolverError,
)
from .case import Case, Got, refuses
from .systems import conserved, operator

GROUP = "poison"
SQUARE = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
PAIR = [[0.0, 0.5], [0.5, 0.0]]
OBJ = b"v 0 0 0\nv 1 0 0\nv nan 1 0\nf 1 2 3\n"


def cases() -> Iterator[Case]:
    """All of this file."""
    for name, kind, work, words in [*_scenes(), *_factors(), *_parameters(), *_files()]:
        expected = f"{kind.__name__}, with {' and '.join(map(repr, words))}"
        yield Case(name, expected, partial(_refusal, kind, work, words), GROUP)


def _refusal(kind: type[RadiosityError], work: Callable[[], Any], words: tuple[str, ...]) -> Got:
    """As `refuses`; where files are made for a moment is of no interest."""
    good, said = refuses(kind, work, *words)
    return Got(good, re.sub(rf"{re.escape(tempfile.gettempdir())}/\w+/", "", said))


Refusal = tuple[str, type[RadiosityError], Callable[[], Any], tuple[str, ...]]


def _scenes() -> Iterator[Refusal]:
    def surface(corners: Any = SQUARE, faces: Any = ((0, 1, 2, 3),), **material: Any) -> rad.Surface:
        return rad.Surface("wall", corners, faces, rad.Material(**material or {"reflectance": 0.5}))

    bad = [[np.nan, 0, 0], *SQUARE[1:]]
    yield "a corner that is NaN", GeometryError, lambda: surface(bad), ("wall", "0")
    yield "a corner at infinity", GeometryError, lambda: surface([[np.inf, 0, 0], *SQUARE[1:]]), ("not finite",)
    yield "a face of a corner that is not there", GeometryError, lambda: surface(faces=[[0, 1, 2, 9]]), ("index 9",)
    yield "a surface without faces", GeometryError, lambda: surface(faces=np.zeros((0, 3), int)), ("no faces",)
    yield "reflectance 1.2", MaterialError, lambda: surface(reflectance=1.2), ("1.2", "[0, 1]")
    yield "reflectance NaN", MaterialError, lambda: surface(reflectance=np.nan), ("nan", "[0, 1]")
    yield "absorptance -1e-12", MaterialError, lambda: surface(absorptance=-1e-12), ("-1e-12",)
    yield "emission that is negative", MaterialError, lambda: surface(reflectance=0, emission=-1.0), ("-1",)
    yield "emission that is infinite", MaterialError, lambda: surface(reflectance=0, emission=np.inf), ("inf",)
    yield "a scene without surfaces", SceneError, lambda: rad.Scene([]), ("empty",)
    yield "two surfaces of one name", SceneError, lambda: rad.Scene([surface(), surface()]), ("share a name",)
    yield "a sky that is NaN", SceneError, lambda: rad.Scene([surface()], sky=np.nan), ("sky",)


def _factors() -> Iterator[Refusal]:
    area = [1.0, 1.0]
    take = rad.FormFactors.from_matrix

    def tampered(weight: float) -> rad.TransportOperator:
        """Factors whose matrix was changed behind the package's back."""
        factors = take(PAIR, area)
        matrix = csr_array(np.array([[0.0, weight], [0.5, 0.0]]))
        return operator(replace(factors, matrix=matrix), reflectance=0.5)

    yield (
        "a row of form factors that sums to 1.1",
        FormFactorError,
        lambda: take([[0, 1.1], [0.5, 0]], area),
        ("row 0",),
    )
    yield "the same, put in behind the package's back", FormFactorError, lambda: tampered(1.1), ("row 0",)
    yield "a form factor that is NaN", FormFactorError, lambda: take([[0, np.nan], [0.5, 0]], area), ("F[0, 1]",)
    yield "NaN put in behind the package's back", FormFactorError, lambda: tampered(np.nan), ("F[0, 1]",)
    yield "a form factor of -0.1", FormFactorError, lambda: take([[0, -0.1], [0.5, 0]], area), ("F[0, 1]",)
    yield "an area of nought", FormFactorError, lambda: take(PAIR, [1.0, 0.0]), ("area",)
    yield "three areas for two patches", FormFactorError, lambda: take(PAIR, [1.0, 1.0, 1.0]), ("shape",)
    yield "rows a hair above 1, ρ = 1", SolverError, _growing, ("spectral radius", "conserved")
    yield "conjugate gradients on raw factors", SolverError, _raw, ("conserved()",)
    yield "light of the wrong shape", SolverError, _wrong_shape, ("shape",)
    yield "emission that is NaN", SolverError, partial(_solve, np.nan), ("not finite",)
    yield "elimination of 200 000 patches", MemoryLimitError, _too_large, ("bytes", "ConjugateGradient")


def _growing() -> rad.Result:
    """Within the tolerance that rounding is given, and still too much where nothing else is lost."""
    factors = rad.FormFactors.from_matrix([[0.0, 1.0], [1.0, 0.0]], [1.0, 1.0])
    matrix = csr_array(np.array([[0.0, 1.0 + 5e-7], [1.0 + 5e-7, 0.0]]))
    T = operator(replace(factors, matrix=matrix), reflectance=1.0)
    return rad.Neumann().solve(T, [1.0, 0.0])


def _raw() -> rad.Result:
    patches = rad.subdivide(rad.scenes.red_rug(), patch_count=200)
    T = rad.TransportOperator(rad.form_factors(patches, rad.MonteCarlo(64)), patches)
    return rad.ConjugateGradient().solve(T, patches.emission)


def _wrong_shape() -> Any:
    _, factors = conserved("furnace", 600)
    return rad.Neumann().solve(operator(factors, reflectance=0.5), np.ones((599, 1)))


def _solve(value: float) -> rad.Result:
    _, factors = conserved("furnace", 600)
    return rad.Neumann().solve(operator(factors, reflectance=0.5), np.full((600, 1), value))


def _too_large() -> rad.Result:
    """A ring of patches, each of which sees its neighbours only."""
    count = 200_000
    here = np.arange(count)
    matrix = csr_array((np.ones(count), (here, (here + 1) % count)), shape=(count, count))
    T = operator(rad.FormFactors.from_matrix(matrix, np.ones(count)), reflectance=0.5)
    return rad.Direct().solve(T, np.ones((count, 1)))


def _parameters() -> Iterator[Refusal]:
    room = rad.scenes.cornell_box()

    def exact() -> Any:
        return rad.form_factors(rad.subdivide(room, patch_count=100), rad.Analytic())

    yield "no rays", ParameterError, lambda: rad.MonteCarlo(rays=0), ("rays is 0",)
    yield "a hemicube of 63 pixels", ParameterError, lambda: rad.Hemicube(63), ("even",)
    yield "no patches", ParameterError, lambda: rad.subdivide(room, patch_count=0), ("patch_count is 0",)
    yield "patches of a nanometre", ParameterError, lambda: rad.subdivide(room, patch_size=1e-9), ("steps",)
    yield "patches of NaN metres", ParameterError, lambda: rad.subdivide(room, patch_size=np.nan), ("nan",)
    yield "-1 bounces", ParameterError, lambda: rad.solve(room, bounces=-1), ("bounces is -1",)
    yield "exact factors where boxes hide things", OccludedSceneError, exact, ("MonteCarlo",)


def _files() -> Iterator[Refusal]:
    def read(name: str, content: bytes) -> Any:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / name
            path.write_bytes(content)
            return rad.read_scene(path)

    yield (
        "a file that is not there",
        MissingFileError,
        lambda: rad.read_scene("no_such_room.glb"),
        ("no_such_room.glb",),
    )
    yield "noise called .glb", FileFormatError, lambda: read("a.glb", bytes(range(256)) * 9), ("a.glb",)
    yield "a .glb cut off in its header", FileFormatError, lambda: read("a.glb", b"glTF\x02\x00"), ("a.glb",)
    yield "an empty .ply", FileFormatError, lambda: read("a.ply", b""), ("a.ply",)
    yield "a web page called .obj", FileFormatError, lambda: read("a.obj", b"<html><body>404</body></html>"), ("a.obj",)
    yield "an .obj with a corner that is NaN", FileFormatError, lambda: read("a.obj", OBJ), ("line 3", "nan")
