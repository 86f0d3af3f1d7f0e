"""Whether a scene has light, and whether it can come to rest."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..finding import Finding, Severity, names
from .mesh import Mesh

NOWHERE = np.zeros((0, 3))


def light(mesh: Mesh) -> Iterator[Finding]:
    """No light at all; light that nothing absorbs."""
    scene = mesh.scene
    surfaces = scene.surfaces
    if not scene.sky.any() and not any(part.material.emission.any() for part in surfaces):
        remedy = "make a surface emit (--lamp SURFACE=E, lamps={…}) or give the sky a radiance (--sky, sky=…)"
        message = "no surface emits, and the sky is black: everything will be black"
        yield Finding("no light", Severity.WARNING, (), len(surfaces), message, remedy, NOWHERE)
    if scene.closed and not any(part.material.absorptance.any() for part in surfaces):
        remedy = "let some surface absorb: a reflectance below 1"
        message = "the scene is closed and absorbs nothing, so that light that is put in grows for ever"
        yield Finding("nothing absorbs", Severity.ERROR, (), len(surfaces), message, remedy, NOWHERE)
    glossy = [part.name for part in surfaces if 0 < part.material.absorptance.max() < 1e-13]
    if glossy and not all(part.material.given == "absorptance" for part in surfaces if part.name in glossy):
        remedy = "give the absorptance instead of the reflectance (Material(absorptance=…)), which keeps all its digits"
        message = f"{names(glossy)} absorb less than 1e-13, of which a reflectance near 1 keeps no digits"
        yield Finding("absorptance rounded", Severity.WARNING, tuple(glossy), len(glossy), message, remedy, NOWHERE)
