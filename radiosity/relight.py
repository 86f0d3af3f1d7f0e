"""Other lamps, other paint, another sky on the same geometry."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .errors import MaterialError, ParameterError
from .patches import Patches
from .scene import Material, Scene, Surface

FloatArray = NDArray[np.float64]


def relit_scene(
    scene: Scene,
    *,
    emission: Mapping[str, ArrayLike] | None = None,
    reflectance: Mapping[str, ArrayLike] | None = None,
    sky: ArrayLike | None = None,
) -> Scene:
    """The same surfaces under other light, or with other paint.

    Parameters
    ----------
    scene : Scene
    emission : mapping of str to array_like (C,), optional
        Exitance, W/m², by the name of a surface or, failing that, of a material.
    reflectance : mapping of str to array_like (C,), optional
    sky : array_like (C,), optional
        Radiance of the surroundings, W/(m² sr).

    Raises
    ------
    ParameterError
        A name that no surface and no material has.
    MaterialError
        A value that no surface can have.

    Examples
    --------
    >>> from radiosity.scenes import furnace
    >>> dark = furnace(emission=0.0)
    >>> relit_scene(dark, emission={"ceiling": 10.0}).surfaces[1].material.emission
    array([10.])
    """
    for argument, named in (("emission", emission), ("reflectance", reflectance)):
        check_names(scene, named or {}, argument)

    def changed(surface: Surface) -> Surface:
        named = {"reflectance": _named(reflectance, surface), "emission": _named(emission, surface)}
        changes = {what: value for what, value in named.items() if value is not None}
        return replace(surface, material=surface.material.replace(**changes)) if changes else surface

    surfaces = tuple(changed(surface) for surface in scene.surfaces)
    return replace(scene, surfaces=surfaces, sky=scene.sky if sky is None else np.asarray(sky, dtype=np.float64))


def check_names(scene: Scene, named: Mapping[str, object], argument: str) -> None:
    """Refuse names that neither a surface nor a material of the scene has.

    Raises
    ------
    ParameterError
        With the names that there are.
    """
    known = dict.fromkeys([*scene.surface_names, *(s.material.name for s in scene.surfaces)])
    known.pop("", None)
    if strangers := [name for name in named if name not in known]:
        shown = ", ".join(map(repr, list(known)[:20])) + (" …" if len(known) > 20 else "")
        raise ParameterError(f"{argument}: no surface or material is named {strangers[0]!r}; there are {shown}")


def relit_patches(
    patches: Patches,
    scene: Scene,
    *,
    emission: ArrayLike | Mapping[str, ArrayLike] | None = None,
    reflectance: ArrayLike | Mapping[str, ArrayLike] | None = None,
) -> Patches:
    """The same patches with the materials of the surfaces named, or values of each patch, and the scene's sky.

    Parameters
    ----------
    patches : Patches
    scene : Scene
        Already relit: the materials of the surfaces named are taken from it.
    emission, reflectance : mapping (its names are taken), or array_like (N, C), (N,) where there is one channel
        What is not given stays as it was, patch by patch.

    Raises
    ------
    MaterialError
        Values outside what a surface can have, a shape that does not fit.
    """
    new = replace(patches, sky=scene.sky)
    if isinstance(emission, Mapping):
        new = replace(new, emission=_by_surface(new.emission, patches, scene, emission, lambda m: m.emission))
    elif emission is not None:
        new = replace(new, emission=_by_patch("emission", emission, patches))
    if isinstance(reflectance, Mapping):
        rho, alpha = (
            _by_surface(old, patches, scene, reflectance, value)
            for old, value in (
                (patches.reflectance, lambda m: m.reflectance),
                (patches.absorptance, lambda m: m.absorptance),
            )
        )
        return replace(new, reflectance=rho, absorptance=alpha)
    if reflectance is not None:
        rho = _by_patch("reflectance", reflectance, patches)
        return replace(new, reflectance=rho, absorptance=1.0 - rho)
    return new


def _named(values: Mapping[str, ArrayLike] | None, surface: Surface) -> ArrayLike | None:
    """What a mapping says of a surface: by its own name, else by its material's."""
    if not values:
        return None
    return values[surface.name] if surface.name in values else values.get(surface.material.name)


def _by_surface(
    old: FloatArray,
    patches: Patches,
    scene: Scene,
    named: Mapping[str, ArrayLike],
    value: Callable[[Material], FloatArray],
) -> FloatArray:
    """Values (N, C) with those of the surfaces that a mapping names taken from their materials."""
    new = old.copy()
    for index, surface in enumerate(scene.surfaces):
        if _named(named, surface) is not None:
            new[patches.surface == index] = value(surface.material)
    return new


def _by_patch(what: str, given: ArrayLike, patches: Patches) -> FloatArray:
    """Values of each patch as float64 (N, C), checked."""
    values = np.array(given, dtype=np.float64)
    if values.ndim == 1 and patches.channels == 1:
        values = values[:, None]
    expected = (len(patches), patches.channels)
    if values.shape != expected:
        raise MaterialError(f"{what} has shape {np.shape(given)}; give {expected}, or a mapping of surface names")
    good = (values >= 0.0) & (values <= (1.0 if what == "reflectance" else np.finfo(np.float64).max))
    if not good.all():
        patch, channel = np.argwhere(~good)[0]
        limits = "outside [0, 1]" if what == "reflectance" else "negative or not finite"
        raise MaterialError(f"{what} {values[patch, channel]:g} of patch {patch}, channel {channel}, is {limits}")
    return values
