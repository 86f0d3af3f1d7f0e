"""Figures that a page makes: the code of a `plot` block runs when the book is built, and stands folded below it.

`sphinx-build -D keep_figures=1` draws only what is not there yet, for those who write.
"""

import hashlib
from pathlib import Path
from typing import Any, ClassVar

from docutils import nodes
from docutils.parsers.rst import directives
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

LOOK = {"figure.figsize": (6.5, 3.6), "font.size": 10, "axes.grid": True, "grid.alpha": 0.3, "figure.dpi": 120}


class Plot(SphinxDirective):
    """A figure drawn with matplotlib by the code of the block; `:alt:` says what is to be seen."""

    has_content = True
    option_spec: ClassVar[dict[str, Any]] = {"alt": directives.unchanged_required}

    def run(self) -> list[nodes.Node]:
        """Run the code, and give the figure and the code."""
        code = "\n".join(self.content)
        name = hashlib.sha256(code.encode()).hexdigest()[:16] + ".png"
        path = Path(self.env.srcdir) / "_build" / "figures" / name
        if not (self.config.keep_figures and path.exists()):
            draw(code, path, self.get_location())
        image = nodes.image(uri=f"/_build/figures/{name}", alt=self.options["alt"])
        listing = nodes.literal_block(code, code, language="python")
        unfold = nodes.raw("", "<details><summary>The code of this figure</summary>", format="html")
        return [nodes.figure("", image), unfold, listing, nodes.raw("", "</details>", format="html")]


def draw(code: str, path: Path, place: str) -> None:
    """Run code, and write the figure that it leaves open."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    plt.close("all")
    with matplotlib.rc_context(LOOK):
        exec(compile(code, place, "exec"), {"__name__": "figure"})
        path.parent.mkdir(parents=True, exist_ok=True)
        plt.savefig(path, bbox_inches="tight")
    plt.close("all")


def setup(app: Sphinx) -> dict[str, Any]:
    """Called by Sphinx."""
    app.add_config_value("keep_figures", False, "", (bool, str))
    app.add_directive("plot", Plot)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
