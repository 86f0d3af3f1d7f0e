"""`radiosity export`: what is looked at, written to files; beside `solve`, with the settings of a picture."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import arguments
from .console import Screen

if TYPE_CHECKING:
    import radiosity as rad

HELP = "write pages, pictures, films and baked scenes of a scene or a solution"
EXAMPLES = """\
examples:
  radiosity export cornell_box -o cornell.html                one page for any browser, to be played with
  radiosity export cornell.npz -o cornell.gif --normalised    a film of the bounces, of a solution that was kept
  radiosity export cornell.npz -o orders.png --sheet          all bounces on one sheet
  radiosity export room.glb -o room.glb.png -o lit.glb --tone linear --exposure 1

`radiosity solve -o` writes the same files as they come, and data (.npz, .vtp); here a picture can be set up.
"""
SUFFIXES = (".png", ".gif", ".mp4", ".html", ".glb")
SWITCHES = ("normalised", "smooth", "false_colour")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Words of this command."""
    parser.add_argument("scene", metavar="SCENE", help="a file, a built-in scene, or a solution .npz")
    arguments.add_output(
        parser, "a page .html, a picture .png, a film .gif or .mp4, a scene with baked light .glb", required=True
    )
    group = parser.add_argument_group("picture")
    group.add_argument("--order", type=arguments.natural, metavar="K", help="bounce to show, or to begin with")
    group.add_argument("--exposure", type=float, metavar="EV", help="steps brighter or darker")
    group.add_argument("--tone", choices=("reinhard", "linear"), help="(default: reinhard)")
    group.add_argument("--normalised", action="store_true", help="each bounce on its own exposure")
    group.add_argument("--smooth", action="store_true", help="interpolate between patches")
    group.add_argument("--false-colour", action="store_true", help="luminance as colours of a scale")
    group.add_argument("--preset", type=arguments.natural, metavar="N", help="camera, counted from 0")
    group.add_argument("--sheet", action="store_true", help="a .png holds all bounces, and their sums")
    group.add_argument("--title", help="of a page")
    group.add_argument("--caption", help="of a page")
    group.add_argument("--no-wrong", action="store_true", help="leave the shortcuts, wrong on purpose, out of a page")
    arguments.add_scene(parser)
    arguments.add_solve(parser)


def run(args: argparse.Namespace, screen: Screen) -> None:
    """Solve if need be, and write."""
    from ..solution import PICTURES
    from ..viewer import probe
    from .source import solution

    for path in args.output:
        arguments.check_output(path, SUFFIXES)
    _check_options(args)
    drawn = [path for path in args.output if path.suffix.lower() in PICTURES]
    if drawn:
        probe.begin()
    solved = solution(args.scene, args, screen)
    for path in sorted(args.output, key=lambda path: path in drawn):  # first what cannot fail for lack of GL
        with screen.working(f"writing {path}"):
            _write(solved, path, args)
        screen.say(f"wrote {path} ({path.stat().st_size / 1024:.0f} KiB)")


def _check_options(args: argparse.Namespace) -> None:
    """Refuse what no output would use.

    Raises
    ------
    ParameterError
    """
    from ..errors import ParameterError

    suffixes = {path.suffix.lower() for path in args.output}
    for option, suffix in (("sheet", ".png"), ("title", ".html"), ("caption", ".html"), ("no_wrong", ".html")):
        if getattr(args, option) and suffix not in suffixes:
            raise ParameterError(f"--{option.replace('_', '-')} is for {suffix}, which is not written; leave it out")


def _write(solved: rad.Solution, path: Path, args: argparse.Namespace) -> None:
    """One file."""
    from ..files.atomic import replacing

    settings: dict[str, Any] = {name: True for name in SWITCHES if getattr(args, name)}
    for name in ("order", "exposure", "tone", "preset"):
        if getattr(args, name) is not None:
            settings[name] = getattr(args, name)
    if path.suffix.lower() == ".html":
        words = {name: getattr(args, name) or "" for name in ("title", "caption")}
        solved.save(path, wrong=not args.no_wrong, **words, **settings)
    elif path.suffix.lower() == ".png" and args.sheet:
        from ..viewer.figures import contact_sheet, save_figure

        figure = contact_sheet(solved, **settings)
        with replacing(path) as temporary:
            save_figure(figure, temporary)
    else:
        solved.save(path, **settings)
