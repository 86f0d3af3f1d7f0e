"""Plots of a study. Colours can be told apart with any kind of colour vision, markers tell the same without colour."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import Any

from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from .fronts import pareto
from .ledger import Record
from .methods import FAMILIES
from .reference import Reference
from .summary import grouped

INK, FAINT, FRONT = "#222222", "#CCCCCC", "#222222"
MOST_PANELS = 3
CLOCKS = {"wall": "seconds", "processor": "processor seconds"}
PER_CENT = FuncFormatter(lambda value, _: f"{100 * value:g} %")
PLAIN = FuncFormatter(lambda value, _: f"{value:g}")
SOLVERS = {
    "Neumann": ("#0072B2", "o"),
    "GaussSeidel": ("#56B4E9", "s"),
    "Shooting": ("#E69F00", "^"),
    "ConjugateGradient": ("#D55E00", "D"),
    "Direct": ("#000000", "*"),
}


def figure(columns: int = 1, width: float = 5.0, height: float = 4.2) -> tuple[Figure, list[Axes]]:
    """A figure of panels side by side, on no screen."""
    made = Figure(figsize=(width * columns, height), layout="constrained")
    FigureCanvasAgg(made)
    axes = [made.add_subplot(1, columns, k + 1) for k in range(columns)]
    for ax in axes:
        ax.grid(color=FAINT, linewidth=0.5)
        ax.set_axisbelow(True)
        ax.spines[["top", "right"]].set_visible(False)
    return made, axes


def log_axes(ax: Axes, x: str, y: str, per_cent: bool = True) -> None:
    """Logarithmic axes with names and plain numbers."""
    ax.set_xscale("log")
    ax.set_yscale("log")
    ax.set_xlabel(x)
    ax.set_ylabel(y)
    for axis, formatter in ((ax.xaxis, PLAIN), (ax.yaxis, PER_CENT if per_cent else PLAIN)):
        low, high = axis.get_view_interval()
        few = low > 0 and high / low < 300
        axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0) if few else (1.0,)))
        axis.set_major_formatter(formatter)
        axis.set_minor_formatter(NullFormatter())


def error_against_time(
    rows: Sequence[Record], references: Sequence[Reference], names: Sequence[str], clock: str
) -> Figure:
    """Total error over seconds, a panel for each of the last subjects, with the Pareto front."""
    shown = list(zip(names, references, strict=True))[-MOST_PANELS:]
    made, axes = figure(len(shown))
    for ax, (name, truth) in zip(axes, shown, strict=True):
        here = [row for row in rows if row["subject"] == name and _positive(row, "seconds", "total_l2")]
        _series(ax, here, "seconds", "total_l2")
        _front(ax, here, "seconds", "total_l2")
        _level(ax, truth.discretisation, "of the patches' size", "--")
        _level(ax, max(truth.discrete_error, truth.continuous_error), "known to", ":")
        ax.set_title(name, fontsize=10)
        log_axes(ax, f"{clock}, form factors and solving", "total error of B - E, relative L2")
    finish(made, axes)
    return made


def error_against_memory(rows: Sequence[Record]) -> Figure | None:
    """Total error over peak memory, all subjects together; None where memory was not measured."""
    here = [row | {"megabytes": row["bytes_peak"] / 1e6} for row in rows if _positive(row, "bytes_peak", "total_l2")]
    if not here:
        return None
    made, (ax,) = figure(width=6.5)
    _series(ax, here, "megabytes", "total_l2", joined=False)
    _front(ax, here, "megabytes", "total_l2")
    log_axes(ax, "peak of resident memory above what was there, MB", "total error of B - E, relative L2")
    finish(made, [ax])
    return made


def error_by_order(rows: Sequence[Record], truth: Reference, name: str) -> Figure:
    """Error of each order, of the largest budget of each family."""
    made, (ax,) = figure(width=6.5)
    of_subject = [row for row in rows if row["subject"] == name]
    for (family,), members in grouped(of_subject, ("family",)).items():
        row = max(members, key=lambda row: row["work"])
        points = [(k, error) for k, error in enumerate(row["by_order"], 1) if error]
        if points:
            look = FAMILIES[family]
            label = f"{look.title}, {row['budget']}"
            ax.plot(*zip(*points, strict=True), color=look.colour, marker=look.marker, label=label, linewidth=1)
    own = [(k, error) for k, error in enumerate(truth.by_order, 1) if error]
    if own:
        ax.plot(*zip(*own, strict=True), color=INK, linestyle=":", linewidth=1, label="the reference's own")
    ax.set_yscale("log")
    ax.yaxis.set_major_formatter(PER_CENT)
    ax.set_xlabel("order k, bounces")
    ax.set_ylabel("error of order k, relative L2")
    ax.set_title(name, fontsize=10)
    finish(made, [ax])
    return made


def error_against_rays(rows: Sequence[Record], names: Sequence[str]) -> Figure:
    """Sampling error over rays a patch: how fast each method converges."""
    shown = names[-MOST_PANELS:]
    made, axes = figure(len(shown))
    for ax, name in zip(axes, shown, strict=True):
        here = [
            row
            for row in rows
            if row["subject"] == name and row["family"] != "analytic" and _positive(row, "work", "sampling_l2")
        ]
        _series(ax, here, "work", "sampling_l2")
        ax.set_title(name, fontsize=10)
        log_axes(ax, "rays (walks: paths) a patch", "sampling error of B - E, relative L2")
    finish(made, axes)
    return made


def bounces(rows: Sequence[Record]) -> Figure:
    """What a series cut after K bounces lacks, and its total error."""
    made, (ax,) = figure(width=6.5)
    looks = (
        ("truncation", False, "#0072B2", "o", "cut: left out"),
        ("truncation", True, "#56B4E9", "s", "geometric tail added: left out"),
    )
    for name, tail, colour, marker, label in (*looks, ("total", False, "#D55E00", "D", "cut: total error")):
        points = [(row["bounces"], row[name]) for row in rows if row["tail"] == tail and _positive(row, name)]
        if points:
            ax.plot(*zip(*points, strict=True), color=colour, marker=marker, label=label, linewidth=1)
    ax.set_yscale("log")
    ax.yaxis.set_major_formatter(PER_CENT)
    ax.set_xlabel("bounces K")
    ax.set_ylabel("error of B - E, relative L2")
    finish(made, [ax])
    return made


def solvers(rows: Sequence[Record], clock: str) -> Figure:
    """Algebraic error of the solvers over seconds and over products, all on the same form factors."""
    made, axes = figure(2)
    for ax, x, title in zip(
        axes, ("seconds", "products"), (clock, "products F x (shooting: N shots are one)"), strict=True
    ):
        for (solver,), members in grouped(rows, ("solver",)).items():
            colour, marker = SOLVERS[solver]
            points = [(row[x], row["algebra"]) for row in members if _positive(row, x, "algebra")]
            if points:
                ax.plot(*zip(*points, strict=True), color=colour, marker=marker, label=solver, linewidth=1)
            elif x == "seconds" and _positive(members[0], "seconds"):  # exact to rounding: no place on these axes
                ax.axvline(
                    members[0]["seconds"], color=colour, linewidth=1, linestyle="-.", label=f"{solver}, to rounding"
                )
        log_axes(ax, title, "error left by the solver, relative L2", per_cent=False)
    finish(made, axes)
    return made


def growth(rows: Sequence[Record], parameter: str, clock: str) -> Figure:
    """Error and seconds over the parameter of a family of scenes, the middle budget of each method."""
    made, axes = figure(2)
    for (family,), members in grouped(rows, ("family",)).items():
        works = sorted({row["work"] for row in members})
        middle = [row for row in members if row["work"] == works[len(works) // 2]] if family != "analytic" else members
        look = FAMILIES[family]
        for ax, y in zip(axes, ("sampling_l2", "seconds"), strict=True):
            points = sorted((row["value"], row[y]) for row in middle if _positive(row, y))
            if points:
                label = f"{look.title}, {middle[0]['budget']}"
                ax.plot(*zip(*points, strict=True), color=look.colour, marker=look.marker, label=label, linewidth=1)
    log_axes(axes[0], parameter, "sampling error of B - E, relative L2")
    log_axes(axes[1], parameter, f"{clock}, all in all", per_cent=False)
    finish(made, axes)
    return made


def _series(ax: Axes, rows: Iterable[Record], x: str, y: str, joined: bool = True) -> None:
    """A line a family through its budgets, with bars from the best run to the worst."""
    for (family,), members in grouped(rows, ("family",)).items():
        look = FAMILIES[family]
        members.sort(key=lambda row: row["work"])
        xs, ys = [row[x] for row in members], [row[y] for row in members]
        bars = [
            [max(row[y] - row[f"{y}_least"], 0.0) for row in members],
            [max(row[f"{y}_most"] - row[y], 0.0) for row in members],
        ]
        ax.errorbar(
            xs,
            ys,
            yerr=bars,
            xerr=_bars(members, x),
            color=look.colour,
            marker=look.marker,
            markersize=6 if family != "analytic" else 11,
            linestyle="-" if joined else "",
            linewidth=1,
            elinewidth=0.7,
            label=look.title,
        )


def _bars(rows: Sequence[Record], x: str) -> Any:
    if f"{x}_least" not in rows[0]:
        return None
    return [
        [max(row[x] - row[f"{x}_least"], 0.0) for row in rows],
        [max(row[f"{x}_most"] - row[x], 0.0) for row in rows],
    ]


def _front(ax: Axes, rows: Sequence[Record], x: str, y: str) -> None:
    """The Pareto front: a ring around each run that nothing beats, and steps between them."""
    front = pareto(rows, x, y)
    points = [(row[x], row[y]) for row in front]
    ax.step(*zip(*points, strict=True), where="post", color=FRONT, linewidth=2.5, alpha=0.25, zorder=1)
    ax.plot(
        *zip(*points, strict=True),
        linestyle="",
        marker="o",
        markersize=13,
        markerfacecolor="none",
        markeredgecolor=FRONT,
        markeredgewidth=1.2,
        label="Pareto front: nothing is both quicker and better"
        if x == "seconds"
        else "Pareto front: nothing is both smaller and better",
    )


def _level(ax: Axes, value: float, what: str, style: str) -> None:
    if value > 0:
        ax.axhline(value, color=INK, linewidth=0.8, linestyle=style)
        ax.annotate(what, (1.0, value), xycoords=("axes fraction", "data"), ha="right", va="bottom", fontsize=8)


def finish(made: Figure, axes: Sequence[Axes]) -> None:
    """One legend for all panels, below them."""
    entries = {label: handle for ax in axes for handle, label in _entries(ax)}
    made.legend(
        entries.values(),
        entries.keys(),
        loc="outside lower center",
        ncols=2 if len(axes) < 3 else 3,
        fontsize=8,
        frameon=False,
    )


def _entries(ax: Axes) -> Iterator[tuple[Any, str]]:
    yield from zip(*ax.get_legend_handles_labels(), strict=True)


def _positive(row: Record, *names: str) -> bool:
    return all(row[name] is not None and row[name] > 0 for name in names)
