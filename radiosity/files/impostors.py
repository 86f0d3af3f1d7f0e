"""Files that are not what their name says, told by how they begin."""

from __future__ import annotations

BEGINNINGS = {
    b"PK\x03\x04": "a ZIP archive; unpack it and name the file in it",
    b"\x1f\x8b": "compressed (gzip); unpack it first",
    b"BZh": "compressed (bzip2); unpack it first",
    b"\xfd7zXZ": "compressed (xz); unpack it first",
    b"7z\xbc\xaf\x27\x1c": "a 7z archive; unpack it and name the file in it",
    b"Rar!": "a RAR archive; unpack it and name the file in it",
    b"\x28\xb5\x2f\xfd": "compressed (zstd); unpack it first",
    b"version https://git-lfs": "a pointer of Git LFS; fetch the file itself with `git lfs pull`",
    b"%PDF": "a PDF, not a scene",
    b"\x89PNG": "a picture (PNG), not a scene",
    b"\xff\xd8\xff": "a picture (JPEG), not a scene",
    b"BLENDER": "a Blender file; export it as glTF (.glb)",
    b"Kaydara FBX": "an FBX file; export it as glTF (.glb)",
    b"\x7fELF": "a program, not a scene",
    b"\x93NUMPY": "a numpy array, not a scene",
}
WEB_PAGES = (b"<!doctype html", b"<html")


def impostor(start: bytes) -> str | None:
    r"""What a file is instead of a scene, and what to do about it, from its first bytes; None where nothing is known.

    >>> impostor(b"PK\x03\x04 and so on")
    'a ZIP archive; unpack it and name the file in it'
    >>> impostor(b"v 0 0 0") is None
    True
    """
    head = start.lstrip(b"\xef\xbb\xbf \t\r\n")
    if head.lower().startswith(WEB_PAGES):
        return "a web page (HTML), not a scene; download the file itself"
    if head.startswith(b"<?xml"):
        return "XML (Collada, X3D or 3MF?), which is not read; export it as glTF (.glb)"
    return next((what for beginning, what in BEGINNINGS.items() if start.startswith(beginning)), None)
