"""`radiosity render`: a picture of a solution as a camera would take it."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from . import arguments
from .console import Screen

if TYPE_CHECKING:
    import radiosity as rad

HELP = "render a scene as a camera would see it: sharp shadows, no patches"
EXAMPLES = """\
examples:
  radiosity render                                the Cornell box, into cornell_box.png
  radiosity render meshes/studio.glb -o studio.png --size 1280x800
  radiosity render red_rug --bounces 1 -o direct.png       only light that has bounced once
  radiosity render room.npz --from 1,1.6,4 --to 0,1,0 --fov 60 -o room.png -o room.npy

A .png is made for screens; a .npy holds the radiance of each pixel, W/(m² sr), for numpy.load.
"""
FORMATS = (".png", ".npy")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Words of this command."""
    parser.add_argument(
        "scene", metavar="SCENE", nargs="?", help="a file, a built-in scene, or a solution .npz (default: Cornell box)"
    )
    group = parser.add_argument_group("picture")
    arguments.add_output(group, "write the picture; .png or .npy (default: the scene's name, .png)")
    group.add_argument(
        "--size", type=size, default=(640, 400), metavar="WxH", help="width and height in pixels (default: 640x400)"
    )
    group.add_argument(
        "--pixel-samples", type=arguments.count, default=16, metavar="N", help="camera rays a pixel (default: 16)"
    )
    group.add_argument("--exposure", type=float, default=0.0, metavar="EV", help="steps brighter or darker")
    group.add_argument("--tone", choices=("reinhard", "linear"), default="reinhard", help="(default: reinhard)")
    group = parser.add_argument_group("camera")
    group.add_argument("--camera", metavar="NAME", help="front, inside or outside (default: what suits the scene)")
    group.add_argument(
        "--from", dest="position", type=point, metavar="X,Y,Z", help="where it stands, m; --from=-1,… if X is negative"
    )
    group.add_argument("--to", dest="focal_point", type=point, metavar="X,Y,Z", help="what it looks at, m")
    group.add_argument(
        "--fov", type=arguments.positive, metavar="DEG", help="its angle over the shorter side (with --from)"
    )
    arguments.add_scene(parser)
    arguments.add_solve(parser)


def run(args: argparse.Namespace, screen: Screen) -> None:
    """Solve if need be, render, write."""
    import radiosity as rad

    from ..display import factor_text
    from ..files.atomic import replacing
    from . import source

    for path in args.output:
        arguments.check_output(path, FORMATS)
    _check_camera(args)
    solved = source.solution(args.scene or source.default(), args, screen)
    camera = _camera(args, solved)
    with screen.progress() as tell:
        picture = rad.render(solved, camera, args.size, samples=args.pixel_samples, threads=args.threads, progress=tell)
    for path in args.output or [Path(f"{solved.scene.name}.png")]:
        with replacing(path) as temporary:
            factor = rad.write_picture(picture, temporary, exposure=args.exposure, tone=args.tone)
        screen.say(f"wrote {path}" + ("" if path.suffix.lower() == ".npy" else f", radiance {factor_text(factor)}"))


def _check_camera(args: argparse.Namespace) -> None:
    """Refuse half a camera, or two, before any work is done."""
    from ..errors import ParameterError

    if (args.position is None) != (args.focal_point is None):
        raise ParameterError("a camera of your own needs both --from and --to")
    if args.camera is not None and args.position is not None:
        raise ParameterError(f"give --camera {args.camera}, or --from and --to, not both")
    if args.fov is not None and args.position is None:
        raise ParameterError("--fov is for a camera of your own; give --from and --to too")


def _camera(args: argparse.Namespace, solved: rad.Solution) -> rad.Camera | None:
    """The camera that the words mean; None for the first preset."""
    import radiosity as rad

    from ..camera import presets

    if args.position is not None:
        angle = {} if args.fov is None else {"fov": args.fov}
        return rad.Camera("own", args.position, args.focal_point, **angle)
    if args.camera is None:
        return None
    known = {preset.name: preset for preset in presets(solved.patches)}
    if args.camera not in known:
        raise rad.errors.ParameterError(
            f"{solved.scene.name} has no camera {args.camera!r}; it has {', '.join(known)}, or give --from and --to"
        )
    return known[args.camera]


def size(text: str) -> tuple[int, int]:
    """Width and height.

    >>> size("640x400")
    (640, 400)
    """
    width, times, height = text.lower().partition("x")
    if not times:
        raise argparse.ArgumentTypeError(f"{text!r} is not WIDTHxHEIGHT, as in 640x400")
    return arguments.count(width), arguments.count(height)


def point(text: str) -> tuple[float, float, float]:
    """Three coordinates.

    >>> point("1,-0.5,2")
    (1.0, -0.5, 2.0)
    """
    try:
        x, y, z = (float(part) for part in text.split(","))
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is not X,Y,Z, as in 1,1.6,4") from None
    return (x, y, z)
