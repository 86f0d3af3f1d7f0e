"""`radiosity view`: bounce by bounce in a window, or as pictures where there is none."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import arguments
from .console import NO_WINDOW, Screen

if TYPE_CHECKING:
    import radiosity as rad

HELP = "show a scene bounce by bounce in a window, or write pictures where there is no display"
EXAMPLES = """\
examples:
  radiosity view                                  the Cornell box
  radiosity view cornell.npz                      what `radiosity solve … -o cornell.npz` has kept
  radiosity view red_rug --patches 4000 --order 2
  radiosity view cornell_box --screenshot cornell.png

Without a display the pictures are written all the same, but the exit code is 3: a window was asked for.
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Words of this command."""
    parser.add_argument(
        "scene", metavar="SCENE", nargs="?", help="a file, a built-in scene, or a solution .npz (default: Cornell box)"
    )
    group = parser.add_argument_group("view")
    group.add_argument("--screenshot", type=Path, metavar="FILE", help="draw the window into a .png; needs no display")
    group.add_argument("--pictures", type=Path, metavar="FOLDER", help="write the pictures of all bounces; no window")
    group.add_argument(
        "--or-pictures", action="store_true", help="without a display, pictures are as good: exit code 0 (as viewer.py)"
    )
    group.add_argument("--order", type=arguments.natural, default=1, metavar="K", help="bounce to begin with")
    group.add_argument("--exposure", type=float, default=0.0, metavar="EV", help="steps brighter or darker")
    arguments.add_scene(parser)
    arguments.add_solve(parser)


def run(args: argparse.Namespace, screen: Screen) -> int:
    """Solve if need be, and show; the exit code."""
    from ..viewer import probe
    from . import source

    if args.screenshot is not None:
        arguments.check_output(args.screenshot, (".png",))
    window = args.screenshot is None and args.pictures is None and probe.has_display()
    probe.begin("window" if window else "off-screen")
    word = args.scene or source.default()
    solved = source.solution(word, args, screen)
    screen.say(f"{solved.scene.name}: {len(solved.patches):,} patches; {solved.status}")
    settings = {"order": args.order, "exposure": args.exposure}
    if args.screenshot is not None:
        with screen.working("drawing"):
            _screenshot(solved, args.screenshot, settings)
        screen.say(f"wrote {args.screenshot}")
    elif args.pictures is not None:
        write_pictures(solved, args.pictures, screen)
    elif missing := _window(solved, settings):
        say = screen.say if args.or_pictures else screen.warn
        say(f"no window: {missing} Writing pictures instead")
        write_pictures(solved, Path(f"{solved.scene.name}_pictures"), screen)
        return 0 if args.or_pictures else NO_WINDOW
    return 0


def _screenshot(solved: rad.Solution, path: Path, settings: dict[str, Any]) -> None:
    from ..files.atomic import replacing
    from ..viewer import view

    with replacing(path) as temporary:
        view(solved, screenshot=temporary, **settings)


def _window(solved: rad.Solution, settings: dict[str, Any]) -> str:
    """Open the window; why not, if there can be none."""
    from ..errors import DisplayError
    from .interrupts import window_open

    try:
        with window_open():
            solved.show(**settings)
    except DisplayError as error:
        return str(error)
    return ""


def write_pictures(solved: rad.Solution, folder: Path, screen: Screen) -> None:
    """Write the pictures; where nothing can be drawn, keep the solution, so that no work is lost.

    Raises
    ------
    DisplayError
        With what to install, and where the solution is.
    """
    from ..errors import DisplayError
    from ..viewer import figures

    try:
        with screen.working("drawing"):
            written = figures.write_pictures(solved, folder)
    except DisplayError as error:
        folder.mkdir(parents=True, exist_ok=True)
        kept = folder / "solution.npz"
        solved.save(kept)
        raise DisplayError(f"{error} The solution is kept: afterwards, run `radiosity view {kept}`") from error
    screen.say(f"wrote {len(written)} pictures into {folder.resolve()}:")
    for path in written:
        screen.say(f"  {path.name}")
