"""`radiosity plan`: what a scene needs and what will be left out, before it is solved."""

from __future__ import annotations

import argparse

from . import arguments
from .check import list_findings
from .console import Screen

HELP = "say what a scene needs, what is left out and what that saves, before solving it"
EXAMPLES = """\
examples:
  radiosity plan cornell_box
  radiosity plan room.obj --unit mm --lamp Ceiling=30,28,25 --patches 40000 --rays 1024

Seconds and bytes are foretold from a small sample of the rows of form factors, which are then thrown away. `radiosity
solve` with the same words does what is printed here; rad.solve(…, leave_out=False) leaves nothing out.
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Words of this command."""
    parser.add_argument("scene", metavar="SCENE", help="a file (.glb .gltf .obj .ply .stl .off) or a built-in scene")
    arguments.add_scene(parser)
    arguments.add_solve(parser)


def run(args: argparse.Namespace, screen: Screen) -> None:
    """Plan and print."""
    import radiosity as rad

    from .source import scene

    if args.accuracy is not None:
        raise rad.errors.ParameterError("--accuracy chooses by trials, which no plan foretells: use `radiosity solve`")
    settings = arguments.solve_settings(args)
    for option in ("memory_limit", "checkpoint"):
        settings.pop(option, None)
    looked_at = scene(args.scene, args)
    if found := looked_at.validate():
        screen.out.print("about the scene (`radiosity scenes --check` marks the places in a picture):", style="bold")
        list_findings(found, screen)
    with screen.working("looking at the scene"):
        made = rad.plan(looked_at, **settings)
    print_plan(made, screen)


def print_plan(plan: object, screen: Screen) -> None:
    """The plan as tables: what is left out, what is needed, what it takes."""
    from rich import box
    from rich.table import Table

    import radiosity as rad

    assert isinstance(plan, rad.Plan)
    head = str(plan).splitlines()
    screen.out.print("\n".join(head[: 1 + (plan.seconds is not None)]), soft_wrap=True, markup=False, highlight=False)
    for title, items in (("left out", plan.left_out), ("needed", [i for i in plan.items if not i.left_out])):
        table = Table(title=title, title_justify="left", box=box.SIMPLE_HEAD)
        table.add_column("what", no_wrap=True, style="bold")
        table.add_column("why")
        for name in ("seconds", "MB"):
            table.add_column(name, justify="right")
        for item in items:
            seconds = f"{item.seconds:.2g}" if item.seconds else ""
            table.add_row(item.name, item.story, seconds, f"{item.bytes / 1e6:.3g}" if item.bytes else "")
        screen.out.print(table)
