"""Gathering against shooting, one row of F at a time against one column: the solvers' own iterations, as frames.

A frame is a number of rows gathered, and of as many columns shot. Gathering is `GaussSeidel`: it works in place, so
that after n rows of a sweep the first n patches have the light of that sweep and the others that of the sweep before.
Shooting is `Shooting`, which goes on from frame to frame from the light it had.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..solvers import GaussSeidel, Shooting
from ..transport import TransportOperator
from .state import FRAMES

if TYPE_CHECKING:
    from ..result import Step
    from ..solution import Solution

FloatArray = NDArray[np.float64]

SWEEPS = 3  # of gathering, where the race ends


def work(patches: int, frames: int = FRAMES) -> list[int]:
    """Rows, and columns, used after each frame: one by one at first, ever more at once, `SWEEPS` × N at the end.

    >>> work(100, 14)
    [0, 1, 2, 3, 4, 6, 10, 17, 27, 44, 72, 110, 180, 300]
    """
    end = SWEEPS * patches
    growing = np.geomspace(1.0, end, max(2, frames - 1))
    found = [0]
    for rows in growing:
        two_digits = 10 ** max(0, int(np.log10(rows)) - 1)
        nice = int(rows) if rows < 10 else int(rows / two_digits) * two_digits
        found.append(min(max(nice, found[-1] + 1), end))
    return sorted({*found, end})


@dataclass(frozen=True, eq=False)
class Frame:
    """Both solvers after the same work.

    Attributes
    ----------
    rows : int
        Rows gathered, and columns shot.
    gathered, shot : ndarray (N, C)
        Light so far, W/m²; that of shooting holds the unshot light, too.
    unshot : ndarray (N, C)
        Light that waits to be shot, W/m².
    row, column : int
        Patch that gathers next, and patch that shoots next: the one with most unshot power.
    missing_gathered, missing_shot : float
        Share of the power of all reflected light that is still missing, whatever its sign.
    unshot_power : float
        All channels, W.
    """

    rows: int
    gathered: FloatArray
    shot: FloatArray
    unshot: FloatArray
    row: int
    column: int
    missing_gathered: float
    missing_shot: float
    unshot_power: float


@dataclass(eq=False)
class Race:
    """Frames of both solvers on one solution, each computed when it is first asked for.

    Parameters
    ----------
    solution : Solution
        For its patches and factors, and its radiosity as the goal.
    """

    solution: Solution
    frames: list[Frame] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.T = TransportOperator(self.solution.factors, self.solution.patches)
        self.work = work(len(self.solution.patches))
        self._coming = self._run()

    def __getitem__(self, number: int) -> Frame:
        """A frame; those before it are computed on the way."""
        number = min(number, len(self.work) - 1)
        while len(self.frames) <= number:
            self.frames.append(next(self._coming))
        return self.frames[number]

    def _run(self) -> Iterator[Frame]:
        patches = self.solution.patches
        sweeps = GaussSeidel(rtol=0.0, maxiter=SWEEPS + 1).iterate(self.T, patches.emission, patches.sky)
        before, after = next(sweeps).radiosity, next(sweeps).radiosity
        swept = 0
        step = self._shoot(None, 0)
        for index, rows in enumerate(self.work):
            while rows // len(patches) > swept:
                before, swept = after, swept + 1
                after = next(sweeps, None).radiosity if swept < SWEEPS else after  # type: ignore[union-attr]
            here = rows - swept * len(patches)
            gathered = np.concatenate([after[:here], before[here:]])
            if index:
                step = self._shoot(step, rows - self.work[index - 1])
            yield self._frame(rows, gathered, step)

    def _shoot(self, before: Step | None, shots: int) -> Step:
        """The solver's step after some shots more.

        The residual of what has been shot is what has not been: so the solver finds its unshot light again.
        """
        patches = self.solution.patches
        solver = Shooting(rtol=0.0, shots=shots or None, maxiter=1 if shots else 0)
        light = None if before is None or before.unshot is None else before.radiosity - before.unshot
        return list(solver.iterate(self.T, patches.emission, patches.sky, x0=light))[-1]

    def _frame(self, rows: int, gathered: FloatArray, step: Step) -> Frame:
        unshot = step.unshot if step.unshot is not None else np.zeros_like(gathered)
        area = self.solution.patches.area
        goal = self.solution.radiosity
        reflected = float(self.T.power(goal - self.solution.emission).sum()) or 1.0
        missing = [float(self.T.power(np.abs(goal - light)).sum()) / reflected for light in (gathered, step.radiosity)]
        return Frame(
            rows=rows,
            gathered=gathered,
            shot=step.radiosity,
            unshot=unshot,
            row=rows % len(area),
            column=int(np.argmax(area * np.abs(unshot).sum(axis=1))),
            missing_gathered=missing[0],
            missing_shot=missing[1],
            unshot_power=float(self.T.power(unshot).sum()),
        )
