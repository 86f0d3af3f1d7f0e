"""Pictures on faces, by their mean over each face: a diffuse patch has one colour."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from io import BytesIO
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..display import decode_srgb
from ..scene import FloatArray, IntArray

LARGEST = 2**26  # pixels; a small file can promise a picture of any size
HELD = 2**26  # pixels, of all pictures that are kept while a scene is read
SAMPLES = 2**19  # in all, but at least 16 and at most 4096 a face

REPEAT, MIRROR, CLAMP = 10497, 33648, 33071  # the numbers that glTF has for them


Codes = NDArray[np.uint8]

LINEAR = decode_srgb(np.arange(256, dtype=np.uint8))


class Album:
    """Pictures that are wanted again, as many as `HELD` pixels allow."""

    def __init__(self) -> None:
        self._pages: dict[Hashable, Codes | None] = {}

    def picture(self, key: Hashable, load: Callable[[], Codes | None]) -> Codes | None:
        """The picture of a key, loaded if it is not at hand; None where it cannot be used."""
        if key not in self._pages:
            self._pages[key] = load()
            pixels = sum(page.size // 3 for page in self._pages.values() if page is not None)
            for old in [k for k, page in self._pages.items() if k != key and page is not None]:
                if pixels <= HELD:
                    break
                pixels -= self._pages.pop(old).size // 3  # type: ignore[union-attr]
        return self._pages[key]


def load_picture(content: bytes) -> Codes:
    """SRGB codes (H, W, 3), row 0 at the top, of a picture file.

    Raises
    ------
    ValueError
        A picture that is too large, of unknown format or damaged, or no library to read it (pillow); the message says
        which.
    """
    try:
        from PIL import Image
    except ImportError as error:
        raise ValueError("pillow is not installed, which reads pictures") from error
    try:
        with Image.open(BytesIO(content)) as picture:
            if picture.width * picture.height > LARGEST:
                raise ValueError(f"{picture.width} × {picture.height} pixels are too many")
            return np.asarray(picture if picture.mode == "RGB" else picture.convert("RGB"))
    except (OSError, SyntaxError, Image.DecompressionBombError) as error:
        raise ValueError(f"{error}") from error


def mean_colour(picture: Codes) -> FloatArray:
    """Mean linear RGB of a picture (3,)."""
    counts = [np.bincount(picture[..., c].ravel(), minlength=256) for c in range(3)]
    return np.asarray(np.array(counts) @ LINEAR) / (picture.shape[0] * picture.shape[1])


def mean_over_faces(
    picture: Codes, coordinates: NDArray[Any], faces: IntArray, wrap: tuple[int, int] = (REPEAT, REPEAT)
) -> FloatArray:
    """Mean linear colour of a picture over each face, (M, 3), sampled evenly.

    Parameters
    ----------
    picture : ndarray of uint8 (H, W, 3)
        In sRGB, as textures are.
    coordinates : ndarray (V, 2)
        Texture coordinates (u, v) from the top left corner, v downwards, the picture in [0, 1].
    faces : ndarray of int (M, 3) or (M, 4)
        Rows of `coordinates`, -1 pads a triangle.
    wrap : (int, int), optional
        What is beyond the picture in u and v: `REPEAT`, `MIRROR` or `CLAMP`.

    Returns
    -------
    ndarray (M, 3)
    """
    height, width = picture.shape[:2]
    coordinates = np.nan_to_num(coordinates, nan=0.0, posinf=0.0, neginf=0.0)
    count = int(np.clip(SAMPLES // len(faces), 16, 4096))
    means = np.zeros((len(faces), 3))
    step = max(1, 2**20 // count)
    for start in range(0, len(faces), step):
        part = faces[start : start + step]
        points = _points(coordinates, part, count)
        column = _wrapped(points[..., 0], width, wrap[0])
        row = _wrapped(points[..., 1], height, wrap[1])
        means[start : start + step] = LINEAR[picture[row, column]].mean(axis=1)
    return means


def _points(coordinates: NDArray[Any], faces: IntArray, count: int) -> FloatArray:
    """Texture coordinates (M, count, 2) spread evenly over each face (the R2 sequence of M. Roberts, 2018)."""
    plastic = 1.3247179572447460
    s, t = ((0.5 + np.outer([1 / plastic, 1 / plastic**2], np.arange(1, count + 1))) % 1.0)[..., None]
    folded = s + t > 1
    a, b, c = (coordinates[faces[:, k]][:, None] for k in range(3))
    triangle = a + np.where(folded, 1 - s, s) * (b - a) + np.where(folded, 1 - t, t) * (c - a)
    if faces.shape[1] == 3:
        return np.asarray(triangle)
    d = coordinates[faces[:, 3]][:, None]
    quad = (1 - s) * (1 - t) * a + s * (1 - t) * b + s * t * c + (1 - s) * t * d
    return np.where((faces[:, 3] >= 0)[:, None, None], quad, triangle)


def _wrapped(coordinate: FloatArray, size: int, wrap: int) -> IntArray:
    """Pixel of each coordinate."""
    if wrap == CLAMP:
        inside = np.clip(coordinate, 0.0, 1.0)
    elif wrap == MIRROR:
        inside = 1.0 - np.abs(coordinate % 2.0 - 1.0)
    else:
        inside = coordinate % 1.0
    return np.minimum((inside * size).astype(np.int64), size - 1)
