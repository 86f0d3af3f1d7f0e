"""What a stress run leaves behind: CSV, JSON, and the plot of the curves."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Sequence
from typing import TYPE_CHECKING

from ..machine import machine
from ..summary import grouped
from .case import Outcome
from .curves import MOST_PRODUCTS, Point

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FOREIGN = {"scipy gmres": ("#CC79A7", "v"), "scipy bicgstab": ("#6E6E6E", "X")}
ROUNDING = 1e-16


def as_csv(outcomes: Sequence[Outcome]) -> str:
    """A line a case."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(Outcome._fields)
    writer.writerows(outcomes)
    return text.getvalue()


def as_json(outcomes: Sequence[Outcome], points: Sequence[Point]) -> str:
    """Machine, cases and curves."""
    whole = {
        "origin": machine(),
        "cases": [outcome._asdict() for outcome in outcomes],
        "curves": [point._asdict() | {"error": _number(point.error)} for point in points],
    }
    return json.dumps(whole, ensure_ascii=False, indent=1, allow_nan=False) + "\n"


def _number(value: float) -> float | None:
    return value if abs(value) < float("inf") else None


def plot(points: Sequence[Point]) -> Figure:
    """Error and products over absorptance; hollow where a solver says that it has not converged."""
    from ..plots import SOLVERS, figure, finish, log_axes

    made, (left, right) = figure(2)
    for (solver,), members in grouped([point._asdict() for point in points], ("solver",)).items():
        colour, marker = (SOLVERS | FOREIGN)[solver]
        alpha = [point["absorptance"] for point in members]
        for ax, name in ((left, "error"), (right, "products")):
            values = [max(point[name], ROUNDING if name == "error" else 1) for point in members]
            ax.plot(alpha, values, color=colour, linewidth=1)
            for claimed in (True, False):
                chosen = [
                    (a, v) for a, v, point in zip(alpha, values, members, strict=True) if point["claimed"] == claimed
                ]
                if chosen:
                    face = colour if claimed else "white"
                    label = solver if claimed else None
                    ax.plot(
                        *zip(*chosen, strict=True),
                        color=colour,
                        marker=marker,
                        markerfacecolor=face,
                        linestyle="",
                        label=label,
                    )
    log_axes(left, "absorptance α of all walls", "error of B - E, relative L2", per_cent=False)
    log_axes(right, "absorptance α of all walls", f"products, {MOST_PRODUCTS:,} at most", per_cent=False)
    left.plot([], [], color="#222222", marker="o", markerfacecolor="white", linestyle="", label="says: not converged")
    for ax in (left, right):
        ax.invert_xaxis()
    finish(made, [left, right])
    return made
