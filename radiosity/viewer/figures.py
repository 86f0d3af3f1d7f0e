"""Pictures without a window: one pane, the contact sheet of all orders, power per bounce."""

from __future__ import annotations

import logging
import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pyvista as pv
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from numpy.typing import NDArray

from .. import display
from ..camera import Camera, presets
from ..errors import ParameterError
from . import probe
from .coverage import Coverage
from .drawing import Drawing
from .overlay import CHANNEL_COLOURS, FAINT, HERE, INK
from .overlay import PANEL as PAPER
from .sheet import Sheet
from .state import PANES, Pane, Series, ViewState, picture, start
from .titles import caption, in_words, mathtext

if TYPE_CHECKING:
    from ..patches import Patches
    from ..solution import Solution

logger = logging.getLogger(__name__)

CHANNEL_MARKS = ("o", "s", "^")
CHANNEL_NAMES = ("red", "green", "blue")
MOST_COLUMNS = 7
SHEET_PANE = 300  # pixels
SAMPLES = 3  # each way in a pixel of the sheet


class Stage:
    """An off-screen place to draw one scene many times; close it, or use it in a ``with``.

    Raises
    ------
    DisplayError
        If this machine cannot draw.
    """

    def __init__(
        self, patches: Patches, size: tuple[int, int] = (800, 800), camera: Camera | None = None, preset: int = 0
    ) -> None:
        probe.require("off-screen")
        probe.hush()
        self.plotter = pv.Plotter(off_screen=True, window_size=size)
        self.plotter.render_window.SetMultiSamples(probe.smoothing_samples())
        self.drawing = Drawing(self.plotter, patches, "order")
        cameras = presets(patches)
        self.drawing.look(camera or cameras[preset % len(cameras)])

    def image(self, series: Series, state: ViewState, pane: Pane) -> NDArray[np.uint8]:
        """Picture (height, width, 3) of a state."""
        self.drawing.pane = pane
        self.drawing.draw(series, state)
        self.plotter.render()
        return np.asarray(self.plotter.screenshot(return_img=True))

    def close(self) -> None:
        """Give back what the graphics library holds."""
        self.plotter.close()

    def __enter__(self) -> Stage:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


def write_pictures(solution: Solution, folder: str | Path, *, orders: Sequence[int] = ()) -> list[Path]:
    """Write the pictures of a solution: contact sheet, power per bounce, all its light, and single orders if asked.

    Parameters
    ----------
    solution : Solution
    folder : path
        Made if it is not there.
    orders : sequence of int, optional
        Which orders get a picture of their own, beside those on the contact sheet.

    Returns
    -------
    list of Path
        What was written.

    Raises
    ------
    DisplayError
        If this machine cannot draw.
    """
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    series = Series.of(solution)
    written = [folder / "orders.png", folder / "power.png", folder / "sum.png"]
    last = start(series, order=series.last)
    with Stage(solution.patches, (SAMPLES * SHEET_PANE, SAMPLES * SHEET_PANE)) as stage:
        save_image(written[2], stage.image(series, last, "sum"))
        for k in orders:
            written.append(folder / f"order_{k}.png")
            save_image(written[-1], stage.image(series, last.at(k), "order"))
        sheet = _sheet(solution, series, columns(series.last), last, stage)
    save_figure(sheet, written[0])
    save_figure(power_plot(series), written[1])
    return written


def save_picture(solution: Solution, path: str | Path, *, size: tuple[int, int] = (900, 900), **settings: Any) -> Path:
    """Write one picture of the light after the last bounce, or as the settings of `ViewState` say.

    Parameters
    ----------
    solution : Solution
    path : path
        Ends in .png.
    size : (int, int)
        Pixels.
    **settings
        Fields of `ViewState`, and ``pane="order"`` or ``"sum"`` (the default).
    """
    pane = settings.pop("pane", "sum")
    if pane not in PANES:
        raise ParameterError(f"pane {pane!r} is unknown; choose from {', '.join(PANES)}")
    series = Series.of(solution)
    state = start(series, **{"order": series.last, **settings})
    with Stage(solution.patches, size, preset=state.preset) as stage:
        return save_image(path, stage.image(series, state, pane))


def save_image(path: str | Path, image: NDArray[np.uint8]) -> Path:
    """Write pixels (height, width, 3) as PNG."""
    from PIL import Image

    Image.fromarray(image).save(path, format="PNG", compress_level=3)
    return Path(path)


def save_figure(figure: Figure, path: str | Path, dpi: float = 100.0) -> Path:
    """Write a figure on its own paper."""
    figure.savefig(path, dpi=dpi, facecolor=figure.get_facecolor(), format="png", pil_kwargs={"compress_level": 3})
    return Path(path)


def columns(last: int) -> list[int]:
    """Which orders a contact sheet shows: all, or the first ones and then ever wider steps up to the last.

    >>> columns(3), columns(40)
    ([0, 1, 2, 3], [0, 1, 2, 3, 5, 14, 40])
    """
    if last < MOST_COLUMNS:
        return list(range(last + 1))
    wide = np.geomspace(5.0, last, MOST_COLUMNS - 4)
    return [0, 1, 2, 3, *sorted({round(k) for k in wide})]


def contact_sheet(
    solution: Solution,
    *,
    series: Series | None = None,
    orders: Sequence[int] | None = None,
    camera: Camera | None = None,
    pane_size: int = SHEET_PANE,
    **settings: Any,
) -> Figure:
    """All orders at a glance, in three rows of one camera.

    On the exposure common to all, which shows how the light fades; each on its own exposure with the factor printed,
    which shows where it is; and the partial sums.

    Parameters
    ----------
    solution : Solution
    series : Series, optional
        Its light, if prepared before.
    orders : sequence of int, optional
        Which columns to show.
    camera : Camera, optional
    pane_size : int
        Pixels.
    **settings
        Fields of `ViewState`.

    Returns
    -------
    matplotlib.figure.Figure
        To be shown or saved at 100 dpi.
    """
    series = series or Series.of(solution)
    shown = columns(series.last) if orders is None else list(orders)
    state = start(series, **settings)
    with Stage(solution.patches, (SAMPLES * pane_size, SAMPLES * pane_size), camera, state.preset) as stage:
        return _sheet(solution, series, shown, state, stage)


