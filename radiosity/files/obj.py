"""Scenes out of Wavefront OBJ: polygons in objects and groups, materials from the .mtl beside it.

The parser is our own and strict. General mesh loaders merge objects and lose which face had which material, cut
quads, cut concave polygons by a fan from their first corner, and read a file that ends too early as if it were whole.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from ..errors import FileFormatError
from ..scene import FloatArray, Material, Scene, Surface
from .colours import surfaces_by_colour
from .cut import compact, cut_polygon, narrow
from .defaults import GREY, grey
from .folder import inside
from .mtl import MtlMaterial, read_mtl
from .names import unique_names
from .notes import Notes
from .textures import Album, Codes, mean_colour, mean_over_faces
from .words import real, text_lines, whole

IGNORED = {"s", "vn", "shadow_obj", "trace_obj", "maplib", "usemap", "bevel", "c_interp", "d_interp", "mg"}
IGNORED |= {"lod"}  # codespell:ignore lod
FREE_FORM = {"vp", "cstype", "deg", "bmat", "step", "curv", "curv2", "surf", "trim", "hole", "scrv", "sp", "end"}
FREE_FORM |= {"parm"}  # codespell:ignore parm


@dataclass
class _Part:
    """Faces of one object or group with one material: rows of four corners, -1 pads a triangle."""

    faces: list[list[int]] = field(default_factory=list)
    texture: list[list[int]] = field(default_factory=list)


@dataclass
class _Content:
    """What has been read so far."""

    vertices: list[tuple[float, float, float]] = field(default_factory=list)
    texture: list[tuple[float, float]] = field(default_factory=list)
    parts: dict[tuple[str, str], _Part] = field(default_factory=dict)
    libraries: list[tuple[str, int]] = field(default_factory=list)
    object: str = ""
    group: str = ""
    material: str = ""

    @property
    def part(self) -> _Part:
        """Where the next face goes."""
        both = [name for name in dict.fromkeys((self.object, self.group)) if name]
        return self.parts.setdefault(("_".join(both), self.material), _Part())


def read_obj(path: Path, notes: Notes) -> Scene:
    """Read a scene from .obj and its .mtl: one surface per object or group and material.

    Parameters
    ----------
    path : Path
    notes : Notes
        Takes what is not used or replaced.

    Returns
    -------
    Scene
        In the file's own unit of length.

    Raises
    ------
    FileFormatError
        A line that is no OBJ statement, an index that names no vertex, a material library outside the folder.
    SceneError
        No faces, or values no scene can have.
    """
    content = _Content()
    data = path.read_bytes()
    for number, line in _lines(text_lines(data)):
        _statement(line, number, content, notes)
    if not data.rstrip(b" \t").endswith((b"\n", b"\r")):
        notes.say("the last line has no end: was the file cut off?")
    _check_indices(content, notes)
    library = _library(content, path, notes)
    parts = {key: part for key, part in content.parts.items() if part.faces}
    names = unique_names(_part_names(list(parts), path.stem), notes)
    vertices = np.array(content.vertices, dtype=np.float64)
    surfaces: list[Surface] = []
    album = Album()
    for name, (key, part) in zip(names, parts.items(), strict=True):
        material = _material(library, key[1], name, notes)
        faces = narrow(np.array(part.faces, dtype=np.int64))
        pictures = library[key[1]].pictures(path.parent, album, notes) if key[1] in library else {}
        if pictures:
            colours = _face_colours(pictures, np.array(content.texture).reshape(-1, 2), part, material)
            surfaces += surfaces_by_colour(name, vertices, faces, colours, material, notes)
        else:
            surfaces.append(Surface(name, *compact(vertices, faces), material))
    return Scene(tuple(surfaces), name=path.stem)


def _lines(lines: list[str]) -> Iterator[tuple[int, str]]:
    """Statements with the number of their first line; a backslash at a line's end continues it."""
    held, first = "", 0
    for number, line in enumerate(lines, start=1):
        line = line.strip()
        first = first if held else number
        if line.endswith("\\"):
            held += line[:-1] + " "
            continue
        if held or line:
            yield first, (held + line).strip()
        held = ""


def _statement(line: str, number: int, content: _Content, notes: Notes) -> None:
    words = line.split()
    if not words:
        return
    keyword, rest = words[0], words[1:]
    try:
        if keyword in _STATEMENTS:
            _STATEMENTS[keyword](rest, number, content)
        elif keyword in ("l", "p"):
            notes.skip("points and lines", content.object or content.group or "the file")
        elif keyword in FREE_FORM:
            notes.skip("free-form curves and surfaces", content.object or content.group or "the file")
        elif keyword not in IGNORED:
            raise FileFormatError(f"line {number} is {line[:40]!r}, no OBJ statement: damaged, or not an OBJ file")
    except ValueError as error:
        if isinstance(error, FileFormatError):
            raise
        raise FileFormatError(f"line {number} is {line[:40]!r}: expected numbers after {keyword!r}") from error


