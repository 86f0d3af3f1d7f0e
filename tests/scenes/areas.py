"""Area vectors of surfaces, written plainly for the tests."""

import numpy as np


def triangles(surface):
    """Corners (T, 3, 3) of a surface's faces, each quad as two triangles."""
    first = surface.faces[:, [0, 1, 2]]
    if surface.faces.shape[1] == 3:
        return surface.vertices[first]
    quads = surface.faces[surface.faces[:, 3] >= 0]
    return surface.vertices[np.concatenate([first, quads[:, [0, 2, 3]]])]


def vector_areas(surface):
    """Area times normal of each triangle, (T, 3)."""
    a, b, c = np.moveaxis(triangles(surface), 1, 0)
    return 0.5 * np.cross(b - a, c - a)


def enclosed_volume(surfaces):
    """Volume (negative where normals point inwards) and total vector area of a closed mesh."""
    corners = np.concatenate([triangles(s) for s in surfaces])
    a, b, c = np.moveaxis(corners, 1, 0)
    area = 0.5 * np.cross(b - a, c - a)
    return float(np.einsum("nx,nx->", a, area) / 3), area.sum(axis=0)
