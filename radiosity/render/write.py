"""A rendered picture as a file."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import display
from ..errors import FileFormatError, MissingFileError, ParameterError

FORMATS = (".png", ".npy")


def write_picture(
    picture: NDArray[np.floating[Any]],
    path: str | os.PathLike[str],
    *,
    exposure: float = 0.0,
    tone: display.Tone = "reinhard",
) -> float:
    """Write the radiance of a picture as what a screen shows of it, or as it is.

    Parameters
    ----------
    picture : ndarray (height, width, C)
        Linear radiance, as from `render`.
    path : path
        `.png`: sRGB bytes. `.npy`: the numbers themselves, as float32, for `numpy.load`.
    exposure : float, optional
        Steps brighter (+) or darker (-) than the automatic exposure, which shows the middle of the lit pixels as
        mid-grey. For `.png`, as the next.
    tone : {"reinhard", "linear"}, optional
        See `radiosity.display`.

    Returns
    -------
    float
        The factor that radiance was multiplied by before it was pressed into bytes; 1 for `.npy`.

    Raises
    ------
    FileFormatError
        Another suffix.
    MissingFileError
        The folder is not there.
    ParameterError
        Unknown tone operator, no picture.
    """
    file = Path(path)
    if picture.ndim != 3:
        raise ParameterError(f"a picture has shape {picture.shape}; give (height, width, C)")
    if file.suffix.lower() not in FORMATS:
        raise FileFormatError(f"{file}: pictures are not written as {file.suffix!r}; choose from {', '.join(FORMATS)}")
    if not file.parent.is_dir():
        raise MissingFileError(f"cannot write {file}: there is no folder {file.parent}; make it first")
    if file.suffix.lower() == ".npy":
        with file.open("wb") as stream:
            np.save(stream, picture.astype(np.float32))
        return 1.0
    from PIL import Image

    rgb = display.as_rgb(picture)
    pixels = rgb.reshape(-1, 3)
    factor = display.automatic_factor(pixels, np.ones(len(pixels))) * display.exposure_factor(exposure)
    Image.fromarray(display.tone_map(rgb, factor, tone)).save(file, format="PNG")
    return factor
