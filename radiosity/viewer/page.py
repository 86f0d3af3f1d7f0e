"""The page: a solution in one HTML file that needs no network, no Python and no installation to be played with.

All orders are inside. Light is stored as the logarithm of each channel in 2047 steps over 20 stops below the brightest
patch of its order: 0.34 % off at most, less than one of 255 steps of a screen. Neighbouring patches
differ little, so differences of the codes pack well.
"""

from __future__ import annotations

import base64
import gzip
import html
import json
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .. import display
from ..camera import presets
from .state import Series, start

if TYPE_CHECKING:
    from ..patches import Patches
    from ..solution import Solution

STOPS = 20  # factors of two below the brightest patch of an order; what is darker is stored as black
LEVELS = 2047
GRID_BITS = 22  # corners are kept to this share, 2⁻²², of the scene's size
SCRIPTS = ("data.js", "draw.js", "plots.js", "app.js")


def write_page(solution: Solution, path: str | Path, *, title: str = "", caption: str = "") -> Path:
    """Write a solution as a self-contained page.

    Parameters
    ----------
    solution : Solution
    path : path
        Ends in .html.
    title, caption : str, optional
        Above the picture; by default the scene's name and what there is to see.

    Returns
    -------
    Path
    """
    path = Path(path)
    path.write_text(page(solution, title=title, caption=caption), encoding="utf-8")
    return path


def page(solution: Solution, *, title: str = "", caption: str = "") -> str:
    """The text of the page; see `write_page`."""
    series = Series.of(solution)
    patches = solution.patches
    parts = {
        "title": html.escape(title or f"Light in {patches.name}, bounce by bounce"),
        "caption": html.escape(caption or default_caption(solution, series)),
        "table": power_table(series),
        "data": script_json(page_data(patches, series)),
        "style": asset("page.css"),
        "script": "\n".join(asset(name) for name in SCRIPTS) + "\n",
    }
    text = asset("page.html")
    # One pass, so that a scene named "{script}" is only a name.
    pieces = []
    while "{" in text:
        before, _, rest = text.partition("{")
        name, _, text = rest.partition("}")
        pieces += [before, parts[name]]
    return "".join([*pieces, text])


def asset(name: str) -> str:
    """A file of the page's source."""
    return resources.files(__package__).joinpath("web", name).read_text(encoding="utf-8")


def script_json(value: Any) -> str:
    """JSON that cannot end the script element it stands in, whatever a scene's surfaces are called."""
    return json.dumps(value, ensure_ascii=False, allow_nan=False, separators=(",", ":")).replace("<", "\\u003c")


def default_caption(solution: Solution, series: Series) -> str:
    """What there is to see, in two sentences, also for those who do not see it."""
    power = series.power.sum(axis=1)
    shares = ", ".join(f"{share:.0%}" for share in power[1:4] / power[0]) if power[0] > 0 else ""
    fading = f" Against the emitted power, the first bounces carry {shares}." if shares else ""
    patches = solution.patches
    return (
        f"{len(patches):,} patches on {len(patches.surface_names)} surfaces, {series.last} bounces. One term of the "
        f"series L = Lₑ + T Lₑ + T² Lₑ + … beside the sum so far.{fading}"
    )


def power_table(series: Series) -> str:
    """Power of each bounce as an HTML table."""
    channels = series.power.shape[1]
    names = ("red", "green", "blue") if channels == 3 else tuple(str(c) for c in range(channels))
    heads = "".join(f'<th scope="col">{name}, W</th>' for name in names)
    rows = "".join(
        f'<tr><th scope="row">{k}</th>' + "".join(f"<td>{watts:.4g}</td>" for watts in power) + "</tr>"
        for k, power in enumerate(series.power)
    )
    caption = "Power that leaves the surfaces with each bounce"
    return f'<table><caption>{caption}</caption><tr><th scope="col">bounce</th>{heads}</tr>{rows}</table>'


def page_data(patches: Patches, series: Series) -> dict[str, Any]:
    """Everything that the page's script needs, ready for JSON."""
    grey = bool(np.array_equal(series.orders[..., :1].repeat(3, axis=-1), series.orders))
    light = series.orders[..., :1] if grey else series.orders
    planes = np.moveaxis(light, -1, 1).reshape(-1, len(patches))
    brightest = planes.max(axis=1)
    low, step, grid = on_grid(patches.vertices)
    common_scale = start(series)
    return {
        "patches": len(patches),
        "orders": len(series.orders),
        "channels": 1 if grey else 3,
        "stops": STOPS,
        "levels": LEVELS,
        "brightest": [float(value) for value in brightest],
        "light": pack(light_codes(planes, brightest)),
        "vertexCount": len(grid),
        "low": [float(value) for value in low],
        "step": step,
        "vertices": pack(grid.T),
        "faces": pack(patches.faces.T),
        "surface": pack(patches.surface[None]),
        "surfaceNames": list(patches.surface_names),
        "radius": 0.5 * float(np.linalg.norm(np.ptp(grid, axis=0))) * step,
        "cameras": [vars(camera) for camera in presets(patches)],
        "power": series.power.tolist(),
        "common": series.common,
        "own": series.own.tolist(),
        "scale": series.scale(common_scale, "sum"),
        "ownScales": [
            series.scale(common_scale.at(k).toggled("normalised"), "order") for k in range(len(series.orders))
        ],
        "falseColours": display.FALSE_COLOURS.astype(int).tolist(),
    }


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
    return base64.b64encode(gzip.compress(np.ascontiguousarray(planes).tobytes(), 9, mtime=0)).decode("ascii")
