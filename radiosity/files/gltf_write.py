"""Scenes written as .glb or .gltf: plain glTF that every program reads, with the exact values in its extras."""

from __future__ import annotations

import base64
import json
import struct
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._version import __version__
from ..errors import FileFormatError
from ..scene import Material, Scene, Surface
from .atomic import write_bytes
from .checked import JSON
from .gltf_container import CHUNK_BIN, CHUNK_JSON, MAGIC
from .gltf_exact import (
    FACES,
    KEY,
    STRENGTH,
    VERTICES,
    material_extras,
    needs_exact_geometry,
    plain_material,
    plain_triangles,
)

FLOAT, UNSIGNED_INT, ARRAY_BUFFER, ELEMENT_ARRAY_BUFFER = 5126, 5125, 34962, 34963
LARGEST = float(np.finfo(np.float32).max)


def write_gltf(scene: Scene, path: Path) -> None:
    """Write a scene as .glb (binary) or .gltf (JSON with its buffer as base64), whole or not at all.

    The plain part holds one node and mesh per surface, named alike, corners as float32, quads as two triangles,
    materials as reflectance and emission / π; channels other than 1 or 3 show as grey there.

    Raises
    ------
    FileFormatError
        A coordinate beyond the range of float32.
    """
    document, binary = _Writer().document(scene)
    if path.suffix.lower() == ".gltf":
        uri = "data:application/octet-stream;base64," + base64.b64encode(binary).decode("ascii")
        document["buffers"][0]["uri"] = uri
        write_bytes(path, json.dumps(document, allow_nan=False, indent=1).encode("ascii"))
        return
    write_bytes(path, glb(document, binary))


def glb(document: JSON, binary: bytes) -> bytes:
    """A GLB of a document and its one buffer (glTF 2.0 specification, section 4.4).

    Raises
    ------
    FileFormatError
        More than the 4 GiB that the format holds.
    """
    text = json.dumps(document, allow_nan=False, separators=(",", ":")).encode("ascii")
    text += b" " * (-len(text) % 4)
    binary += b"\0" * (-len(binary) % 4)
    chunks = struct.pack("<II", len(text), CHUNK_JSON) + text + struct.pack("<II", len(binary), CHUNK_BIN) + binary
    if len(chunks) + 12 >= 2**32:
        raise FileFormatError(f"the scene needs {len(chunks) + 12} bytes, a GLB holds 4 GiB; write .gltf")
    return struct.pack("<III", MAGIC, 2, len(chunks) + 12) + chunks


class _Writer:
    """Collects the parts of one document; equal arrays and equal materials are written once."""

    def __init__(self) -> None:
        self.binary = bytearray()
        self.views: list[JSON] = []
        self.accessors: list[JSON] = []
        self.materials: list[JSON] = []
        self._known: dict[Any, int] = {}

    def document(self, scene: Scene) -> tuple[JSON, bytes]:
        primitives = [self._primitive(surface) for surface in scene.surfaces]
        nodes = [self._node(k, surface) for k, surface in enumerate(scene.surfaces)]
        extras = {"version": 1, "name": scene.name, "sky": scene.sky.tolist(), "closed": scene.closed}
        document: JSON = {
            "asset": {"version": "2.0", "generator": f"radiosity {__version__}"},
            "scene": 0,
            "scenes": [{"name": scene.name, "nodes": list(range(len(nodes))), "extras": {KEY: extras}}],
            "nodes": nodes,
            "meshes": [{"name": s.name, "primitives": [p]} for s, p in zip(scene.surfaces, primitives, strict=True)],
            "materials": self.materials,
            "accessors": self.accessors,
            "bufferViews": self.views,
            "buffers": [{"byteLength": len(self.binary)}],
        }
        if any("extensions" in material for material in self.materials):
            document["extensionsUsed"] = [STRENGTH]
        return document, bytes(self.binary)

    def _primitive(self, surface: Surface) -> JSON:
        furthest = float(np.abs(surface.vertices).max())
        if furthest > LARGEST:
            raise FileFormatError(
                f"surface {surface.name!r} reaches {furthest:g} m, glTF {LARGEST:.3g}; choose a larger unit of length"
            )
        positions = surface.vertices.astype("<f4")
        triangles = plain_triangles(surface.faces).astype("<u4")
        bounds = {"min": positions.min(axis=0).tolist(), "max": positions.max(axis=0).tolist()}
        return {
            "attributes": {"POSITION": self._accessor(positions, "VEC3", FLOAT, ARRAY_BUFFER, bounds)},
            "indices": self._accessor(triangles.reshape(-1), "SCALAR", UNSIGNED_INT, ELEMENT_ARRAY_BUFFER, {}),
            "material": self._material(surface.material),
        }

    def _node(self, k: int, surface: Surface) -> JSON:
        node: JSON = {"name": surface.name, "mesh": k}
        if needs_exact_geometry(surface.vertices, surface.faces):
            vertices, faces = surface.vertices.astype(VERTICES), surface.faces.astype(FACES)
            node["extras"] = {
                KEY: {
                    "vertices": {"bufferView": self._view(vertices, None), "rows": len(vertices)},
                    "faces": {"bufferView": self._view(faces, None), "rows": len(faces), "columns": faces.shape[1]},
                }
            }
        return node

    def _material(self, material: Material) -> int:
        plain = plain_material(material) | {"extras": {KEY: material_extras(material)}}
        if material.name:
            plain["name"] = material.name
        key = json.dumps(plain)
        if key not in self._known:
            self._known[key] = len(self.materials)
            self.materials.append(plain)
        return self._known[key]

    def _accessor(self, array: NDArray[Any], kind: str, component: int, target: int, bounds: JSON) -> int:
        view = self._view(array, target)
        key = ("accessor", view, kind)
        if key not in self._known:
            self._known[key] = len(self.accessors)
            accessor = {"bufferView": view, "componentType": component, "count": len(array), "type": kind}
            self.accessors.append(accessor | bounds)
        return self._known[key]

    def _view(self, array: NDArray[Any], target: int | None) -> int:
        content = array.tobytes()
        key = (target, content)
        if key not in self._known:
            self._known[key] = len(self.views)
            view: JSON = {"buffer": 0, "byteOffset": len(self.binary), "byteLength": len(content)}
            self.views.append(view if target is None else view | {"target": target})
            self.binary += content + b"\0" * (-len(content) % 8)
        return self._known[key]
