"""Names of surfaces: a scene needs them unique, files do not."""

from __future__ import annotations

from collections import Counter

from .notes import Notes


def unique_names(names: list[str], notes: Notes) -> list[str]:
    """The names, later ones of a kind with a number behind, which is noted.

    Examples
    --------
    >>> unique_names(["wall", "lamp", "wall"], Notes())
    ['wall', 'lamp', 'wall_2']
    """
    taken = set(names)
    met: Counter[str] = Counter()
    result = []
    for name in names:
        met[name] += 1
        if met[name] > 1:
            number = met[name]
            while f"{name}_{number}" in taken:
                number += 1
            name = f"{name}_{number}"
        taken.add(name)
        result.append(name)
    if repeated := [name for name, count in met.items() if count > 1]:
        shown = ", ".join(f"{name!r} × {met[name]}" for name in repeated[:4])
        more = f" and {len(repeated) - 4} more" if len(repeated) > 4 else ""
        notes.say(f"surfaces share names ({shown}{more}); numbers are put behind them")
    return result
