"""Materials of OBJ files (.mtl): `Kd` is the reflectance, `Ke` the radiance of the emission."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

import numpy as np

from ..errors import FileFormatError
from ..scene import Material
from .defaults import GREY
from .folder import inside
from .notes import Notes
from .textures import Album, Codes, load_picture
from .words import real, text_lines

COLOURS = ("Kd", "Ke", "Ks", "Tf")
NUMBERS = ("d", "Tr", "illum")
TEXTURES = {"map_bump": "normal map", "bump": "normal map", "norm": "normal map", "map_d": "transparency (alpha)"}


@dataclass
class MtlMaterial:
    """What a file says about one material, of what matters here.

    Attributes
    ----------
    name : str
    values : dict
        Statement (Kd, Ke, …) → its numbers.
    texture : dict
        Statement (map_Kd, map_Ke) → the name of its picture.
    """

    name: str
    values: dict[str, list[float]] = field(default_factory=dict)
    texture: dict[str, str] = field(default_factory=dict)

    def material(self, notes: Notes) -> Material:
        """The diffuse material; what it has beyond that is noted."""
        reflectance = self.values.get("Kd")
        if reflectance is None and "map_Kd" in self.texture:
            reflectance = [1.0, 1.0, 1.0]
        if reflectance is None:
            notes.say(f"material {self.name!r} has no Kd; it gets a grey of reflectance {GREY}")
            reflectance = [GREY] * 3
        self._note_unused(reflectance, notes)
        radiance = np.array(self.values.get("Ke", [0.0, 0.0, 0.0]))
        return Material(np.array(reflectance), emission=np.pi * radiance, name=self.name)

    def pictures(self, folder: Path, album: Album, notes: Notes) -> dict[str, Codes]:
        """The pictures of map_Kd and map_Ke; those that cannot be read are noted."""

        def load(key: str, name: str) -> Codes | None:
            try:
                file = inside(name.replace("\\", "/"), key, folder)
                if file.exists() and not file.is_file():
                    raise ValueError("it is no file")
                return load_picture(file.read_bytes())
            except (OSError, ValueError) as error:
                reason = "it is not there" if isinstance(error, FileNotFoundError) else str(error)
                notes.say(f"{key} {name!r} of material {self.name!r} is not used ({reason}); its plain colour counts")
                return None

        found = {key: album.picture((key, name), partial(load, key, name)) for key, name in self.texture.items()}
        return {key: picture for key, picture in found.items() if picture is not None}

    def _note_unused(self, reflectance: list[float], notes: Notes) -> None:
        if max(self.values.get("Ks", [0.0])) > 0:
            alone = max(reflectance) == 0  # Kd 0: nothing is left of it
            notes.skip("glossy reflection (Ks)" + (" without Kd, so black here" if alone else ""), self.name)
        if self.values.get("d", [1.0])[0] < 1 or self.values.get("Tr", [0.0])[0] > 0:
            notes.skip("transparency (alpha)", self.name)


def read_mtl(path: Path, notes: Notes) -> dict[str, MtlMaterial]:
    """Materials of a .mtl file by name.

    Raises
    ------
    FileFormatError
        A statement whose values are not numbers, or one before the first `newmtl`; with its line.
    """
    found: dict[str, MtlMaterial] = {}
    current: MtlMaterial | None = None
    try:
        lines = text_lines(path.read_bytes())
    except FileFormatError as error:
        raise FileFormatError(f"{path.name}: {error}") from error
    for number, line in enumerate(lines, start=1):
        keyword, *others = line.split(maxsplit=1) or [""]
        rest = others[0].strip() if others else ""
        where = f"{path.name}, line {number}"
        if not keyword:
            continue
        if keyword == "newmtl":
            current = found.setdefault(rest, MtlMaterial(rest))
            continue
        if current is None:
            raise FileFormatError(f"{where}: {keyword!r} before any newmtl; this is no material library")
        if keyword in COLOURS or keyword in NUMBERS:
            current.values[keyword] = _numbers(rest, 3 if keyword in COLOURS else 1, where, keyword)
        elif keyword in ("map_Kd", "map_Ke"):
            current.texture[keyword] = rest.split()[-1] if rest.startswith("-") else rest  # behind its options
        elif keyword.lower() in TEXTURES:
            notes.skip(TEXTURES[keyword.lower()], current.name)
    return found


def _numbers(rest: str, count: int, where: str, keyword: str) -> list[float]:
    words = rest.split()
    if words and words[0] in ("spectral", "xyz"):
        raise FileFormatError(f"{where}: {keyword} {words[0]} is not read; give {keyword} as red, green, blue")
    try:
        values = [real(word) for word in words[:count]]
    except ValueError as error:
        raise FileFormatError(f"{where}: {keyword} {rest!r} holds no numbers") from error
    if count == 3 and len(values) == 1:
        values *= 3  # one value stands for all three
    if len(values) != count:
        raise FileFormatError(f"{where}: {keyword} {rest!r} has {len(values)} numbers; expected {count}")
    return values
