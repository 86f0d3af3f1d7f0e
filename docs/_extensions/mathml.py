"""Formulas as MathML, which browsers draw by themselves: the pages work without a network and without scripts.

An equation that is labelled with a number is printed with that number, so that "Eq. (7)" in the code is (7) in the
book, whatever else is added around it.
"""

from typing import Any

from docutils import nodes
from latex2mathml.converter import convert
from sphinx.application import Sphinx


def inline(self: Any, node: nodes.math) -> None:
    """A formula in a sentence."""
    self.body.append(convert(node.astext()))
    raise nodes.SkipNode


def displayed(self: Any, node: nodes.math_block) -> None:
    """A formula on a line of its own, with its number."""
    label = node.get("label")
    anchor = f' id="equation-{label}"' if label else ""
    number = f'<span class="eqno">({label})</span>' if label else ""
    formula = convert(node.astext().strip(), display="block")
    self.body.append(f'<div class="math"{anchor}>{formula}{number}</div>')
    raise nodes.SkipNode


def setup(app: Sphinx) -> dict[str, Any]:
    """Called by Sphinx."""
    app.add_html_math_renderer("mathml", (inline, None), (displayed, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}
