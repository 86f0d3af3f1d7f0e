"""Colours that vary over a glTF mesh (textures, vertex colours), as one reflectance and emission per face."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import FileFormatError
from ..scene import FloatArray, IntArray, Material
from . import checked
from .checked import JSON
from .gltf_accessors import Accessors
from .gltf_container import resource
from .notes import Notes
from .textures import CLAMP, MIRROR, REPEAT, Album, Codes, load_picture, mean_over_faces

TRANSFORM = "KHR_texture_transform"


class Pictures:
    """The textures of a document, each picture read once, when it is first used.

    Parameters
    ----------
    document : dict
    accessors : Accessors
    folder : Path
        Of the scene; pictures come from it or from the file itself.
    notes : Notes
        Takes pictures that cannot be used.
    """

    def __init__(self, document: JSON, accessors: Accessors, folder: Path, notes: Notes) -> None:
        self.materials = checked.mappings(document, "materials", "glTF")
        self._textures = checked.mappings(document, "textures", "glTF")
        self._images = checked.mappings(document, "images", "glTF")
        self._samplers = checked.mappings(document, "samplers", "glTF")
        self._accessors, self._folder, self._notes = accessors, folder, notes
        self._album = Album()

    def face_colours(
        self, material: int | None, base: Material | None, attributes: JSON, faces: IntArray, where: str
    ) -> FloatArray | None:
        """Reflectance and emission of each face, (M, 6), or None where the material is the same everywhere.

        Parameters
        ----------
        material : int or None
            Its index; without one, vertex colours alone are the reflectance.
        base : Material or None
            Its factors, which textures and vertex colours multiply.
        attributes : dict
            Of the primitive.
        faces : ndarray (M, 3)
        where : str
            The primitive's place in the document.
        """
        obj = {} if material is None else self.materials[material]
        base = base or Material(np.ones(3))
        if base.channels != 3:  # exact values of more channels than a picture has
            return None
        pbr = checked.mapping(obj, "pbrMetallicRoughness", where)
        diffuse = self._means(pbr, "baseColorTexture", attributes, faces, where)
        emissive = self._means(obj, "emissiveTexture", attributes, faces, where)
        unlit = "KHR_materials_unlit" in checked.mapping(obj, "extensions", where)
        vertex = None if unlit else self._vertex_colours(attributes, faces, where)
        if diffuse is None and emissive is None and vertex is None:
            return None
        one = np.ones((len(faces), 3))
        reflectance = (one if diffuse is None else diffuse) * (one if vertex is None else vertex)
        return np.hstack([reflectance * base.reflectance, (one if emissive is None else emissive) * base.emission])

    def _vertex_colours(self, attributes: JSON, faces: IntArray, where: str) -> FloatArray | None:
        if "COLOR_0" not in attributes:
            return None
        colours = self._accessors.read(attributes, "COLOR_0", where, ("VEC3", "VEC4"))[:, :3]
        self._check_count(colours, "COLOR_0", attributes, where)
        return np.asarray(colours.astype(np.float64)[faces].mean(axis=1))

    def _means(self, obj: JSON, key: str, attributes: JSON, faces: IntArray, where: str) -> FloatArray | None:
        if key not in obj:
            return None
        info = checked.mapping(obj, key, where)
        texture = self._textures[checked.index(info, "index", f"{where}.{key}", len(self._textures), "textures")]
        picture = self._picture(texture, where)
        moved = checked.mapping(checked.mapping(info, "extensions", where), TRANSFORM, where)
        channel = checked.integer(moved, "texCoord", where, default=checked.integer(info, "texCoord", where, default=0))
        name = f"TEXCOORD_{channel}"
        if picture is None or name not in attributes:
            return None
        coordinates = self._accessors.read(attributes, name, where, ("VEC2",)).astype(np.float64)
        self._check_count(coordinates, name, attributes, where)
        return mean_over_faces(picture, _moved(coordinates, moved, where), faces, self._wrap(texture, where))

    def _check_count(self, values: NDArray[Any], name: str, attributes: JSON, where: str) -> None:
        count = self._accessors.count(attributes, "POSITION", where)
        if len(values) != count:
            raise FileFormatError(f"{where}: {name} has {len(values)} elements, but there are {count} vertices")

    def _wrap(self, texture: JSON, where: str) -> tuple[int, int]:
        if "sampler" not in texture:
            return REPEAT, REPEAT
        sampler = self._samplers[checked.index(texture, "sampler", where, len(self._samplers), "samplers")]
        u, v = (checked.integer(sampler, key, where, default=REPEAT) for key in ("wrapS", "wrapT"))
        if not {u, v} <= {REPEAT, MIRROR, CLAMP}:
            raise FileFormatError(f"a sampler wraps by {u} and {v}; glTF has {REPEAT}, {MIRROR}, {CLAMP}")
        return u, v

    def _picture(self, texture: JSON, where: str) -> Codes | None:
        """The picture of a texture, or None where it cannot be used, which is noted."""
        if "source" not in texture:
            self._notes.skip("textures in formats beyond PNG and JPEG", where)
            return None
        k = checked.index(texture, "source", where, len(self._images), "images")
        return self._album.picture(k, lambda: self._load(k))

    def _load(self, k: int) -> Codes | None:
        try:
            return load_picture(self._content(self._images[k], f"images[{k}]"))
        except FileFormatError:
            raise
        except ValueError as error:
            self._notes.say(f"images[{k}] cannot be read ({error}); the plain colour of its material counts")
            return None

    def _content(self, image: JSON, where: str) -> bytes:
        if "uri" in image:
            return resource(checked.text(image, "uri", where), f"{where}.uri", self._folder)
        return bytes(self._accessors.view(image, "bufferView", where)[0])


def _moved(coordinates: FloatArray, transform: JSON, where: str) -> NDArray[Any]:
    """Texture coordinates after KHR_texture_transform: scaled, turned, shifted."""
    scale = checked.numbers(transform, "scale", where, 2, (1.0, 1.0))
    shift = checked.numbers(transform, "offset", where, 2, (0.0, 0.0))
    angle = checked.number(transform, "rotation", where, 0.0)
    turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    return coordinates * scale @ turn.T + shift
