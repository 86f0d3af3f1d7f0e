"""Words, boxes and curves on top of a pane, placed in shares of its width and height.

VTK's built-in font lacks Σ, superscripts and ρ, so words are set in the DejaVu fonts that matplotlib brings.
"""

from __future__ import annotations

import functools
from collections.abc import Sequence
from pathlib import Path
from typing import Literal

import matplotlib
import numpy as np
import pyvista as pv
from numpy.typing import ArrayLike, NDArray
from PIL import ImageFont
from vtkmodules.vtkCommonCore import VTK_FONT_FILE
from vtkmodules.vtkRenderingCore import (
    vtkActor2D,
    vtkCoordinate,
    vtkPolyDataMapper2D,
    vtkTextActor,
    vtkTexturedActor2D,
)

from .. import display
from .palette import CHANNEL_COLOURS as CHANNEL_COLOURS
from .palette import FAINT as FAINT
from .palette import HERE as HERE
from .palette import INK as INK
from .palette import PANEL as PANEL
from .palette import STRONG

DESIGN_HEIGHT = 900.0  # window height, in pixels, that font sizes are given for

Align = Literal["left", "center", "right"]


def font(style: str = "") -> str:
    """File of a DejaVu Sans style: "", "-Bold", "-Oblique"."""
    return str(Path(matplotlib.get_data_path()) / "fonts" / "ttf" / f"DejaVuSans{style}.ttf")


@functools.lru_cache(maxsize=64)
def _face(style: str, size: int) -> ImageFont.FreeTypeFont:
    return ImageFont.truetype(font(style), size)


@functools.lru_cache(maxsize=64)
def _bytes(colour: str) -> tuple[int, int, int]:
    red, green, blue = pv.Color(colour).int_rgb
    return red, green, blue


def wrap(text: str, width: float, size: float, style: str = "") -> list[str]:
    """Break a text into lines that are not wider than `width` pixels in letters of `size` pixels."""
    face = _face(style, max(6, round(size)))
    found = [""]
    for word in text.split(" "):
        longer = f"{found[-1]} {word}".strip()
        if face.getlength(longer) <= width or not found[-1]:
            found[-1] = longer
        else:
            found.append(word)
    return found


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
        self.style = style
        self.fitted: tuple[float, float, str] | None = None  # what the size was worked out for
        self.plain, self.strong = colour, False
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
        self.plain = colour
        self.property.SetColor(*pv.Color(STRONG.get(colour, colour) if self.strong else colour).float_rgb)

    def contrast(self, strong: bool) -> None:
        """Set the letters in stronger colours, for a projector, or in their own."""
        if strong == self.strong:
            return
        self.strong = strong
        self.colour(self.plain)

    def stand_at(self, point: ArrayLike) -> None:
        """Put the words where a point of the scene is seen, (3,)."""
        self.actor.GetPositionCoordinate().SetCoordinateSystemToWorld()
        self.actor.GetPositionCoordinate().SetValue(*np.asarray(point, dtype=np.float64))

    def scale(self, scale: float, room: float = 0.0) -> None:
        """Set the letters larger or smaller than designed; not wider than `room` pixels, if that is given."""
        if self.fitted == (scale, room, self.actor.GetInput()):
            return
        self.fitted = (scale, room, self.actor.GetInput())
        size = self.size * scale
        if room > 0.0 and (width := self.width(size)) > room:
            size *= room / width
        self.property.SetFontSize(max(6, round(size - 0.5 * (size < self.size * scale))))

    def width(self, size: float) -> float:
        """Pixels that the words take in letters of a size."""
        return _face(self.style, max(6, round(size))).getlength(self.actor.GetInput())

    def on_ground(self, opacity: float = 0.6) -> None:
        """Set the words on a dark ground, to be read on any picture."""
        self.property.SetBackgroundColor(*pv.Color(PANEL).float_rgb)
        self.property.SetBackgroundOpacity(opacity)

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
            colours = np.array([_bytes(colour) for colour in colours], dtype=np.uint8).reshape(-1, 3)
        mesh.cell_data.set_array(colours, "rgb")
        mesh.cell_data.active_scalars_name = "rgb"
        self.mapper.SetInputData(mesh)

    def show(self, visible: bool) -> None:
        """Show or hide."""
        self.actor.SetVisibility(visible)


class Raster:
    """A picture of pixels, as large as fits in the middle of a box, or in its lower left corner.

    Parameters
    ----------
    renderer : pyvista.Renderer
    box : (left, bottom, right, top)
        In shares of the pane.
    smooth : bool
        Blend neighbouring pixels.
    corner : bool
        Stand in the lower left corner.
    """

    def __init__(
        self,
        renderer: pv.Renderer,
        box: tuple[float, float, float, float] = (0.03, 0.03, 0.97, 0.97),
        *,
        smooth: bool = False,
        corner: bool = False,
    ) -> None:
        self.renderer, self.box, self.smooth, self.corner = renderer, box, smooth, corner
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
        middle = np.array([left + x, bottom + y, 0] if self.corner else [(left + right) / 2, (bottom + top) / 2, 0])
        corners = np.array([[-x, -y, 0], [x, -y, 0], [x, y, 0], [-x, y, 0]])
        self.mesh.points = middle + corners
        texture = pv.Texture(np.ascontiguousarray(image))
        texture.SetInterpolate(self.smooth)
        texture.SetMipmap(self.smooth)
        self.actor.SetTexture(texture)


class ScaleBar:
    """The colours of false colour and the numbers they stand for, along the lower edge of a title pane."""

    steps = 64

    def __init__(self, renderer: pv.Renderer, box: tuple[float, float, float, float]) -> None:
        self.renderer, self.box, self.shown = renderer, box, False
        self.strip = Shapes(renderer)
        left, bottom, right, top = box
        edges = np.linspace(left, right, self.steps + 1)
        boxes = np.column_stack([edges[:-1], np.full(self.steps, bottom), edges[1:], np.full(self.steps, top)])
        self.strip.boxes(boxes, display.false_colour(np.linspace(0.0, 1.0, self.steps), 0.0, 1.0))
        self.words = [Words(renderer, (0.0, 0.0), 12, colour=INK, align="center") for _ in range(8)]

    def update(self, low: float, high: float, visible: bool, unit: str = "W/m²") -> None:
        """Show a logarithmic scale, or nothing."""
        self.shown = visible
        self.strip.show(visible)
        left, bottom, right, _ = self.box
        ticks = display.scale_ticks(low, high, logarithmic=True)[: len(self.words)] if visible else []
        for i, words in enumerate(self.words):
            words.show(i < len(ticks))
            if i < len(ticks):
                share = np.log(ticks[i] / low) / np.log(high / low)
                words.actor.SetPosition(left + (right - left) * share, bottom - 0.14)
                words.say(f"{ticks[i]:g}" + (f" {unit}" if i == len(ticks) - 1 else ""))
