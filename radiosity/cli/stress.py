"""`radiosity stress`: stiff and extreme cases, and where each solver stops being one."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from . import arguments
from .console import Screen

if TYPE_CHECKING:
    from ..study.stress.case import Case, Outcome
    from ..study.stress.curves import Point

HELP = "put stiff and extreme cases to the package: what is expected of each, and what comes"
EXAMPLES = """\
examples:
  radiosity stress                                all cases, and the solvers against absorptance: under 3 minutes
  radiosity stress --only albedo 1e-12            cases with these words in their group or name
  radiosity stress -o stress.csv -o stress.json --plot stress.png
  radiosity stress my_cases.py                    your own, a few lines each:

      import radiosity as rad
      from radiosity.study.stress import case, within

      @case("a furnace at one part in a thousand", expected="B = E / α within 1e-4")
      def thousandth():
          solution = rad.solve(rad.scenes.furnace(absorptance=1e-3), solver=rad.Neumann(maxiter=20_000))
          return within(solution.radiosity * 1e-3, 1.0, 1e-4)

The exit code is 1 if a case does not come out as expected.
"""
FAILED = 1


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Words of this command."""
    parser.add_argument("files", metavar="FILE.py", nargs="*", help="cases of your own, instead of the package's")
    parser.add_argument(
        "--only", nargs="+", default=[], metavar="WORD", help="cases whose group or name holds all words"
    )
    parser.add_argument("--list", action="store_true", help="say which cases there are, and run none")
    arguments.add_output(parser, ".csv or .json")
    parser.add_argument(
        "--plot", type=Path, metavar="FILE", help="error and products against absorptance; .png or .svg"
    )
    parser.add_argument("-q", "--quiet", action="store_true", help="show only cases that fail")


def run(args: argparse.Namespace, screen: Screen) -> int:
    """Run the cases, show, write; 1 if one failed."""
    from ..study.stress.curves import curve
    from ..study.stress.runner import built_in, cases_of, chosen, run_cases

    for path in args.output:
        arguments.check_output(path, (".csv", ".json"))
    if args.plot is not None:
        arguments.check_output(args.plot, (".png", ".svg"))
    cases = [case for file in args.files for case in cases_of(file)] if args.files else built_in()
    cases = chosen(cases, args.only)
    if args.list:
        _list(cases, screen)
        return 0
    whole = not (args.files or args.only)
    with screen.progress() as tell:
        outcomes = run_cases(cases, tell)
        points = curve(progress=tell) if whole or args.plot is not None else []
    failed = [outcome for outcome in outcomes if not outcome.good]
    _show(failed if args.quiet else outcomes, screen)
    if points and not args.quiet:
        _show_curves(points, screen)
    _write(args, outcomes, points, screen)
    screen.say(f"{len(outcomes)} cases in {sum(o.seconds for o in outcomes):.0f} s, {len(failed)} not as expected")
    return FAILED if failed else 0


def _list(cases: Sequence[Case], screen: Screen) -> None:
    for case in cases:
        screen.out.print(f"{case.group:<9} {case.name}: {case.expected}", markup=False, highlight=False, soft_wrap=True)


def _show(outcomes: Sequence[Outcome], screen: Screen) -> None:
    """A table with a line for each case."""
    from rich import box
    from rich.table import Table
    from rich.text import Text

    if not outcomes:
        return
    table = Table(box=box.SIMPLE_HEAD)
    for head in ("case", "expected", "got", "verdict"):
        table.add_column(head)
    table.add_column("seconds", justify="right")
    group = ""
    for outcome in outcomes:
        if outcome.group != group:
            group = outcome.group
            table.add_row(Text(group, style="bold"), "", "", "", "")
        style = "green" if outcome.good else "bold red"
        words = map(Text, (outcome.name, outcome.expected, outcome.got))
        table.add_row(*words, Text(outcome.verdict, style=style), f"{outcome.seconds:.2f}")
    screen.out.print(table)


def _show_curves(points: Sequence[Point], screen: Screen) -> None:
    """Products and error of each solver, a line for each absorptance."""
    from rich import box
    from rich.table import Table

    names = list(dict.fromkeys(point.solver for point in points))
    table = Table(
        title="products (error), two rooms; ! not converged, and says so",
        title_justify="left",
        box=box.SIMPLE_HEAD,
    )
    table.add_column("absorptance")
    for name in names:
        table.add_column(name)
    for alpha in dict.fromkeys(point.absorptance for point in points):
        cells = [
            f"{point.products} ({point.error:.0e}){'' if point.claimed else ' !'}"
            for point in points
            if point.absorptance == alpha
        ]
        table.add_row(f"{alpha:.2g}", *cells)
    screen.out.print(table, markup=False)


def _write(args: argparse.Namespace, outcomes: Sequence[Outcome], points: Sequence[Point], screen: Screen) -> None:
    from ..files.atomic import replacing, write_bytes
    from ..study.stress import outputs

    for path in args.output:
        text = outputs.as_csv(outcomes) if path.suffix.lower() == ".csv" else outputs.as_json(outcomes, points)
        write_bytes(path, text.encode())
        screen.say(f"wrote {path}")
    if args.plot is not None:
        with replacing(args.plot) as temporary:
            outputs.plot(points).savefig(temporary, dpi=110)
        screen.say(f"wrote {args.plot}")
