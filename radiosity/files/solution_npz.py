"""A solution in a numpy archive: everything, to the last bit.

Arrays are stored under the names of `solution_arrays`; the rest is one JSON header. Python's JSON keeps every bit
of a float64. A reader refuses versions above its own and still reads those below.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Mapping
from dataclasses import asdict, is_dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import solvers
from .._version import __version__
from ..errors import FileFormatError, RadiosityError, RadiosityWarning
from ..form_factors import Analytic, Hemicube, MonteCarlo, TwoLevel
from ..patches import Patches
from ..result import Result
from ..scene import Material, Scene, Surface
from ..solution import Solution
from ..solvers import Neumann, Solver
from . import checked
from .checked import JSON
from .matrix_arrays import Reader
from .npz import Archive, write_archive
from .provenance import provenance, scene_hash
from .solution_arrays import (
    RESULT,
    factors_from_arrays,
    factors_header,
    factors_to_arrays,
    patches_from_arrays,
    patches_to_arrays,
)

FORMAT, VERSION = "radiosity solution", 1
PARTS = {
    "header": ("scene", "patches", "estimator", "factors", "solver", "bounces", "result", "settings", "statistics"),
    "result": ("status", "converged", "orders", "statistics"),
    "scene": ("name", "closed", "sky", "surfaces"),
    "patches": ("name", "closed"),
}
# What a file may name: nothing else is ever made of it.
ESTIMATORS = {kind.__name__: kind for kind in (MonteCarlo, Hemicube, Analytic, TwoLevel)}
SOLVERS = {name: getattr(solvers, name) for name in solvers.__all__}


def write_npz(solution: Solution, path: Path) -> None:
    """Write a solution as .npz, whole or not at all."""
    geometry = _SceneArrays(solution.scene)
    factors, result = solution.factors, solution.result
    header = {
        "format": FORMAT,
        "version": VERSION,
        **provenance(solution.scene),
        "scene": geometry.header,
        "patches": {"closed": solution.patches.closed, "name": solution.patches.name},
        "estimator": _parameters(factors.estimator),
        "factors": _plain(factors_header(factors)),
        "solver": _parameters(solution.solver),
        "bounces": solution.bounces,
        "result": {
            "status": result.status,
            "converged": result.converged,
            "statistics": _plain(result.statistics),
            "orders": result.orders is not None,
        },
        "settings": _plain(solution.settings),
        "statistics": _plain(solution.statistics),
    }
    arrays = {**geometry.arrays, **dict(patches_to_arrays(solution.patches)), **dict(factors_to_arrays(factors))}
    for name in RESULT:
        if (array := getattr(result, name)) is not None:
            arrays[f"result/{name}"] = array
    write_archive(path, header, arrays)


def read_npz(path: Path) -> Solution:
    """Read what `write_npz` wrote.

    Raises
    ------
    FileFormatError
        With the part of the file that is wrong.
    """
    with Archive(path) as archive:
        if "header" not in archive:
            raise FileFormatError("it is a numpy archive, but no solution: `solution.save` writes those")
        header = archive.header()
        _check_version(header)
        _check_parts(header)
        reader = Reader(archive)
        scene = _scene(reader, header["scene"])
        _check_scene(scene, header)
        patches = _patches(reader, header["patches"], scene)
        estimator = _made(checked.mapping(header, "estimator", "header"), ESTIMATORS, "estimator")
        counters = checked.mappings(header, "factors", "header")
        solver = _made(checked.mapping(header, "solver", "header"), SOLVERS, "solver") or Neumann()
        assert isinstance(solver, Solver)
        return Solution(
            scene,
            patches,
            factors_from_arrays(reader, patches, counters, estimator),
            _result(reader, header["result"]),
            solver,
            None if header["bounces"] is None else checked.integer(header, "bounces", "header"),
            checked.mapping(header, "settings", "header"),
            checked.mapping(header, "statistics", "header"),
        )


def _check_version(header: JSON) -> None:
    if header.get("format") != FORMAT:
        raise FileFormatError(f"its header says {header.get('format')!r:.60}; expected {FORMAT!r}")
    version = checked.integer(header, "version", "header", low=1)
    if version > VERSION:
        by = checked.text(header, "written_by", "header", "a newer radiosity")
        raise FileFormatError(
            f"it was written by {by:.40} in version {version} of the format; radiosity {__version__} reads up to "
            f"{VERSION}: install the newer one"
        )


def _check_scene(scene: Scene, header: JSON) -> None:
    """Refuse a scene that is not the one that was written; the first files of version 1 have no hash."""
    said = checked.text(header, "scene_sha256", "header")
    if said and said != scene_hash(scene):
        raise FileFormatError("its scene is not the one that it was written with: the hash does not fit")


def _check_parts(header: JSON) -> None:
    """Refuse a header that lacks something: nothing is filled in for it."""
    for part, keys in PARTS.items():
        found = header if part == "header" else checked.mapping(header, part, "header")
        if missing := [key for key in keys if key not in found]:
            raise FileFormatError(f"{part} has no {missing[0]!r}: the file is not as radiosity writes it")
    if not header["factors"]:
        raise FileFormatError("header.factors is empty; expected the counters of the form factors")


def _patches(reader: Reader, header: JSON, scene: Scene) -> Patches:
    closed, name = checked.flag(header, "closed", "patches"), checked.text(header, "name", "patches")
    patches = patches_from_arrays(reader, closed, scene.surface_names, name)
    if patches.channels != scene.channels:
        raise FileFormatError(f"patches have {patches.channels} channels, the scene has {scene.channels}")
    return patches


def _result(reader: Reader, header: JSON) -> Result:
    names = [name for name in RESULT if name != "orders" or checked.flag(header, "orders", "result")]
    arrays = {name: reader.take(f"result/{name}", *RESULT[name]) for name in names}
    return Result(
        radiosity=arrays["radiosity"],
        orders=arrays.get("orders"),
        status=checked.text(header, "status", "result"),
        converged=checked.flag(header, "converged", "result"),
        history=arrays["history"],
        statistics=checked.mapping(header, "statistics", "result"),
    )


class _SceneArrays:
    """A scene as a header and few arrays; vertices that surfaces share are stored once."""

    def __init__(self, scene: Scene) -> None:
        self._vertices: list[NDArray[Any]] = []
        self._faces: list[NDArray[Any]] = []
        self._known: dict[bytes, list[int]] = {}
        surfaces = [self._surface(surface) for surface in scene.surfaces]
        self.header: JSON = {
            "name": scene.name,
            "closed": scene.closed,
            "sky": scene.sky.tolist(),
            "surfaces": surfaces,
        }
        self.arrays = {"scene/vertices": np.concatenate(self._vertices), "scene/faces": np.concatenate(self._faces)}

    def _surface(self, surface: Surface) -> JSON:
        content = surface.vertices.tobytes()
        if content not in self._known:
            self._known[content] = _append(self._vertices, surface.vertices)
        columns = surface.faces.shape[1]
        padded = np.full((len(surface.faces), 4), -1, dtype=np.int64)
        padded[:, :columns] = surface.faces
        material = surface.material
        return {
            "name": surface.name,
            "vertices": self._known[content],
            "faces": _append(self._faces, padded),
            "columns": columns,
            "material": {
                "name": material.name,
                material.given: getattr(material, material.given).tolist(),
                "emission": material.emission.tolist(),
                "two_sided": material.two_sided,
            },
        }


def _append(blocks: list[NDArray[Any]], block: NDArray[Any]) -> list[int]:
    """Put a block behind the others; its [begin, end]."""
    begin = sum(map(len, blocks))
    blocks.append(block)
    return [begin, begin + len(block)]


def _scene(reader: Reader, header: JSON) -> Scene:
    vertices = reader.take("scene/vertices", "<f8", "v3")
    faces = reader.take("scene/faces", "<i8", "m4")
    surfaces = []
    for number, part in enumerate(checked.mappings(header, "surfaces", "scene")):
        where = f"scene.surfaces[{number}]"
        mesh = _block(part, "vertices", where, vertices), _block(part, "faces", where, faces)
        columns = checked.integer(part, "columns", where, low=3, high=4)
        material = _material(checked.mapping(part, "material", where), f"{where}.material")
        surfaces.append((checked.text(part, "name", where), mesh[0], mesh[1][:, :columns], material))
    closed = None if header.get("closed") is None else checked.flag(header, "closed", "scene")
    sky = checked.numbers(header, "sky", "scene", None, ())
    try:
        made = tuple(Surface(*surface) for surface in surfaces)
        return Scene(made, sky=np.array(sky), name=checked.text(header, "name", "scene"), closed=closed)
    except RadiosityError as error:
        raise FileFormatError(f"its scene is none: {error}") from error


def _block(part: JSON, key: str, where: str, array: NDArray[Any]) -> NDArray[Any]:
    begin, end = checked.numbers(part, key, where, 2, ())
    if not (begin.is_integer() and end.is_integer() and 0 <= begin <= end <= len(array)):
        raise FileFormatError(f"{where}.{key} is {begin:g} … {end:g} of {len(array)}")
    return array[int(begin) : int(end)]


def _material(part: JSON, where: str) -> Material:
    given = "absorptance" if "absorptance" in part else "reflectance"
    values = {key: np.array(checked.numbers(part, key, where, None, ())) for key in (given, "emission")}
    two_sided, name = checked.flag(part, "two_sided", where), checked.text(part, "name", where)
    try:
        return Material(**values, two_sided=two_sided, name=name)
    except RadiosityError as error:
        raise FileFormatError(f"{where}: {error}") from error


def _parameters(method: object) -> JSON:
    """An estimator or solver as its name and parameters."""
    if method is None or not is_dataclass(method) or isinstance(method, type):
        return {"type": type(method).__name__, "parameters": {}}
    return {"type": type(method).__name__, "parameters": _plain(asdict(method))}


def _made(part: JSON, known: Mapping[str, Any], what: str) -> object | None:
    """An estimator or solver of this package from its name and parameters; None, and a warning, for a stranger."""
    name = checked.text(part, "type", what)
    if name == "NoneType":
        return None
    if name not in known:
        warnings.warn(
            f"it was made by the {what} {name!r:.60}, which is not part of radiosity {__version__}: the light is read, "
            f"the {what} is not",
            RadiosityWarning,
            stacklevel=4,
        )
        return None
    try:
        return known[name](**checked.mapping(part, "parameters", what))
    except (RadiosityError, TypeError, ValueError) as error:
        raise FileFormatError(f"{what} {name}: {error}") from error


def _plain(value: Any) -> Any:
    """Values as JSON has them: arrays as lists, what is not finite as null, anything else as its text."""
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, np.ndarray):
        return _plain(value.tolist())
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    if isinstance(value, np.generic):
        return _plain(value.item())
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    return value if value is None or isinstance(value, (bool, int, str)) else str(value)
