"""Pure functions on arrays of triangles (n, 3, 3) and quads (n, 4, 3), corners counter-clockwise."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]


def unit(vectors: FloatArray) -> FloatArray:
    """Vectors (…, 3) scaled to length one; zero vectors stay zero."""
    largest = np.abs(vectors).max(axis=-1, keepdims=True)
    scaled = vectors / np.where(largest > 0, largest, 1.0)  # no overflow, no underflow in the squares
    length = np.linalg.norm(scaled, axis=-1, keepdims=True)
    return scaled / np.where(length > 0, length, 1.0)


def cross(a: FloatArray, b: FloatArray) -> FloatArray:
    """Products a × b of vectors (…, 3): the bits of `numpy.cross`, which takes its time before it starts."""
    product = np.empty(a.shape)
    for k, i, j in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        np.multiply(a[..., i], b[..., j], out=product[..., k])
        product[..., k] -= a[..., j] * b[..., i]
    return product


def triangle_vector_areas(triangles: FloatArray) -> FloatArray:
    """½ (b - a) × (c - a) of triangles (n, 3, 3): area times normal, (n, 3)."""
    edges = triangles[:, 1:] - triangles[:, :1]
    return 0.5 * cross(edges[:, 0], edges[:, 1])


def quad_vector_areas(quads: FloatArray) -> FloatArray:
    """½ (c - a) × (d - b) of quads (n, 4, 3): the area enclosed times its mean normal, (n, 3)."""
    return 0.5 * cross(quads[:, 2] - quads[:, 0], quads[:, 3] - quads[:, 1])


def quad_jacobians(quads: FloatArray, normals: FloatArray) -> FloatArray:
    """Area density |∂P/∂u × ∂P/∂v| of the bilinear map at the four corners, (n, 4).

    Positive at all four if the quad is convex. On a planar quad the density is linear in (u, v), so its
    mean over any cell is its value in the cell's middle.
    """
    after = quads[:, [1, 2, 3, 0]] - quads
    before = quads[:, [3, 0, 1, 2]] - quads
    return np.einsum("nkx,nx->nk", cross(after, before), normals)


def quad_bends(quads: FloatArray) -> FloatArray:
    """Largest angle between the two triangles of a quad, over both ways to cut it, radians (n,)."""
    corner_normals = unit(cross(quads[:, [1, 2, 3, 0]] - quads, quads[:, [3, 0, 1, 2]] - quads))
    pairs = corner_normals[:, :2], corner_normals[:, 2:]
    sine = np.linalg.norm(cross(*pairs), axis=-1)
    cosine = np.einsum("nkx,nkx->nk", *pairs)
    return np.arctan2(sine, cosine).max(axis=1)


def quad_centroids(quads: FloatArray) -> FloatArray:
    """Centres of area of planar convex quads, (n, 3)."""
    first, second = quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]
    weights = np.stack([np.linalg.norm(triangle_vector_areas(t), axis=1) for t in (first, second)])
    share = weights / weights.sum(axis=0)
    return share[0, :, None] * first.mean(axis=1) + share[1, :, None] * second.mean(axis=1)


def longest_edges(polygons: FloatArray) -> FloatArray:
    """Longest edge of polygons (n, k, 3), (n,)."""
    return np.linalg.norm(np.roll(polygons, -1, axis=1) - polygons, axis=2).max(axis=1)
