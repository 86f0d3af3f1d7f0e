"""Files that a scene names: only those in or below its own folder, because a scene comes from anywhere."""

from __future__ import annotations

from pathlib import Path, PurePosixPath, PureWindowsPath

from ..errors import FileFormatError


def inside(name: str, where: str, folder: Path, scheme: str = "") -> Path:
    """The path of a relative name in or below a folder; whether it exists is for the caller to see.

    Parameters
    ----------
    name : str
        As it stands in the file.
    where : str
        Place in the file, for the message.
    folder : Path
        The folder of the scene.
    scheme : str
        Of a URI; any is refused.

    Raises
    ------
    FileFormatError
        An absolute name, one with ``..``, another scheme, or a link that leads out of the folder.
    """
    parts = (*PurePosixPath(name).parts, *PureWindowsPath(name).parts)
    absolute = PurePosixPath(name).is_absolute() or bool(PureWindowsPath(name).anchor)
    if scheme or absolute or ".." in parts or "\0" in name or not name:
        raise FileFormatError(f"{where} names {name!r}; only files in the folder of the scene are read")
    path = folder / name
    if not path.resolve().is_relative_to(folder.resolve()):
        raise FileFormatError(f"{where} names {name!r}, a link out of the folder of the scene")
    return path
