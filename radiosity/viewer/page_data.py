"""What is inside a page: patches, and their light by bounces and by shortcuts, as text that takes little room.

Light is stored as the logarithm of each channel in 2047 steps over 20 stops below the brightest patch of its order:
0.34 % off at most, less than one of 255 steps of a screen. Neighbouring patches differ little, so differences of
the codes pack well.
"""

from __future__ import annotations

import base64
import gzip
import io
import json
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .. import display
from ..camera import Camera, presets
from .state import Series, ViewState, start

if TYPE_CHECKING:
    from ..patches import Patches
    from ..solution import Solution

STOPS = 20  # factors of two below the brightest patch of an order; what is darker is stored as black
LEVELS = 2047
GRID_BITS = 22  # corners are kept to this share, 2⁻²², of the scene's size
SAME = 1e-6  # of the brightest patch: how near light is to a partial sum that is stored in its place

# Fields of `ViewState` that a page can begin with, and what its script calls them.
IN_SCRIPT = {
    "order": "k", "exposure": "ev", "tone": "tone", "normalised": "normalised", "mark_clipped": "markClipped",
    "false_colour": "falseColour", "smooth": "smooth", "preset": "camera", "picked": "picked", "other": "other",
    "left": "left", "wrong": "wrong", "difference": "difference", "playing": "playing",
}  # fmt: skip
LEFT_IN_SCRIPT = {"order": "order", "hemicube": "sees", "wrong": "wrong"}


def scene_data(solution: Solution, series: Series, *, wrong: bool = True) -> dict[str, Any]:
    """A solution, ready for JSON: its patches, its light, and if asked for the light of all shortcuts."""
    data = light_data(solution, series)
    if wrong:
        data["wrong"] = wrong_data(solution, series)
    return {**patch_data(solution.patches), **data}


def patch_data(patches: Patches) -> dict[str, Any]:
    """Where the patches are."""
    low, step, grid = on_grid(patches.vertices)
    return {
        "patches": len(patches),
        "vertexCount": len(grid),
        "low": [float(value) for value in low],
        "step": step,
        "vertices": pack(grid.T),
        "faces": pack(patches.faces.T),
        "surface": pack(patches.surface[None]),
        "surfaceNames": list(patches.surface_names),
        "radius": 0.5 * float(np.linalg.norm(np.ptp(grid, axis=0))) * step,
        "cameras": [camera_data(camera) for camera in presets(patches)],
    }


def camera_data(camera: Camera) -> dict[str, Any]:
    """A camera as the script has it."""
    return {
        "position": list(camera.position),
        "target": list(camera.focal_point),
        "up": list(camera.up),
        "fov": camera.fov,
    }


def light_data(solution: Solution, series: Series) -> dict[str, Any]:
    """Light of each order, and what the exposure and the scales need."""
    begin = start(series)
    grey = is_grey(series.orders)
    return {
        "orders": len(series.orders),
        **planes_data(series.orders, grey),
        "power": series.power.tolist(),
        "common": series.common,
        "own": series.own.tolist(),
        "scale": series.scale(begin, "sum"),
        "ownScales": [series.scale(begin.at(k).toggled("normalised"), "order") for k in range(len(series.orders))],
        "status": solution.status,
    }


def wrong_data(solution: Solution, series: Series) -> dict[str, Any]:
    """Light of every shortcut; those that are a partial sum of the series by its number."""
    from ..shortcuts import ALL

    truth = display.luminance(series.sums[-1].astype(np.float64))
    kept, sums, off = [], [], []
    for shortcut in ALL:
        light = display.as_rgb(np.asarray(shortcut.radiosity(solution.patches, solution.factors, solution.radiosity)))
        same = [k for k, total in enumerate(series.sums) if np.abs(light - total).max() <= SAME * light.max()]
        sums.append(same[0] if same else -1)
        if not same:
            kept.append(light.astype(np.float32))
        gap = np.abs(display.luminance(light.astype(np.float64)) - truth)
        relative = np.divide(gap, truth, out=np.zeros_like(truth), where=truth > 0)
        off.append(float(np.sum(series.area * relative) / series.area.sum()))
    planes = planes_data(np.array(kept).reshape(-1, *series.sums[0].shape), is_grey(series.orders))
    return {"sums": sums, "off": off, "count": len(kept), **planes}


def is_grey(light: NDArray[np.float32]) -> bool:
    """Whether all channels of light (…, 3) are one."""
    return bool(np.array_equal(light[..., :1].repeat(3, axis=-1), light))


