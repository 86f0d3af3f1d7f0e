"""What glTF cannot hold exactly, kept in its `extras`, and how it is checked against the plain part.

glTF has float32 corners, triangles and RGB. A scene has float64 corners, quads, any number of channels, absorptance,
emission, a sky. Both are written: the plain part for every program, the exact part for us. A program that edits the
file may carry the extras along unchanged, so they count only where they still agree with the plain part.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import FileFormatError, MaterialError
from ..scene import FloatArray, IntArray, Material
from . import checked
from .checked import JSON
from .gltf_accessors import Accessors

KEY = "radiosity"
STRENGTH = "KHR_materials_emissive_strength"
VERTICES, FACES = np.dtype("<f8"), np.dtype("<i4")


def plain_triangles(faces: IntArray) -> IntArray:
    """Triangles (T, 3) of faces (M, 3) or (M, 4): each quad a, b, c, d as a, b, c and a, c, d, one after the other."""
    if faces.shape[1] == 3:
        return faces
    both = faces[:, [[0, 1, 2], [0, 2, 3]]]
    keep = np.column_stack([np.ones(len(faces), dtype=bool), faces[:, 3] >= 0])
    return both[keep]


def plain_colour(values: FloatArray) -> list[float]:
    """RGB of one value per channel: as they are for 3, and grey (their mean) for any other number."""
    return [float(v) for v in values] if values.size == 3 else [float((values / values.size).sum())] * 3


def plain_material(material: Material) -> JSON:
    """A material as glTF has it: base colour = reflectance, emissive factor × strength = emission / π."""
    radiance = np.array(plain_colour(material.emission / np.pi))
    strength = float(radiance.max())
    result: JSON = {
        "pbrMetallicRoughness": {
            "baseColorFactor": [*plain_colour(material.reflectance), 1.0],
            "metallicFactor": 0.0,
            "roughnessFactor": 1.0,
        },
        "doubleSided": material.two_sided,
    }
    if strength > 0:
        result["emissiveFactor"] = [float(v) for v in np.minimum(radiance / strength, 1.0)]
        result["extensions"] = {STRENGTH: {"emissiveStrength": strength}}
    return result


def material_extras(material: Material) -> JSON:
    """The exact values of a material; JSON keeps every bit of a float64."""
    return {material.given: getattr(material, material.given).tolist(), "emission": material.emission.tolist()}


def exact_material(extras: JSON, plain: Material, where: str) -> Material | None:
    """The material of its extras, or None where it does not agree with the plain one any more.

    Parameters
    ----------
    extras : dict
        What `material_extras` wrote.
    plain : Material
        As read from the plain part of the file.
    """
    given = "absorptance" if "absorptance" in extras else "reflectance"
    value = checked.numbers(extras, given, where, None, ())
    emission = checked.numbers(extras, "emission", where, None, ())
    try:
        exact = Material(**{given: value}, emission=emission, two_sided=plain.two_sided, name=plain.name)
    except MaterialError:
        return None
    pairs = ((exact.reflectance, plain.reflectance), (exact.emission / np.pi, plain.emission / np.pi))
    agree = all(np.allclose(plain_colour(a), b, rtol=1e-6, atol=1e-9 * float(b.max())) for a, b in pairs)
    return exact if agree else None


def needs_exact_geometry(vertices: FloatArray, faces: IntArray) -> bool:
    """Whether float32 corners and triangles would lose something."""
    return faces.shape[1] == 4 or not np.array_equal(vertices.astype(np.float32).astype(np.float64), vertices)


def exact_geometry(
    extras: JSON, accessors: Accessors, positions: NDArray[Any], triangles: IntArray, where: str
) -> tuple[FloatArray, IntArray] | None:
    """Vertices and faces of a node's extras, or None where they do not agree with the plain mesh any more."""
    vertices = _array(extras, "vertices", accessors, VERTICES, 3, where)
    faces = _array(extras, "faces", accessors, FACES, None, where).astype(np.int64)
    if vertices.shape != positions.shape or faces.shape[1] not in (3, 4):
        return None
    with np.errstate(over="ignore", invalid="ignore"):  # numbers that nobody has checked yet
        if not np.array_equal(vertices.astype(np.float32), positions):
            return None
    return (vertices, faces) if np.array_equal(plain_triangles(faces), triangles) else None


def _array(
    extras: JSON, key: str, accessors: Accessors, dtype: np.dtype[Any], width: int | None, where: str
) -> NDArray[Any]:
    part, where = checked.mapping(extras, key, where), f"{where}.{key}"
    rows = checked.integer(part, "rows", where, low=1)
    columns = width or checked.integer(part, "columns", where, low=3, high=4)
    data, _ = accessors.view(part, "bufferView", where)
    if rows * columns * dtype.itemsize != len(data):
        raise FileFormatError(f"{where} is {rows} × {columns} in {len(data)} bytes of {dtype}")
    return np.frombuffer(data, dtype).reshape(rows, columns)
