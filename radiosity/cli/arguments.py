"""Arguments that several commands share, and what they become."""

from __future__ import annotations

import argparse
import math
import os
import re
from pathlib import Path
from typing import Any

SIZE = re.compile(r"\s*(\d+\.?\d*|\.\d+)\s*([kKMGT]?)[bB]?\s*")  # 4G, 1.5 GB, 800000000
UNITS = ("m", "cm", "mm", "in", "ft")
METHODS = {  # words of the API
    "monte-carlo": "MonteCarlo",
    "hemicube": "Hemicube",
    "analytic": "Analytic",
    "two-levels": "TwoLevel",
}
SOLVE_OPTIONS = (
    "unit", "fix_normals", "turn", "patches", "patch_size", "method", "rays", "light_rays", "sampling", "replicates",
    "seed", "resolution", "samples", "bounces", "rtol", "threads", "memory", "checkpoint", "accuracy",
)  # fmt: skip
CHOSEN_BY_ACCURACY = (
    "method", "rays", "light_rays", "sampling", "replicates", "resolution", "samples", "bounces", "rtol", "checkpoint",
)  # fmt: skip
ONLY_FOR = {
    **dict.fromkeys(("rays", "light_rays", "seed"), ("monte-carlo", "two-levels")),
    **dict.fromkeys(("sampling", "replicates"), ("monte-carlo",)),
    **dict.fromkeys(("resolution", "samples"), ("hemicube",)),
}


def add_scene(parser: argparse.ArgumentParser) -> None:
    """What to light, and by what."""
    group = parser.add_argument_group("scene")
    group.add_argument("--unit", choices=UNITS, help="unit of length of the file (default: m)")
    group.add_argument(
        "--fix-normals",
        action="store_const",
        const=True,
        help="turn round the faces of closed shells that look the wrong way",
    )
    group.add_argument(
        "--turn",
        action="append",
        metavar="SURFACE",
        help="turn round a surface (or all of a material) that shows its back; may be given again",
    )
    group.add_argument(
        "--sky", type=channels, metavar="L", help="radiance of the surroundings, W/(m² sr): one number, or R,G,B"
    )
    group.add_argument(
        "--lamp",
        type=lamp,
        action="append",
        default=[],
        metavar="SURFACE=E",
        help="make a surface (or all of a material) emit E W/m²: one number, or R,G,B; may be given again",
    )


def add_output(parser: argparse._ActionsContainer, what: str, *, required: bool = False) -> None:
    """Files to write, each by its suffix."""
    parser.add_argument(
        "-o",
        "--output",
        type=Path,
        action="append",
        default=[],
        required=required,
        metavar="FILE",
        help=f"{what}; may be given again",
    )


def add_solve(parser: argparse.ArgumentParser) -> None:
    """How finely, how exactly, how far."""
    _add_accuracy(parser)
    _add_form_factors(parser.add_argument_group("form factors"))
    group = parser.add_argument_group("series")
    group.add_argument("--bounces", type=natural, metavar="K", help="cut the series after K bounces")
    group.add_argument(
        "--rtol",
        type=positive,
        metavar="R",
        help="else go on until the residual is this small a part of the source (default: 1e-6)",
    )
    _add_work(parser.add_argument_group("work"))


def _add_accuracy(parser: argparse.ArgumentParser) -> None:
    group = parser.add_argument_group("accuracy")
    group.add_argument(
        "--accuracy",
        type=share,
        metavar="A",
        help="largest error, as 1%% or 0.01: patches, rays and bounces are then chosen to reach it",
    )
    group = parser.add_argument_group("patches")
    size = group.add_mutually_exclusive_group()
    size.add_argument("--patches", type=count, metavar="N", help="about how many patches (default: 10000)")
    size.add_argument("--patch-size", type=positive, metavar="M", help="longest edge of a patch, m")


def _add_form_factors(group: argparse._ArgumentGroup) -> None:
    group.add_argument(
        "--method",
        choices=METHODS,
        help="two-levels: for very many patches (default: monte-carlo, or two-levels from 50 000 where as good)",
    )
    group.add_argument("--rays", type=count, metavar="R", help="rays a patch (default: 256; two-levels: 128)")
    group.add_argument("--light-rays", type=natural, metavar="R", help="shadow rays between a patch and a lamp's face")
    group.add_argument("--sampling", choices=("sobol", "random"), help="of rays (default: sobol)")
    group.add_argument(
        "--replicates", type=count, metavar="N", help="independent estimates, for standard errors (default: 2)"
    )
    group.add_argument("--seed", type=natural, metavar="S", help="of the random numbers (default: 0)")
    group.add_argument("--resolution", type=count, metavar="N", help="pixels an edge, for hemicube (default: 64)")
    group.add_argument("--samples", type=count, metavar="N", help="points a patch, for hemicube (default: 1)")


def _add_work(group: argparse._ArgumentGroup) -> None:
    group.add_argument("--threads", type=count, metavar="N", help="(default: as many as there are processors)")
    group.add_argument(
        "--memory",
        type=bytes_of,
        metavar="SIZE",
        help="refuse more for form factors, as 4G (default: 80 %% of what is free)",
    )
    group.add_argument(
        "--checkpoint", type=Path, metavar="FOLDER", help="keep finished rows there; run again to go on after Ctrl-C"
    )
    group.add_argument("-q", "--quiet", action="store_true", help="say only what is wrong")


