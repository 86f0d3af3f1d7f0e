"""What is studied: scenes cut into patches, along one parameter."""

from __future__ import annotations

import hashlib
import warnings
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

import radiosity as rad

from ..errors import GeometryWarning


@dataclass(frozen=True, eq=False)
class Subject:
    """A scene cut into patches.

    Attributes
    ----------
    name : str
        Unique in its study: "cornell_box, 1,600 patches".
    parameter : str
        What differs from one subject to the next: "patches", "gap".
    value : float
        How much of it.
    scene : Scene
    patches : Patches
    """

    name: str
    parameter: str
    value: float
    scene: rad.Scene
    patches: rad.Patches

    @property
    def fingerprint(self) -> str:
        """A hash of geometry, materials and light: the same for the same subject."""
        patches = self.patches
        digest = hashlib.sha256()
        for array in (patches.vertices, patches.faces, patches.absorptance, patches.emission, patches.sky):
            digest.update(np.ascontiguousarray(array).tobytes())
        return digest.hexdigest()[:12]


def by_patches(scene: rad.Scene, counts: Iterable[int]) -> list[Subject]:
    """One scene, ever more finely cut; counts that come to the same patches are taken once."""
    subjects: dict[int, Subject] = {}
    for count in sorted(set(counts)):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", GeometryWarning)  # that there are more faces shows in the number
            patches = rad.subdivide(scene, patch_count=count)
        name = f"{scene.name}, {len(patches):,} patches"
        subjects[len(patches)] = Subject(name, "patches", float(len(patches)), scene, patches)
    return list(subjects.values())
