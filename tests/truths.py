"""Truth files as scenes: exactly their patches, in their order."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

import radiosity as rad

FOLDER = Path(__file__).parent / "truth"


class Truth(NamedTuple):
    """A scene cut into the truth's own patches, and the arrays of the file."""

    scene: rad.Scene
    patches: rad.Patches
    data: dict[str, NDArray]


def load(name: str) -> Truth:
    """Read a truth; one surface for each patch, so that each keeps its own material and place."""
    with np.load(FOLDER / f"{name}.npz") as file:
        data = {key: file[key] for key in file}
    faces = data["faces"] if "faces" in data else data["quads"]
    reflectance = data["reflectance"] if "reflectance" in data else data["albedo"]
    surfaces = [
        rad.Surface(f"patch {i}", data["vertices"][quad], [[0, 1, 2, 3]], rad.Material(reflectance[i], emission=E))
        for i, (quad, E) in enumerate(zip(faces, data["emission"], strict=True))
    ]
    sky = data["sky_radiance"] if "sky_radiance" in data else data["env"]
    scene = rad.Scene(surfaces, sky=sky, name=name)
    patches = rad.subdivide(scene)
    assert len(patches) == len(faces)
    return Truth(scene, patches, data)


def relative_error(patches: rad.Patches, found: NDArray, true: NDArray) -> float:
    """Area-weighted relative L2 over patches and channels."""
    weight = patches.area[:, None]
    return float(np.sqrt((weight * (found - true) ** 2).sum() / (weight * true**2).sum()))
