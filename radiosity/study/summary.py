"""Records of runs → rows of tables: medians with spread, exponents, where the error comes from."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from .fits import Exponent, cost_exponent, exponent
from .ledger import Record
from .methods import FAMILIES
from .reference import Reference
from .subject import Subject

MEASURED = (
    "seconds", "factor_seconds", "solve_seconds", "processor_seconds", "bytes_peak", "bytes_matrix", "bytes_predicted",
    "bounces", "sampling_l2", "sampling_maximum", "sampling_median", "sampling_p95", "total_l2", "total_maximum",
    "total_median", "total_p95",
)  # fmt: skip
ABOUT = ("subject", "parameter", "value", "patches", "family", "budget", "work")


def grouped(records: Iterable[Record], names: Sequence[str]) -> dict[tuple[Any, ...], list[Record]]:
    """Records by the values of some fields, in the order in which these first appear."""
    found: dict[tuple[Any, ...], list[Record]] = defaultdict(list)
    for record in records:
        found[tuple(record[name] for name in names)].append(record)
    return dict(found)


def on_clock(records: Iterable[Record], clock: str) -> list[Record]:
    """Records whose "seconds" are those of a clock, "wall" or "processor"."""
    if clock == "wall":
        return list(records)
    return [record | {"seconds": record["processor_seconds"]} if "seconds" in record else record for record in records]


def method_rows(records: Iterable[Record]) -> list[Record]:
    """One row a subject, family and budget: medians, and the least and largest of seconds and errors.

    Of peaks of memory the largest: where a run is given pages that the process had kept, less of it shows.
    """
    rows = []
    for about, runs in grouped(records, ABOUT).items():
        row: Record = dict(zip(ABOUT, about, strict=True)) | {"runs": len(runs)}
        for name in MEASURED:
            row[name] = _median(runs, name)
        row["bytes_peak"] = _ends(runs, "bytes_peak")[1]
        for name in ("seconds", "sampling_l2", "total_l2"):
            row[f"{name}_least"], row[f"{name}_most"] = _ends(runs, name)
        row["by_order"] = _by_order(runs)
        rows.append(row)
    return sorted(rows, key=lambda row: (row["value"], order_of(row["family"]), row["work"]))


def _values(runs: Iterable[Record], name: str) -> list[float]:
    return [run[name] for run in runs if run.get(name) is not None]


def _median(runs: list[Record], name: str) -> float | None:
    values = _values(runs, name)
    return float(np.median(values)) if values else None


def _ends(runs: list[Record], name: str) -> tuple[float | None, float | None]:
    values = _values(runs, name)
    return (min(values), max(values)) if values else (None, None)


def _by_order(runs: list[Record]) -> list[float | None]:
    """Median error of each order against the same patches' own."""
    orders = zip(*(run["sampling_by_order"] for run in runs), strict=True)
    return [None if None in values else float(np.median(values)) for values in orders]


def convergence_rows(records: Iterable[Record]) -> list[Record]:
    """Exponents of the sampling error against rays and against seconds, for each subject and family."""
    rows = []
    ordered = sorted(records, key=lambda run: (run["value"], order_of(run["family"])))
    for (subject, family), runs in grouped(ordered, ("subject", "family")).items():
        error, work = _column(runs, "sampling_l2"), _column(runs, "work")
        by_work = exponent(work, error)
        by_time = exponent(_typical(runs, work), error)
        if by_work is not None and by_time is not None:
            rows.append({"subject": subject, "family": family, "error by rays": by_work, "error by seconds": by_time})
    return rows


def growth_rows(records: Iterable[Record]) -> list[Record]:
    """Exponents against the parameter: of error, seconds and bytes at one budget, and of the time to one error."""
    rows = []
    everything = list(records)
    for (family,), of_family in grouped(everything, ("family",)).items():
        value, work, error, time = (_column(of_family, name) for name in ("value", "work", "sampling_l2", "seconds"))
        equal = cost_exponent(value, work, error, time)
        for (budget,), runs in grouped(of_family, ("budget",)).items():
            value = _column(runs, "value")
            row: Record = {"family": family, "budget": budget, "work": runs[0]["work"]}
            for name, column in (("error", "sampling_l2"), ("seconds", "seconds"), ("bytes", "bytes_matrix")):
                row[name] = exponent(value, _column(runs, column))
            row["seconds to one error"] = equal
            if any(isinstance(entry, Exponent) for entry in row.values()):
                rows.append(row)
    return sorted(rows, key=lambda row: (order_of(row["family"]), row["work"]))


def order_of(family: str) -> int:
    """Where a family stands in the list."""
    return list(FAMILIES).index(family)


def _typical(runs: Sequence[Record], work: Sequence[float]) -> list[float]:
    """Median seconds of the runs of as much work as each: a slow moment of the machine is no property of the method."""
    medians = {amount: _median([run for run in runs if run["work"] == amount], "seconds") for amount in set(work)}
    return [np.nan if medians[amount] is None else float(medians[amount] or 0.0) for amount in work]


def _column(runs: Iterable[Record], name: str) -> list[float]:
    return [np.nan if run[name] is None else run[name] for run in runs]


def split_rows(subjects: Sequence[Subject], references: Sequence[Reference], rows: Sequence[Record]) -> list[Record]:
    """What the patches of each subject cost, how well that is known, and the least sampling error reached on them."""
    found = []
    for subject, truth in zip(subjects, references, strict=True):
        reached = [row["sampling_l2"] for row in rows if row["subject"] == subject.name and row["work"] > 0]
        found.append(
            {
                "subject": subject.name,
                "patches": len(subject.patches),
                "finer patches": truth.fine_patches,
                "discretisation": truth.discretisation,
                "known to": float(np.hypot(truth.discrete_error, truth.continuous_error)),
                "reference error": truth.discrete_error,
                "least sampling": min(reached, default=None),
                "how": truth.how,
            }
        )
    return found


def bounce_rows(records: Iterable[Record]) -> list[Record]:
    """Medians by number of bounces, with and without the geometric tail."""
    rows = []
    for (bounces, tail), runs in sorted(grouped(records, ("bounces", "tail")).items()):
        medians = {name: _median(runs, name) for name in ("seconds", "truncation", "sampling", "total")}
        rows.append({"bounces": bounces, "tail": tail, "runs": len(runs), **medians})
    return rows


def solver_rows(records: Iterable[Record]) -> list[Record]:
    """Medians by solver and tolerance; what a solver refused is said."""
    rows = []
    for (solver, rtol), runs in sorted(
        grouped(records, ("solver", "rtol")).items(), key=lambda item: _tightening(item[0])
    ):
        refused = next((run["refused"] for run in runs if "refused" in run), None)
        row: Record = {"solver": solver, "rtol": rtol, "runs": len(runs), "refused": refused}
        for name in ("seconds", "products", "algebra"):
            row[name] = None if refused else _median(runs, name)
        row["converged"] = not refused and all(run["converged"] for run in runs)
        rows.append(row)
    return rows


def _tightening(solver_and_rtol: tuple[Any, ...]) -> tuple[str, float]:
    return solver_and_rtol[0], -solver_and_rtol[1]
