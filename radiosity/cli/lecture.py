"""`radiosity lecture`: a scripted talk in the viewer, as a page to hand out, or as pictures for slides."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from . import arguments
from .console import NO_WINDOW, Screen

if TYPE_CHECKING:
    from ..lectures import Talk

HELP = "give a lecture in the viewer, step by step, or write it as a page or as pictures"
EXAMPLES = """\
examples:
  radiosity lecture                            which lectures there are
  radiosity lecture cornell                    Page down goes on, Page up goes back, ? lists the keys
  radiosity lecture cornell -o cornell.html    one page for a browser, to hand out; needs no display
  radiosity lecture cornell -o slides          every step as a picture, into a folder; slides.png: slides_01.png, …
  radiosity lecture my_lecture.py              your own: `radiosity lecture cornell --copy my_lecture.py` to begin

Without a display the page is written all the same, but the exit code is 3: a window was asked for.
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Words of this command."""
    parser.add_argument("name", metavar="NAME", nargs="?", help="a lecture, or a file FILE.py with one")
    arguments.add_output(parser, "write it: .html, .png (one a step) or a folder; no window")
    parser.add_argument(
        "--copy", type=Path, metavar="FILE.py", help="write the lecture's own file, to be changed; nothing else"
    )
    parser.add_argument("--patches", type=arguments.count, metavar="N", help="about how many patches, for each scene")
    parser.add_argument("-q", "--quiet", action="store_true", help="say only what is wrong")


def run(args: argparse.Namespace, screen: Screen) -> int:
    """Solve what the lecture shows, and give it; the exit code."""
    if args.name is None:
        _list(screen)
    elif args.copy is not None:
        _copy(args.name, args.copy)
        screen.say(f"wrote {args.copy}: change it, then run `radiosity lecture {args.copy}`")
    else:
        return _give(args, screen)
    return 0


def _give(args: argparse.Namespace, screen: Screen) -> int:
    """In a window, or written; as a page if there can be no window."""
    from .. import lectures

    lecture = lectures.find(args.name)
    outputs: list[Path] = args.output
    _check(outputs)
    with screen.working(f"solving for {lecture.title!r}"):
        talk = lectures.Talk.prepare(lecture, args.patches)
    missing = "" if outputs else _window(talk)
    if missing:
        screen.warn(f"no window: {missing} Writing a page for a browser instead")
        outputs = [Path(f"{Path(args.name).stem}_lecture.html")]
    for path in outputs:
        with screen.working("drawing"):
            written = lectures.export(talk, path)
        if len(written) == 1:
            screen.say(f"wrote {written[0]} ({written[0].stat().st_size / 1024:.0f} KiB)")
        else:
            screen.say(f"wrote {len(written)} pictures, {written[0]} to {written[-1].name}")
    return NO_WINDOW if missing else 0


def _window(talk: Talk) -> str:
    """Give the lecture in a window; why not, if there can be none."""
    from .. import lectures
    from ..errors import DisplayError
    from .interrupts import window_open

    try:
        with window_open():
            lectures.run(talk)
    except DisplayError as error:
        return str(error)
    return ""


def _list(screen: Screen) -> None:
    """Every lecture on a line."""
    from .. import lectures

    for name in lectures.names():
        lecture = lectures.find(name)
        screen.out.print(f"{name:<10} {lecture.title} ({lecture.minutes:g} minutes)", highlight=False, markup=False)


def _check(outputs: list[Path]) -> None:
    """Refuse, before any work, what cannot be written."""
    from ..errors import MissingFileError
    from ..lectures.runner import check
    from ..viewer import probe

    for path in outputs:
        check(path)
        if not path.parent.is_dir():
            raise MissingFileError(f"cannot write {path}: there is no folder {path.parent}; make it first")
    if any(path.suffix.lower() != ".html" for path in outputs):
        probe.require("off-screen")


def _copy(name: str, path: Path) -> None:
    """The file of a lecture, to be changed.

    Raises
    ------
    FileFormatError
        Not a .py, or one that is there already.
    """
    from .. import lectures
    from ..errors import FileFormatError
    from ..files.atomic import write_bytes

    if path.suffix != ".py":
        raise FileFormatError(f"{path}: a lecture is a Python file; give it the suffix .py")
    if path.exists():
        raise FileFormatError(f"{path} is there already, and is left as it is; give another name")
    lectures.find(name)
    source = Path(lectures.__file__ or "").parent / f"{name}.py" if name in lectures.names() else Path(name)
    write_bytes(path, source.read_bytes())
