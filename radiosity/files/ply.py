"""Scenes out of PLY: polygons, with a colour per face or per vertex.

The parser is our own: the general loader reorders triangles and quads and so gives faces the colours of others.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..display import decode_srgb
from ..errors import FileFormatError
from ..scene import FloatArray, Material, Scene, Surface
from .colours import surfaces_by_colour
from .cut import face_rows, narrow
from .defaults import GREY, grey
from .notes import Notes
from .words import real, whole

TYPES = {
    "char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1", "short": "i2", "int16": "i2", "ushort": "u2",
    "uint16": "u2", "int": "i4", "int32": "i4", "uint": "u4", "uint32": "u4", "float": "f4", "float32": "f4",
    "double": "f8", "float64": "f8",
}  # fmt: skip
ORDERS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}
CORNERS = ("vertex_indices", "vertex_index")
COLOURS = (("red", "green", "blue"), ("diffuse_red", "diffuse_green", "diffuse_blue"), ("r", "g", "b"))

Columns = dict[str, Any]


@dataclass(frozen=True)
class _Property:
    name: str
    type: str
    count: str = ""  # type of the length of a list


@dataclass(frozen=True)
class _Element:
    name: str
    count: int
    properties: list[_Property]


def read_ply(path: Path, notes: Notes) -> Scene:
    """Read a scene from .ply, ASCII or binary: one surface per colour.

    Colours in whole numbers are taken as sRGB, in fractions as linear reflectance; colours of faces count before
    those of vertices, of which a face has the mean. Without any, the mesh is grey.

    Raises
    ------
    FileFormatError
        A broken header, a file that ends too early, corners that do not exist.
    SceneError
        No faces, or values no scene can have.
    """
    content = path.read_bytes()
    order, elements, start = _header(content)
    read = _read_ascii if order == "" else _read_binary
    columns = read(content[start:], elements, order)
    if order == "" and not content.rstrip(b" \t").endswith((b"\n", b"\r")):
        notes.say("the last line has no end: was the file cut off?")
    vertex, face = columns.get("vertex", {}), columns.get("face", {})
    if missing := [axis for axis in "xyz" if axis not in vertex]:
        raise FileFormatError(f"the PLY has no vertex property {missing[0]!r}")
    key = next((name for name in CORNERS if name in face), None)
    for element in elements:
        if element.name not in ("vertex", "face") and element.count:
            notes.skip(f"PLY element {element.name!r}", f"{element.count} of them")
    vertices = np.column_stack([np.asarray(vertex[axis], dtype=np.float64) for axis in "xyz"])
    polygons = [np.asarray(corners, dtype=np.int64) for corners in face[key]] if key else []
    rows, source = face_rows(polygons, vertices, "face")
    return Scene(tuple(_surfaces(path.stem, vertices, rows, source, (vertex, face), notes)), name=path.stem)


def _surfaces(
    name: str,
    vertices: FloatArray,
    rows: NDArray[np.int64],
    source: NDArray[np.int64],
    columns: tuple[Columns, Columns],
    notes: Notes,
) -> list[Surface]:
    if not len(rows):
        return []
    by_vertex, by_face = (_colours(part) for part in columns)
    if by_face is not None:
        colours = by_face[source]
    elif by_vertex is not None:
        there = (rows >= 0)[:, :, None]
        colours = np.where(there, by_vertex[rows], 0.0).sum(axis=1) / there.sum(axis=1)
    else:
        notes.say(f"the PLY has no colours; its mesh gets a grey of reflectance {GREY}")
        return [Surface(name, vertices, narrow(rows), grey())]
    return surfaces_by_colour(name, vertices, rows, colours, Material(np.zeros(3)), notes)


def _colours(columns: Columns) -> FloatArray | None:
    """Linear RGB of each vertex or face."""
    for names in COLOURS:
        if all(name in columns for name in names):
            values = np.column_stack([columns[name] for name in names])
            if values.dtype.kind == "f":
                return values.astype(np.float64)
            if values.min(initial=0) < 0 or values.max(initial=0) > 255:
                raise FileFormatError(f"PLY colours reach {values.min()} … {values.max()}; expected 0 … 255")
            return np.asarray(decode_srgb(values.astype(np.uint8)), dtype=np.float64)
    return None


def _header(content: bytes) -> tuple[str, list[_Element], int]:
    """Byte order ("" for ASCII), elements, and where the data start."""
    end = content.find(b"end_header", 0, 65536)
    if not content.startswith(b"ply") or end < 0:
        raise FileFormatError("the file does not begin with a PLY header; damaged, or no PLY file")
    start = content.find(b"\n", end) + 1
    order: str | None = None
    elements: list[_Element] = []
    for number, line in enumerate(content[:end].decode("ascii", errors="replace").splitlines()[1:], start=2):
        words = line.split()
        try:
            if not words or words[0] in ("comment", "obj_info"):
                continue
            if words[0] == "format":
                order = ORDERS[words[1]]
            elif words[0] == "element":
                _add_element(elements, words[1], whole(words[2]))
            elif words[0] == "property" and words[1] == "list":
                _add_property(elements, _Property(words[4], TYPES[words[3]], TYPES[words[2]]))
            elif words[0] == "property":
                _add_property(elements, _Property(words[2], TYPES[words[1]]))
            else:
                raise KeyError(words[0])
        except (KeyError, IndexError, ValueError) as error:
            raise FileFormatError(f"line {number} of the PLY header is {line[:50]!r}, which is not PLY") from error
    if order is None or start == 0:
        raise FileFormatError("the PLY header names no format; damaged")
    for element in elements:
        if not 0 <= element.count <= len(content):  # every element takes a byte at least
            raise FileFormatError(
                f"the PLY header promises {element.count} of {element.name!r}: more than the file holds"
            )
    return order, elements, start


def _add_element(elements: list[_Element], name: str, count: int) -> None:
    if any(element.name == name for element in elements):
        raise ValueError(f"{name!r} is there twice")
    elements.append(_Element(name, count, []))


def _add_property(elements: list[_Element], new: _Property) -> None:
    if new.count.startswith("f") or any(p.name == new.name for p in elements[-1].properties):
        raise ValueError(f"{new.name!r} is there twice, or its length is no whole number")
    if new.name in CORNERS and (not new.count or new.type.startswith("f")):
        raise ValueError(f"{new.name!r} is no list of whole numbers")
    elements[-1].properties.append(new)


def _read_ascii(data: bytes, elements: list[_Element], _: str) -> dict[str, Columns]:
    lines = data.decode("ascii", errors="replace").splitlines()
    place = 0
    result: dict[str, Columns] = {}
    for element in elements:
        rows = lines[place : place + element.count]
        if len(rows) < element.count:
            raise FileFormatError(
                f"the PLY promises {element.count} of {element.name!r} and has {len(rows)}: truncated"
            )
        values: Columns = {p.name: [] for p in element.properties}
        for k, row in enumerate(rows):
            try:
                _ascii_row(row.split(), element.properties, values)
            except (ValueError, IndexError, OverflowError) as error:
                raise FileFormatError(f"{element.name} {k} of the PLY is {row[:50]!r}: damaged") from error
        place += element.count
        result[element.name] = {
            p.name: v if p.count else np.array(v, dtype=_kind(p)) for p, v in _with(element, values)
        }
    if any(line.strip() for line in lines[place:]):
        raise FileFormatError("the PLY goes on behind the last element that its header promises: damaged")
    return result


def _ascii_row(words: list[str], properties: list[_Property], values: Columns) -> None:
    place = 0
    for p in properties:
        convert = real if p.type.startswith("f") else whole
        if p.count:
            length = whole(words[place])
            part = words[place + 1 : place + 1 + length]
            if length < 0 or len(part) < length:
                raise IndexError
            values[p.name].append([convert(word) for word in part])
            place += 1 + length
        else:
            values[p.name].append(convert(words[place]))
            place += 1
    if place != len(words):
        raise IndexError


def _kind(p: _Property) -> type:
    return np.float64 if p.type.startswith("f") else np.int64


def _with(element: _Element, values: Columns) -> list[tuple[_Property, Any]]:
    return [(p, values[p.name]) for p in element.properties]


def _read_binary(data: bytes, elements: list[_Element], order: str) -> dict[str, Columns]:
    place = 0
    result = {}
    for element in elements:
        columns, place = _binary_element(data, place, element, order)
        result[element.name] = columns
    if data[place:].strip():
        raise FileFormatError(f"the PLY has {len(data) - place} bytes more than its header promises: damaged")
    return result


def _binary_element(data: bytes, place: int, element: _Element, order: str) -> tuple[Columns, int]:
    """All rows at once where their lists are equally long, else one by one."""
    if element.count == 0 or not element.properties:
        return {}, place
    _, lengths = _binary_row(data, place, element, order)
    fields: list[Any] = []
    for p, length in zip(element.properties, lengths, strict=True):
        if p.count:
            fields.append((f"{p.name} length", order + p.count))
        fields.append((p.name, order + p.type, (length,)) if p.count else (p.name, order + p.type))
    row = np.dtype(fields)
    if place + row.itemsize * element.count <= len(data):
        table = np.frombuffer(data, row, element.count, place)
        lists = [(p, n) for p, n in zip(element.properties, lengths, strict=True) if p.count]
        if all((table[f"{p.name} length"] == n).all() for p, n in lists):
            return {p.name: table[p.name] for p in element.properties}, place + row.itemsize * element.count
    values: Columns = {p.name: [] for p in element.properties}
    for _ in range(element.count):
        found, _lengths = _binary_row(data, place, element, order)
        for p, value in zip(element.properties, found, strict=True):
            values[p.name].append(value)
        place += sum(np.dtype(p.count).itemsize for p in element.properties if p.count)
        place += sum(np.asarray(value).nbytes for value in found)
    return {p.name: v if p.count else np.array(v) for p, v in _with(element, values)}, place


def _binary_row(data: bytes, place: int, element: _Element, order: str) -> tuple[list[Any], list[int]]:
    """Values and list lengths of the row at a place."""
    values, lengths = [], []
    for p in element.properties:
        length = 1
        try:
            if p.count:
                length = int(np.frombuffer(data, order + p.count, 1, place)[0])
                place += np.dtype(p.count).itemsize
                if length < 0:
                    raise ValueError
            value = np.frombuffer(data, order + p.type, length, place) if length else np.zeros(0, order + p.type)
        except ValueError as error:
            raise FileFormatError(
                f"the PLY ends within its {element.name!r} elements, or a list there has a wrong length: truncated"
            ) from error
        values.append(value if p.count else value[0])
        lengths.append(length)
        place += value.nbytes
    return values, lengths
