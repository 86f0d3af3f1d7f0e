"""Reading a scene from a file of any known format."""

from __future__ import annotations

import os
import warnings
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from ..contacts import remove_contacts
from ..contacts.report import listed
from ..errors import FileFormatError, GeometryError, GeometryWarning, MissingFileError, ParameterError, RadiosityError
from ..overlaps import overlaps
from ..scene import Material, Scene, Surface
from .gltf_read import read_gltf
from .impostors import impostor
from .notes import Notes
from .obj import read_obj
from .off import read_off
from .ply import read_ply
from .stl import read_stl

UNITS = {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "in": 0.0254, "ft": 0.3048}
"""Metres in each unit of length that `read_scene` knows."""
LARGE = 1000.0  # metres from end to end, over which millimetres are more likely than metres

NO_CUT = (
    "faces that lie back to back are seen from either side, but rays cannot tell which is in front: leave a gap of "
    "more than 1e-5 of the scene's diagonal, or make one two-sided face of them"
)

READERS: dict[str, Callable[[Path, Notes], Scene]] = {
    ".glb": read_gltf,
    ".gltf": read_gltf,
    ".obj": read_obj,
    ".ply": read_ply,
    ".stl": read_stl,
    ".off": read_off,
}


def read_scene(
    path: str | os.PathLike[str],
    *,
    unit: str | None = None,
    materials: Mapping[str, Material] | None = None,
    sky: ArrayLike | None = None,
    lamps: Mapping[str, ArrayLike] | None = None,
    name: str | None = None,
    contacts: Literal["cut", "keep"] | None = None,
    fix_normals: bool = False,
    turn: Iterable[str] = (),
) -> Scene:
    """Read a scene from .glb, .gltf, .obj (with its .mtl), .ply, .stl or .off.

    Coordinates keep the axes of the file. What a format cannot say comes by argument. What a file holds and a
    diffuse solver does not use is named in one warning; what is taken otherwise than the file has it, in another.

    Parameters
    ----------
    path : str or path-like
    unit : {"m", "cm", "mm", "in", "ft"}, optional
        Unit of length of the file; metres if not given. glTF is in metres by its specification, but there are programs
        that write their own unit into it.
    materials : mapping of str to Material, optional
        Materials to put in place of the file's, by the name of the surface or, failing that, of its material.
    sky : array_like (C,), optional
        Radiance of everything outside, W/(m² sr).
    lamps : mapping of str to array_like (C,), optional
        Exitance, W/m², that surfaces emit, by the name of the surface or of its material.
    name : str, optional
        Name of the scene; the file's own, or the file's name, if not given.
    contacts : {"cut", "keep"}, optional
        What becomes of faces that lie in each other, as a floor and the bottom of a box that stands on it: cut away, as
        `radiosity.contacts` says, or kept and only named. By default they are cut, but in files that `write_scene`
        made, which come back as the scene that was written.
    fix_normals : bool, optional
        Turn round the faces of closed shells that look the wrong way, as `radiosity.inspection.fixed_normals` does.
    turn : iterable of str, optional
        Surfaces (or materials, all of whose surfaces) to turn round, by name: walls of an open room that face outwards,
        say, of which nothing else can tell that they do.

    Returns
    -------
    Scene

    Raises
    ------
    MissingFileError
        There is no such file.
    FileFormatError
        An unknown suffix, a file that is damaged or not what its suffix says; the message names the place in it.
    SceneError
        A file without surfaces, or with values that no scene can have.
    ParameterError
        An unknown unit or word for `contacts`, or a name in `materials`, `lamps` or `turn` that the scene does not
        have.

    Warns
    -----
    UnusedFeatureWarning
        The file holds features that a diffuse solver does not use.
    GeometryWarning
        Surfaces lie in each other: which, over what area, and what was done about it. Faces that were turned round. A
        scene of more than a kilometre whose unit was not given.
    """
    if contacts not in (None, "cut", "keep"):
        raise ParameterError(f"contacts is {contacts!r}; give 'cut' or 'keep'")
    file = _checked_path(path)
    notes = Notes()
    try:
        scene = READERS[file.suffix.lower()](file, notes)
    except RadiosityError as error:
        raise type(error)(f"{file}: {error}") from error
    except MemoryError as error:
        raise FileFormatError(f"{file} ({file.stat().st_size:,} bytes) needs more memory than there is") from error
    notes.warn(str(file))
    scene = _scaled(scene, _metres(unit))
    if unit is None and not notes.exact:
        _warn_of_size(scene, file)
    if materials:
        scene = _with_materials(scene, materials)
    if lamps:
        scene = _with_lamps(scene, lamps)
    if sky is not None:
        scene = replace(scene, sky=np.asarray(sky, dtype=np.float64))
    if turned := tuple(turn):
        scene = _turned(scene, turned)
    if fix_normals:
        scene = scene.fixed_normals()
    if contacts == "keep" or (contacts is None and notes.exact):
        _warn_of_overlaps(scene, file)
    else:
        scene = _without_contacts(scene, file)
    return scene if name is None else replace(scene, name=name)


