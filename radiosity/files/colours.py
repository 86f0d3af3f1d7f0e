"""Meshes with a colour per face, as surfaces with one material each."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..display import encode_srgb
from ..scene import FloatArray, IntArray, Material, Surface
from .cut import compact, narrow
from .names import unique_names
from .notes import Notes

MOST = 256
"""Surfaces that one mesh is divided into at most."""


def surfaces_by_colour(
    name: str, vertices: FloatArray, faces: IntArray, reflectance: FloatArray, base: Material, notes: Notes
) -> list[Surface]:
    """Divide a mesh into surfaces of one colour.

    A mesh with more than `MOST` colours is divided by similar ones; each surface then has the mean of its faces,
    weighted by area, so that as much light is reflected on the whole.

    Parameters
    ----------
    name : str
        Of the mesh; the surfaces are named by it and their colour in hexadecimal sRGB.
    vertices : ndarray (V, 3)
    faces : ndarray of int (M, 3) or (M, 4)
    reflectance : ndarray (M, 3) or (M, 6)
        RGB, linear, per face; three more columns: emission, W/m².
    base : Material
        Name, sides and, where there are no columns for it, emission of them all.
    notes : Notes
        Takes what is approximated.
    """
    values, group = np.unique(reflectance, axis=0, return_inverse=True)
    group = group.reshape(-1)
    if len(values) > MOST:
        group = _similar(reflectance)
        notes.say(f"{name!r} has {len(values)} colours; similar ones are put together, {group.max() + 1} in all")
        weight = _areas(vertices, faces)
        total = np.bincount(group, weight)
        sums = np.column_stack([np.bincount(group, weight * column) for column in reflectance.T])
        values = sums / np.where(total > 0, total, 1.0)[:, None]
    parts = [_part(values[k], vertices, faces[group == k], base) for k in range(len(values))]
    if len(parts) == 1:
        names = [name]
    else:
        names = unique_names([f"{name}_{encode_srgb(value[:3]).tobytes().hex()}" for value in values], Notes())
    return [Surface(n, *mesh, material) for n, (mesh, material) in zip(names, parts, strict=True)]


def _part(
    value: FloatArray, vertices: FloatArray, faces: IntArray, base: Material
) -> tuple[tuple[FloatArray, IntArray], Material]:
    emission = value[3:] if value.size > 3 else base.emission
    material = Material(value[:3], emission=emission, two_sided=base.two_sided, name=base.name)
    return compact(vertices, narrow(faces)), material


def _similar(values: FloatArray) -> NDArray[np.int64]:
    """Groups (M,) of similar rows: as fine a grid of square roots, which suits the eye, as leaves at most `MOST`."""
    scale = np.sqrt(values / np.maximum(values.max(axis=0), 1e-300))
    for levels in (64, 32, 16, 8, 6, 4, 3, 2):
        cells, group = np.unique(np.minimum((scale * levels).astype(np.int64), levels - 1), axis=0, return_inverse=True)
        if len(cells) <= MOST:
            return group.reshape(-1)
    return np.zeros(len(values), dtype=np.int64)


def _areas(vertices: FloatArray, faces: IntArray) -> FloatArray:
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    d = c if faces.shape[1] == 3 else np.where(faces[:, 3:] >= 0, vertices[faces[:, 3]], c)
    return np.asarray(np.linalg.norm(np.cross(c - a, d - b), axis=1) / 2)
