"""The series as a film: bounce after bounce, one term beside the sum, as .gif or .mp4."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from ..errors import MissingDependencyError
from .figures import Stage
from .overlay import FAINT, INK, PANEL, font
from .state import PANES, Series, ViewState, caption, formula, in_words, start

if TYPE_CHECKING:
    from ..solution import Solution

SECONDS = 0.9  # a bounce
LAST = 2.5  # the last one, before the film begins again
GAP, HEAD, FOOT = 16, 52, 40  # pixels around the panes
FRAMES_PER_SECOND = 10
BLOCK = 16  # video encoders want sides that are multiples of this


def write_animation(
    solution: Solution, path: str | Path, *, pane_size: int = 480, seconds: float = SECONDS, **settings: Any
) -> Path:
    """Write a film of the bounces.

    Parameters
    ----------
    solution : Solution
    path : path
        Ends in .gif or .mp4; the latter needs the optional group `video`.
    pane_size : int
        Pixels of one of the two panes.
    seconds : float
        For each bounce.
    **settings
        Fields of `ViewState`, such as ``normalised=True``.

    Returns
    -------
    Path

    Raises
    ------
    DisplayError
        This machine cannot draw.
    MissingDependencyError
        .mp4 without imageio-ffmpeg.
    """
    path = Path(path)
    write = _write_mp4 if path.suffix.lower() == ".mp4" else _write_gif
    if write is _write_mp4:
        _encoder()  # found missing before the work, not after it
    series = Series.of(solution)
    times = [seconds] * series.last + [max(seconds, LAST)]
    write(path, frames(solution, series, pane_size, **settings), times)
    return path


def frames(solution: Solution, series: Series, pane_size: int, **settings: Any) -> Iterator[NDArray[np.uint8]]:
    """One picture (height, width, 3) for each order."""
    begin = start(series, **settings)
    with Stage(solution.patches, (pane_size, pane_size), preset=begin.preset) as stage:
        for k in range(series.last + 1):
            state = begin.at(k)
            yield _frame(series, state, [stage.image(series, state, pane) for pane in PANES])


def _frame(series: Series, state: ViewState, images: list[NDArray[np.uint8]]) -> NDArray[np.uint8]:
    """Both panes with their titles above and what is seen below."""
    size = images[0].shape[0]
    width, height = (side + -side % BLOCK for side in (2 * size + 3 * GAP, size + HEAD + FOOT))
    paper = Image.new("RGB", (width, height), PANEL)
    pen = ImageDraw.Draw(paper)
    large, small = ImageFont.truetype(font("-Oblique"), 26), ImageFont.truetype(font(), 15)
    for number, (pane, image) in enumerate(zip(PANES, images, strict=True)):
        left = GAP + number * (size + GAP)
        paper.paste(Image.fromarray(image), (left, HEAD))
        pen.text((left, HEAD / 2), formula(state.order, pane), INK, font=large, anchor="lm")
        pen.text((left + size, HEAD / 2), caption(series, state, pane), FAINT, font=small, anchor="rm")
    watts = " / ".join(f"{power:.3g}" for power in series.power[state.order]) if series.power.shape[1] <= 3 else ""
    words = f"k = {state.order}: {in_words(state.order)}" + (f" · {watts} W" if watts else "")
    pen.text((GAP, HEAD + size + FOOT / 2), words, FAINT, font=small, anchor="lm")
    return np.asarray(paper)


def _write_gif(path: Path, images: Iterator[NDArray[np.uint8]], times: list[float]) -> None:
    first, *others = [Image.fromarray(image).quantize(256, dither=Image.Dither.FLOYDSTEINBERG) for image in images]
    durations = [round(1000 * time) for time in times]
    first.save(path, format="GIF", save_all=True, append_images=others, duration=durations, loop=0, disposal=1)


def _encoder() -> Any:
    """The module that writes .mp4.

    Raises
    ------
    MissingDependencyError
    """
    try:
        import imageio_ffmpeg
    except ImportError as error:
        raise MissingDependencyError(
            "writing .mp4 needs imageio-ffmpeg: pip install 'radiosity[video]', or write a .gif"
        ) from error
    return imageio_ffmpeg


def _write_mp4(path: Path, images: Iterator[NDArray[np.uint8]], times: list[float]) -> None:
    writer = None
    for image, time in zip(images, times, strict=True):
        if writer is None:
            size = (image.shape[1], image.shape[0])
            writer = _encoder().write_frames(str(path), size, fps=FRAMES_PER_SECOND, quality=8, macro_block_size=BLOCK)
            writer.send(None)
        for _ in range(max(1, round(time * FRAMES_PER_SECOND))):
            writer.send(np.ascontiguousarray(image))
    if writer is not None:
        writer.close()