def solve_settings(args: argparse.Namespace) -> dict[str, Any]:
    """Keyword arguments of `rad.solve`.

    Raises
    ------
    ParameterError
        An option of the one method given to the other.
    """
    import radiosity as rad

    from ..plan.plan import RAYS, REPLICATES

    method = args.method or "monte-carlo"
    for option, its_methods in ONLY_FOR.items():
        if getattr(args, option) is not None and method not in its_methods:
            word, whose = option.replace("_", "-"), " or ".join(its_methods)
            raise rad.errors.ParameterError(f"--{word} is for --method {whose}, not for {method}; leave it out")
    if args.accuracy is not None:
        return _accuracy_settings(args)
    given = {option: value for option in ONLY_FOR if (value := getattr(args, option)) is not None}
    asked = args.method is not None or bool(given)
    if method == "monte-carlo" and given.get("rays", RAYS) % REPLICATES == 0:
        given.setdefault("replicates", REPLICATES)  # as `rad.solve` does, for the certificate's sake
    return {
        "patch_count": args.patches,
        "patch_size": args.patch_size,
        "estimator": getattr(rad, METHODS[method])(**given) if asked else None,
        "solver": None if args.rtol is None else rad.Neumann(rtol=args.rtol),
        "bounces": args.bounces,
        "threads": args.threads,
        "memory_limit": args.memory,
        "checkpoint": args.checkpoint,
    }


def _accuracy_settings(args: argparse.Namespace) -> dict[str, Any]:
    """Keyword arguments of `rad.solve` where an accuracy is asked for; what it chooses cannot be given.

    Raises
    ------
    ParameterError
    """
    import radiosity as rad

    for option in CHOSEN_BY_ACCURACY:
        if getattr(args, option) is not None:
            word = option.replace("_", "-")
            raise rad.errors.ParameterError(f"--{word} would not be used: --accuracy chooses it; leave one out")
    return {
        "accuracy": args.accuracy,
        "patch_count": args.patches,
        "patch_size": args.patch_size,
        "estimator": rad.MonteCarlo(seed=args.seed or 0),
        "threads": args.threads,
        "memory_limit": args.memory,
    }


def refuse_solve_settings(args: argparse.Namespace, why: str) -> None:
    """Refuse options that would not be used.

    Raises
    ------
    ParameterError
    """
    from ..errors import ParameterError

    for option in SOLVE_OPTIONS:
        if getattr(args, option) is not None:
            raise ParameterError(f"--{option.replace('_', '-')} would not be used: {why}; leave it out")


def check_output(path: Path, suffixes: tuple[str, ...]) -> None:
    """Refuse an output that cannot be written, before hours of work are put into it.

    Raises
    ------
    FileFormatError, MissingFileError, OSError
    """
    from ..errors import FileFormatError, MissingFileError

    if path.suffix.lower() not in suffixes:
        raise FileFormatError(f"{path}: {path.suffix!r} is not written here; choose from {', '.join(suffixes)}")
    if not path.parent.is_dir():
        raise MissingFileError(f"cannot write {path}: there is no folder {path.parent}; make it first")
    if path.is_dir():
        raise FileFormatError(f"cannot write {path}: it is a folder")
    if not os.access(path.parent, os.W_OK):
        raise PermissionError(f"cannot write {path}: the folder {path.parent} is not yours to write to")


# Types of arguments. argparse puts the name of the option before what they say.


def count(text: str) -> int:
    """A whole number, at least 1."""
    return _whole(text, 1)


def natural(text: str) -> int:
    """A whole number, at least 0."""
    return _whole(text, 0)


def _whole(text: str, low: int) -> int:
    try:
        number = int(text.replace("_", ""))
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is not a whole number") from None
    if number < low:
        raise argparse.ArgumentTypeError(f"{number} is too few; give at least {low}")
    return number


def positive(text: str) -> float:
    """A number above 0."""
    number = _number(text)
    if not 0.0 < number < math.inf:
        raise argparse.ArgumentTypeError(f"{text!r} is not a positive number")
    return number


def bytes_of(text: str) -> int:
    """Bytes, or thousands, millions … of them.

    >>> bytes_of("4G"), bytes_of("1.5 GB"), bytes_of("800M")
    (4000000000, 1500000000, 800000000)
    """
    found = SIZE.fullmatch(text)
    if found is None:
        raise argparse.ArgumentTypeError(f"{text!r} is not a size, as in 4G or 800M")
    return round(positive(found[1]) * 1000.0 ** " KMGT".index(found[2].upper() or " "))


def share(text: str) -> float:
    """A number between 0 and 1, or per cent.

    >>> share("1%"), share("0.02")
    (0.01, 0.02)
    """
    number = _number(text.rstrip().removesuffix("%")) / (100.0 if text.rstrip().endswith("%") else 1.0)
    if not 0.0 < number < 1.0:
        raise argparse.ArgumentTypeError(f"{text!r} is not between 0 and 1, nor between 0% and 100%")
    return number


def channels(text: str) -> list[float]:
    """Numbers with commas between them, one for each channel, none negative.

    >>> channels("17,12,4")
    [17.0, 12.0, 4.0]
    """
    numbers = [_number(part) for part in text.split(",")]
    if not all(0.0 <= number < math.inf for number in numbers):
        raise argparse.ArgumentTypeError(f"{text!r} holds a number that is negative or not finite")
    return numbers


def lamp(text: str) -> tuple[str, list[float]]:
    """A surface and what it emits; the name may hold equals signs.

    >>> lamp("Ceiling=30,28,25")
    ('Ceiling', [30.0, 28.0, 25.0])
    """
    name, equals, light = text.rpartition("=")
    if not (name and equals):
        raise argparse.ArgumentTypeError(f"{text!r} is not SURFACE=E, as in Ceiling=30,28,25")
    return name, channels(light)


def _number(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is not a number") from None
