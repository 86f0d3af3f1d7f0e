"""Scenes out of STL, ASCII or binary: triangles without colour, as one grey surface.

trimesh reads them; it takes a file that was cut off as if it were whole, so that lengths are checked before.
"""

from __future__ import annotations

import logging
import struct
from collections.abc import Iterator
from contextlib import contextmanager
from io import BytesIO
from pathlib import Path

import numpy as np

from ..errors import FileFormatError
from ..scene import Scene, Surface
from .cut import merged
from .defaults import GREY, grey
from .notes import Notes


def read_stl(path: Path, notes: Notes) -> Scene:
    """Read a scene from .stl: one grey surface; equal corners of its triangles are made one.

    Raises
    ------
    FileFormatError
        A file that is neither ASCII nor binary STL, or ends too early.
    SceneError
        No triangles, or coordinates that are not finite.
    """
    import trimesh

    content = path.read_bytes()
    count = _checked_count(content)
    try:
        with np.errstate(all="ignore"), _silent_trimesh():  # of numbers that nobody has checked yet
            loaded = trimesh.load(BytesIO(content), file_type="stl", process=False)
            triangles = np.asarray(loaded.triangles, dtype=np.float64) if count else np.zeros((0, 3, 3))
    except Exception as error:  # whatever a third party's parser throws at broken input
        raise FileFormatError(f"the STL cannot be read: {error}") from error
    if len(triangles) != count:
        raise FileFormatError(f"the STL has {count} triangles, of which {len(triangles)} could be read: damaged")
    notes.say(f"an STL file has no materials; its mesh gets a grey of reflectance {GREY}")
    if count == 0:
        return Scene((), name=path.stem)
    mesh = merged(triangles.reshape(-1, 3), np.arange(3 * count).reshape(-1, 3))
    return Scene((Surface(path.stem, *mesh, grey()),), name=path.stem)


@contextmanager
def _silent_trimesh() -> Iterator[None]:
    """Keep trimesh from printing a traceback about what becomes a named error here, where nobody handles its log."""
    logger, silence = logging.getLogger("trimesh"), logging.NullHandler()
    logger.addHandler(silence)
    try:
        yield
    finally:
        logger.removeHandler(silence)


def _checked_count(content: bytes) -> int:
    """How many triangles the file holds, if it is whole."""
    count: int = struct.unpack_from("<I", content, 80)[0] if len(content) >= 84 else 0
    if len(content) == 84 + 50 * count:
        return count
    text = content.lower()
    if not text.lstrip().startswith(b"solid") or b"\0" in content:
        promised = f"; its header says {count} triangles, {84 + 50 * count} bytes" if len(content) >= 84 else ""
        raise FileFormatError(f"the file is no whole STL: it has {len(content)} bytes{promised}")
    starts, ends, corners = (text.count(word) for word in (b"outer loop", b"endfacet", b"vertex"))
    if not starts == ends == corners / 3 or b"endsolid" not in text.rstrip().splitlines()[-1]:
        raise FileFormatError(
            f"the ASCII STL has {starts} loops, {ends} facets that end and {corners} corners, and ends with "
            f"{content.rstrip()[-30:]!r}: it is truncated or damaged"
        )
    return starts
