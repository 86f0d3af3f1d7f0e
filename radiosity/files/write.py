"""Writing scenes."""

from __future__ import annotations

import os
from pathlib import Path

from ..errors import FileFormatError
from ..scene import Scene
from .gltf_write import write_gltf

SUFFIXES = (".glb", ".gltf")


def write_scene(scene: Scene, path: str | os.PathLike[str]) -> None:
    """Write a scene as .glb or .gltf, so that `read_scene` gives the same scene back to the last bit.

    The file is written whole or not at all.

    Parameters
    ----------
    scene : Scene
    path : str or path-like

    Raises
    ------
    FileFormatError
        Another suffix, or coordinates beyond the range of float32.
    MissingFileError
        The folder is not there.
    """
    file = Path(path)
    if file.suffix.lower() not in SUFFIXES:
        raise FileFormatError(f"{file}: scenes are not written as {file.suffix!r}; choose {' or '.join(SUFFIXES)}")
    write_gltf(scene, file)
