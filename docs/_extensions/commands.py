"""The reference of the command line, as its own parser tells it."""

import argparse
import os
from typing import Any
from unittest.mock import patch

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective


class Commands(SphinxDirective):
    """A section for each command, with the text of its `--help`."""

    def run(self) -> list[nodes.Node]:
        """Ask the parser."""
        from radiosity.cli.main import parser

        top = parser()
        (choices,) = (action.choices for action in top._actions if isinstance(action, argparse._SubParsersAction))
        return [told(name, command) for name, command in choices.items()]


def told(name: str, command: argparse.ArgumentParser) -> nodes.section:
    """A section about one command."""
    with patch.dict(os.environ, {"COLUMNS": "96", "NO_COLOR": "1"}):
        text = command.format_help()
    section = nodes.section(ids=[f"radiosity-{name}"], names=[name])
    section += nodes.title(text=f"radiosity {name}")
    section += nodes.literal_block(text, text, language="text")
    return section


def setup(app: Sphinx) -> dict[str, Any]:
    """Called by Sphinx."""
    app.add_directive("commands", Commands)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
