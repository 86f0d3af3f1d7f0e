"""A lecture as one page: its words, and the picture of each step, live, to be turned and played with."""

from __future__ import annotations

import base64
import html
import io
import warnings
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from ..errors import UnusedFeatureWarning
from ..files.atomic import replacing
from ..viewer.inspect import HemicubeView, MatrixView, factor_colours
from ..viewer.page import document, power_table
from ..viewer.page_data import (
    IN_SCRIPT,
    LEFT_IN_SCRIPT,
    camera_data,
    light_data,
    pack,
    pack_json,
    patch_data,
    state_data,
    wrong_data,
)
from ..viewer.state import Series, start
from .lecture import VIEW, Place
from .plots import save_svg
from .talk import Talk

LEFTS = {**LEFT_IN_SCRIPT, "hemisphere": "sees", "solvers": "order"}  # the page unfolds the hemisphere as a hemicube
HEMICUBE = 192  # pixels an edge, for a row of form factors, as in the window


def write_lecture(talk: Talk, path: str | Path) -> Path:
    """Write a lecture as a self-contained page.

    Parameters
    ----------
    talk : Talk
    path : path
        Ends in .html.

    Returns
    -------
    Path

    Warns
    -----
    UnusedFeatureWarning
        A step shows what only the window can, such as the edges of patches.
    """
    text = lecture_page(talk)
    with replacing(path) as temporary:
        temporary.write_text(text, encoding="utf-8")
    return Path(path)


def lecture_page(talk: Talk) -> str:
    """The text of the page; see `write_lecture`."""
    pages = _Steps(talk)
    lecture = talk.lecture
    data = {"scenes": pages.scenes(), "begin": {}, "talk": pages.data()}
    several = len(talk.solutions) > 1
    tables = [power_table(series, name if several else "") for name, series in pages.series.items()]
    caption = f"A lecture in {len(lecture.steps)} steps, about {lecture.minutes:g} minutes"
    return document(data, title=lecture.title, caption=caption, tables=tables, talk=words(talk))


def words(talk: Talk) -> str:
    """All that is said, as HTML; the page's script shows it step by step."""
    articles = []
    for number in range(len(talk.lecture.steps)):
        said = talk.words(Place(talk.lecture, number))
        question = ""
        if said.question:
            reveal = '<button type="button" class="reveal">show the answer</button>'
            answer = f'<div class="answer">{_html(said.answer)}</div>'
            question = f'<div class="question">{_html(said.question)}{reveal}{answer}</div>'
        articles.append(f"<article><h2>{html.escape(said.title)}</h2>{_html(said.text)}{question}</article>")
    nav = (
        '<nav aria-label="Steps"><button type="button" id="talk-back">back</button><span id="talk-where"></span>'
        '<button type="button" id="talk-on">next</button></nav>'
    )
    body = f'<div id="words" aria-live="polite">{"".join(articles)}</div>'
    return f'<section id="talk" aria-label="Lecture">{body}<div id="dots"></div>{nav}</section>'


def _html(paragraphs: list[str]) -> str:
    return "".join(f"<p>{html.escape(part)}</p>" for part in paragraphs)


