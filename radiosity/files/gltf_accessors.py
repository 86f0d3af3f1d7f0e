"""Typed arrays out of glTF buffers, every range checked before anything is allocated."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import FileFormatError
from . import checked
from .checked import JSON

COMPONENTS: dict[int, np.dtype[Any]] = {
    5120: np.dtype("<i1"),
    5121: np.dtype("<u1"),
    5122: np.dtype("<i2"),
    5123: np.dtype("<u2"),
    5125: np.dtype("<u4"),
    5126: np.dtype("<f4"),
}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}
LARGEST_EMPTY = 2**16  # elements of an accessor that no data backs: the only arrays not bounded by the file's size


class Accessors:
    """The arrays of a glTF document.

    Parameters
    ----------
    document : dict
    buffers : list of bytes
    """

    def __init__(self, document: JSON, buffers: list[bytes]) -> None:
        self._accessors = checked.mappings(document, "accessors", "glTF")
        self._views = checked.mappings(document, "bufferViews", "glTF")
        self._buffers = buffers

    @property
    def size(self) -> int:
        """Bytes of all buffers."""
        return sum(map(len, self._buffers))

    def count(self, obj: JSON, key: str, where: str) -> int:
        """How many elements the accessor has that `obj[key]` names."""
        k = checked.index(obj, key, where, len(self._accessors), "accessors")
        return checked.integer(self._accessors[k], "count", f"accessors[{k}]", low=1)

    def read(self, obj: JSON, key: str, where: str, types: tuple[str, ...]) -> NDArray[Any]:
        """The array that `obj[key]` names, (count,) or (count, width), in its own component type.

        Raises
        ------
        FileFormatError
            A type that is not among `types`, or a range outside the buffer.
        """
        k = checked.index(obj, key, where, len(self._accessors), "accessors")
        accessor, where = self._accessors[k], f"accessors[{k}]"
        kind = checked.text(accessor, "type", where)
        if kind not in types:
            raise FileFormatError(f"{where}.type is {kind!r}; expected {' or '.join(types)}")
        dtype = _dtype(accessor, where)
        count, width = checked.integer(accessor, "count", where, low=1), WIDTHS[kind]
        if "bufferView" in accessor:
            array = self._strided(accessor, where, dtype, count, width)
        elif count > LARGEST_EMPTY:
            raise FileFormatError(
                f"{where} has {count} elements and no bufferView; at most {LARGEST_EMPTY} are accepted"
            )
        else:
            array = np.zeros((count, width), dtype=dtype)
        if "sparse" in accessor:
            array = self._with_sparse(array, checked.mapping(accessor, "sparse", where), f"{where}.sparse")
        if checked.flag(accessor, "normalized", where) and dtype.kind != "f":
            largest = float(np.iinfo(dtype).max)
            array = np.maximum(array / largest, -1.0)
        return array[:, 0] if kind == "SCALAR" else array

    def view(self, obj: JSON, key: str, where: str) -> tuple[memoryview, int]:
        """The bytes of the bufferView that `obj[key]` names, and its stride (0: packed)."""
        k = checked.index(obj, key, where, len(self._views), "bufferViews")
        view, where = self._views[k], f"bufferViews[{k}]"
        buffer = self._buffers[checked.index(view, "buffer", where, len(self._buffers), "buffers")]
        start = checked.integer(view, "byteOffset", where, default=0)
        length = checked.integer(view, "byteLength", where, low=1)
        if start + length > len(buffer):
            raise FileFormatError(f"{where} ends at byte {start + length} of a buffer of {len(buffer)}")
        stride = checked.integer(view, "byteStride", where, default=0, high=252)
        return memoryview(buffer)[start : start + length], stride

    def _strided(self, obj: JSON, where: str, dtype: np.dtype[Any], count: int, width: int) -> NDArray[Any]:
        data, stride = self.view(obj, "bufferView", where)
        element = dtype.itemsize * width
        stride = stride or element
        if stride < element or stride % dtype.itemsize:
            raise FileFormatError(f"{where}: a stride of {stride} bytes does not hold elements of {element}")
        start = checked.integer(obj, "byteOffset", where, default=0)
        end = start + stride * (count - 1) + element
        if end > len(data):
            raise FileFormatError(f"{where} needs {end} bytes of a bufferView of {len(data)}: count is {count}")
        return np.ndarray((count, width), dtype, data, start, (stride, dtype.itemsize))

    def _with_sparse(self, array: NDArray[Any], sparse: JSON, where: str) -> NDArray[Any]:
        count = checked.integer(sparse, "count", where, low=1, high=len(array))
        places = checked.mapping(sparse, "indices", where)
        dtype = _dtype(places, f"{where}.indices")
        if dtype.kind != "u":
            raise FileFormatError(f"{where}.indices are {dtype}; expected unsigned integers")
        rows = self._strided(places, f"{where}.indices", dtype, count, 1)[:, 0]
        if int(rows.max()) >= len(array):
            raise FileFormatError(f"{where}.indices reach {rows.max()}, the accessor has {len(array)} elements")
        values = checked.mapping(sparse, "values", where)
        result = array.copy()
        result[rows] = self._strided(values, f"{where}.values", array.dtype, count, array.shape[1])
        return result


def _dtype(obj: JSON, where: str) -> np.dtype[Any]:
    code = checked.integer(obj, "componentType", where)
    if code not in COMPONENTS:
        raise FileFormatError(f"{where}.componentType is {code}; expected one of {sorted(COMPONENTS)}")
    return COMPONENTS[code]
