"""The keys of the viewer, as the viewer's own list has them."""

from typing import Any

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective


class Keys(SphinxDirective):
    """A table of all keys and what the mouse does."""

    def run(self) -> list[nodes.Node]:
        """Ask the viewer."""
        from radiosity.viewer.commands import GROUPS, MOUSE

        groups = {name: [(command.shown, command.does) for command in group] for name, group in GROUPS.items()}
        body = nodes.tbody()
        for name, rows in {**groups, "mouse": list(MOUSE)}.items():
            for number, (key, does) in enumerate(rows):
                body += row(nodes.emphasis(text="" if number else name), nodes.literal(text=key), nodes.Text(does))
        columns = [nodes.colspec(colwidth=width) for width in (2, 1, 6)]
        head = nodes.thead("", row(nodes.Text("of"), nodes.Text("key"), nodes.Text("does")))
        return [nodes.table("", nodes.tgroup("", *columns, head, body, cols=3))]


def row(*cells: nodes.Node) -> nodes.row:
    """A row of a table."""
    return nodes.row("", *(nodes.entry("", nodes.paragraph("", "", cell)) for cell in cells))


def setup(app: Sphinx) -> dict[str, Any]:
    """Called by Sphinx."""
    app.add_directive("keys", Keys)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
