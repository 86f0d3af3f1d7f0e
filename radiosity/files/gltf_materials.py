"""Diffuse materials out of glTF's: base colour and emission; what a diffuse solver does not use is noted by name."""

from __future__ import annotations

import numpy as np

from ..errors import FileFormatError
from ..scene import Material
from . import checked
from .checked import JSON
from .gltf_exact import KEY, STRENGTH, exact_material
from .notes import Notes

UNUSED_EXTENSIONS = {
    "KHR_materials_anisotropy": "anisotropy",
    "KHR_materials_clearcoat": "clear coat",
    "KHR_materials_diffuse_transmission": "diffuse transmission",
    "KHR_materials_dispersion": "dispersion",
    "KHR_materials_ior": "index of refraction",
    "KHR_materials_iridescence": "iridescence",
    "KHR_materials_pbrSpecularGlossiness": "specular-glossiness colours",
    "KHR_materials_sheen": "sheen",
    "KHR_materials_specular": "specular reflection",
    "KHR_materials_transmission": "transmission",
    "KHR_materials_volume": "volume",
}


def read_materials(document: JSON, notes: Notes) -> list[Material]:
    """All materials of a document.

    Reflectance is `baseColorFactor` (linear), emission π × `emissiveFactor` × emissive strength.

    Raises
    ------
    FileFormatError
        A factor outside [0, 1], a negative strength, values that are not numbers.
    """
    return [
        _material(material, f"materials[{k}]", notes)
        for k, material in enumerate(checked.mappings(document, "materials", "glTF"))
    ]


def _material(obj: JSON, where: str, notes: Notes) -> Material:
    name = checked.text(obj, "name", where)
    pbr = checked.mapping(obj, "pbrMetallicRoughness", where)
    extensions = checked.mapping(obj, "extensions", where)
    colour = _factor(pbr, "baseColorFactor", f"{where}.pbrMetallicRoughness", 4, [1.0] * 4)
    emissive = np.array(_factor(obj, "emissiveFactor", where, 3, [0.0] * 3))
    strength = checked.number(checked.mapping(extensions, STRENGTH, where), "emissiveStrength", where, 1.0)
    if strength < 0:
        raise FileFormatError(f"{where}: emissiveStrength is {strength}; light cannot be negative")
    two_sided = checked.flag(obj, "doubleSided", where)
    plain = Material(np.array(colour[:3]), emission=np.pi * (emissive * strength), two_sided=two_sided, name=name)
    _note_unused(obj, pbr, extensions, name or where, notes)
    extras = our_extras(obj)
    if extras is None:
        return plain
    exact = exact_material(extras, plain, f"{where}.extras.{KEY}")
    if exact is None:
        notes.say(f"material {name or where!r} was changed since its exact values were written; the changed ones count")
    return exact or plain


def _factor(obj: JSON, key: str, where: str, count: int, default: list[float]) -> list[float]:
    values = checked.numbers(obj, key, where, count, default)
    if min(values) < 0 or max(values) > 1:
        raise FileFormatError(f"{where}.{key} is {values}; glTF allows [0, 1] (brighter light: {STRENGTH})")
    return values


def our_extras(obj: JSON) -> JSON | None:
    """The part of an object's extras that this package wrote, if any; others may put anything there."""
    extras = obj.get("extras")
    ours = extras.get(KEY) if isinstance(extras, dict) else None
    return ours if isinstance(ours, dict) else None


def _note_unused(obj: JSON, pbr: JSON, extensions: JSON, name: str, notes: Notes) -> None:
    """Note what changes the look of a material and is not used here. Values that change nothing are passed over."""
    if isinstance(pbr.get("metallicFactor"), (int, float)) and pbr["metallicFactor"] > 0:
        notes.skip("metallic reflection", name)
    colour = pbr.get("baseColorFactor", [1, 1, 1, 1])
    if obj.get("alphaMode", "OPAQUE") != "OPAQUE" and (obj["alphaMode"] == "MASK" or colour[3] < 1):
        notes.skip("transparency (alpha)", name)
    textures = {"normalTexture": obj, "occlusionTexture": obj, "metallicRoughnessTexture": pbr}
    for key, holder in textures.items():
        if key in holder:
            notes.skip(key.removesuffix("Texture") + " texture", name)
    if "KHR_materials_unlit" in extensions:
        notes.skip("unlit colour (baked light?)", name)
    for extension, feature in UNUSED_EXTENSIONS.items():
        if extension in extensions:
            notes.skip(feature, name)
