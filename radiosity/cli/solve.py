"""`radiosity solve`: from a scene to files and a report."""

from __future__ import annotations

import argparse
from pathlib import Path

from . import arguments
from .console import Screen

HELP = "solve a scene, report, and write the light to files"
EXAMPLES = """\
examples:
  radiosity solve meshes/cornell_box.glb -o cornell.npz -o cornell.vtp -o cornell.png
  radiosity solve cornell_box --patches 4000 --method hemicube --bounces 8
  radiosity solve room.obj --unit mm --sky 1 --lamp "Ceiling lamp=30,28,25" -o room.npz

A .npz holds everything, for `radiosity view` and rad.read_solution; a .vtp all bounces, for ParaView; a .png a picture.
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Words of this command."""
    parser.add_argument("scene", metavar="SCENE", help="a file (.glb .gltf .obj .ply .stl .off), or a built-in scene")
    parser.add_argument(
        "-o",
        "--output",
        type=Path,
        action="append",
        default=[],
        metavar="FILE",
        help="write the solution; .npz, .vtp or .png; may be given again",
    )
    arguments.add_scene(parser)
    arguments.add_solve(parser)


def run(args: argparse.Namespace, screen: Screen) -> None:
    """Solve, report, write."""
    from ..solution import DATA, PICTURES
    from .report import print_report
    from .source import solution

    for path in args.output:
        arguments.check_output(path, DATA + PICTURES)
    solved = solution(args.scene, args, screen)
    if not args.quiet:
        print_report(solved, screen.out)
    for path in args.output:
        solved.save(path)
        screen.say(f"wrote {path}")
