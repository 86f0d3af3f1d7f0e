"""`radiosity study`: error against run time and memory, over methods, patches, bounces and solvers."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from . import arguments
from .console import Screen

if TYPE_CHECKING:
    from ..study.outputs import Findings
    from ..study.study import Settings
    from ..study.subject import Subject
    from ..study.tables import Sheet

HELP = "measure error against run time and memory of every method on a scene, with plots and a report"
EXAMPLES = """\
examples:
  radiosity study cornell_box --quick             under a minute
  radiosity study cornell_box                     minutes; Ctrl-C keeps what is done, the same command goes on
  radiosity study room.obj --unit mm --sky 1 --patches 500 2000 8000 -o study_room
  radiosity study occlusion                       how cost and error grow with the number of blockers; also
                                                  singularity, reflectance, complexity, tube

The folder then holds report.html (everything in one file), the tables as .csv, all of them as study.json, the plots as
.png and .svg, and every single run in runs.jsonl.
"""
COUNTS, FEW_COUNTS = (300, 1000, 3000), (250, 1000)
SHOWN = (
    "where the error comes from",
    "independent yardstick",
    "how the sampling error falls",
    "growth with the parameter",
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Words of this command."""
    parser.add_argument("scene", metavar="SCENE", help="a file, a built-in scene, or one of the families of scenes")
    group = parser.add_argument_group("study")
    group.add_argument("--quick", action="store_true", help="few budgets and repeats: under a minute")
    group.add_argument(
        "--patches",
        type=arguments.count,
        nargs="+",
        metavar="N",
        help=f"numbers of patches (default: {_words(COUNTS)})",
    )
    group.add_argument("--repeats", type=arguments.count, metavar="N", help="times that each run is made (default: 3)")
    group.add_argument("--parts", nargs="+", choices=("methods", "bounces", "solvers"), help="(default: all)")
    group.add_argument(
        "--clock",
        choices=("wall", "processor"),
        default="wall",
        help="seconds that pass, or those of all processors together: for a machine with other work (default: wall)",
    )
    group.add_argument("--seed", type=arguments.natural, default=0, metavar="S", help="(default: 0)")
    group.add_argument("-o", "--output", type=Path, metavar="FOLDER", help="(default: study_SCENE)")
    arguments.add_scene(parser)
    group = parser.add_argument_group("work")
    group.add_argument(
        "--threads", type=arguments.count, metavar="N", help="(default: as many as there are processors)"
    )
    group.add_argument("-q", "--quiet", action="store_true", help="say only what is wrong")


def run(args: argparse.Namespace, screen: Screen) -> None:
    """Study, show, write."""
    from ..study.outputs import findings, write
    from ..study.study import LEDGER, run_study

    name, subjects = _subjects(args)
    folder = args.output or Path(f"study_{name}")
    try:
        with screen.progress() as tell:
            study = run_study(name, subjects, _settings(args, name), folder, tell)
    except KeyboardInterrupt:
        screen.say(f"what is done is kept in {folder / LEDGER}; the same command goes on from there")
        raise
    found = findings(study)
    if not args.quiet:
        show(found, screen)
    written = write(found, folder)
    screen.say(f"wrote {len(written)} files into {folder.resolve()}; begin with {folder / 'report.html'}")


def _subjects(args: argparse.Namespace) -> tuple[str, list[Subject]]:
    """What is studied, and what it is called."""
    from ..errors import ParameterError
    from ..study.families import SCENE_FAMILIES, by_parameter
    from ..study.subject import by_patches
    from . import source

    if args.scene in SCENE_FAMILIES and not Path(args.scene).exists():
        if args.patches or args.lamp or args.sky or args.unit:
            raise ParameterError(
                f"{args.scene} is a family of scenes with its own patches and light; leave out the rest"
            )
        return args.scene, by_parameter(args.scene, few=args.quick)
    scene = source.scene(args.scene, args)
    return scene.name, by_patches(scene, args.patches or (FEW_COUNTS if args.quick else COUNTS))


def _settings(args: argparse.Namespace, name: str) -> Settings:
    from dataclasses import replace

    from ..study.families import SCENE_FAMILIES
    from ..study.study import PARTS, Settings

    settings = Settings.quick() if args.quick else Settings()
    family = name in SCENE_FAMILIES
    return replace(
        settings,
        seed=args.seed,
        threads=args.threads,
        clock=args.clock,
        repeats=args.repeats or settings.repeats,
        few=args.quick or family,
        parts=tuple(args.parts or (PARTS[:1] if family else PARTS)),
    )


def show(found: Findings, screen: Screen) -> None:
    """The tables that fit a terminal, and the sentences."""
    from ..study.summary import grouped
    from ..study.tables import narrow_sheet, sheets, without

    for (subject,), rows in grouped(found.tables["methods"], ("subject",)).items():
        _print(narrow_sheet(subject, rows), screen)
    for sheet in sheets(found):
        if sheet.title in SHOWN or sheet.title.startswith("growth"):
            _print(without(sheet, "reference"), screen)
    for sentence in found.sentences:
        screen.out.print(sentence, markup=False, highlight=False, soft_wrap=True)


def _print(sheet: Sheet, screen: Screen) -> None:
    from rich import box
    from rich.table import Table

    table = Table(
        title=sheet.title, title_justify="left", box=box.SIMPLE_HEAD, caption=sheet.note, caption_justify="left"
    )
    for head in sheet.heads:
        table.add_column(head)
    for row in sheet.rows:
        table.add_row(*row)
    screen.out.print(table, markup=False)


def _words(counts: tuple[int, ...]) -> str:
    return " ".join(map(str, counts))
