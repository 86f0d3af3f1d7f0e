"""`radiosity scenes`: which built-in scenes there are, and their files."""

from __future__ import annotations

import argparse
from functools import partial
from pathlib import Path

from .console import Screen

HELP = "list the built-in scenes, or write them as .glb"
EXAMPLES = """\
examples:
  radiosity scenes
  radiosity scenes --write meshes
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Words of this command."""
    parser.add_argument(
        "--write",
        type=Path,
        nargs="?",
        const=Path("meshes"),
        metavar="FOLDER",
        help="write every scene as .glb, with a README of units and origin (default folder: meshes)",
    )


def run(args: argparse.Namespace, screen: Screen) -> None:
    """List or write."""
    if args.write is None:
        _list(screen)
        return
    from ..files.builtin import write_builtin_scenes

    written = write_builtin_scenes(args.write)
    screen.say(f"wrote {len(written)} files into {args.write.resolve()}")


def _list(screen: Screen) -> None:
    from rich import box
    from rich.table import Table

    from ..scenes import BUILT_IN

    table = Table(box=box.SIMPLE_HEAD)
    table.add_column("scene", no_wrap=True, style="bold")
    table.add_column("surfaces", justify="right")
    table.add_column("channels", justify="right")
    table.add_column("what it is")
    for name, make in BUILT_IN.items():
        scene = make()
        function = make.func if isinstance(make, partial) else make
        what = (function.__doc__ or "").partition("\n")[0].rstrip(".")
        table.add_row(name, str(len(scene.surfaces)), str(scene.channels), what)
    screen.out.print(table)
