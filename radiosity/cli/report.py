"""What a solve has to tell, as tables."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rich.console import Console
    from rich.table import Table

    import radiosity as rad

FIRST_BOUNCES = 10
CHANNEL_NAMES = {1: ("power, W",), 3: ("red, W", "green, W", "blue, W")}


def print_report(solution: rad.Solution, console: Console) -> None:
    """Patches, form factors, defects, seconds, power of each bounce, whether it converged, how wrong it can be."""
    console.print(_facts(solution))
    if solution.power is not None:
        console.print(_bounces(solution.power))
    if solution.accuracy is not None:
        console.print(_trials(solution.accuracy))
    certificate = solution.certificate
    for line, good in ((solution.status, solution.converged), (_verdict(certificate), not certificate.reasons)):
        console.print(line, style="green" if good else "yellow", markup=False, highlight=False, soft_wrap=True)


def _trials(accuracy: rad.Accuracy) -> Table:
    """Error against time, and of what it is made."""
    from rich import box
    from rich.table import Table

    title = f"error against time, {100 * accuracy.target:g}% asked for"
    table = Table(title=title, title_justify="left", box=box.SIMPLE_HEAD)
    for name in ("seconds", "patches", "rays", "sampling", "discretisation", "truncation", "error"):
        table.add_column(name, justify="right")
    for t in accuracy.trials:
        errors = [f"{error:.2%}" for error in (t.sampling, t.discretisation, t.truncation, t.total)]
        table.add_row(f"{t.seconds:.2f}", f"{t.patches:,}", f"{t.rays:,}", *errors)
    return table


def _verdict(certificate: Any) -> str:
    """The certificate's verdict, and what to do for a better one."""
    first = str(certificate).partition("\n")[0]
    return "\n".join([first, *(f"  {reason}" for reason in certificate.reasons)])


def _facts(solution: rad.Solution) -> Table:
    from rich import box
    from rich.table import Table

    table = Table(title=solution.scene.name, title_justify="left", box=box.SIMPLE_HEAD, show_header=False)
    table.add_column(style="bold", no_wrap=True)
    table.add_column()
    for name, value in _rows(solution):
        table.add_row(name, value)
    return table


def _rows(solution: rad.Solution) -> list[tuple[str, str]]:
    from ..dark import dark_patches
    from ..solution import seconds

    patches, factors, certificate = solution.patches, solution.lit_factors, solution.certificate
    entries = factors.non_zeros
    kind = "closed" if patches.closed else "open"
    expected = certificate.reciprocity_expected
    beside = "" if expected is None else f" ({expected:.2g} expected of raw factors)"
    rows = [
        ("patches", f"{len(patches):,} on {len(patches.surface_names)} surfaces, {kind}"),
        ("form factors", f"{factors.estimator}"),
        ("non-zeros", f"{entries:,} ({entries / len(patches) ** 2:.2%}), {_bytes(factors)}"),
        ("closure defect", f"{certificate.closure:.2g} at most in a row"),
        ("reciprocity defect", f"{certificate.reciprocity:.2g} of all exchange{beside}"),
        ("power", _power(solution)),
        ("energy defect", _defect(certificate)),
    ]
    if leaked := certificate.leaked_rays:
        rows.append(("leaks", f"{leaked:,} rays of {solution.statistics['rays/traced']:,} left a closed scene"))
    if story := dark_patches(patches, factors).story:
        rows.append(("dark", story))
    if left_out := solution.statistics.get("plan/left out"):
        rows.append(("left out", left_out.removeprefix("left out: ")))
    stages = seconds(solution.statistics)
    parts = ", ".join(f"{stage} {s:.2f}" for stage, s in stages.items())
    rows.append(("seconds", f"{parts}; together {sum(stages.values()):.2f}"))
    return rows


def _power(solution: rad.Solution) -> str:
    """Power put in, and where it ends."""
    balance = solution.balance
    put_in = float(balance.put_in.sum())
    ends = {"absorbed": balance.absorbed, "escaped": balance.to_sky, "on black backs": balance.to_backs}
    parts = [
        f"{float(part.sum()):.4g} W {name} ({float(part.sum()) / put_in:.1%})"
        for name, part in ends.items()
        if part.any()
    ]
    return ", ".join([f"{put_in:.4g} W put in", *parts])


def _defect(certificate: Any) -> str:
    spread = "" if certificate.energy_error is None else f" ± {certificate.energy_error:.2%}, its standard error"
    return f"{certificate.energy_defect:+.2%}{spread}"


def _bytes(factors: Any) -> str:
    return f"{factors.nbytes / 1e6:.1f} MB"


def _bounces(power: Any) -> Table:
    """Power of the first bounces and of the last, by channel, and the share that is left."""
    from rich import box
    from rich.table import Table

    channels = power.shape[1]
    if channels not in CHANNEL_NAMES:
        power, channels = power.sum(axis=1, keepdims=True), 1
    table = Table(title="power by bounce", title_justify="left", box=box.SIMPLE_HEAD)
    table.add_column("bounce", justify="right")
    for name in (*CHANNEL_NAMES[channels], "of the first"):
        table.add_column(name, justify="right")
    total = power.sum(axis=1)
    first = next((watts for watts in total if watts > 0), 1.0)  # of a scene lit by the sky: order 1
    shown = range(len(power)) if len(power) <= FIRST_BOUNCES + 2 else [*range(FIRST_BOUNCES), -1]
    for k in shown:
        if k == -1:
            table.add_row(*["…"] * (channels + 2))
        watts = [f"{watts:.4g}" for watts in power[k]]
        table.add_row(str(k % len(power)), *watts, f"{100 * total[k] / first:.3g} %")
    return table
