"""The outer shell of glTF: a GLB's chunks or a .gltf with its buffers, read with every length checked.

The reader is our own. General mesh loaders round `baseColorFactor` to 8 bits, drop `KHR_materials_emissive_strength`
and load damaged files without a word; here a file gives what it says, or a named error.
"""

from __future__ import annotations

import base64
import binascii
import json
import struct
from pathlib import Path
from typing import Any
from urllib.parse import unquote, urlsplit

from ..errors import FileFormatError
from . import checked
from .checked import JSON
from .folder import inside

MAGIC, CHUNK_JSON, CHUNK_BIN = 0x46546C67, 0x4E4F534A, 0x004E4942


def load(path: Path) -> tuple[JSON, list[bytes]]:
    """Read a .glb or .gltf: its JSON and the bytes of its buffers.

    Parameters
    ----------
    path : Path

    Returns
    -------
    document : dict
    buffers : list of bytes
        At least `byteLength` long each.

    Raises
    ------
    FileFormatError
        Not glTF 2, truncated, broken JSON, a buffer that is missing, too short or outside the file's folder.
    """
    content = path.read_bytes()
    binary: bytes | None = None
    if content[:4] == b"glTF":
        content, binary = _chunks(content)
    document = _parse(content)
    version = checked.text(checked.mapping(document, "asset", "glTF"), "version", "asset")
    if version.split(".")[0] != "2":
        raise FileFormatError(f"asset.version is {version!r}; expected glTF 2.0, so export it again as that")
    buffers = [
        _buffer(buffer, f"buffers[{k}]", path.parent, binary if k == 0 else None)
        for k, buffer in enumerate(checked.mappings(document, "buffers", "glTF"))
    ]
    return document, buffers


def _chunks(content: bytes) -> tuple[bytes, bytes | None]:
    """The JSON and the binary chunk of a GLB (glTF 2.0 specification, section 4.4)."""
    if len(content) < 20:
        raise FileFormatError(f"the file ends after {len(content)} bytes, within the header of a GLB; it is truncated")
    _, version, length = struct.unpack_from("<III", content)
    if version != 2:
        raise FileFormatError(f"a GLB of version {version}; expected 2, so export it again as glTF 2.0")
    if length > len(content):
        raise FileFormatError(f"the header says {length} bytes, the file has {len(content)}: it is truncated")
    if length < len(content):
        raise FileFormatError(f"the header says {length} bytes, the file has {len(content)}: it is damaged")
    chunks: dict[int, bytes] = {}
    place = 12
    while place + 8 <= length:
        size, kind = struct.unpack_from("<II", content, place)
        if place + 8 + size > length:
            raise FileFormatError(
                f"the chunk at byte {place} says {size} bytes, {length - place - 8} are left: damaged"
            )
        chunks.setdefault(kind, content[place + 8 : place + 8 + size])
        place += 8 + size + (-size) % 4
    if CHUNK_JSON not in chunks:
        raise FileFormatError("the GLB has no JSON chunk; it is damaged")
    return chunks[CHUNK_JSON], chunks.get(CHUNK_BIN)


def _parse(content: bytes) -> JSON:
    try:
        document = json.loads(content.decode("utf-8-sig"), parse_constant=_no_constant)
    except UnicodeDecodeError as error:
        raise FileFormatError(f"byte {error.start} is not UTF-8 text, and the file is no GLB either") from error
    except json.JSONDecodeError as error:
        raise FileFormatError(f"line {error.lineno}, column {error.colno} is not JSON: {error.msg}") from error
    except FileFormatError:
        raise
    except ValueError as error:
        raise FileFormatError("the JSON holds a number that is too long") from error
    except RecursionError as error:
        raise FileFormatError("the JSON is nested too deeply to be a scene") from error
    if not isinstance(document, dict) or "asset" not in document:
        raise FileFormatError("the JSON is not glTF: it has no 'asset'")
    return document


def _no_constant(name: str) -> Any:
    raise FileFormatError(f"the JSON holds {name}, which is no number")


def _buffer(buffer: JSON, where: str, folder: Path, binary: bytes | None) -> bytes:
    length = checked.integer(buffer, "byteLength", where)
    if "uri" not in buffer:
        if binary is None:
            raise FileFormatError(f"{where} has no uri, and the file no binary chunk for it")
        content = binary
    else:
        content = resource(checked.text(buffer, "uri", where), f"{where}.uri", folder)
    if len(content) < length:
        raise FileFormatError(f"{where} says {length} bytes, there are {len(content)}: truncated")
    return content


def resource(uri: str, where: str, folder: Path) -> bytes:
    """The bytes that a URI means: base64 within it, or a file in or below the folder of the scene.

    A scene comes from anywhere, so that other folders, other schemes and links out of the folder are refused.
    """
    if uri.startswith("data:"):
        head, comma, data = uri.partition(",")
        if not comma or not head.endswith(";base64"):
            raise FileFormatError(f"{where} is a data URI without base64")
        try:
            return base64.b64decode(data, validate=True)
        except binascii.Error as error:
            raise FileFormatError(f"{where} is not valid base64: {error}") from error
    path = inside(unquote(uri), where, folder, scheme=urlsplit(uri).scheme)
    if not path.is_file():
        raise FileFormatError(f"{where} names {uri!r}, which is not in the folder of the scene; put it there")
    return path.read_bytes()