class _Steps:
    """The steps of a talk as the page's script has them, and what they need beside the scenes."""

    def __init__(self, talk: Talk) -> None:
        self.talk = talk
        self.names = list(talk.solutions)
        self.series = {name: Series.of(solution) for name, solution in talk.solutions.items()}
        self.figures: list[dict[str, str]] = []
        self.plates: list[dict[str, Any]] = []
        self.places = Place(talk.lecture).all()

    def data(self) -> dict[str, Any]:
        """What the script needs of the lecture."""
        lecture = self.talk.lecture
        steps: list[dict[str, Any]] = [{"minutes": step.minutes, "show": {}, "reveal": None} for step in lecture.steps]
        for place in self.places:
            steps[place.number]["reveal" if place.revealed else "show"] = self.shown(place)
        figures, plates = pack_json(self.figures), self.plates
        return {"steps": steps, "minutes": lecture.minutes, "figures": figures, "plates": plates}

    def scenes(self) -> list[dict[str, Any]]:
        """Each solution; those on the patches of one before say so, and shortcuts are there where a step shows them."""
        wanted = {self.talk.name(place) for place in self.places if place.shown.get("left") == "wrong"}
        found: list[dict[str, Any]] = []
        solutions = list(self.talk.solutions.values())
        for number, (name, series) in enumerate(self.series.items()):
            solution = solutions[number]
            same = [k for k in range(number) if solutions[k].patches.vertices is solution.patches.vertices]
            where = {"like": same[0]} if same else patch_data(solution.patches)
            wrong = {"wrong": wrong_data(solution, series)} if name in wanted else {}
            found.append({**where, **light_data(solution, series), **wrong})
        return found

    def shown(self, place: Place) -> dict[str, Any]:
        """What the page shows at a place."""
        name = self.talk.name(place)
        state = self.talk.view(place, start(self.series[name]))
        used = [field for field in place.shown if field in VIEW]
        shown = {"scene": self.names.index(name), "k": state.order, **state_data(state, used)}
        if state.picked >= 0:
            shown |= {"picked": state.picked, "other": state.other}
        if (camera := place.shown.get("camera")) is not None:
            shown["camera"] = camera_data(camera)
        shown |= self._left(place)
        if titles := self.talk.titles(place):
            shown["titles"] = [titles.get("order", ""), titles.get("sum", "")]
        unable = set(used) - set(IN_SCRIPT) - {"left", "dome"} | ({"solvers"} & {state.left})
        if unable:
            warnings.warn(
                f"step {place.step.title!r} shows {', '.join(sorted(unable))}, which the page leaves out",
                UnusedFeatureWarning,
                stacklevel=2,
            )
        return shown

    def _left(self, place: Place) -> dict[str, Any]:
        """The left pane."""
        if (figure := self.talk.figure(place)) is not None:  # over what else there may be, as in the window
            title = self.talk.words(place).title
            return {"left": "figure", "figure": self._keep({"svg": save_svg(figure), "alt": f"Plot: {title}"})}
        if beside := place.shown.get("beside"):
            return {"left": "beside", "beside": self.names.index(beside)}
        left = place.shown.get("left", "order")
        solution = self.talk.solution(place)
        if left == "factors":
            picked = self.talk.picks(place).get("picked", place.shown.get("picked", -1))
            row = HemicubeView.of(solution.patches, picked, HEMICUBE).row(len(solution.patches))
            colours, _, _ = factor_colours(row)
            self.plates.append({"colours": pack(colours.T.astype(np.int64)), "patches": len(solution.patches)})
            return {"left": "colours", "colours": len(self.plates) - 1}
        if left == "matrix":
            return {
                "left": "figure",
                "figure": self._keep({"png": _png(_matrix(place, solution)), "alt": "T, a matrix"}),
            }
        return {"left": LEFTS[left]}

    def _keep(self, figure: dict[str, str]) -> int:
        if figure not in self.figures:
            self.figures.append(figure)
        return self.figures.index(figure)


def _matrix(place: Place, solution: Any) -> NDArray[np.uint8]:
    """The transport operator as the window shows it."""
    from ..transport import TransportOperator

    patches = solution.patches
    matrix = TransportOperator(solution.factors, patches).matrix(0)
    view = MatrixView.of(matrix, patches.surface, patches.surface_names)
    return view.picture(place.shown.get("picked", -1))


def _png(image: NDArray[np.uint8]) -> str:
    """Pixels as a data address."""
    file = io.BytesIO()
    Image.fromarray(image).quantize(64).save(file, format="PNG", optimize=True)
    return "data:image/png;base64," + base64.b64encode(file.getvalue()).decode("ascii")
