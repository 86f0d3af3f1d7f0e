"""What a scene is: surfaces with one material each, and the sky outside.

Everything is checked when it is made, so that whoever holds a `Scene` holds a valid one. Arrays are
read-only; to change a scene, make a new one: ``dataclasses.replace(scene, sky=1.0)``,
``dataclasses.replace(surface, material=…)``, ``material.replace(emission=…)``.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .errors import GeometryError, MaterialError, SceneError
from .finding import Finding

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

LARGEST = 1e75  # metres: the fourth power, which the formulas need, still is a float64
SURFACES_SHOWN = 6


def _frozen(values: ArrayLike, dtype: Any) -> NDArray[Any]:
    """A read-only copy, so that what was valid once stays valid."""
    array = np.array(values, dtype=dtype)
    array.setflags(write=False)
    return array


def _set(thing: object, **values: Any) -> None:
    """Fill the fields of a frozen dataclass that is being made."""
    for name, value in values.items():
        object.__setattr__(thing, name, value)


def _per_channel(values: ArrayLike, what: str) -> FloatArray:
    try:
        array = _frozen(np.atleast_1d(values), np.float64)
    except (TypeError, ValueError) as error:
        raise MaterialError(f"{what} is {values!r}; give one number per channel") from error
    if array.ndim != 1 or array.size == 0:
        raise MaterialError(f"{what} has shape {array.shape}; give one number per channel, shape (C,)")
    return array


@dataclass(frozen=True, eq=False, init=False)
class Material:
    """How a surface reflects, absorbs and emits light: diffuse, one number per channel.

    Give either `reflectance` or `absorptance`; that one is kept to the last digit and the other is
    derived. (An absorptance of 1e-12 cannot be recovered from a reflectance of 1 - 1e-12.)
    Values are checked when the material is put on a surface, so that the message can name it.

    Parameters
    ----------
    reflectance : array_like (C,), optional
        Share ρ of the arriving light that leaves again, in [0, 1].
    absorptance : array_like (C,), optional
        Share α = 1 - ρ of the arriving light that stays.
    emission : array_like (C,), optional
        Exitance E that the surface emits by itself, W/m². Files speak of radiance: E = π × radiance.
    two_sided : bool, optional
        Both sides reflect and emit. A one-sided face has a black, opaque back.
    name : str, optional
        The name the material has in a file.

    Attributes
    ----------
    given : {"reflectance", "absorptance"}
        Which of the two was given, and so is exact.

    Raises
    ------
    MaterialError
        If both or neither of reflectance and absorptance are given, or a shape is not (C,).

    Examples
    --------
    >>> Material(reflectance=[0.63, 0.065, 0.05]).absorptance
    array([0.37 , 0.935, 0.95 ])
    >>> Material(absorptance=1e-12).given
    'absorptance'
    """

    reflectance: FloatArray
    absorptance: FloatArray
    emission: FloatArray
    two_sided: bool
    name: str
    given: str

    def __init__(
        self,
        reflectance: ArrayLike | None = None,
        absorptance: ArrayLike | None = None,
        emission: ArrayLike = 0.0,
        two_sided: bool = False,
        name: str = "",
    ) -> None:
        if (reflectance is None) == (absorptance is None):
            raise MaterialError("give either reflectance or absorptance of a material, and not both")
        given = "absorptance" if reflectance is None else "reflectance"
        derived = "reflectance" if given == "absorptance" else "absorptance"
        value = _per_channel(absorptance if reflectance is None else reflectance, given)  # type: ignore[arg-type]
        exitance = _per_channel(emission, "emission")
        channels = max(value.size, exitance.size)
        if {value.size, exitance.size} - {1, channels}:
            raise MaterialError(
                f"{given} has {value.size} channels and emission {exitance.size}; give as many to both, or one for all"
            )
        if exitance.size != channels:
            exitance = _frozen(np.full(channels, exitance[0]), np.float64)
        _set(self, given=given, two_sided=bool(two_sided), name=name, emission=exitance)
        _set(self, **{given: value, derived: _frozen(1.0 - value, np.float64)})

    def replace(self, **changes: Any) -> Material:
        """Make a material like this one but for the parameters named; they are those of `Material`.

        >>> Material(absorptance=1e-12).replace(emission=2.0).absorptance
        array([1.e-12])
        """
        kept: dict[str, Any] = {"emission": self.emission, "two_sided": self.two_sided, "name": self.name}
        if not {"reflectance", "absorptance"} & changes.keys():
            kept[self.given] = getattr(self, self.given)
        return Material(**kept | changes)

    @property
    def channels(self) -> int:
        """Number of channels C that the values are given for; 1 serves any number."""
        return max(self.reflectance.size, self.emission.size)

    def problems(self) -> list[str]:
        """Values that no surface can have, one sentence each (empty if there are none)."""
        found = []
        value = getattr(self, self.given)
        for c in np.flatnonzero(~((value >= 0.0) & (value <= 1.0))):
            found.append(f"{self.given} {value[c]:g} in channel {c} is outside [0, 1]")
        for c in np.flatnonzero(~((self.emission >= 0.0) & np.isfinite(self.emission))):
            found.append(f"emission {self.emission[c]:g} W/m² in channel {c} is negative or not finite")
        return found


def _mesh(where: str, vertices: ArrayLike, faces: ArrayLike) -> tuple[FloatArray, IntArray]:
    """Vertices (V, 3) and faces (M, 3) or (M, 4) as read-only arrays."""
    try:
        points, corners = _frozen(vertices, np.float64), np.array(faces)
    except (TypeError, ValueError) as error:
        raise GeometryError(f"{where}: vertices and faces must be arrays of numbers: {error}") from error
    if points.ndim != 2 or points.shape[1] != 3:
        raise GeometryError(f"{where}: vertices have shape {points.shape}; give (V, 3)")
    if corners.ndim != 2 or corners.shape[1] not in (3, 4):
        raise GeometryError(f"{where}: faces have shape {corners.shape}; give (M, 3) triangles or (M, 4) quads")
    if len(corners) == 0:
        raise GeometryError(f"{where} has no faces; leave it out of the scene")
    if not np.issubdtype(corners.dtype, np.integer):
        raise GeometryError(f"{where}: faces are {corners.dtype}; give integer indices into vertices")
    return points, _frozen(corners, np.int64)


def _some(indices: NDArray[Any], limit: int = 5) -> str:
    """The first few of many places, for a message."""
    shown = ", ".join(str(i) for i in indices[:limit])
    return shown + (f" … ({len(indices)} in all)" if len(indices) > limit else "")


@dataclass(frozen=True, eq=False, init=False)
class Surface:
    """A named part of a scene with one material.

    Parameters
    ----------
    name : str
        Unique in its scene.
    vertices : array_like (V, 3)
        Metres. May be shared with other surfaces; vertices that no face uses are allowed.
    faces : array_like of int (M, 3) or (M, 4)
        Triangles or quads, counter-clockwise seen from the front; -1 in the last column pads a triangle.
    material : Material

    Raises
    ------
    GeometryError
        Vertices that are not finite, indices out of range, no faces.
    MaterialError
        Reflectance or absorptance outside [0, 1], emission negative or not finite.
    """

    name: str
    vertices: FloatArray
    faces: IntArray
    material: Material

    def __init__(self, name: str, vertices: ArrayLike, faces: ArrayLike, material: Material) -> None:
        if not isinstance(name, str) or not name:
            raise SceneError(f"a surface is named {name!r}; give it a name, so that messages can speak of it")
        where = f"surface {name!r}"
        points, corners = _mesh(where, vertices, faces)
        _set(self, name=name, vertices=points, faces=corners, material=material)
        if problems := self._geometry_problems():
            raise GeometryError(f"{where}: " + "; ".join(problems))
        if not isinstance(material, Material):
            raise MaterialError(f"{where}: material is {material!r}; give a Material")
        if problems := material.problems():
            raise MaterialError(f"{where}: " + "; ".join(problems))

    def turned(self, faces: ArrayLike | None = None) -> Surface:
        """The same surface seen from its other side.

        Parameters
        ----------
        faces : array_like of int (n,), optional
            Which faces to turn round; all by default.

        Returns
        -------
        Surface

        Examples
        --------
        >>> Surface("floor", np.eye(3), [[0, 1, 2]], Material(0.5)).turned().faces
        array([[2, 1, 0]])
        """
        rows = np.arange(len(self.faces)) if faces is None else np.asarray(faces, dtype=np.int64)
        corners = self.faces.copy()
        corners[rows, :3] = self.faces[rows, 2::-1]
        if corners.shape[1] == 4:
            quads = rows[self.faces[rows, 3] >= 0]
            corners[quads] = self.faces[quads][:, [0, 3, 2, 1]]
        return Surface(self.name, self.vertices, corners, self.material)

    def __repr__(self) -> str:
        return f"Surface({self.name!r}, {len(self.vertices):,} vertices, {len(self.faces):,} faces, {self.material!r})"

    def _geometry_problems(self) -> list[str]:
        found = []
        bad = np.flatnonzero(~np.isfinite(self.vertices).all(axis=1))
        if bad.size:
            found.append(f"vertices are not finite: {_some(bad)}; mend the file or leave them out")
        elif float(np.abs(self.vertices).max(initial=0.0)) > LARGEST:
            found.append(
                f"coordinates reach {np.abs(self.vertices).max():.3g} m, at most {LARGEST:g} can be computed with; "
                "mend the file or choose another unit of length"
            )
        lowest = np.zeros(self.faces.shape[1], dtype=np.int64)
        if self.faces.shape[1] == 4:
            lowest[3] = -1  # -1 pads a triangle
        outside = (self.faces < lowest) | (self.faces >= len(self.vertices))
        bad = np.flatnonzero(outside.any(axis=1))
        if bad.size:
            index = self.faces[bad[0]][outside[bad[0]]][0]
            found.append(f"index {index} is outside 0 … {len(self.vertices) - 1} in faces {_some(bad)}")
        return found


@dataclass(frozen=True, eq=False, init=False)
class Scene:
    """Surfaces and the sky around them.

    Parameters
    ----------
    surfaces : sequence of Surface
    sky : array_like (C,), optional
        Radiance of everything outside, W/(m² sr); black by default.
    name : str, optional
    closed : bool or None, optional
        Whether no light can escape. None: found out from the mesh. In a closed scene a ray that hits
        nothing is a leak, not sky.

    Raises
    ------
    SceneError
        No surfaces, two surfaces of one name, different numbers of channels, a sky that is negative or not finite.

    Examples
    --------
    >>> floor = Surface("floor", [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2, 3]], Material(0.5))
    >>> Scene([floor], sky=[1.0]).channels
    1
    """

    surfaces: tuple[Surface, ...]
    sky: FloatArray
    name: str
    closed: bool | None

    def __init__(
        self, surfaces: Iterable[Surface], sky: ArrayLike = 0.0, name: str = "scene", closed: bool | None = None
    ) -> None:
        _set(self, surfaces=tuple(surfaces), sky=_per_channel(sky, "sky"), name=name, closed=closed)
        self._refuse_bad()
        if self.sky.size != self.channels:
            _set(self, sky=_frozen(np.full(self.channels, self.sky[0]), np.float64))

    @property
    def channels(self) -> int:
        """Number of channels C (3 for RGB)."""
        return max([surface.material.channels for surface in self.surfaces] + [self.sky.size])

    @property
    def surface_names(self) -> tuple[str, ...]:
        """Names in the order of `surfaces`; `Patches.surface` indexes them."""
        return tuple(surface.name for surface in self.surfaces)

    def __repr__(self) -> str:
        names = ", ".join(self.surface_names[:SURFACES_SHOWN]) + (" …" if len(self.surfaces) > SURFACES_SHOWN else "")
        faces = sum(len(surface.faces) for surface in self.surfaces)
        return f"<Scene {self.name!r}: {len(self.surfaces)} surfaces ({names}), {faces:,} faces, sky {self.sky}>"

    def validate(self) -> tuple[Finding, ...]:
        """Report everything about the geometry and the light that is wrong, doubtful or good to know.

        What no scene may have was refused when the scene and its surfaces were made.

        Returns
        -------
        tuple of Finding
            Errors, warnings, notes: each with surfaces, place, number and remedy. See `radiosity.inspection.findings`.

        Examples
        --------
        >>> floor = Surface("floor", [[0, 0, 0], [1, 0, 0], [1, 1, 0]], [[0, 1, 2]], Material(0.5))
        >>> [finding.kind for finding in Scene([floor], sky=1.0).validate()]
        ['open edges']
        """
        from .inspection import findings

        return findings(self)

    def fixed_normals(self) -> Scene:
        """Turn round the faces of closed shells that look the wrong way; see `radiosity.inspection.fixed_normals`.

        Warns
        -----
        GeometryWarning
            Which surfaces had faces turned, and how many.
        """
        from .inspection import fixed_normals

        return fixed_normals(self)

    def _refuse_bad(self) -> None:
        """Check the scene as a whole; its surfaces checked themselves when they were made.

        Raises
        ------
        SceneError
            Everything that is wrong, in one message.
        """
        if not self.surfaces:
            raise SceneError(f"scene {self.name!r} is empty: it has no surfaces to light")
        strangers = [s for s in self.surfaces if not isinstance(s, Surface)]
        if strangers:
            raise SceneError(f"scene {self.name!r}: {strangers[0]!r} is not a Surface")
        problems = []
        names = self.surface_names
        if repeated := sorted(name for name, times in Counter(names).items() if times > 1):
            problems.append(f"surfaces share a name: {', '.join(map(repr, repeated))}; rename all but one")
        counts = {s.material.channels for s in self.surfaces} | {self.sky.size}
        if len(counts - {1}) > 1:
            odd = ", ".join(f"{s.name!r} {s.material.channels}" for s in self.surfaces)
            problems.append(f"channels differ (sky {self.sky.size}, {odd}); give as many everywhere, or one for all")
        if not (np.isfinite(self.sky).all() and (self.sky >= 0).all()):
            problems.append(f"sky {self.sky} W/(m² sr) is negative or not finite")
        if problems:
            raise SceneError(f"scene {self.name!r}: " + "; ".join(problems))
