"""Where a result comes from, as it is written into every file of results."""

from __future__ import annotations

import hashlib
import platform
from importlib import metadata
from typing import Any

import numpy as np

from .._version import __version__
from ..scene import Scene

LIBRARIES = ("numpy", "scipy", "numba", "embreex")  # what computes


def provenance(scene: Scene) -> dict[str, Any]:
    """Program, versions, and a hash of the scene: what has to be the same for the result to come out the same.

    Parameters
    ----------
    scene : Scene

    Returns
    -------
    dict
        `written_by`, `versions` by name, `scene_sha256`; the method and its seed are in the settings of a solution.
    """
    versions = {"python": platform.python_version()} | {name: metadata.version(name) for name in LIBRARIES}
    return {"written_by": f"radiosity {__version__}", "versions": versions, "scene_sha256": scene_hash(scene)}


def scene_hash(scene: Scene) -> str:
    """SHA-256 of all that a scene holds, to the last bit, as 64 hexadecimal digits.

    Examples
    --------
    >>> from radiosity.scenes import furnace
    >>> scene_hash(furnace(emission=1.0)) == scene_hash(furnace(emission=2.0))
    False
    """
    digest = hashlib.sha256()
    _add(digest, scene.name, repr(scene.closed), scene.sky)
    for surface in scene.surfaces:
        material = surface.material
        _add(digest, surface.name, surface.vertices, surface.faces)
        _add(digest, material.name, material.given, repr(material.two_sided))
        _add(digest, getattr(material, material.given), material.emission)
    return digest.hexdigest()


def _add(digest: Any, *parts: str | np.ndarray[Any, Any]) -> None:
    """Each part with its kind and length before it, so that none runs into the next."""
    for part in parts:
        if isinstance(part, str):
            content, kind = part.encode(), "text"
        else:
            content, kind = np.ascontiguousarray(part).tobytes(), f"{part.dtype.str}{part.shape}"
        digest.update(f"{kind} {len(content)}\n".encode() + content)
