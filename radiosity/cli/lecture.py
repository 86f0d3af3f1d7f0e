"""`radiosity lecture`: a scripted talk in the viewer, or as pictures for slides."""

from __future__ import annotations

import argparse
from pathlib import Path

from .console import Screen

HELP = "give a lecture in the viewer, step by step, or write its steps as pictures"
EXAMPLES = """\
examples:
  radiosity lecture                               which lectures there are
  radiosity lecture cornell                       Page down goes on, Page up goes back, ? lists the keys
  radiosity lecture cornell --pictures slides     every step as a picture; needs no display
  radiosity lecture my_lecture.py                 your own: copy radiosity/lectures/cornell.py
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Words of this command."""
    parser.add_argument("name", metavar="NAME", nargs="?", help="a lecture, or a file FILE.py with one")
    parser.add_argument("--pictures", type=Path, metavar="FOLDER", help="write each step as a picture; no window")


def run(args: argparse.Namespace, screen: Screen) -> None:
    """Solve what the lecture shows, and give it."""
    from .. import lectures
    from ..viewer import probe
    from .interrupts import window_open

    if args.name is None:
        for name in lectures.names():
            lecture = lectures.find(name)
            screen.out.print(f"{name:<12} {lecture.title} ({lecture.minutes:g} minutes)", highlight=False, markup=False)
        return
    lecture = lectures.find(args.name)
    with screen.working(f"solving for {lecture.title!r}"):
        solution = lecture.solve()
    if args.pictures is None and probe.has_display():
        with window_open():
            lectures.run(lecture, solution)
        return
    folder = args.pictures or Path(f"{lecture.name}_lecture")
    if args.pictures is None:
        screen.say("there is no display; writing the steps as pictures instead")
    with screen.working("drawing"):
        written = lectures.export(lecture, folder, solution)
    screen.say(f"wrote {len(written)} pictures into {folder.resolve()}")
