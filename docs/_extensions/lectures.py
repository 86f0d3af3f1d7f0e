"""A lecture's page, live in the book: made when the book is built, from the lecture's own file.

`sphinx-build -D keep_figures=1` makes only what is not there yet.
"""

import inspect
from pathlib import Path
from typing import Any, ClassVar

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

LIVE = Path("_build") / "live" / "live"  # copied beside the pages, as live/NAME.html
PATCHES = 600  # enough for a picture of this size, and light on the reader's line


class LectureDirective(SphinxDirective):
    """`{lecture} NAME`: minutes, how to run it, its page in a frame, and its steps."""

    required_arguments = 1
    option_spec: ClassVar[dict[str, Any]] = {}

    def run(self) -> list[nodes.Node]:
        """Make the lecture's page, and frame it."""
        from radiosity import lectures

        name = self.arguments[0]
        lecture = lectures.find(name)
        page = Path(self.env.srcdir) / LIVE / f"{name}.html"
        if not (self.config.keep_figures and page.exists()):
            page.parent.mkdir(parents=True, exist_ok=True)
            few = PATCHES if "patch_count" in inspect.signature(lecture.solve).parameters else None
            lectures.export(lectures.Talk.prepare(lecture, few), page)
        frame = (
            f"<p><em>{lecture.minutes:g} minutes in class.</em> In the viewer: <code>radiosity lecture {name}</code>. "
            f'This page alone, to hand out: <a href="../live/{name}.html">{name}.html</a>.</p>'
            f'<iframe class="live" loading="lazy" title="{lecture.title}" src="../live/{name}.html"></iframe>'
        )
        return [nodes.raw("", frame, format="html")]


def setup(app: Sphinx) -> dict[str, Any]:
    """Called by Sphinx."""
    (Path(app.srcdir) / LIVE).mkdir(parents=True, exist_ok=True)
    app.add_directive("lecture", LectureDirective)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
