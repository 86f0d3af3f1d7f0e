"""Named arrays and one JSON header in a numpy archive (.npz), read as if a stranger had made it.

`numpy.load` believes what an archive says of itself: sizes, types, shapes. Here nothing is allocated that the
file does not hold byte for byte, nothing is unpickled, and checksums are compared.
"""

from __future__ import annotations

import io
import json
import zipfile
import zlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import FileFormatError, MissingFileError
from .atomic import replacing
from .checked import JSON

HEADER = "header"  # UTF-8 JSON, as bytes: json.loads(bytes(numpy.load(path)["header"]))
MOST_HEADER = 1 << 28  # bytes


def write_archive(path: Path, header: JSON, arrays: Mapping[str, NDArray[Any]]) -> None:
    """Write a header and arrays, uncompressed, whole or not at all."""
    text = json.dumps(header, allow_nan=False, separators=(",", ":")).encode()
    parts = {HEADER: np.frombuffer(text, dtype=np.uint8), **arrays}
    with replacing(path) as temporary:
        np.savez(temporary, **{name: np.ascontiguousarray(array) for name, array in parts.items()})  # type: ignore[arg-type]


class Archive:
    """A numpy archive that is open for reading; use it in a ``with``.

    Raises
    ------
    MissingFileError
        There is no such file.
    FileFormatError
        It is no archive, or damaged.
    """

    def __init__(self, path: Path) -> None:
        if not path.is_file():
            raise MissingFileError(f"there is no file {path}")
        self.size = path.stat().st_size
        try:
            self._zip = zipfile.ZipFile(path)
        except (zipfile.BadZipFile, EOFError, OSError, NotImplementedError, ValueError) as error:
            raise FileFormatError(
                f"it is no numpy archive, or it was cut short ({self.size} bytes): {error}"
            ) from error
        self._infos = {info.filename: info for info in self._zip.infolist()}

    def __enter__(self) -> Archive:
        return self

    def __exit__(self, *_: object) -> None:
        self._zip.close()

    def __contains__(self, name: str) -> bool:
        return f"{name}.npy" in self._infos

    def header(self) -> JSON:
        """The JSON header."""
        text = self.array(HEADER)
        if text.dtype != np.uint8 or text.ndim != 1 or text.size > MOST_HEADER:
            raise FileFormatError(f"{HEADER} is {text.dtype} {text.shape}; expected bytes of JSON")
        try:
            value = json.loads(text.tobytes().decode(), parse_constant=_refuse_constant)
        except (ValueError, RecursionError) as error:
            raise FileFormatError(f"{HEADER} is no JSON: {error}") from error
        if not isinstance(value, dict):
            raise FileFormatError(f"{HEADER} is a {type(value).__name__}; expected an object")
        return value

    def array(self, name: str) -> NDArray[Any]:
        """One array, in memory of its own, with the shape and type that the archive gives it.

        Raises
        ------
        FileFormatError
            It is not there, not as long as it says, damaged, or holds Python objects.
        """
        info = self._infos.get(f"{name}.npy")
        if info is None:
            raise FileFormatError(f"{name} is missing")
        if info.compress_type != zipfile.ZIP_STORED or info.file_size > self.size or info.flag_bits & 1:
            raise FileFormatError(
                f"{name} is compressed, encrypted, or said to be {info.file_size} bytes in a file of {self.size}; "
                "solutions are stored plainly: take the file as it was written"
            )
        memory = np.empty(info.file_size, dtype=np.uint8)
        try:
            with self._zip.open(info) as stream:
                filled = 0
                while part := stream.read(1 << 24):  # the checksum is compared at the end of the stream
                    memory[filled : filled + len(part)] = np.frombuffer(part, dtype=np.uint8)
                    filled += len(part)
        except (zipfile.BadZipFile, EOFError, OSError, NotImplementedError, zlib.error, ValueError) as error:
            raise FileFormatError(f"{name} is damaged: {error}") from error
        if filled != info.file_size:
            raise FileFormatError(f"{name} has {filled} bytes, not {info.file_size}: the file was cut short")
        return _shaped(name, memory)


def _shaped(name: str, memory: NDArray[np.uint8]) -> NDArray[Any]:
    """The array that bytes in numpy's format hold, without a copy."""
    stream = io.BytesIO(memory[: 1 << 16].tobytes())
    try:
        version = np.lib.format.read_magic(stream)
        read = {(1, 0): np.lib.format.read_array_header_1_0, (2, 0): np.lib.format.read_array_header_2_0}[version]
        shape, fortran, dtype = read(stream)
    except (ValueError, KeyError, EOFError, SyntaxError, TypeError, RecursionError, MemoryError) as error:
        raise FileFormatError(f"{name} is not in numpy's format: {error}") from error
    count = 1
    for length in shape:  # Python's integers do not overflow
        count *= length
    held = len(memory) - stream.tell()
    if dtype.hasobject or dtype.itemsize == 0 or (fortran and len(shape) > 1):
        raise FileFormatError(f"{name} holds {dtype} in {'columns' if fortran else 'rows'}; expected numbers in rows")
    if min(shape, default=0) < 0 or count * dtype.itemsize != held:
        raise FileFormatError(f"{name} says {shape} of {dtype}, {count * dtype.itemsize} bytes, but holds {held}")
    return memory[stream.tell() :].view(dtype).reshape(shape)


def _refuse_constant(word: str) -> float:
    raise ValueError(f"{word} is no number")
