"""Scenes out of OFF: polygons without colour, as one grey surface."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from ..errors import FileFormatError
from ..scene import IntArray, Scene, Surface
from .cut import face_rows, narrow
from .defaults import GREY, grey
from .notes import Notes
from .words import real, text_lines, whole

HEADER = re.compile(r"\s*(ST)?(?P<colours>C)?N?(?P<four>4)?(?P<many>n)?OFF\b")


def read_off(path: Path, notes: Notes) -> Scene:
    """Read a scene from .off (ASCII): one grey surface; colours are not used.

    Raises
    ------
    FileFormatError
        No OFF header, fewer vertices or faces than promised, corners that do not exist.
    SceneError
        No faces, or coordinates that are not finite.
    """
    content = path.read_bytes()
    lines = text_lines(content)
    header = HEADER.match(lines[0]) if lines else None
    if header is None:
        raise FileFormatError("the file does not begin with OFF; damaged, or no OFF file")
    if header["four"] or header["many"]:
        raise FileFormatError(f"the header is {lines[0].strip()!r}: points of other than three dimensions are not read")
    lines[0] = lines[0][header.end() :]
    numbered = [(k, words) for k, line in enumerate(lines, start=1) if (words := line.split())]
    vertices_count, faces_count = _counts(numbered)
    body = numbered[1:]
    if len(body) < vertices_count + faces_count:
        raise FileFormatError(
            f"the OFF promises {vertices_count} vertices and {faces_count} faces and has {len(body)} lines: truncated"
        )
    if len(body) > vertices_count + faces_count:
        raise FileFormatError(
            f"the OFF promises {vertices_count} vertices and {faces_count} faces, but line "
            f"{body[vertices_count + faces_count][0]} follows: damaged"
        )
    vertices = np.array([_vertex(*row) for row in body[:vertices_count]], dtype=np.float64).reshape(-1, 3)
    polygons = []
    for number, words in body[vertices_count : vertices_count + faces_count]:
        corners, rest = _corners(number, words)
        if rest:
            notes.skip("colours of an OFF file", path.name)
        polygons.append(corners)
    if header["colours"]:
        notes.skip("colours of an OFF file", path.name)
    if not content.rstrip(b" \t").endswith((b"\n", b"\r")):
        notes.say("the last line has no end: was the file cut off?")
    rows, _ = face_rows(polygons, vertices, "face")
    notes.say(f"an OFF file has no materials; its mesh gets a grey of reflectance {GREY}")
    surfaces = (Surface(path.stem, vertices, narrow(rows), grey()),) if len(rows) else ()
    return Scene(surfaces, name=path.stem)


def _counts(numbered: list[tuple[int, list[str]]]) -> tuple[int, int]:
    try:
        counts = [whole(word) for word in numbered[0][1][:2]]
        if len(counts) == 2 and min(counts) >= 0:
            return counts[0], counts[1]
    except (ValueError, IndexError):
        pass
    raise FileFormatError("the OFF header has no numbers of vertices and faces; binary OFF is not read")


def _vertex(number: int, words: list[str]) -> list[float]:
    try:
        point = [real(word) for word in words[:3]]
        if len(point) == 3:
            return point
    except ValueError:
        pass
    raise FileFormatError(f"line {number} is {' '.join(words)[:40]!r}; expected a vertex of three numbers")


def _corners(number: int, words: list[str]) -> tuple[IntArray, list[str]]:
    try:
        count = whole(words[0])
        corners = np.array([whole(word) for word in words[1 : count + 1]], dtype=np.int64)
        if count >= 3 and len(corners) == count:
            return corners, words[count + 1 :]
    except (ValueError, OverflowError):
        pass
    raise FileFormatError(f"line {number} is {' '.join(words)[:40]!r}; expected a face of at least three corners")
