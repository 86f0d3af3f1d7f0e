"""Scenes out of .glb and .gltf: nodes, meshes, materials."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import FileFormatError
from ..scene import FloatArray, IntArray, Material, Scene, Surface
from . import checked
from .checked import JSON
from .colours import surfaces_by_colour
from .defaults import GREY, grey
from .gltf_accessors import Accessors
from .gltf_container import load
from .gltf_exact import KEY, STRENGTH, exact_geometry
from .gltf_materials import UNUSED_EXTENSIONS, our_extras, read_materials
from .gltf_textures import Pictures
from .names import unique_names
from .notes import Notes

LARGEST = 50_000_000  # triangles
COPIES = 4_000_000  # triangles beyond those that the file can hold: a small file can name one mesh a million times
UNDERSTOOD = {
    STRENGTH,
    "KHR_lights_punctual",
    "KHR_materials_unlit",
    "KHR_mesh_quantization",
    "KHR_texture_transform",
    *UNUSED_EXTENSIONS,
}
TRIANGLES, STRIP, FAN = 4, 5, 6


@dataclass(frozen=True)
class _Placed:
    """A primitive of a mesh where a node puts it."""

    name: str
    vertices: FloatArray
    faces: IntArray
    material: int | None
    colours: FloatArray | None  # reflectance and emission (M, 6) of each face, where they differ


def read_gltf(path: Path, notes: Notes) -> Scene:
    """Read a scene from .glb or .gltf: one surface per node and primitive, in metres as glTF demands.

    Parameters
    ----------
    path : Path
    notes : Notes
        Takes what is not used.

    Returns
    -------
    Scene

    Raises
    ------
    FileFormatError
        Whatever the specification forbids and matters here, with the place in the document.
    SceneError
        No triangles, or values no scene can have.
    """
    document, buffers = load(path)
    _refuse_unknown(document)
    materials = read_materials(document, notes)
    accessors = Accessors(document, buffers)
    reader = _Reader(document, accessors, notes, materials, Pictures(document, accessors, path.parent, notes))
    placed = reader.placed()
    surfaces: list[Surface] = []
    for name, part in zip(unique_names([p.name for p in placed], notes), placed, strict=True):
        material = grey() if part.material is None else materials[part.material]
        if part.material is None and part.colours is None:
            notes.say(f"surface {name!r} has no material; it gets a grey of reflectance {GREY} (glTF's default is 1)")
        if part.colours is None:
            surfaces.append(Surface(name, part.vertices, part.faces, material))
        else:
            surfaces += surfaces_by_colour(name, part.vertices, part.faces, part.colours, material, notes)
    notes.exact = reader.exact and our_extras(reader.scene) is not None
    return _scene(reader.scene, surfaces, path)


def _refuse_unknown(document: JSON) -> None:
    required = document.get("extensionsRequired", [])
    if not isinstance(required, list):
        raise FileFormatError("extensionsRequired is not a list")
    if unknown := [str(name) for name in required if name not in UNDERSTOOD]:
        raise FileFormatError(
            f"the file requires {', '.join(unknown)}, which is not read; export it without compression"
        )


def _scene(scene: JSON, surfaces: list[Surface], path: Path) -> Scene:
    extras = our_extras(scene) or {}
    name = checked.text(extras, "name", "extras", default=path.stem)  # of others, most scenes are named "Scene"
    closed = extras.get("closed")
    if closed not in (None, True, False):
        raise FileFormatError(f"the scene's extras.{KEY}.closed is {closed!r}; expected true, false or null")
    sky = checked.numbers(extras, "sky", "extras", None, (0.0,))
    return Scene(tuple(surfaces), sky=np.array(sky), name=name, closed=closed)


class _Reader:
    """Walks the nodes of one document."""

    def __init__(
        self, document: JSON, accessors: Accessors, notes: Notes, materials: list[Material], pictures: Pictures
    ) -> None:
        self.accessors, self.notes, self.materials, self.pictures = accessors, notes, materials, pictures
        self.exact = True  # until a surface turns out to have been changed by others
        self.nodes = checked.mappings(document, "nodes", "glTF")
        self.meshes = checked.mappings(document, "meshes", "glTF")
        self.scene = self._chosen_scene(document)
        for key, feature in (("animations", "animation"), ("skins", "skinning")):
            if document.get(key):
                notes.skip(feature, f"{len(document[key])} in the file")

    def _chosen_scene(self, document: JSON) -> JSON:
        scenes = checked.mappings(document, "scenes", "glTF")
        if scenes:
            return scenes[checked.index(document, "scene", "glTF", len(scenes), "scenes") if "scene" in document else 0]
        children = {k for node in self.nodes for k in node.get("children", []) if isinstance(k, int)}
        return {"nodes": [k for k in range(len(self.nodes)) if k not in children]}

    def placed(self) -> list[_Placed]:
        """All primitives of triangles, in the world's coordinates."""
        found = list(self._walk())
        total = sum(self._triangle_count(m) for k, _ in found if (m := self._mesh_of(k)) is not None)
        most = min(LARGEST, COPIES + self.accessors.size // 3)
        if total > most:
            raise FileFormatError(
                f"the scene's nodes add up to {total} triangles; at most {most} are read from this file"
            )
        return [part for k, matrix in found for part in self._node(k, matrix)]

    def _walk(self) -> Iterator[tuple[int, FloatArray]]:
        """Nodes and their 4 × 4 matrices, parents first. glTF's nodes form trees: each is met once."""
        roots = checked.indices(self.scene, "nodes", "scene", len(self.nodes), "nodes")
        stack = [(k, np.eye(4)) for k in reversed(roots)]
        seen = set()
        while stack:
            k, parent = stack.pop()
            if k in seen:
                raise FileFormatError(f"nodes[{k}] has two parents or is its own ancestor; glTF nodes form trees")
            seen.add(k)
            matrix = parent @ _local_matrix(self.nodes[k], f"nodes[{k}]")
            yield k, matrix
            children = checked.indices(self.nodes[k], "children", f"nodes[{k}]", len(self.nodes), "nodes")
            stack += [(child, matrix) for child in reversed(children)]

    def _mesh_of(self, k: int) -> int | None:
        node = self.nodes[k]
        if "KHR_lights_punctual" in checked.mapping(node, "extensions", f"nodes[{k}]"):
            self.notes.skip("punctual light", checked.text(node, "name", f"nodes[{k}]") or f"nodes[{k}]")
        return checked.index(node, "mesh", f"nodes[{k}]", len(self.meshes), "meshes") if "mesh" in node else None

    def _triangle_count(self, m: int) -> int:
        count = 0
        for i, primitive in enumerate(checked.mappings(self.meshes[m], "primitives", f"meshes[{m}]")):
            where = f"meshes[{m}].primitives[{i}]"
            holder = primitive if "indices" in primitive else checked.mapping(primitive, "attributes", where)
            key = "indices" if "indices" in primitive else "POSITION"
            count += self.accessors.count(holder, key, where) // (3 if primitive.get("mode", 4) == TRIANGLES else 1)
        return count

    def _node(self, k: int, matrix: FloatArray) -> Iterator[_Placed]:
        m = self._mesh_of(k)
        if m is None:
            return
        node, mesh = self.nodes[k], self.meshes[m]
        name = checked.text(node, "name", f"nodes[{k}]") or checked.text(mesh, "name", f"meshes[{m}]") or f"node {k}"
        primitives = checked.mappings(mesh, "primitives", f"meshes[{m}]")
        for i, primitive in enumerate(primitives):
            where = f"meshes[{m}].primitives[{i}]"
            part = self._part(primitive, node, matrix, where, name if len(primitives) == 1 else f"{name}_{i + 1}")
            if part is not None:
                yield part

    def _part(self, primitive: JSON, node: JSON, matrix: FloatArray, where: str, name: str) -> _Placed | None:
        mode = checked.integer(primitive, "mode", where, default=TRIANGLES, high=6)
        if mode < TRIANGLES:
            self.notes.skip("points and lines", name)
            return None
        attributes = checked.mapping(primitive, "attributes", where)
        positions = self.accessors.read(attributes, "POSITION", f"{where}.attributes", ("VEC3",))
        if primitive.get("targets"):
            self.notes.skip("morph targets", name)
        triangles = self._triangles(primitive, mode, len(positions), where)
        material = None
        if "material" in primitive:
            material = checked.index(primitive, "material", where, len(self.materials), "materials")
        base = None if material is None else self.materials[material]
        colours = self.pictures.face_colours(material, base, attributes, triangles, where)
        exact = None if colours is not None else our_extras(node)
        vertices, faces = self._placed_mesh(exact, positions, triangles, matrix, name)
        return _Placed(name, vertices, faces, material, colours)

    def _placed_mesh(
        self, extras: JSON | None, positions: NDArray[Any], triangles: IntArray, matrix: FloatArray, name: str
    ) -> tuple[FloatArray, IntArray]:
        """Corners in the world and faces; the exact ones where the node has them and they still hold."""
        identity = np.array_equal(matrix, np.eye(4))
        if extras is not None:
            exact = exact_geometry(extras, self.accessors, positions, triangles, "extras") if identity else None
            if exact is not None:
                return exact
            self.exact = False
            self.notes.say(f"surface {name!r} was changed since its exact mesh was written; the changed one counts")
        vertices = positions.astype(np.float64)
        return (vertices, triangles) if identity else _transformed(vertices, triangles, matrix)

    def _triangles(self, primitive: JSON, mode: int, count: int, where: str) -> IntArray:
        if "indices" in primitive:
            flat = self.accessors.read(primitive, "indices", where, ("SCALAR",))
            if flat.dtype.kind != "u":
                raise FileFormatError(f"{where}.indices are {flat.dtype}; glTF allows unsigned integers")
            if int(flat.max()) >= count:
                raise FileFormatError(f"{where}.indices reach {flat.max()}, but there are {count} vertices")
            flat = flat.astype(np.int64)
        else:
            flat = np.arange(count, dtype=np.int64)
        return _as_triangles(flat, mode, where)


def _as_triangles(flat: IntArray, mode: int, where: str) -> IntArray:
    if mode == TRIANGLES:
        if flat.size % 3:
            raise FileFormatError(f"{where} has {flat.size} indices, no multiple of 3 for triangles; it is damaged")
        return flat.reshape(-1, 3)
    if flat.size < 3:
        raise FileFormatError(f"{where} has {flat.size} indices; a strip or fan needs at least 3")
    if mode == FAN:
        return np.column_stack([flat[1:-1], flat[2:], np.full(flat.size - 2, flat[0])])
    strip = np.column_stack([flat[:-2], flat[1:-1], flat[2:]])
    strip[1::2] = strip[1::2, [0, 2, 1]]  # every other triangle of a strip runs the other way round
    return strip


def _local_matrix(node: JSON, where: str) -> FloatArray:
    if "matrix" in node:
        return np.array(checked.numbers(node, "matrix", where, 16, ())).reshape(4, 4).T
    x, y, z, w = checked.numbers(node, "rotation", where, 4, (0.0, 0.0, 0.0, 1.0))
    length = float(np.linalg.norm([x, y, z, w]))
    if not 0.9 < length < 1.1:
        raise FileFormatError(f"{where}.rotation has length {length:g}; a rotation is a unit quaternion")
    x, y, z, w = x / length, y / length, z / length, w / length
    rotation = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
    matrix = np.eye(4)
    matrix[:3, :3] = rotation * checked.numbers(node, "scale", where, 3, (1.0, 1.0, 1.0))
    matrix[:3, 3] = checked.numbers(node, "translation", where, 3, (0.0, 0.0, 0.0))
    return matrix


def _transformed(vertices: FloatArray, faces: IntArray, matrix: FloatArray) -> tuple[FloatArray, IntArray]:
    """Vertices in the world; a mirror image turns its faces round, so that their fronts stay fronts."""
    moved: NDArray[Any] = vertices @ matrix[:3, :3].T + matrix[:3, 3]
    return moved, faces[:, ::-1] if np.linalg.det(matrix[:3, :3]) < 0 else faces
