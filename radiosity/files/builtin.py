"""The built-in scenes as files, with a README of their units and origin."""

from __future__ import annotations

import os
from functools import partial
from pathlib import Path

import numpy as np

from ..scene import Scene
from ..scenes import BUILT_IN
from .atomic import write_bytes
from .gltf_write import write_gltf

TITLE = "# Scenes of the radiosity package"

INTRODUCTION = f"""{TITLE}

Written by `radiosity scenes --write`, from the functions of `radiosity.scenes`, where each scene is described;
write them again rather than editing them. Lengths are metres, y is up, fronts of faces are counter-clockwise,
as glTF demands. Every file is plain glTF 2.0 that any viewer opens; what glTF cannot hold exactly (float64
corners, quads, spectra, absorptance, sky) is in `extras.radiosity`, so that `radiosity.read_scene` gives the very
scene that was written.

`baseColorFactor` is the reflectance (linear), `emissiveFactor` × `KHR_materials_emissive_strength` the radiance of
the emission, W/(m² sr) a channel; the exitance is π times that. A sky is in the extras only. Scenes of one channel,
or of other than three, look grey elsewhere.

The Cornell box is the one that was measured at Cornell University Program of Computer Graphics ("Cornell Box Data",
https://www.graphics.cornell.edu/online/box/data.html); the other scenes were made up for this package.

| file | what | size, m | channels | surfaces | faces | closed |
|---|---|---|---|---|---|---|
"""

STUDIO = """
`studio.glb` was modelled in Blender 5.0.1 and exported by its glTF exporter, as an example of what other software
writes: node transforms with uneven scales, every material double-sided, a lamp by emissive strength. Metres, y up.
"""


def write_builtin_scenes(folder: str | os.PathLike[str]) -> list[Path]:
    """Write every built-in scene as .glb into a folder, with a README.md of units and origin.

    Parameters
    ----------
    folder : str or path-like
        Made if it is not there. A README.md in it that is not of this function is left alone.

    Returns
    -------
    list of Path
        The files that were written.
    """
    target = Path(folder)
    target.mkdir(parents=True, exist_ok=True)
    rows, written = [], []
    for name, make in BUILT_IN.items():
        scene = make()
        path = target / f"{name}.glb"
        write_gltf(scene, path)
        written.append(path)
        function = make.func if isinstance(make, partial) else make
        rows.append(_row(path.name, (function.__doc__ or "").splitlines()[0], scene))
    readme = target / "README.md"
    if not readme.exists() or readme.read_text("utf-8", errors="replace").startswith(TITLE):
        studio = STUDIO if (target / "studio.glb").exists() else ""
        write_bytes(readme, (INTRODUCTION + "\n".join(rows) + "\n" + studio).encode())
        written.append(readme)
    return written


def _row(file: str, what: str, scene: Scene) -> str:
    corners = np.concatenate([s.vertices for s in scene.surfaces])
    size = " × ".join(f"{extent:.3g}" for extent in np.ptp(corners, axis=0))
    faces = sum(len(s.faces) for s in scene.surfaces)
    closed = "yes" if scene.closed else "no"
    return f"| `{file}` | {what.rstrip('.')} | {size} | {scene.channels} | {len(scene.surfaces)} | {faces} | {closed} |"
