"""Patches in a pane of a pyvista plotter, coloured as the state says. Shared by the window and the figures."""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING

import numpy as np
import pyvista as pv
from numpy.typing import NDArray
from scipy.sparse import csr_array
from vtkmodules.util.numpy_support import numpy_to_vtk

from ..camera import Camera
from .mesh import corner_weights, patch_mesh
from .state import Pane, Series, ViewState, coloured, picture

if TYPE_CHECKING:
    from ..patches import Patches

BACKGROUND = "#262b33"  # not black, so that unlit surfaces and the void around them look different
BACK_COLOUR = "#ff8c00"
EDGE_COLOUR = "#8a93a0"


class Drawing:
    """The patches of one solution in one pane, and the backs of the faces.

    Faces that look away are left out (one-sided walls are black from behind, and would hide the room), which makes a
    closed room a doll's house when it is seen from outside.

    Every patch has corners of its own, and the colours are theirs: a flat patch has four times the same. Without a
    graphics card that is a fifth quicker than a colour for each cell, which VTK looks up again for every pixel.

    Parameters
    ----------
    plotter : pyvista.Plotter
        Drawing goes to its active renderer.
    patches : Patches
    pane : {"order", "sum"}

    Attributes
    ----------
    colours : ndarray of uint8 (N, 4, 3)
        What is drawn, at the corners of each patch; VTK reads this memory.
    """

    def __init__(self, plotter: pv.Plotter, patches: Patches, pane: Pane) -> None:
        self.patches = patches
        self.pane = pane
        self.plotter = plotter
        self.renderer = plotter.renderer
        self.renderer.SetBackground(pv.Color(BACKGROUND).float_rgb)
        self.mesh = patch_mesh(patches)
        self.colours = np.zeros((len(patches), 4, 3), dtype=np.uint8)
        self._stored = numpy_to_vtk(self.colours.reshape(-1, 3))
        self._stored.SetName("rgb")
        self.mesh.GetPointData().AddArray(self._stored)
        actor = pv.Actor(mapper=_colour_mapper(self.mesh), prop=_flat_property("back"))
        self.actor = self.renderer.add_actor(actor, reset_camera=False, render=False)[0]

    @functools.cached_property
    def weights(self) -> csr_array:
        """From the light of patches to that of their corners in the smooth view, worked out when it is asked for."""
        return corner_weights(self.patches).astype(np.float32)

    @functools.cached_property
    def backs(self) -> pv.Actor:
        """The same faces seen from behind, in a signal colour."""
        mapper = pv.DataSetMapper(self.mesh)
        mapper.scalar_visibility = False
        prop = _flat_property("front")
        prop.color = BACK_COLOUR
        return self.renderer.add_actor(pv.Actor(mapper=mapper, prop=prop), reset_camera=False, render=False)[0]

    def draw(self, series: Series, state: ViewState, colours: NDArray[np.uint8] | None = None) -> None:
        """Bring the pane up to date; the caller renders.

        Parameters
        ----------
        series : Series
        state : ViewState
        colours : ndarray of uint8 (N, 3), optional
            Shown instead of the picture of the state.
        """
        if state.smooth and colours is None:
            light = self.weights @ series.light(state, self.pane)
            self.colours[...] = coloured(series, state, self.pane, light).reshape(self.colours.shape)
        else:
            self.colours[...] = (picture(series, state, self.pane) if colours is None else colours)[:, None]
        self._stored.Modified()
        self.actor.visibility = True
        self.actor.prop.show_edges = state.wireframe
        if state.backs or "backs" in self.__dict__:
            self.backs.visibility = state.backs

    def hide(self) -> None:
        """Leave the pane to something else, until `draw` is called again."""
        for actor in (self.actor, self.__dict__.get("backs")):
            if actor is not None:
                actor.visibility = False

    def look(self, camera: Camera) -> None:
        """Put the camera of the pane to a preset."""
        place(self.renderer, camera)


def place(renderer: pv.Renderer, camera: Camera) -> None:
    """Set the camera of a renderer."""
    renderer.camera.position = camera.position
    renderer.camera.focal_point = camera.focal_point
    renderer.camera.up = camera.up
    renderer.camera.view_angle = camera.fov
    width, height = renderer.GetSize()
    renderer.camera.SetUseHorizontalViewAngle(width < height)  # in a narrow pane the picture is cut at neither side
    renderer.camera_set = True
    renderer.ResetCameraClippingRange()


def _colour_mapper(mesh: pv.PolyData) -> pv.DataSetMapper:
    """Takes the bytes of "rgb", of points, as they are."""
    mapper = pv.DataSetMapper(mesh)
    mapper.SetScalarModeToUsePointFieldData()
    mapper.SelectColorArray("rgb")
    mapper.SetColorModeToDirectScalars()
    mapper.scalar_visibility = True
    return mapper


def _flat_property(culling: str) -> pv.Property:
    """Unlit: the colours are the light."""
    prop = pv.Property(lighting=False, culling=culling, edge_color=EDGE_COLOUR, line_width=1.0)
    prop.interpolation = "flat"
    return prop
