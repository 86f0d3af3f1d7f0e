"""The page: a solution in one HTML file that needs no network, no Python and no installation to be played with.

All orders are inside, and the shortcuts, wrong on purpose. `page_data` packs them; the scripts in web/ draw them.
"""

from __future__ import annotations

import html
import json
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .. import display
from .page_data import begin_data, pack_json, scene_data, shortcut_words
from .state import Series

if TYPE_CHECKING:
    from ..solution import Solution

SCRIPTS = ("data.js", "draw.js", "plots.js", "light.js", "app.js", "talk.js", "begin.js")


def write_page(
    solution: Solution, path: str | Path, *, title: str = "", caption: str = "", wrong: bool = True, **settings: Any
) -> Path:
    """Write a solution as a self-contained page.

    Parameters
    ----------
    solution : Solution
    path : path
        Ends in .html.
    title, caption : str, optional
        Above the picture; by default the scene's name and what there is to see.
    wrong : bool, optional
        Whether the shortcuts of `radiosity.shortcuts` are inside; some trace rays, which takes seconds.
    **settings
        Fields of `ViewState` to begin with, such as ``order=2, normalised=True``.

    Returns
    -------
    Path

    Raises
    ------
    ParameterError
        A setting that a page does not have.
    """
    path = Path(path)
    path.write_text(page(solution, title=title, caption=caption, wrong=wrong, **settings), encoding="utf-8")
    return path


def page(solution: Solution, *, title: str = "", caption: str = "", wrong: bool = True, **settings: Any) -> str:
    """The text of the page; see `write_page`."""
    series = Series.of(solution)
    data = {"scenes": [scene_data(solution, series, wrong=wrong)], "begin": begin_data(series, settings)}
    return document(
        data,
        title=title or f"Light in {solution.patches.name}, bounce by bounce",
        caption=caption or default_caption(solution, series),
        tables=[power_table(series)],
    )


def document(data: dict[str, Any], *, title: str, caption: str, tables: list[str], talk: str = "") -> str:
    """A page from what is inside it.

    Parameters
    ----------
    data : dict
        "scenes": of `scene_data`; "begin": the state; lectures add their "talk".
    title, caption : str
        Plain text.
    tables : list of str
        HTML, for those who do not see the picture.
    talk : str, optional
        HTML of a lecture's words, for those whose browser draws nothing.
    """
    if any("wrong" in scene for scene in data["scenes"]):
        data = {**data, "shortcuts": pack_json(shortcut_words())}
    colours = {"falseColours": display.FALSE_COLOURS.astype(int).tolist(), "diverging": display.DIVERGING}
    parts = {
        "title": html.escape(title),
        "caption": html.escape(caption),
        "kind": "lecture" if talk else "page",
        "talk": talk,
        "tables": "\n".join(tables),
        "data": script_json({**data, **colours}),
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
    fading = f" Of the emitted power, bounces 1, 2, … carry {shares}." if shares else ""
    patches = solution.patches
    return (
        f"{len(patches):,} patches, {series.last} bounces: one term of L = Lₑ + T Lₑ + T² Lₑ + … beside the sum so far."
        f"{fading}"
    )


def power_table(series: Series, scene: str = "") -> str:
    """Power of each bounce as an HTML table."""
    channels = series.power.shape[1]
    names = ("red", "green", "blue") if channels == 3 else tuple(str(c) for c in range(channels))
    heads = "".join(f'<th scope="col">{name}, W</th>' for name in names)
    rows = "".join(
        f'<tr><th scope="row">{k}</th>' + "".join(f"<td>{watts:.4g}</td>" for watts in power) + "</tr>"
        for k, power in enumerate(series.power)
    )
    caption = "Power that leaves the surfaces with each bounce" + (f": {html.escape(scene)}" if scene else "")
    return f'<table><caption>{caption}</caption><tr><th scope="col">bounce</th>{heads}</tr>{rows}</table>'
