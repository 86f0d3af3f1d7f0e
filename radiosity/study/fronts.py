"""Which runs nothing beats, and which method to take for a given accuracy: read off the rows, in sentences."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from .ledger import Record
from .methods import FAMILIES

TARGETS = (0.1, 0.05, 0.02, 0.01, 0.005, 0.002)


def pareto(rows: Iterable[Record], cost: str, error: str) -> list[Record]:
    """Rows that no other row beats in both, cheapest first.

    >>> rows = [{"s": 1, "e": 3}, {"s": 2, "e": 4}, {"s": 3, "e": 1}]
    >>> pareto(rows, "s", "e")
    [{'s': 1, 'e': 3}, {'s': 3, 'e': 1}]
    """
    front: list[Record] = []
    for row in sorted((row for row in rows if _known(row, cost, error)), key=lambda row: (row[cost], row[error])):
        if not front or row[error] < front[-1][error]:
            front.append(row)
    return front


def _known(row: Record, *names: str) -> bool:
    return all(row[name] is not None for name in names)


def cheapest(rows: Iterable[Record], target: float, cost: str = "seconds") -> dict[str, Record]:
    """The cheapest row of each family whose worst run keeps the total error within `target`, cheapest family first."""
    best: dict[str, Record] = {}
    good = [row for row in rows if _known(row, cost, "total_l2_most") and row["total_l2_most"] <= target]
    for row in sorted(good, key=lambda row: row[cost]):
        best.setdefault(row["family"], row)
    return best


def sentences(rows: Sequence[Record]) -> list[str]:
    """The best method for each accuracy, one sentence each; accuracies that nothing reaches are said to be so."""
    said = []
    for target in TARGETS:
        best = cheapest(rows, target)
        if not best:
            said.append(f"To {100 * target:g} %: nothing that was run gets there.")
            break
        said.append(_sentence(target, list(best.values()), rows))
    return said


def _sentence(target: float, best: list[Record], rows: Sequence[Record]) -> str:
    first, *others = best
    place = f"{first['budget']} on {first['patches']:,} patches"
    memory = "" if first["bytes_peak"] is None else f" and {first['bytes_peak'] / 1e6:.2g} MB"
    head = (
        f"To {100 * target:g} %: {FAMILIES[first['family']].title}, {place}, in {first['seconds']:.2g} s"
        f"{memory} (error {100 * first['total_l2']:.2g} %)"
    )
    longer = [
        f"{FAMILIES[row['family']].short} ({row['budget']}) takes {row['seconds'] / first['seconds']:.1f} × as long"
        for row in others[:2]
    ]
    tried = {row["family"] for row in rows}
    missed = [family.short for name, family in FAMILIES.items() if name in tried - {row["family"] for row in best}]
    never = [f"not reached by: {', '.join(missed)}"] if missed else []
    return "; ".join([head, *longer, *never]) + "."
