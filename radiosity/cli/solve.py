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
  radiosity solve meshes/studio.glb --patches 200000 --memory 4G --checkpoint rows -o studio.npz
  radiosity solve cornell_box --accuracy 1% -o cornell.png    as many patches and rays as that takes
  radiosity solve room.npz --lamp Ceiling=0 -o dark.vtp       other light on the same form factors, at once

A .npz holds everything, for `radiosity view` and rad.read_solution; a .vtp all bounces, for ParaView; a .html a page
with all bounces, for any browser; a .png a picture.
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Words of this command."""
    parser.add_argument(
        "scene", metavar="SCENE", help="a file (.glb .gltf .obj .ply .stl .off), a built-in scene, or a solution .npz"
    )
    arguments.add_output(parser, "write the solution; .npz, .vtp, .html or .png")
    arguments.add_scene(parser)
    arguments.add_solve(parser)


def run(args: argparse.Namespace, screen: Screen) -> None:
    """Solve, report, write."""
    from ..solution import DATA, PAGES, PICTURES
    from ..viewer import probe
    from .report import print_report
    from .source import solution

    def needs_gl(path: Path) -> bool:
        return path.suffix.lower() in PICTURES

    for path in args.output:
        arguments.check_output(path, DATA + PAGES + PICTURES)
    if any(map(needs_gl, args.output)):
        probe.begin()
    solved = solution(args.scene, args, screen)
    if not args.quiet:
        print_report(solved, screen.out)
    for path in sorted(args.output, key=needs_gl):  # first what cannot fail for lack of GL
        solved.save(path)
        screen.say(f"wrote {path}")