def _sheet(solution: Solution, series: Series, shown: Sequence[int], state: ViewState, stage: Stage) -> Figure:
    """The contact sheet, with panes smaller than the stage by `SAMPLES`."""
    rows: list[tuple[Pane, bool, str]] = [
        ("order", False, "each bounce,\ncommon exposure"),
        ("order", True, "each bounce,\nits own exposure"),
        ("sum", False, "all light so far"),
    ]
    sheet = Sheet(len(shown), len(rows), stage.plotter.window_size[0] // SAMPLES)
    panes = _panes(series, state, stage)
    for row, (pane, normalised, title) in enumerate(rows):
        sheet.row_title(row, title)
        for column, k in enumerate(shown):
            here = replace(state.at(k), normalised=normalised)
            sheet.pane(row, column, panes(here, pane), mathtext(k, pane), _words(series, k, pane, normalised))
    by_channel = ", red / green / blue" if series.power.shape[1] == 3 else ""
    name = f"{solution.patches.name} · {len(solution.patches):,} patches"
    sheet.foot(f"{name} · {caption(series, state, 'sum')} · W: power that leaves all surfaces{by_channel}")
    return sheet.finished()


def _words(series: Series, k: int, pane: Pane, normalised: bool) -> str:
    """What to say beside the formula of a pane."""
    if pane == "sum":
        power = series.power[: k + 1].sum(axis=0)
        return " / ".join(f"{watts:.3g}" for watts in (power if len(power) <= 3 else [power.sum()])) + " W"
    if normalised:
        return display.factor_text(float(series.own[k])) if series.orders[k].any() else "no light of this order"
    return in_words(k)


def _panes(series: Series, state: ViewState, stage: Stage) -> Callable[[ViewState, Pane], NDArray[np.uint8]]:
    """What makes the pictures of a sheet: from one drawing where patches have plain colours, else each drawn anew."""
    if state.smooth or state.wireframe or state.backs:
        return lambda here, pane: shrunk(stage.image(series, here, pane), SAMPLES)
    coverage = Coverage(stage.drawing, series, state, SAMPLES)
    return lambda here, pane: coverage.picture(picture(series, here, pane))


def shrunk(image: NDArray[np.uint8], by: int) -> NDArray[np.uint8]:
    """A picture at a fraction of its size, each pixel the mean light of by × by."""
    height, width = image.shape[0] // by, image.shape[1] // by
    light = display.decode_srgb(image[: height * by, : width * by]).reshape(height, by, width, by, -1)
    return display.encode_srgb(light.mean(axis=(1, 3)))


def power_plot(series: Series, order: int | None = None, size: tuple[float, float] = (7.2, 4.2)) -> Figure:
    """Power of each order in watts, on a logarithmic axis.

    Parameters
    ----------
    series : Series
    order : int, optional
        Where to put the marker.
    size : (float, float)
        Inches at 100 dpi.
    """
    figure = Figure(figsize=size, dpi=100, facecolor=PAPER)
    FigureCanvasAgg(figure)
    axes = figure.add_axes((0.11, 0.13, 0.8, 0.77))
    draw_power(axes, series, order)
    figure.text(0.11, 0.935, "power that leaves all surfaces with each bounce", color=INK, fontsize=11)
    return figure


def _power_of_ten(value: float, _position: float) -> str:
    """A label of a logarithmic axis, in plain Unicode: mathtext takes thirty milliseconds for each."""
    exponent = round(math.log10(value))
    return str(10**exponent) if 0 <= exponent <= 2 else f"10{str(exponent).translate(display.SUPERSCRIPTS)}"


def draw_power(axes: Axes, series: Series, order: int | None = None) -> None:
    """Curves of power per bounce, one for each channel, named at their ends."""
    channels = series.power.shape[1]
    bounces = np.arange(series.last + 1)
    for c in range(channels):
        colour = CHANNEL_COLOURS[c] if channels == 3 else FAINT if channels > 1 else INK
        lit = series.power[:, c] > 0.0
        axes.plot(bounces[lit], series.power[lit, c], "-", color=colour, marker=CHANNEL_MARKS[c % 3], markersize=5)
        if channels == 3 and lit.any():
            end = bounces[lit][-1], series.power[lit, c][-1]
            axes.annotate(CHANNEL_NAMES[c], end, (8, 0), textcoords="offset points", color=colour, va="center")
    if (series.power > 0.0).any():
        axes.set_yscale("log")
        axes.yaxis.set_major_formatter(_power_of_ten)
        axes.minorticks_off()
    if order is not None:
        axes.axvline(order, color=HERE, linewidth=1.4, zorder=0)
    axes.set_facecolor(PAPER)
    axes.set_xlim(-0.4, series.last + (0.9 if channels == 3 else 0.4))
    axes.set_xticks(bounces if series.last <= 12 else columns(series.last))
    axes.set_xlabel("bounce $k$", color=INK)
    axes.set_ylabel(r"power of $T^k E$, W", color=INK)
    axes.tick_params(colors=FAINT)
    axes.grid(axis="y", color=FAINT, alpha=0.2)
    for side, spine in axes.spines.items():
        spine.set_visible(side in ("left", "bottom"))
        spine.set_color(FAINT)
