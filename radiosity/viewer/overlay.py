"""Words, boxes and curves on top of a pane, placed in shares of its width and height.

VTK's built-in font lacks Σ, superscripts and ρ, so words are set in the DejaVu fonts that matplotlib brings.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import matplotlib
import numpy as np
import pyvista as pv
from numpy.typing import ArrayLike, NDArray
from vtkmodules.vtkCommonCore import VTK_FONT_FILE
from vtkmodules.vtkRenderingCore import (
    vtkActor2D,
    vtkCoordinate,
    vtkPolyDataMapper2D,
    vtkTextActor,
    vtkTexturedActor2D,
)

from .. import display

if TYPE_CHECKING:
    from .state import Series

DESIGN_HEIGHT = 900.0  # window height, in pixels, that font sizes are given for
PANEL = "#15181d"
INK = "#e8eaed"
FAINT = "#9aa3ae"
HERE = "#ff7043"
CHANNEL_COLOURS = ("#e4572e", "#5fb346", "#5b8def")

Align = Literal["left", "center", "right"]


def font(style: str = "") -> str:
    """File of a DejaVu Sans style: "", "-Bold", "-Oblique"."""
    return str(Path(matplotlib.get_data_path()) / "fonts" / "ttf" / f"DejaVuSans{style}.ttf")


class Words:
    """A few words that can change.

    Parameters
    ----------
    renderer : pyvista.Renderer
    place : (float, float)
        Shares of the pane's width and height, from its lower left.
    size : float
        Pixels in a window 900 pixels high; `scale` adapts it to others.
    """

    def __init__(
        self,
        renderer: pv.Renderer,
        place: tuple[float, float],
        size: float,
        *,
        colour: str = INK,
        align: Align = "left",
        vertical: Literal["bottom", "center", "top"] = "center",
        style: str = "",
        words: str = "",
    ) -> None:
        self.size = size
        self.actor = vtkTextActor()
        self.actor.SetTextScaleModeToNone()
        self.actor.GetPositionCoordinate().SetCoordinateSystemToNormalizedViewport()
        self.actor.SetPosition(*place)
        prop = self.property = self.actor.GetTextProperty()
        prop.SetFontFamily(VTK_FONT_FILE)
        prop.SetFontFile(font(style))
        self.colour(colour)
        prop.SetJustificationToLeft()
        if align != "left":
            (prop.SetJustificationToCentered if align == "center" else prop.SetJustificationToRight)()
        {"bottom": prop.SetVerticalJustificationToBottom, "center": prop.SetVerticalJustificationToCentered}.get(
            vertical, prop.SetVerticalJustificationToTop
        )()
        prop.SetLineSpacing(1.3)
        self.scale(1.0)
        self.say(words)
        renderer.AddViewProp(self.actor)

    def say(self, words: str) -> None:
        """Show other words."""
        self.actor.SetInput(words)

    def colour(self, colour: str) -> None:
        """Set the letters in another colour."""
        self.property.SetColor(*pv.Color(colour).float_rgb)

    def scale(self, scale: float) -> None:
        """Set the letters larger or smaller than designed."""
        self.property.SetFontSize(max(6, round(self.size * scale)))

    def show(self, visible: bool) -> None:
        """Show or hide."""
        self.actor.SetVisibility(visible)


class Shapes:
    """Boxes, or one polyline, in plain colours.

    Parameters
    ----------
    renderer : pyvista.Renderer
    opacity : float
    width : float
        Of lines, pixels.
    """

    def __init__(self, renderer: pv.Renderer, *, opacity: float = 1.0, width: float = 1.0) -> None:
        place = vtkCoordinate()
        place.SetCoordinateSystemToNormalizedViewport()
        self.mapper = vtkPolyDataMapper2D()
        self.mapper.SetTransformCoordinate(place)
        self.mapper.SetColorModeToDirectScalars()
        self.mapper.SetScalarModeToUseCellData()
        self.actor = vtkActor2D()
        self.actor.SetMapper(self.mapper)
        self.actor.GetProperty().SetOpacity(opacity)
        self.actor.GetProperty().SetLineWidth(width)
        renderer.AddViewProp(self.actor)

    def boxes(self, boxes: ArrayLike, colours: Sequence[str] | NDArray[np.uint8]) -> None:
        """Show boxes (left, bottom, right, top), each in its colour."""
        sides = np.asarray(boxes, dtype=np.float64).reshape(-1, 4)
        corners = sides[:, [[0, 1], [2, 1], [2, 3], [0, 3]]].reshape(-1, 2)
        faces = np.column_stack([np.full(len(sides), 4), np.arange(4 * len(sides)).reshape(-1, 4)])
        mesh = pv.PolyData(np.column_stack([corners, np.zeros(len(corners))]), faces=faces.ravel())
        self._set(mesh, colours)

    def lines(self, points: ArrayLike, colour: str) -> None:
        """Show a polyline through points (n, 2)."""
        places = np.asarray(points, dtype=np.float64).reshape(-1, 2)
        lines = np.concatenate([[len(places)], np.arange(len(places))])
        self._set(pv.PolyData(np.column_stack([places, np.zeros(len(places))]), lines=lines), [colour])

    def _set(self, mesh: pv.PolyData, colours: Sequence[str] | NDArray[np.uint8]) -> None:
        if not isinstance(colours, np.ndarray):
            colours = np.array([pv.Color(colour).int_rgb for colour in colours], dtype=np.uint8).reshape(-1, 3)
        mesh.cell_data.set_array(colours, "rgb")
        mesh.cell_data.active_scalars_name = "rgb"
        self.mapper.SetInputData(mesh)

    def show(self, visible: bool) -> None:
        """Show or hide."""
        self.actor.SetVisibility(visible)


class Raster:
    """A picture of pixels, as large as fits in the middle of a box.

    Parameters
    ----------
    renderer : pyvista.Renderer
    box : (left, bottom, right, top)
        In shares of the pane.
    smooth : bool
        Blend neighbouring pixels.
    """

    def __init__(
        self,
        renderer: pv.Renderer,
        box: tuple[float, float, float, float] = (0.03, 0.03, 0.97, 0.97),
        *,
        smooth: bool = False,
    ) -> None:
        self.renderer, self.box, self.smooth = renderer, box, smooth
        place = vtkCoordinate()
        place.SetCoordinateSystemToNormalizedViewport()
        self.mesh = pv.PolyData(np.zeros((4, 3)), faces=[4, 0, 1, 2, 3])
        self.mesh.active_texture_coordinates = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], dtype=np.float32)
        mapper = vtkPolyDataMapper2D()
        mapper.SetInputData(self.mesh)
        mapper.SetTransformCoordinate(place)
        self.actor = vtkTexturedActor2D()
        self.actor.SetMapper(mapper)
        self.actor.VisibilityOff()
        renderer.AddViewProp(self.actor)

    def show(self, image: NDArray[np.uint8] | None) -> None:
        """Show a picture (height, width, 3), or nothing."""
        self.actor.SetVisibility(image is not None)
        if image is None:
            return
        width, height = self.renderer.GetSize()
        left, bottom, right, top = self.box
        size = min((right - left) * width / image.shape[1], (top - bottom) * height / image.shape[0])
        x, y = (size * image.shape[1] / width / 2, size * image.shape[0] / height / 2)
        middle = np.array([(left + right) / 2, (bottom + top) / 2, 0])
        corners = np.array([[-x, -y, 0], [x, -y, 0], [x, y, 0], [-x, y, 0]])
        self.mesh.points = middle + corners
        texture = pv.Texture(np.ascontiguousarray(image))
        texture.SetInterpolate(self.smooth)
        texture.SetMipmap(self.smooth)
        self.actor.SetTexture(texture)


class PowerPanel:
    """Power per bounce on a logarithmic axis, with a marker at the bounce that is shown.

    Parameters
    ----------
    renderer : pyvista.Renderer
    series : Series
    box : (left, bottom, right, top)
        Of the curves, in shares of the pane; words stand around it.
    """

    def __init__(self, renderer: pv.Renderer, series: Series, box: tuple[float, float, float, float]) -> None:
        self.box = box
        self.power = series.power
        self.low, self.high = _decades(series.power)
        left, bottom, right, top = box
        self.words = [
            Words(renderer, (left, top + 0.09), 15, colour=INK, words="power per bounce, W"),
            Words(renderer, ((left + right) / 2, bottom - 0.2), 13, colour=FAINT, align="center", words="bounce k"),
        ]
        self.marker = Shapes(renderer, width=2.0)
        self.patch_curve = Shapes(renderer, width=1.5)
        grid = Shapes(renderer, opacity=0.5)
        levels = range(self.low, self.high + 1, max(1, (self.high - self.low + 3) // 4))
        grid.boxes(
            [(left, self._y(10.0**n) - 0.003, right, self._y(10.0**n) + 0.003) for n in levels],
            ["#4a525d"] * len(levels),
        )
        for n in levels:
            self.words.append(
                Words(renderer, (left - 0.008, self._y(10.0**n)), 12, colour=FAINT, align="right", words=_ten(n))
            )
        for k in range(0, series.last + 1, max(1, round(series.last / 10))):
            self.words.append(
                Words(renderer, (self._x(k), bottom - 0.08), 12, colour=FAINT, align="center", words=str(k))
            )
        self._curves(renderer)

    def _curves(self, renderer: pv.Renderer) -> None:
        channels = self.power.shape[1]
        for c in range(channels):
            colour = CHANNEL_COLOURS[c] if channels == 3 else INK
            lit = np.flatnonzero(self.power[:, c] >= 10.0**self.low)
            if lit.size:
                points = [(self._x(k), self._y(self.power[k, c])) for k in lit]
                Shapes(renderer, width=2.0).lines(points, colour)
                dots = Shapes(renderer)
                dots.boxes([(x - 0.003, y - 0.018, x + 0.003, y + 0.018) for x, y in points], [colour] * len(points))

    def _x(self, order: Any) -> float:
        left, _, right, _ = self.box
        return left + (right - left) * (order + 0.5) / len(self.power)

    def _y(self, power: float) -> float:
        _, bottom, _, top = self.box
        return bottom + (top - bottom) * (np.log10(power) - self.low) / (self.high - self.low)

    def mark(self, order: int) -> None:
        """Put the marker at a bounce."""
        x = self._x(order)
        self.marker.boxes([(x - 0.0015, self.box[1], x + 0.0015, self.box[3])], [HERE])

    def show_patch(self, light: NDArray[np.floating[Any]] | None) -> None:
        """Add the shape of one patch's light by order (K + 1,), lifted to the top of the panel; or take it away."""
        shown = light is not None and bool((light > 0).sum() > 1)
        self.patch_curve.show(shown)
        if light is not None and shown:
            lifted = light * (10.0**self.high / light.max())
            orders = np.flatnonzero(lifted >= 10.0**self.low)
            self.patch_curve.lines([(self._x(k), self._y(lifted[k])) for k in orders], INK)


