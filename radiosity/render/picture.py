"""`render`: a solution lit as seen."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from ..camera import Camera, presets
from ..errors import MemoryLimitError, ParameterError
from ..parallel import blocks, ordered_map
from ..patches import Patches
from ..progress import Progress, quiet
from ..rays import Tracer
from ..sequences import seed_key
from .aim import bright_patches
from .kernels import FloatArray, Pieces, View
from .share import MOMENTS, share
from .strips import Light, Strip, StripTracer

SAMPLES_AT_ONCE = 1 << 13  # of a strip: their rays stay in cache
MOST_SAMPLES = 1 << 12
MOST_BYTES = 8 << 30
PIECES = 1.5  # surfaces that a pixel shows, on the average of a cluttered picture
RELATIVE = 1e-9  # of a length or an angle, below which a camera has no direction


class Factors(Protocol):
    """What is needed of form factors."""

    def gather(self, radiosity: FloatArray) -> FloatArray:
        """Product F @ B."""


class Solved(Protocol):
    """What is needed of a `Solution`."""

    @property
    def patches(self) -> Patches:
        """N patches."""

    @property
    def factors(self) -> Factors:
        """Form factors between them."""

    @property
    def radiosity(self) -> FloatArray:
        """W/m², (N, C)."""

    @property
    def orders(self) -> FloatArray | None:
        """Light by number of bounces, W/m², (K + 1, N, C)."""

    @property
    def bounces(self) -> int | None:
        """Where the series was cut on request."""


def render(
    solution: Solved,
    camera: Camera | None = None,
    size: tuple[int, int] = (640, 400),
    *,
    samples: int = 16,
    seed: int = 0,
    threads: int | None = None,
    progress: Progress | None = None,
) -> FloatArray:
    """Picture of a solution as a camera would take it: sharp shadows, and no patches to be seen.

    The light that leaves each point seen is worked out anew, L = (E + ρ H) / π, from its own irradiance H: straight
    from emitters in closed form, as far as shadow rays find them unhidden; from everything else, and the sky, by rays
    into the room, which meet the patches' light. The picture shows as many bounces as the solution holds. Neighbouring
    pixels share what they know of indirect light. Faces that look away from the camera are left out, as in a doll's
    house, unless they are two-sided; the light meets them all the same.

    Parameters
    ----------
    solution : Solution
    camera : Camera, optional
        By default the first of `radiosity.camera.presets`.
    size : tuple of int
        Width and height, pixels.
    samples : int, optional
        Rays of the camera per pixel, spread over its square; powers of two serve best. Each sends four rays to
        emitters, twelve more where they are partly hidden, and four into the room (eight, where a few patches outshine
        all others).
    seed : int, optional
    threads : int, optional
        As many as there are processors by default. The picture has the same bits for any number.
    progress : callable, optional
        Called as ``progress(stage, done, total)``; stages are "render" (pixels) and "share" (rows).

    Returns
    -------
    ndarray (height, width, C)
        Linear radiance, W/(m² sr), rows from the top. See `radiosity.display` for how to make bytes of it.

    Raises
    ------
    ParameterError
        A size, a number of samples or a camera that gives no picture.
    MemoryLimitError
        A picture that would need more than 8 GB.

    Notes
    -----
    Final gather (Reichert 1992; Cohen & Wallace 1993, §10.4) with direct light apart (Shirley 1990). Indirect light is
    blurred by about two pixels, and further where that hides less detail than noise; direct light is not.

    Examples
    --------
    In a furnace every wall has the same light from everywhere, B = E / (1 - ρ):

    >>> import numpy as np
    >>> import radiosity as rad
    >>> solution = rad.solve(rad.scenes.furnace(reflectance=0.5, emission=1.0), patch_count=96)
    >>> picture = rad.render(solution, size=(8, 6), samples=4)
    >>> picture.shape, bool(np.allclose(np.pi * picture, 2.0, rtol=1e-5))
    ((6, 8, 1), True)
    """
    patches = solution.patches
    width, height = _checked_size(size, patches.channels)
    _check_samples(samples)
    seed_key(seed)
    tracer = Tracer(patches.grid)
    view = _view(presets(patches)[0] if camera is None else camera, width, height, tracer)
    light = _light(solution)
    if solution.bounces == 0:
        patches = replace(patches, reflectance=np.zeros_like(patches.reflectance))
    targets = bright_patches(patches, light.reflected.sum(axis=1), tracer.scale, solution.factors.gather)
    work = StripTracer(tracer, _camera_tracer(patches, view, tracer), patches, light, targets, view, samples, seed)
    tell = progress or quiet
    spans = blocks(width * height, max(1, SAMPLES_AT_ONCE // samples))
    strips = []
    for (_, done), strip in zip(spans, ordered_map(work, spans, threads), strict=True):
        strips.append(strip)
        tell("render", done, width * height)
    return _composed(strips, width, threads, tell).reshape(height, width, -1)


def _checked_size(size: tuple[int, int], channels: int) -> tuple[int, int]:
    """Width and height, if a picture of that size can be made."""
    if len(size) != 2 or not all(isinstance(s, (int, np.integer)) and s >= 1 for s in size):
        raise ParameterError(f"size is {size}; give width and height, in pixels, as whole numbers from 1")
    width, height = int(size[0]), int(size[1])
    numbers = channels + PIECES * (8 + 2 * channels + 2 * (channels + MOMENTS + 1))
    needed = 2 * 8 * numbers * width * height  # strips, and the whole that is made of them
    if needed > MOST_BYTES:
        raise MemoryLimitError(
            f"a picture of {width} × {height} pixels with {channels} channels would need about {needed / 1e9:.0f} GB, "
            f"more than {MOST_BYTES / 1e9:.0f}; make a smaller one"
        )
    return width, height


def _check_samples(samples: int) -> None:
    if not isinstance(samples, (int, np.integer)) or not 1 <= samples <= MOST_SAMPLES:
        raise ParameterError(f"samples is {samples!r}; give a whole number from 1 to {MOST_SAMPLES}")


def _view(camera: Camera, width: int, height: int, tracer: Tracer) -> View:
    """The camera in unit coordinates. Its angle spans the shorter side of the picture."""
    eye, target, up = (np.asarray(v, dtype=np.float64) for v in (camera.position, camera.focal_point, camera.up))
    if not (all(v.shape == (3,) and np.isfinite(v).all() for v in (eye, target, up)) and 0.0 < camera.fov < 180.0):
        raise ParameterError(f"{camera} is no pinhole; give finite points (x, y, z) and an angle between 0° and 180°")
    forward = target - eye
    distance, upright = np.linalg.norm(forward), np.linalg.norm(up)
    right = np.cross(forward, up)
    across = np.linalg.norm(right)
    if not across > RELATIVE * distance * upright or not distance > RELATIVE * np.abs(eye).max():
        raise ParameterError(
            f"the camera at {camera.position} looks to {camera.focal_point} with {camera.up} as up: these leave open "
            "what it sees; look at another point than where it stands, and not along up"
        )
    forward, right = forward / distance, right / across
    down = np.cross(forward, right)
    step = 2.0 * math.tan(math.radians(camera.fov) / 2.0) / min(width, height)
    corner = forward - 0.5 * step * (width * right + height * down)
    return View(tracer.to_unit(eye), corner, step * right, step * down, width, height)


def _camera_tracer(patches: Patches, view: View, tracer: Tracer) -> Tracer:
    """What the camera's rays meet: not the backs of one-sided faces."""
    faces = patches.grid.faces
    to_eye = view.eye - tracer.to_unit(faces.corners[:, 0])
    shown = faces.two_sided | (np.einsum("fx,fx->f", to_eye, faces.normal) > 0.0)
    return tracer if shown.all() or not shown.any() else Tracer(patches.grid, shown)