def _vertex(rest: list[str], number: int, content: _Content) -> None:
    if len(rest) < 3:
        raise FileFormatError(f"line {number}: a vertex of {len(rest)} numbers; it needs 3")
    content.vertices.append((real(rest[0]), real(rest[1]), real(rest[2])))


def _texture_vertex(rest: list[str], number: int, content: _Content) -> None:
    if not rest:
        raise FileFormatError(f"line {number}: a texture vertex without numbers")
    content.texture.append((real(rest[0]), real(rest[1]) if len(rest) > 1 else 0.0))


def _face(rest: list[str], number: int, content: _Content) -> None:
    if len(rest) < 3:
        raise FileFormatError(f"line {number}: a face of {len(rest)} corners; it needs 3")
    corners, texture = [], []
    for word in rest:
        first, *others = word.split("/")
        corners.append(_index(first, len(content.vertices), "vertex", number))
        texture.append(
            _index(others[0], len(content.texture), "texture vertex", number) if others and others[0] else -1
        )
        if len(others) > 1 and others[1]:
            whole(others[1])  # the normal is not used, but a broken one betrays a damaged line
    part = content.part
    if len(corners) <= 4:
        part.faces.append(corners + [-1] * (4 - len(corners)))
        part.texture.append(texture + [-1] * (4 - len(corners)))
        return
    points = np.array([content.vertices[k] for k in corners])
    for a, b, c in cut_polygon(points, f"line {number}").tolist():
        part.faces.append([corners[a], corners[b], corners[c], -1])
        part.texture.append([texture[a], texture[b], texture[c], -1])


def _index(word: str, count: int, of: str, number: int) -> int:
    """From 1, or negative from the end, to from 0."""
    value = whole(word)
    if not (-count <= value < 0 or 0 < value <= count):
        raise FileFormatError(f"line {number}: {of} {value} does not exist; {count} come before this line")
    return value - 1 if value > 0 else count + value


def _set_object(rest: list[str], _: int, content: _Content) -> None:
    content.object, content.group = " ".join(rest), ""


def _set_group(rest: list[str], _: int, content: _Content) -> None:
    content.group = " ".join(rest)


def _set_material(rest: list[str], _: int, content: _Content) -> None:
    content.material = " ".join(rest)


def _add_library(rest: list[str], number: int, content: _Content) -> None:
    content.libraries.append((" ".join(rest), number))


_STATEMENTS: dict[str, Callable[[list[str], int, _Content], None]] = {
    "v": _vertex,
    "vt": _texture_vertex,
    "f": _face,
    "o": _set_object,
    "g": _set_group,
    "usemtl": _set_material,
    "mtllib": _add_library,
}


def _check_indices(content: _Content, notes: Notes) -> None:
    used = {k for part in content.parts.values() for face in part.faces for k in face if k >= 0}
    loose = len(content.vertices) - len(used)
    if loose and used:
        notes.say(f"{loose} of {len(content.vertices)} vertices belong to no face: is the file whole?")


def _library(content: _Content, path: Path, notes: Notes) -> dict[str, MtlMaterial]:
    """Materials of all libraries that the file names; its name may hold spaces, or stand for several files."""
    found: dict[str, MtlMaterial] = {}
    for name, number in content.libraries:
        where = f"line {number}: mtllib"
        file = inside(name, where, path.parent)
        files = [file] if file.is_file() else [inside(word, where, path.parent) for word in name.split()]
        for file in files:
            if file.is_file():
                found |= read_mtl(file, notes)
            else:
                notes.say(f"the material library {file.name!r} is not beside the file; put it there")
    return found


def _material(library: dict[str, MtlMaterial], name: str, surface: str, notes: Notes) -> Material:
    if name in library:
        return library[name].material(notes)
    what = f"its material {name!r} is not defined" if name else "it has no material"
    notes.say(f"surface {surface!r}: {what}; it gets a grey of reflectance {GREY}")
    return grey(name)


def _part_names(keys: list[tuple[str, str]], stem: str) -> list[str]:
    """The group's name where it has one material, group and material where it has several."""
    groups = [group for group, _ in keys]
    return [
        (group if groups.count(group) == 1 else f"{group}_{material}" if group else material) or material or stem
        for group, material in keys
    ]


def _face_colours(pictures: dict[str, Codes], coordinates: FloatArray, part: _Part, material: Material) -> FloatArray:
    """Reflectance and emission (M, 6) of each face: the material's, times the means of its pictures there."""
    corners = np.array(part.texture, dtype=np.int64)
    there = ((corners >= 0) == (np.array(part.faces) >= 0)).all(axis=1)  # faces with texture vertices at all corners
    from_top = np.column_stack([coordinates[:, 0], 1.0 - coordinates[:, 1]])  # OBJ counts from the bottom
    factors = {key: np.ones((len(corners), 3)) for key in ("map_Kd", "map_Ke")}
    for key, picture in pictures.items():
        factors[key][:] = mean_colour(picture)
        if there.any():
            factors[key][there] = mean_over_faces(picture, from_top, corners[there])
    return np.hstack([factors["map_Kd"] * material.reflectance, factors["map_Ke"] * material.emission])
