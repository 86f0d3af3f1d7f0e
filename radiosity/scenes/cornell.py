"""The Cornell box as it was measured."""

from __future__ import annotations

import numpy as np

from ..scene import Material, Scene, Surface
from . import cornell_data as data
from .build import FloatArray, Mesh, floor_around, paint, panel


def cornell_box(spectral: bool = False) -> Scene:
    """The measured Cornell box, in metres, with its lamp on and its front open to a black outside.

    Coordinates are the measured ones: y is up, z runs into the box, and seen from the open front (z = 0) x runs to
    the left, so that the red wall is on the left. Surfaces, all one-sided and facing into the room: floor, ceiling,
    lamp, back_wall, green_wall, red_wall, short_block, tall_block.

    The real box was no perfect one, and three things in its data need a word:

    - The red wall is bent: its fourth corner lies 3.2 mm off the plane of the others. The corners are kept, and the
      quad is divided into two triangles when the scene is cut into patches.
    - The lamp lies exactly in the plane of the ceiling. The ceiling has a hole there (eight rectangles around
      the lamp), so that no two faces coincide.
    - The blocks stand on the floor and have no bottoms. The floor is cut away under them: it would see nothing
      there, and the patches on the border would be too dark.

    Parameters
    ----------
    spectral : bool, optional
        False: three channels, linear sRGB primaries, lamp of radiance (17, 12, 4) W/(m² sr), so of exitance π times
        that. True: the 76 measured bands of 4 nm from 400 to 700 nm. The lamp's spectrum is known up to a factor only;
        its relative values (0, 8, 15.6, 18.4 at 400, 500, 600, 700 nm) are taken as radiance, W/(m² sr), of each band.
        Weighted by the CIE 1931 response ȳ they have a mean of 12.4, the luminance of the RGB lamp is 12.5: both
        scenes need the same exposure.

    Returns
    -------
    Scene
        With `closed` False.

    References
    ----------
    C. M. Goral, K. E. Torrance, D. P. Greenberg, B. Battaile, "Modeling the interaction of light between diffuse
    surfaces", SIGGRAPH 1984, doi:10.1145/964965.808601, for the idea; the data: see `cornell_data`.
    """
    materials = _materials(spectral)
    meshes = {name: _quads([corners]) for name, corners in data.GEOMETRY.items()}
    meshes |= {name: _quads(faces) for name, faces in data.BLOCKS.items()}
    meshes["floor"] = _floor()
    meshes["ceiling"] = _ceiling()
    paints = {"lamp": "lamp", "green_wall": "green", "red_wall": "red"}
    surfaces = [Surface(name, *mesh, materials[paints.get(name, "white")]) for name, mesh in meshes.items()]
    return Scene(tuple(surfaces), name="cornell_box_spectral" if spectral else "cornell_box", closed=False)


def _materials(spectral: bool) -> dict[str, Material]:
    table = data.REFLECTANCE if spectral else data.RGB
    radiance: FloatArray = np.array(data.RGB_LAMP_RADIANCE)
    if spectral:
        radiance = np.interp(data.WAVELENGTHS, *np.array(data.LAMP_SPECTRUM).T)
    materials = {name: paint(name, reflectance) for name, reflectance in table.items()}
    return materials | {"lamp": paint("lamp", np.full(radiance.size, data.LAMP_REFLECTANCE), radiance)}


def _metres(corners: object) -> FloatArray:
    return np.array(corners, dtype=np.float64) / 1000.0


def _quads(corners: object) -> Mesh:
    vertices = _metres(corners).reshape(-1, 3)
    return vertices, np.arange(len(vertices)).reshape(-1, 4)


def _floor() -> Mesh:
    """The measured trapezoid without the footprints of the blocks."""
    outline = _metres(data.GEOMETRY["floor"])[:, [0, 2]]
    return floor_around(outline, [_metres(faces[0])[:, [0, 2]] for faces in data.BLOCKS.values()])


def _ceiling() -> Mesh:
    ceiling, lamp = (_metres(data.GEOMETRY[name]) for name in ("ceiling", "lamp"))
    return panel(ceiling.min(axis=0), ceiling.max(axis=0), -1, [(lamp.min(axis=0), lamp.max(axis=0))])