def _checked_path(path: str | os.PathLike[str]) -> Path:
    file = Path(path)
    if file.is_dir():
        raise FileFormatError(f"{file} is a folder; name a file in it")
    if file.suffix.lower() not in READERS:
        known = ", ".join(READERS)
        raise FileFormatError(f"{file}: the suffix {file.suffix!r} is not read; known are {known}")
    if not file.is_file():
        raise MissingFileError(f"there is no file {file}; scenes to start with come from `radiosity scenes --write`")
    with file.open("rb") as stream:
        start = stream.read(512)
    if not start.strip():
        raise FileFormatError(f"{file} is empty; the download or export that made it has failed")
    if (what := impostor(start)) is not None:
        raise FileFormatError(f"{file} is {what}")
    return file


def _without_contacts(scene: Scene, file: Path) -> Scene:
    try:
        scene, report = remove_contacts(scene)
    except GeometryError as error:
        raise GeometryError(f"{file}: {error}") from error
    if report.mended:
        message = f"{file}: faces that lie in each other were cut (contacts='keep' leaves them): {report}"
        warnings.warn(message, GeometryWarning, stacklevel=3)
    if report.unclear:
        message = f"{file}: {listed(report.unclear)}; {NO_CUT}"
        warnings.warn(message, GeometryWarning, stacklevel=3)
    return scene


def _warn_of_overlaps(scene: Scene, file: Path) -> None:
    if not (found := overlaps(scene)):
        return
    names = scene.surface_names
    shown = [
        f"{names[o.first]!r} and {names[o.second]!r} over {o.area:.3g} m²"
        if o.first != o.second
        else f"faces of {names[o.first]!r} over {o.area:.3g} m²"
        for o in found[:5]
    ]
    more = f", and {len(found) - 5} more" if len(found) > 5 else ""
    warnings.warn(
        f"{file}: surfaces lie in each other: {'; '.join(shown)}{more}; what is covered sees nothing, and patches on "
        "its border come out too dark: cut it away (rad.read_scene(…, contacts='cut'), rad.remove_contacts)",
        GeometryWarning,
        stacklevel=3,
    )


def _metres(unit: str | None) -> float:
    if unit is not None and unit not in UNITS:
        raise ParameterError(f"unit is {unit!r}; known are {', '.join(UNITS)}")
    return UNITS[unit or "m"]


def _warn_of_size(scene: Scene, file: Path) -> None:
    """Light per m² is the same at any size, and watts, lumens and places are not."""
    points = np.concatenate([s.vertices[s.faces[s.faces >= 0]] for s in scene.surfaces])
    size = float(np.ptp(points, axis=0).max())
    if size > LARGE:
        warnings.warn(
            f"{file}: the scene is {size:,.0f} m long if it is in metres, as is taken where no unit is given; "
            "say which it is (rad.read_scene(…, unit='mm'), --unit mm; 'm' for metres)",
            GeometryWarning,
            stacklevel=3,
        )


def _scaled(scene: Scene, factor: float) -> Scene:
    if factor == 1.0:
        return scene
    return replace(scene, surfaces=tuple(replace(s, vertices=s.vertices * factor) for s in scene.surfaces))


def _with_materials(scene: Scene, materials: Mapping[str, Material]) -> Scene:
    _refuse_strangers(scene, materials, "materials")

    def chosen(surface: Surface) -> Material:
        return materials.get(surface.name) or materials.get(surface.material.name) or surface.material

    return replace(scene, surfaces=tuple(replace(s, material=chosen(s)) for s in scene.surfaces))


def _with_lamps(scene: Scene, lamps: Mapping[str, ArrayLike]) -> Scene:
    _refuse_strangers(scene, lamps, "lamps")

    def lit(surface: Surface) -> Surface:
        key = surface.name if surface.name in lamps else surface.material.name
        return replace(surface, material=with_emission(surface.material, lamps[key])) if key in lamps else surface

    return replace(scene, surfaces=tuple(lit(s) for s in scene.surfaces))


def _turned(scene: Scene, names: Sequence[str]) -> Scene:
    _refuse_strangers(scene, names, "turn")
    surfaces = (s.turned() if s.name in names or s.material.name in names else s for s in scene.surfaces)
    return replace(scene, surfaces=tuple(surfaces))


def with_emission(material: Material, emission: ArrayLike) -> Material:
    """The same material with another exitance, W/m²; reflectance or absorptance stays the one that was given."""
    given = {material.given: getattr(material, material.given)}
    light = np.asarray(emission, dtype=np.float64)
    return Material(**given, emission=light, two_sided=material.two_sided, name=material.name)


def _refuse_strangers(scene: Scene, named: Iterable[str], argument: str) -> None:
    known = dict.fromkeys(scene.surface_names) | dict.fromkeys(s.material.name for s in scene.surfaces)
    known.pop("", None)
    if strangers := [name for name in named if name not in known]:
        shown = ", ".join(map(repr, list(known)[:20])) + (" …" if len(known) > 20 else "")
        raise ParameterError(f"{argument}: no surface or material is named {strangers[0]!r}; there are {shown}")
