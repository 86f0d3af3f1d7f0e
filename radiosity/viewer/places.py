"""A picture of a scene that marks where something is wrong with it."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pyvista as pv
from numpy.typing import NDArray

from ..finding import Finding, Severity
from ..overlaps import scene_triangles
from ..scene import Scene
from . import probe
from .figures import save_image

PAPER, FACE, EDGE = "#ffffff", "#b9c0c9", "#7d8793"
COLOURS = {Severity.NOTE: "#2a78c2", Severity.WARNING: "#d98200", Severity.ERROR: "#c8202f"}
SHOWN = 60  # places of one finding
DOT = 14.0  # pixels


def write_places(scene: Scene, found: Sequence[Finding], path: str | Path, size: tuple[int, int] = (1000, 800)) -> Path:
    """Draw a scene as glass, with a dot at every place of every finding, numbered as they are listed.

    Errors are red, warnings orange, notes blue. The worst place of each bears its number.

    Parameters
    ----------
    scene : Scene
    found : sequence of Finding
        Of the scene, in the order of the list.
    path : path
        A PNG.
    size : (int, int), optional
        Pixels.

    Returns
    -------
    Path

    Raises
    ------
    DisplayError
        On a machine that cannot draw.
    """
    probe.require("off-screen")
    probe.hush()
    plotter = pv.Plotter(off_screen=True, window_size=size)
    plotter.set_background(PAPER)
    _draw_scene(plotter, scene)
    for severity in Severity:  # errors last, on top
        for number, one in enumerate(found, start=1):
            if one.severity is severity and len(one.places):
                _draw_places(plotter, one, number)
    plotter.enable_parallel_projection()
    plotter.camera_position = _position(scene)
    plotter.reset_camera()
    plotter.camera.zoom(1.15)
    plotter.render()
    image = np.asarray(plotter.screenshot(return_img=True))
    plotter.close()
    return save_image(path, image)


def _draw_scene(plotter: pv.Plotter, scene: Scene) -> None:
    corners, _, _ = scene_triangles(scene)
    mesh = pv.PolyData.from_regular_faces(corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3))
    plotter.add_mesh(mesh, color=FACE, opacity=0.25, lighting=False)
    edges = mesh.clean().extract_feature_edges(feature_angle=20, boundary_edges=True, non_manifold_edges=True)
    if edges.n_cells:
        plotter.add_mesh(edges, color=EDGE, line_width=1.5, lighting=False)


def _draw_places(plotter: pv.Plotter, one: Finding, number: int) -> None:
    colour = COLOURS[one.severity]
    plotter.add_points(one.places[:SHOWN], color=colour, point_size=DOT, render_points_as_spheres=True, lighting=False)
    plotter.add_point_labels(
        one.places[:1], [str(number)], text_color=colour, font_size=20, bold=True, shape=None, show_points=False,
        always_visible=True,
    )  # fmt: skip


def _position(scene: Scene) -> list[NDArray[np.float64]]:
    """From above, in front and to the right; y is up."""
    points = np.concatenate([surface.vertices for surface in scene.surfaces])
    low, high = points.min(axis=0), points.max(axis=0)
    middle, size = 0.5 * (low + high), float(np.linalg.norm(high - low)) or 1.0
    return [middle + 3.0 * size * np.array([0.45, 0.5, 0.75]), middle, np.array([0.0, 1.0, 0.0])]
