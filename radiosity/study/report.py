"""The report: one HTML file that holds everything, and needs nothing else."""

from __future__ import annotations

import html
from collections.abc import Mapping

from .outputs import Findings
from .tables import Sheet, sheets

CAPTIONS = {
    "growth": "Error and seconds over the parameter, the middle budget of each method.",
    "error_against_time": (
        "Total error over time. Bars reach from the best run to the worst; rings mark the Pareto front. Dashed: what "
        "patches of this size cost whatever the method; dotted: how well the truth is known."
    ),
    "error_against_memory": "Total error over memory, all numbers of patches together.",
    "error_by_order": "Error of each order of light, against the same patches' own.",
    "error_against_rays": "How the sampling error falls with work; shadow rays of direct light apart come on top.",
    "bounces": "What cutting the series after K bounces leaves out.",
    "solvers": "Error that solvers leave, on the same form factors.",
}
STYLE = """
body { font: 16px/1.5 system-ui, sans-serif; color: #222; background: #fff }
body { max-width: 72rem; margin: 2rem auto; padding: 0 1rem }
figure { margin: 2rem 0 } figure svg { max-width: 100%; height: auto }
figcaption, .note { color: #555; font-size: 0.9rem }
.wide { overflow-x: auto } table { border-collapse: collapse; font-size: 0.85rem; font-variant-numeric: tabular-nums }
th, td { padding: 0.2rem 0.6rem; text-align: left; border-bottom: 1px solid #ddd; white-space: nowrap }
th { border-bottom: 2px solid #222 }
"""


def report(found: Findings, plots: Mapping[str, str]) -> str:
    """Text of the report, with plots given as SVG by name."""
    title = f"Error against run time: {found.study.title}"
    pieces = [f"<h1>{html.escape(title)}</h1>", _origin(found)]
    if found.sentences:
        items = "".join(f"<li>{html.escape(sentence)}</li>" for sentence in found.sentences)
        pieces.append(f"<h2>Which method to take</h2><ul>{items}</ul>")
    for name, text in plots.items():
        svg = text[text.index("<svg") :]
        caption = html.escape(CAPTIONS[name])
        pieces.append(f'<figure role="img" aria-label="{caption}">{svg}<figcaption>{caption}</figcaption></figure>')
    pieces += map(_table, sheets(found))
    return (
        f'<!doctype html>\n<html lang="en"><head><meta charset="utf-8"><title>{html.escape(title)}</title>'
        f'<meta name="viewport" content="width=device-width"><style>{STYLE}</style></head>'
        f"<body><main>{''.join(pieces)}</main></body></html>\n"
    )


def _origin(found: Findings) -> str:
    """How and where it was made."""
    settings = found.study.settings
    origin = {name: value for name, value in found.study.origin.items() if name != "title"}
    words = ", ".join(f"{name} {value}" for name, value in origin.items())
    clock = {"wall": "that pass", "processor": "of all processors together"}[settings.clock]
    return (
        f'<p class="note">Seconds are those {clock}. '
        f"{settings.repeats} runs of everything, in shuffled order, seeds {settings.seed} … "
        f"{settings.seed + settings.repeats - 1}. {html.escape(words)}.</p>"
    )


def _table(sheet: Sheet) -> str:
    heads = "".join(f'<th scope="col">{html.escape(head)}</th>' for head in sheet.heads)
    rows = "".join("<tr>" + "".join(f"<td>{html.escape(cell)}</td>" for cell in row) + "</tr>" for row in sheet.rows)
    note = f'<p class="note">{html.escape(sheet.note)}</p>' if sheet.note else ""
    return (
        f"<h2>{html.escape(sheet.title.capitalize())}</h2>{note}"
        f'<div class="wide"><table><thead><tr>{heads}</tr></thead><tbody>{rows}</tbody></table></div>'
    )