def _decades(power: NDArray[np.float64], most: int = 8) -> tuple[int, int]:
    """Powers of ten around positive values, not more than `most` apart."""
    positive = power[power > 0.0]
    if positive.size == 0:
        return (0, 1)
    high = int(np.ceil(np.log10(positive.max()) + 1e-9))
    low = int(np.floor(np.log10(positive.min()) - 1e-9))
    return (max(low, high - most), high)


def _ten(power: int) -> str:
    """A power of ten for an axis.

    >>> _ten(-2), _ten(1)
    ('10⁻²', '10')
    """
    if power in (0, 1):
        return "1" if power == 0 else "10"
    return "10" + str(power).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))


class ScaleBar:
    """The colours of false colour and the numbers they stand for, along the lower edge of a title pane."""

    steps = 64

    def __init__(self, renderer: pv.Renderer, box: tuple[float, float, float, float]) -> None:
        self.renderer, self.box = renderer, box
        self.strip = Shapes(renderer)
        left, bottom, right, top = box
        edges = np.linspace(left, right, self.steps + 1)
        boxes = np.column_stack([edges[:-1], np.full(self.steps, bottom), edges[1:], np.full(self.steps, top)])
        self.strip.boxes(boxes, display.false_colour(np.linspace(0.0, 1.0, self.steps), 0.0, 1.0))
        self.words = [Words(renderer, (0.0, 0.0), 12, colour=INK, align="center") for _ in range(8)]

    def update(self, low: float, high: float, visible: bool, unit: str = "W/m²") -> None:
        """Show a logarithmic scale, or nothing."""
        self.strip.show(visible)
        left, bottom, right, _ = self.box
        ticks = display.scale_ticks(low, high, logarithmic=True)[: len(self.words)] if visible else []
        for i, words in enumerate(self.words):
            words.show(i < len(ticks))
            if i < len(ticks):
                share = np.log(ticks[i] / low) / np.log(high / low)
                words.actor.SetPosition(left + (right - left) * share, bottom - 0.14)
                words.say(f"{ticks[i]:g}" + (f" {unit}" if i == len(ticks) - 1 else ""))
