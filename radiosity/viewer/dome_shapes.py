"""Meshes and actors that a dome is drawn with: unit size, z along the normal."""

from __future__ import annotations

import numpy as np
import pyvista as pv
from numpy.typing import ArrayLike, NDArray

from .dome import on_dome

FloatArray = NDArray[np.float64]

RINGS, SECTORS = 30, 72  # of the mesh that the picture lies on


def line_actor(mesh: pv.PolyData, colour: str, width: float, opacity: float = 1.0) -> pv.Actor:
    """Lines in a plain colour."""
    mapper = pv.DataSetMapper(mesh)
    mapper.scalar_visibility = False
    return pv.Actor(mapper=mapper, prop=pv.Property(lighting=False, color=colour, line_width=width, opacity=opacity))


def texture(image: NDArray[np.uint8]) -> pv.Texture:
    """A picture to lie on a mesh: each pixel as it is."""
    made = pv.Texture(np.ascontiguousarray(image))
    made.SetInterpolate(False)
    made.SetMipmap(False)
    return made


def polyline(points: ArrayLike) -> pv.PolyData:
    """A line through points (n, 3)."""
    places = np.asarray(points, dtype=np.float64).reshape(-1, 3)
    return pv.PolyData(places, lines=[len(places), *range(len(places))])


def arrow(begin: FloatArray, neck: FloatArray, end: FloatArray) -> pv.PolyData:
    """A line with a head from `neck` to `end`."""
    along = end - begin
    side = np.cross(along, [0.0, 0.0, 1.0])
    length = np.linalg.norm(side)
    side = 0.045 * (side / length if length > 1e-9 else np.array([1.0, 0.0, 0.0]))
    points = np.array([begin, end, neck + side, neck - side])
    return pv.PolyData(points, lines=[2, 0, 1, 3, 2, 1, 3])


def ring(theta: float, count: int = 96, size: float = 1.0) -> pv.PolyData:
    """A circle of the dome."""
    return polyline([size * on_dome(theta, azimuth) for azimuth in np.linspace(0.0, 360.0, count + 1)])


def graticule() -> pv.PolyData:
    """Circles each 15° of θ and meridians each 30° of azimuth."""
    lines = [ring(theta) for theta in range(15, 91, 15)]
    lines += [polyline([on_dome(t, azimuth) for t in range(0, 91, 3)]) for azimuth in range(0, 360, 30)]
    points = np.concatenate([line.points for line in lines])
    cells, begin = [], 0
    for line in lines:
        cells += [line.n_points, *range(begin, begin + line.n_points)]
        begin += line.n_points
    return pv.PolyData(points, lines=cells)


def dome_mesh(*, flat: bool = False) -> pv.PolyData:
    """The unit dome seen from outside, or its shadow on the floor, with the coordinates of its picture."""
    theta, azimuth = np.meshgrid(np.linspace(0, 90, RINGS + 1), np.linspace(0, 360, SECTORS + 1), indexing="ij")
    points = np.array([on_dome(t, a) for t, a in zip(theta.ravel(), azimuth.ravel(), strict=True)])
    if flat:
        points[:, 2] = 0.0
    mesh = pv.PolyData(points, faces=_grid_faces())
    mesh.active_texture_coordinates = np.column_stack([azimuth.ravel() / 360.0, 1.0 - theta.ravel() / 90.0])
    return mesh


def lobe_mesh() -> pv.PolyData:
    """A surface whose points stand in all directions of the dome, which "direction" keeps."""
    mesh = dome_mesh()
    mesh.point_data["direction"] = np.asarray(mesh.points, dtype=np.float64)
    return mesh


def _grid_faces() -> NDArray[np.int64]:
    """Quads between the rings and sectors of the mesh, counter-clockwise from outside."""
    width = SECTORS + 1
    first = (np.arange(RINGS)[:, None] * width + np.arange(SECTORS)).ravel()
    quads = np.column_stack([first, first + width, first + width + 1, first + 1])
    return np.column_stack([np.full(len(quads), 4), quads]).ravel()
