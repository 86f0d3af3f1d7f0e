"""The picture as a GLB: the patches with their light baked into the colours of their corners, for any 3D program.

Colours in glTF are linear, so what is stored is the tone-mapped light before the sRGB encoding; the program that shows
the file encodes it. `KHR_materials_unlit` keeps that program from lighting the room a second time.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .. import display
from .._version import __version__
from ..files.gltf_write import glb
from ..files.provenance import provenance
from .mesh import corner_points, corner_weights
from .state import Pane, Series, ViewState, coloured, start

if TYPE_CHECKING:
    from ..solution import Solution

FLOAT, UNSIGNED_SHORT, UNSIGNED_INT = 5126, 5123, 5125
VERTEX_DATA, INDICES = 34962, 34963
UNLIT = "KHR_materials_unlit"


def write_baked(solution: Solution, path: str | Path, *, pane: Pane = "sum", **settings: Any) -> Path:
    """Write the light of a solution as the colours of a GLB.

    Parameters
    ----------
    solution : Solution
    path : path
        Ends in .glb.
    pane : {"sum", "order"}
        All light so far, or that of one bounce.
    **settings
        Fields of `ViewState`: ``order`` (the last by default), ``exposure``, ``tone``, ``smooth``, ….

    Returns
    -------
    Path
    """
    series = Series.of(solution)
    state = start(series, **{"order": series.last, **settings})
    colours = baked_colours(solution, series, state, pane)
    path = Path(path)
    path.write_bytes(glb(*_document(solution, series, state, pane, colours)))
    return path


def baked_colours(solution: Solution, series: Series, state: ViewState, pane: Pane) -> NDArray[np.float64]:
    """Linear colours in [0, 1] of the corners of all patches, (N, 4, 3)."""
    light = series.light(state, pane)
    light = corner_weights(solution.patches) @ light if state.smooth else np.repeat(light, 4, axis=0)
    if state.false_colour or state.mark_clipped:
        linear = display.decode_srgb(coloured(series, state, pane, light))
    else:
        linear = display.TONE_OPERATORS[state.tone](np.asarray(light * series.factor(state, pane), dtype=np.float64))
    return np.asarray(linear, dtype=np.float64).reshape(-1, 4, 3)


def _document(
    solution: Solution, series: Series, state: ViewState, pane: Pane, colours: NDArray[np.float64]
) -> tuple[dict[str, Any], bytes]:
    """One node and mesh for each surface."""
    patches = solution.patches
    points = corner_points(patches)
    parts = _Parts()
    meshes = []
    for number, name in enumerate(patches.surface_names):
        mine = np.flatnonzero(patches.surface == number)
        if mine.size:
            meshes.append((name, parts.primitive(points[mine], colours[mine], patches.faces[mine, 3] >= 0)))
    document = {
        "asset": {"version": "2.0", "generator": f"radiosity {__version__}"},
        "extensionsUsed": [UNLIT],
        "scene": 0,
        "scenes": [{"name": patches.name, "nodes": list(range(len(meshes)))}],
        "nodes": [{"name": name, "mesh": k} for k, (name, _) in enumerate(meshes)],
        "meshes": [{"name": name, "primitives": [primitive]} for name, primitive in meshes],
        "materials": [{"name": "light", "extensions": {UNLIT: {}}, "pbrMetallicRoughness": {"metallicFactor": 0}}],
        "accessors": parts.accessors,
        "bufferViews": parts.views,
        "buffers": [{"byteLength": len(parts.binary)}],
        "extras": {
            "radiosity_baked": {
                "shows": pane,
                "order": state.order,
                "tone": state.tone,
                "factor": series.factor(state, pane),
                **provenance(solution.scene),
                "settings": json.loads(json.dumps(solution.settings, default=str)),
            }
        },
    }
    return document, bytes(parts.binary)


class _Parts:
    """Arrays of a document, one view and accessor each."""

    def __init__(self) -> None:
        self.binary = bytearray()
        self.views: list[dict[str, Any]] = []
        self.accessors: list[dict[str, Any]] = []

    def primitive(
        self, points: NDArray[np.float64], colours: NDArray[np.float64], quad: NDArray[np.bool_]
    ) -> dict[str, Any]:
        """Triangles of patches given by corners (M, 4, 3); the second triangle of a triangular patch is left out."""
        position = points.reshape(-1, 3).astype("<f4")
        colour = np.full((len(position), 4), 65535, dtype="<u2")
        colour[:, :3] = np.rint(colours.reshape(-1, 3) * 65535.0)
        first = 4 * np.arange(len(points), dtype="<u4")[:, None]
        triangles = np.concatenate([first + np.array([0, 1, 2], "<u4"), first[quad] + np.array([0, 2, 3], "<u4")])
        bounds = {"min": position.min(axis=0).tolist(), "max": position.max(axis=0).tolist()}
        return {
            "attributes": {
                "POSITION": self._accessor(position, "VEC3", FLOAT, VERTEX_DATA, **bounds),
                "COLOR_0": self._accessor(colour, "VEC4", UNSIGNED_SHORT, VERTEX_DATA, normalized=True),
            },
            "indices": self._accessor(triangles.reshape(-1).astype("<u4"), "SCALAR", UNSIGNED_INT, INDICES),
            "material": 0,
        }

    def _accessor(self, array: NDArray[Any], kind: str, component: int, target: int, **more: Any) -> int:
        content = array.tobytes()
        view = {"buffer": 0, "byteOffset": len(self.binary), "byteLength": len(content), "target": target}
        self.binary += content + b"\0" * (-len(content) % 4)
        self.views.append(view)
        accessor = {"bufferView": len(self.views) - 1, "componentType": component, "count": len(array), "type": kind}
        self.accessors.append(accessor | more)
        return len(self.accessors) - 1
