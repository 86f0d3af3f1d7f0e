"""`radiosity scenes`: which built-in scenes there are, their files, and what is doubtful about a scene."""

from __future__ import annotations

import argparse
from functools import partial
from pathlib import Path

from ..errors import ParameterError
from .arguments import add_scene
from .console import Screen

HELP = "list the built-in scenes, write them as .glb, or check a scene"
EXAMPLES = """\
examples:
  radiosity scenes
  radiosity scenes --write meshes
  radiosity scenes --check room.obj --unit mm -o room_check.png

A check lists, by surface and place, what makes light wrong or what a solve would refuse: faces without area, doubled or
turned round, slivers, gaps that rays do not resolve, holes, cracks. It ends with exit code 2 if there are errors.
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Words of this command."""
    what = parser.add_mutually_exclusive_group()
    what.add_argument("--check", metavar="SCENE", help="report all that is doubtful about a file or a built-in scene")
    what.add_argument(
        "--write",
        type=Path,
        nargs="?",
        const=Path("meshes"),
        metavar="FOLDER",
        help="write every scene as .glb, with a README of units and origin (default folder: meshes)",
    )
    parser.add_argument(
        "-o", "--output", type=Path, metavar="FILE", help="with --check: a picture (.png) that marks the places"
    )
    add_scene(parser)


def run(args: argparse.Namespace, screen: Screen) -> None:
    """List, write or check."""
    if args.check is not None:
        from .check import check

        check(args.check, args, screen)
        return
    for option in ("output", "unit", "fix_normals", "turn", "sky", "lamp"):
        if getattr(args, option):
            raise ParameterError(f"--{option.replace('_', '-')} is for --check SCENE; leave it out")
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
