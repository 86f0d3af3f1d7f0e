"""Tables for people: which columns, in which words. The terminal and the report show the same."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

from .fits import Exponent
from .fronts import pareto
from .ledger import Record
from .methods import FAMILIES
from .outputs import Findings


class Sheet(NamedTuple):
    """A table in words: title, heads, and rows of as many cells."""

    title: str
    heads: tuple[str, ...]
    rows: Sequence[tuple[str, ...]]
    note: str = ""


def sheets(found: Findings) -> Iterator[Sheet]:
    """All tables that have rows."""
    makers: tuple[tuple[str, Callable[[Sequence[Record]], Sheet]], ...] = (
        ("methods", methods_sheet),
        ("splits", splits_sheet),
        ("checks", checks_sheet),
        ("convergence", convergence_sheet),
        ("growth", growth_sheet),
        ("bounces", bounces_sheet),
        ("solvers", solvers_sheet),
    )
    for name, make in makers:
        rows = found.tables[name]
        if rows and not (name == "convergence" and found.growing):
            sheet = make(rows)
            if name == "growth" and not found.growing:
                sheet = sheet._replace(title="growth with the number of patches")
            yield sheet


def without(sheet: Sheet, head: str) -> Sheet:
    """The sheet less the column of that head, if it has one."""
    if head not in sheet.heads:
        return sheet
    k = sheet.heads.index(head)
    return sheet._replace(
        heads=sheet.heads[:k] + sheet.heads[k + 1 :], rows=[row[:k] + row[k + 1 :] for row in sheet.rows]
    )


def methods_sheet(rows: Sequence[Record]) -> Sheet:
    """Every method and budget."""
    heads = (
        "subject", "method", "budget", "seconds", "from … to", "processors", "MB matrix", "foreseen", "MB peak",
        "sampling", "total", "from … to", "median", "p95", "worst patch",
    )  # fmt: skip
    cells = [
        (
            row["subject"],
            FAMILIES[row["family"]].short,
            row["budget"],
            _short(row["seconds"]),
            f"{_short(row['seconds_least'])} … {_short(row['seconds_most'])}",
            _short(row["processor_seconds"]),
            _mega(row["bytes_matrix"]),
            _mega(row["bytes_predicted"]),
            _mega(row["bytes_peak"]),
            _percent(row["sampling_l2"]),
            _percent(row["total_l2"]),
            f"{_percent(row['total_l2_least'])} … {_percent(row['total_l2_most'])}",
            _percent(row["total_median"]),
            _percent(row["total_p95"]),
            _percent(row["total_maximum"]),
        )
        for row in rows
    ]
    note = (
        "Medians over repeats. Sampling: against exact form factors on the same patches; total: against finer patches. "
        "Errors are area-weighted relative L2 of B − E; the last three columns are of single patches, each relative to "
        "its own light."
    )
    return Sheet("methods", heads, cells, note)


def narrow_sheet(subject: str, rows: Sequence[Record]) -> Sheet:
    """The methods on one subject, narrow enough for a terminal, with a star for each on the Pareto front."""
    front = [id(row) for row in pareto(rows, "seconds", "total_l2")]
    cells = [
        (
            "*" if id(row) in front else "",
            FAMILIES[row["family"]].short,
            row["budget"],
            _short(row["seconds"]),
            _mega(row["bytes_peak"]),
            _percent(row["sampling_l2"]),
            _percent(row["total_l2"]),
            _percent(row["total_p95"]),
        )
        for row in rows
    ]
    heads = ("", "method", "budget", "seconds", "MB", "sampling", "total", "p95 patch")
    return Sheet(subject, heads, cells, "* nothing is both quicker and better")


def splits_sheet(rows: Sequence[Record]) -> Sheet:
    """Where the error comes from."""
    heads = (
        "subject",
        "discretisation",
        "known to",
        "finer patches",
        "least sampling error",
        "reference's own error",
        "reference",
    )
    cells = [
        (
            row["subject"],
            _percent(row["discretisation"]),
            _percent(row["known to"]),
            f"{row['finer patches']:,}",
            _percent(row["least sampling"]),
            _percent(row["reference error"]),
            row["how"],
        )
        for row in rows
    ]
    return Sheet(
        "where the error comes from", heads, cells, "Discretisation: of means over patches, against finer patches."
    )


def checks_sheet(rows: Sequence[Record]) -> Sheet:
    """The reference against random walks."""
    words = {True: "yes", False: "NO", None: "—"}
    cells = [
        (row["what"], _percent(row["found"]), _percent(row["expected"]), _percent(row["excess"]), words[row["agrees"]])
        for row in rows
    ]
    note = "Agrees: what standard errors do not explain is within three of its own standard errors."
    return Sheet("independent yardstick", ("what", "apart", "expected by chance", "the rest", "agrees"), cells, note)


def convergence_sheet(rows: Sequence[Record]) -> Sheet:
    """How fast errors fall."""
    heads = ("subject", "method", "error by rays: exponent", "error by seconds: exponent")
    cells = [
        (row["subject"], FAMILIES[row["family"]].short, str(row["error by rays"]), str(row["error by seconds"]))
        for row in rows
    ]
    return Sheet("how the sampling error falls", heads, cells, "± one standard error of the fit.")


def growth_sheet(rows: Sequence[Record]) -> Sheet:
    """How cost and error grow with the parameter."""
    names = ("error", "seconds", "bytes", "seconds to one error")
    cells = [(FAMILIES[row["family"]].short, row["budget"], *(_exponent(row[name]) for name in names)) for row in rows]
    heads = ("method", "budget", "error", "seconds", "bytes of the matrix", "seconds to one error")
    note = (
        "Exponents p of y ∝ parameter^p, ± one standard error of the fit. The last column is of all budgets together: "
        "how the time to one and the same sampling error grows."
    )
    return Sheet("growth with the parameter", heads, cells, note)


def bounces_sheet(rows: Sequence[Record]) -> Sheet:
    """Where the series is cut."""
    cells = [
        (
            str(row["bounces"]),
            "yes" if row["tail"] else "no",
            _short(row["seconds"]),
            _percent(row["truncation"]),
            _percent(row["total"]),
        )
        for row in rows
    ]
    heads = ("bounces", "geometric tail", "seconds", "left out", "total error")
    return Sheet("truncation", heads, cells, "On the same form factors, of 1024 rays and emitters apart.")


def solvers_sheet(rows: Sequence[Record]) -> Sheet:
    """Every solver at every tolerance."""
    cells = [
        (
            row["solver"],
            f"{row['rtol']:g}",
            _short(row["products"]),
            _short(row["seconds"]),
            "—" if row["algebra"] is None else f"{row['algebra']:.1e}",
            "refused: " + row["refused"] if row["refused"] else ("" if row["converged"] else "not converged"),
        )
        for row in rows
    ]
    heads = ("solver", "rtol", "products", "seconds", "error left", "note")
    return Sheet(
        "solvers",
        heads,
        cells,
        "All on the same conserved form factors, against elimination where there are few patches.",
    )


def _short(value: float | None) -> str:
    return "—" if value is None else f"{value:.3g}"


def _mega(value: float | None) -> str:
    return "—" if value is None else f"{value / 1e6:.1f}"


def _percent(value: float | None) -> str:
    if value is None:
        return "—"
    return "0" if value == 0 else (f"{100 * value:.2g} %" if abs(value) < 0.1 else f"{100 * value:.0f} %")


def _exponent(value: Exponent | None) -> str:
    return "—" if value is None else str(value)
