"""What a study leaves behind: tables as CSV and JSON, plots as PNG and SVG, a report in one file."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..files.atomic import replacing, write_bytes
from . import fronts, summary
from .fits import Exponent
from .ledger import Record
from .study import Study

if TYPE_CHECKING:
    from matplotlib.figure import Figure

DOTS = 110  # an inch, of a PNG


@dataclass(frozen=True, eq=False)
class Findings:
    """Tables by name, and sentences drawn from them."""

    study: Study
    tables: Mapping[str, Sequence[Record]]
    sentences: tuple[str, ...]

    @property
    def growing(self) -> bool:
        """Whether the subjects are a family of scenes, and not one scene cut ever more finely."""
        return self.study.subjects[0].parameter != "patches"


def findings(study: Study) -> Findings:
    """Work out tables and sentences."""
    records, bounces, solvers = (
        summary.on_clock(study.ledger.of(part), study.settings.clock) for part in ("methods", "bounces", "solvers")
    )
    rows = summary.method_rows(records)
    growing = study.subjects[0].parameter != "patches"
    tables = {
        "methods": rows,
        "splits": summary.split_rows(study.subjects, study.references, rows),
        "convergence": summary.convergence_rows(records),
        "growth": summary.growth_rows(records) if len(study.subjects) > 1 else [],
        "bounces": summary.bounce_rows(bounces),
        "solvers": summary.solver_rows(solvers),
        "checks": [check._asdict() for check in study.checks],
    }
    return Findings(study, tables, tuple(() if growing else fronts.sentences(rows)))


def figures(found: Findings) -> dict[str, Figure]:
    """All plots by the names of their files."""
    from . import plots

    study, rows = found.study, found.tables["methods"]
    names = [subject.name for subject in study.subjects]
    clock = plots.CLOCKS[study.settings.clock]
    made: dict[str, Figure | None] = {}
    if rows and found.growing:
        made["growth"] = plots.growth(rows, study.subjects[0].parameter, clock)
    if rows:
        made["error_against_time"] = plots.error_against_time(rows, study.references, names, clock)
        made["error_against_memory"] = plots.error_against_memory(rows)
        made["error_by_order"] = plots.error_by_order(rows, study.references[-1], names[-1])
        made["error_against_rays"] = plots.error_against_rays(rows, names)
    if found.tables["bounces"]:
        made["bounces"] = plots.bounces(found.tables["bounces"])
    if found.tables["solvers"]:
        made["solvers"] = plots.solvers(found.tables["solvers"], clock)
    return {name: one for name, one in made.items() if one is not None}


def write(found: Findings, folder: Path) -> list[Path]:
    """Write everything into the folder of the study; each file whole or not at all."""
    from .report import report

    written = []

    def put(name: str, content: bytes) -> None:
        write_bytes(folder / name, content)
        written.append(folder / name)

    made = figures(found)
    drawn = {name: svg(one) for name, one in made.items()}
    put("report.html", report(found, drawn).encode())
    put("study.json", as_json(found).encode())
    for name, rows in found.tables.items():
        if rows:
            put(f"{name}.csv", as_csv(rows).encode())
    for name, one in made.items():
        put(f"{name}.svg", drawn[name].encode())
        with replacing(folder / f"{name}.png") as temporary:
            one.savefig(temporary, dpi=DOTS)
        written.append(folder / f"{name}.png")
    return written


def svg(made: Figure) -> str:
    """A plot as SVG text, the same for the same plot."""
    import matplotlib as mpl

    text = io.StringIO()
    with mpl.rc_context({"svg.hashsalt": "radiosity", "svg.fonttype": "path"}):
        made.savefig(text, format="svg", metadata={"Date": None})
    return text.getvalue()


def as_json(found: Findings) -> str:
    """Machine, sentences and tables."""
    whole = {
        "origin": found.study.origin,
        "clock": found.study.settings.clock,
        "sentences": list(found.sentences),
        "tables": _plain(found.tables),
    }
    return json.dumps(whole, ensure_ascii=False, indent=1, allow_nan=False) + "\n"


def as_csv(rows: Sequence[Record]) -> str:
    """A table; an exponent takes two columns, a list one each."""
    flat = [_flat(row) for row in rows]
    names = list(dict.fromkeys(name for row in flat for name in row))
    text = io.StringIO()
    writer = csv.DictWriter(text, names, lineterminator="\n", restval="")
    writer.writeheader()
    writer.writerows(flat)
    return text.getvalue()


def _flat(row: Record) -> Record:
    flat: Record = {}
    for name, value in row.items():
        if isinstance(value, Exponent):
            flat |= {f"{name} exponent": value.value, f"{name} standard error": value.error}
        elif isinstance(value, (list, tuple)):
            flat |= {f"{name}_{k}": entry for k, entry in enumerate(value, 1)}
        else:
            flat[name] = value
    return flat


def _plain(value: Any) -> Any:
    """The same without types and numbers that JSON does not know."""
    if isinstance(value, Exponent):
        return _plain(value._asdict())
    if isinstance(value, Mapping):
        return {name: _plain(entry) for name, entry in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(entry) for entry in value]
    if isinstance(value, float) and not abs(value) < float("inf"):
        return None
    return value