def _light(solution: Solved) -> Light:
    """The light that goes on to the points seen: one bounce less than they are to show."""
    patches, orders, bounces = solution.patches, solution.orders, solution.bounces
    reflected = solution.radiosity - patches.emission
    if bounces and orders is not None and len(orders) == bounces + 1:
        reflected = reflected - orders[-1]
    elif not bounces and bounces is not None:
        reflected = np.zeros_like(reflected)
    direct = patches.reflectance * solution.factors.gather(patches.emission)
    if bounces is not None and bounces < 2:
        direct = np.zeros_like(direct)
    return Light(patches.emission, reflected, direct)


def _composed(strips: list[Strip], width: int, threads: int | None, tell: Progress) -> FloatArray:
    """The picture (pixels, C) of all strips, in order."""
    ends = np.cumsum([len(strip.pieces.point) for strip in strips])
    begin = [strip.pieces.begin[:-1] + end - len(strip.pieces.point) for strip, end in zip(strips, ends, strict=True)]
    pieces = Pieces(np.concatenate([*begin, ends[-1:]]), *(_joined([s.pieces[k] for s in strips]) for k in range(1, 5)))
    gathered, rays = _joined([s.gathered for s in strips]), _joined([s.rays for s in strips])
    shared = share(pieces, gathered, rays, width, threads, lambda done, total: tell("share", done, total))
    picture = _joined([strip.picture for strip in strips])
    light = pieces.tint * (_joined([strip.direct for strip in strips]) + shared)
    np.add.at(picture, np.repeat(np.arange(len(picture)), np.diff(pieces.begin)), light)
    return picture


def _joined(parts: list[NDArray]) -> NDArray:  # type: ignore[type-arg]
    return np.concatenate(parts)
