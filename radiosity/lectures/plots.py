"""Plots inside a lecture: an empty one in the viewer's colours, and a plot as pixels."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..viewer.overlay import FAINT, HERE, INK, PANEL

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["COLOURS", "FAINT", "HERE", "INK", "legend", "pixels", "plot", "save_svg"]

SIZE = (4.8, 5.2)  # inches: the shape of a pane
COLOURS = ("#5b8def", "#ff7043", "#5fb346", "#d9b44a", "#b07cd8", "#9aa3ae")  # for curves, in this order


def plot(x: str, y: str, *, log: str = "", title: str = "") -> tuple[Figure, Axes]:
    """An empty plot for a lecture.

    Parameters
    ----------
    x, y : str
        What the axes are.
    log : str
        Which axes are logarithmic: "x", "y", "xy".
    title : str

    Returns
    -------
    (Figure, Axes)
        Draw into the axes, return the figure.
    """
    from cycler import cycler
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure
    from matplotlib.ticker import NullFormatter

    figure = Figure(figsize=SIZE, dpi=100, facecolor=PANEL)
    FigureCanvasAgg(figure)
    axes = figure.add_axes((0.21, 0.13, 0.75, 0.77))
    axes.set_prop_cycle(cycler(color=COLOURS))
    axes.set_facecolor(PANEL)
    axes.set_xlabel(x, color=INK, fontsize=12)
    axes.set_ylabel(y, color=INK, fontsize=12)
    axes.set_title(title, color=INK, fontsize=13, loc="left", pad=12)
    if "x" in log:
        axes.set_xscale("log")
        axes.xaxis.set_minor_formatter(NullFormatter())
    if "y" in log:
        axes.set_yscale("log")
    axes.tick_params(which="both", colors=FAINT, labelsize=10.5)
    axes.grid(color=FAINT, alpha=0.18)
    for side, spine in axes.spines.items():
        spine.set_visible(side in ("left", "bottom"))
        spine.set_color(FAINT)
    return figure, axes


def legend(axes: Axes, place: str = "best") -> None:
    """Name the curves of a plot."""
    axes.legend(loc=place, frameon=False, labelcolor=INK, fontsize=11)


def pixels(figure: Figure, dpi: float = 200.0) -> NDArray[np.uint8]:
    """A figure as pixels (height, width, 3)."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    figure.set_dpi(dpi)
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    return np.asarray(canvas.buffer_rgba())[..., :3].copy()


def save_svg(figure: Figure) -> str:
    """A figure as SVG, the letters as curves, so that it looks the same everywhere."""
    import io

    import matplotlib

    file = io.StringIO()
    with matplotlib.rc_context({"svg.fonttype": "path", "svg.hashsalt": "radiosity"}):
        figure.savefig(file, format="svg", facecolor=figure.get_facecolor(), metadata={"Date": None})
    text = file.getvalue()
    return text[text.index("<svg") :]
