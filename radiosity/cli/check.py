"""`radiosity scenes --check`: everything that is doubtful about a scene, before it is solved."""

from __future__ import annotations

import argparse
import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import radiosity as rad

from . import arguments
from .console import Screen

if TYPE_CHECKING:
    from ..finding import Finding

STYLES = {"error": "bold red", "warning": "yellow", "note": "cyan"}


def check(word: str, args: argparse.Namespace, screen: Screen) -> None:
    """List what is found, and mark it in a picture if one is asked for.

    Raises
    ------
    SceneError
        There are errors, so that a solve would refuse the scene or could not be right.
    RadiosityError
        The scene cannot be read, or the picture not be drawn.
    """
    if args.output is not None:
        arguments.check_output(args.output, (".png",))
    scene = _scene(word, args)
    found = scene.validate()
    list_findings(found, screen)
    if not found:
        screen.out.print(f"{scene.name}: nothing to remark", markup=False, highlight=False)
    if args.output is not None:
        _picture(scene, found, args.output, screen)
    errors = sum(one.severity.name == "ERROR" for one in found)
    if errors:
        raise rad.errors.SceneError(f"{scene.name!r} has {errors} error{'s' * (errors != 1)}; mend the scene first")


def _scene(word: str, args: argparse.Namespace) -> rad.Scene:
    """The scene as the file has it: what lies in each other is not cut away, but reported."""
    from .source import scene

    with warnings.catch_warnings():
        said_below = ".*surfaces lie in each other"
        warnings.filterwarnings("ignore", said_below, rad.errors.GeometryWarning)
        return scene(word, args, contacts="keep")


def list_findings(found: Sequence[Finding], screen: Screen) -> None:
    """Findings, numbered, a line each."""
    from rich.text import Text

    for number, one in enumerate(found, start=1):
        head, _, rest = str(one).partition(": ")
        screen.out.print(Text.assemble(f"{number:3} ", (head, STYLES[head]), f": {rest}"), soft_wrap=True)


def _picture(scene: rad.Scene, found: Sequence[Finding], path: Path, screen: Screen) -> None:
    from ..files.atomic import replacing
    from ..viewer.places import write_places

    with replacing(path) as temporary:
        write_places(scene, found, temporary)
    screen.say(f"wrote {path}")
