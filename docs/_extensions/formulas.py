"""Formulas as drawings, set by matplotlib: the pages need no network, no script and no font, and look alike everywhere.

An equation that is labelled with a number is printed with that number, so that "Eq. (7)" in the code is (7) in the
book, whatever else is added around it.
"""

import html
import re
from functools import cache
from typing import Any

import numpy as np
from docutils import nodes
from matplotlib.font_manager import FontProperties
from matplotlib.mathtext import MathTextParser
from matplotlib.path import Path
from matplotlib.textpath import text_to_path
from sphinx.application import Sphinx

SIZE = text_to_path.FONT_SCALE  # points of the drawing that make one em of the page
FONT = FontProperties(size=SIZE, math_fontfamily="stix")
LARGER = 1.12  # STIX letters are small beside those of a screen font
STROKES = {Path.MOVETO: "M", Path.LINETO: "L", Path.CURVE3: "Q", Path.CURVE4: "C", Path.CLOSEPOLY: "Z"}
OURS = {  # commands that matplotlib knows by another name
    "lVert": "Vert",
    "rVert": "Vert",
    "le": "leq",
    "ge": "geq",
    "text": "mathrm",
    "operatorname": "mathrm",
    "tfrac": "frac",
}


@cache
def drawing(tex: str) -> str:
    """An SVG that stands on the line of the text around it."""
    formula = tex.replace("\n", " ").replace(r"\!", "").strip()
    formula = re.sub(r"\\([a-zA-Z]+)", lambda command: "\\" + OURS.get(command[1], command[1]), formula)
    formula = f"${spaced(formula)}$"
    width, height, depth, *_ = MathTextParser("path").parse(formula, 72, FONT)
    path = Path(*text_to_path.get_text_path(FONT, formula, ismath=True))
    top = max(height, path.vertices[:, 1].max()) + 5.0
    bottom = min(-depth, path.vertices[:, 1].min()) - 5.0
    marks = []
    for vertices, code in path.iter_segments(curves=True, simplify=False):
        places = " ".join(f"{x:.1f} {-y:.1f}" for x, y in np.reshape(vertices, (-1, 2)))
        marks.append(STROKES[code] + ("" if code == Path.CLOSEPOLY else places))
    em = LARGER / SIZE
    return (
        f'<svg class="formula" role="img" aria-label="{html.escape(tex, quote=True)}" '
        f'style="width:{width * em:.3f}em;height:{(top - bottom) * em:.3f}em;vertical-align:{bottom * em:.3f}em" '
        f'viewBox="0 {-top:.2f} {width:.2f} {top - bottom:.2f}"><path d="{"".join(marks)}"/></svg>'
    )


def spaced(formula: str) -> str:
    """Words in upright letters keep their blanks."""
    parts = formula.split(r"\mathrm{")
    words = [part.replace("}", "\0", 1).split("\0") for part in parts[1:]]
    return parts[0] + "".join(r"\mathrm{" + word.replace(" ", r"\ ") + "}" + rest for word, rest in words)


def inline(self: Any, node: nodes.math) -> None:
    """A formula in a sentence."""
    self.body.append(drawing(node.astext()))
    raise nodes.SkipNode


def displayed(self: Any, node: nodes.math_block) -> None:
    """A formula on a line of its own, with its number."""
    label = node.get("label")
    anchor = f' id="equation-{label}"' if label else ""
    number = f'<span class="eqno">({label})</span>' if label else ""
    formula = drawing(node.astext().replace(r"\frac", r"\dfrac"))
    self.body.append(f'<div class="math"{anchor}>{formula}{number}</div>')
    raise nodes.SkipNode


def setup(app: Sphinx) -> dict[str, Any]:
    """Called by Sphinx."""
    app.add_html_math_renderer("formulas", (inline, None), (displayed, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}
