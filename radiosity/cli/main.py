"""Reads the command line, runs one command, and turns what goes wrong into one line and an exit code."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence
from contextlib import suppress

from .._version import __version__
from ..errors import RadiosityError
from . import export, lecture, plan, render, scenes, solve, stress, study, view
from .console import Screen
from .interrupts import INTERRUPTED, interruptible

FAILED = 2

COMMANDS = (solve, plan, view, export, render, lecture, scenes, study, stress)

DESCRIPTION = """\
How light fills a room of matt surfaces, bounce by bounce: form factors by hemicube or by Monte Carlo rays, and the
Neumann series B = E + T E + T² E + …
"""
EXAMPLES = """\
examples:
  radiosity view                                  the Cornell box, in a window
  radiosity solve cornell_box -o cornell.npz      a built-in scene, solved and kept
  radiosity solve room.obj --unit mm --lamp Ceiling=30,28,25 -o room.vtp
  radiosity view cornell.npz --screenshot cornell.png

exit codes: 0 done; 1 a case of `stress` failed; 2 refused, the last line says why and what to do; 3 there is no window
to be had, so pictures or a page were written instead; 130 after Ctrl-C
"""


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line.

    Parameters
    ----------
    argv : sequence of str, optional
        Without the program's name; ``sys.argv[1:]`` by default.

    Returns
    -------
    int
        0 when all went well, 1 when a case of `stress` failed, 2 when the input or the machine does not allow it, 3
        when a window was asked for and none can open, 130 after Ctrl-C.
    """
    for stream in (sys.stdout, sys.stderr):
        with suppress(AttributeError, ValueError):  # a terminal that lacks ρ shows a question mark for it
            stream.reconfigure(errors="replace")  # type: ignore[union-attr]
    try:
        args = parser().parse_args(argv)
    except SystemExit as end:
        return int(end.code or 0)
    screen = Screen(quiet=getattr(args, "quiet", False))
    with interruptible(lambda: _interrupted(args)), screen.warnings():
        return _run(args, screen)


def _run(args: argparse.Namespace, screen: Screen) -> int:
    """Run a command; errors that are meant for people become one line."""
    try:
        code = args.run(args, screen)
    except KeyboardInterrupt:
        screen.error(_interrupted(args))
        return INTERRUPTED
    except RadiosityError as error:
        screen.error(str(error))
        return FAILED
    except BrokenPipeError:  # `radiosity … | head` has read enough
        sys.stdout = open(os.devnull, "w")  # noqa: SIM115 (for the interpreter's own flush at its end)
        return 1
    except (OSError, MemoryError) as error:
        screen.error(f"{type(error).__name__}: {error}")
        return FAILED
    return int(code or 0)  # a command that has something to say by its code returns one


def _interrupted(args: argparse.Namespace) -> str:
    """What is left after Ctrl-C, and how to go on."""
    folder = getattr(args, "checkpoint", None)
    if folder is None or not folder.is_dir():
        return "interrupted; nothing half-written is left"
    return f"interrupted; the rows that were finished are kept in {folder}: the same command goes on from there"


def parser() -> argparse.ArgumentParser:
    """The words that the command line knows."""
    top = argparse.ArgumentParser(
        prog="radiosity", description=DESCRIPTION, epilog=EXAMPLES, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    top.add_argument("--version", action="version", version=f"radiosity {__version__}")
    commands = top.add_subparsers(title="commands", metavar="COMMAND", required=True)
    for command in COMMANDS:
        name = command.__name__.rpartition(".")[2]
        own = commands.add_parser(
            name,
            help=command.HELP,
            description=command.HELP[0].upper() + command.HELP[1:] + ".",
            epilog=command.EXAMPLES,
            formatter_class=argparse.RawDescriptionHelpFormatter,
        )
        command.add_arguments(own)
        own.set_defaults(run=command.run)
    return top