def planes_data(light: NDArray[np.float32], grey: bool) -> dict[str, Any]:
    """Light (n, N, 3), packed; of grey light one channel."""
    planes = np.moveaxis(light[..., :1] if grey else light, -1, 1).reshape(-1, light.shape[1])
    brightest = planes.max(axis=1, initial=0.0)
    return {
        "channels": 1 if grey else 3,
        "stops": STOPS,
        "levels": LEVELS,
        "brightest": [float(value) for value in brightest],
        "light": pack(light_codes(planes, brightest)),
    }


def shortcut_words() -> list[dict[str, str]]:
    """Name, sentence and struck-out equation of every shortcut."""
    from ..shortcuts import ALL

    return [{"name": one.name, "sentence": one.sentence, "equation": equation_svg(one.equation)} for one in ALL]


def equation_svg(mathtext: str) -> str:
    """An equation typeset by matplotlib, the letters as curves, light on nothing."""
    import matplotlib
    from matplotlib.backends.backend_svg import FigureCanvasSVG
    from matplotlib.figure import Figure

    from .overlay import INK

    figure = Figure(figsize=(8.0, 1.2))
    FigureCanvasSVG(figure)
    figure.text(0.5, 0.5, mathtext, color=INK, fontsize=18, ha="center", va="center")
    file = io.StringIO()
    with matplotlib.rc_context({"svg.fonttype": "path", "svg.hashsalt": "radiosity"}):
        figure.savefig(file, format="svg", transparent=True, bbox_inches="tight", metadata={"Date": None})
    text = file.getvalue()
    return text[text.index("<svg") :]


def begin_data(series: Series, settings: dict[str, Any]) -> dict[str, Any]:
    """Fields of `ViewState` as the page's script has them.

    Raises
    ------
    ParameterError
        A setting that no view has, or that a page cannot show.
    """
    from ..errors import ParameterError

    state = start(series, **settings)
    if unable := sorted(name for name in settings if name not in IN_SCRIPT):
        raise ParameterError(f"a page cannot show {', '.join(unable)}; it can {', '.join(sorted(IN_SCRIPT))}")
    if state.left not in LEFT_IN_SCRIPT:
        raise ParameterError(f"the left pane of a page cannot show {state.left!r}; it can {', '.join(LEFT_IN_SCRIPT)}")
    return {**state_data(state, settings), **({"left": LEFT_IN_SCRIPT[state.left]} if "left" in settings else {})}


def state_data(state: ViewState, names: Sequence[str] | dict[str, Any]) -> dict[str, Any]:
    """Some fields of a state under the script's names, but for `left`."""
    return {IN_SCRIPT[name]: getattr(state, name) for name in names if name in IN_SCRIPT and name != "left"}


def light_codes(planes: NDArray[np.float32], brightest: NDArray[np.float32]) -> NDArray[np.int64]:
    """Codes 0 (black), 1 … `LEVELS` of light (planes, N): steps of its logarithm below the brightest of each plane."""
    top = np.where(brightest > 0, brightest, 1.0)[:, None].astype(np.float64)
    share = planes / top
    stops_down = np.log2(np.maximum(share, 2.0**-STOPS / 2))
    codes = 1 + np.rint((stops_down / STOPS + 1.0) * (LEVELS - 1)).astype(np.int64)
    return np.where(share >= 2.0**-STOPS, codes, 0)


def on_grid(vertices: NDArray[np.float64]) -> tuple[NDArray[np.float64], float, NDArray[np.int64]]:
    """Points as integers on a fine grid: lowest corner, step in metres, (V, 3)."""
    low = vertices.min(axis=0)
    step = float(np.ptp(vertices, axis=0).max()) / (2**GRID_BITS - 1) or 1.0
    return low, step, np.rint((vertices - low) / step).astype(np.int64)


def pack(numbers: NDArray[np.integer[Any]]) -> str:
    """Rows of integers (R, M) for `unpack` in data.js.

    Differences along each row, the sign moved to the lowest bit so that small ones of either sign have zero high bytes,
    byte by byte, gzip, base64.
    """
    rows = np.ascontiguousarray(numbers, dtype=np.int64)
    steps = np.diff(rows, axis=1, prepend=0)
    folded = (np.where(steps < 0, -2 * steps - 1, 2 * steps)).astype("<u4").ravel()
    depth = max(1, (int(folded.max(initial=0)).bit_length() + 7) // 8)
    planes = folded.view(np.uint8).reshape(-1, 4).T[:depth]
    return pack_bytes(np.ascontiguousarray(planes).tobytes())


def pack_bytes(content: bytes) -> str:
    """Bytes for `inflate` in data.js."""
    return base64.b64encode(gzip.compress(content, 9, mtime=0)).decode("ascii")


def pack_json(value: Any) -> str:
    """Anything for `inflateJSON` in data.js."""
    return pack_bytes(json.dumps(value, ensure_ascii=False, separators=(",", ":")).encode())
