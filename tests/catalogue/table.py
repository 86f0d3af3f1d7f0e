"""``python -m tests.catalogue.table`` runs every case and prints docs/evidence/catalogue.md."""

from __future__ import annotations

import tempfile
from itertools import groupby
from pathlib import Path

from . import files, geometry, work
from .case import Case

CASES: list[Case] = [*files.CASES, *geometry.CASES, *work.CASES]
LONGEST = 190

HEAD = """\
# Catalogue of difficult cases

Each case is built, run and compared by `tests/catalogue`; a case that does not give what is expected fails the tests. `python -m
tests.catalogue.table` runs them all and prints this page. What came is shortened where it is long.
"""


def run(case: Case) -> str:
    """What came of a case, in a folder of its own."""
    with tempfile.TemporaryDirectory() as folder:
        return case.run(Path(folder))


def main() -> None:
    """Run all cases, and print the page if they pass."""
    pages = []
    for group, cases in groupby(CASES, key=lambda case: case.group):
        pages.append(f"\n## {group.capitalize()}\n\n| case | construction | expected | came |\n|---|---|---|---|")
        pages += [_row(case) for case in cases]
    print(HEAD)
    print(f"All {len(CASES)} cases pass.")
    print("\n".join(pages))


def _row(case: Case) -> str:
    return f"| {case.name} | {_cell(case.construction)} | {_cell(case.expected)} | {_cell(run(case), LONGEST)} |"


def _cell(text: str, longest: int = 1000) -> str:
    short = text if len(text) <= longest else text[:longest].rsplit(" ", 1)[0] + " …"
    for mark in "\\|<*$":
        short = short.replace(mark, f"\\{mark}")
    return short


if __name__ == "__main__":
    main()
