"""Some rows of form factors, where the others are not needed."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from .assembly import RowBlock, RowMaker, joined

BoolArray = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class RowChoice:
    """Which rows are made.

    Attributes
    ----------
    made : ndarray of bool (N,)
    open : ndarray of bool (N,)
        Those of patches before which there is nothing: known without a ray to go to the sky with all they have.
    """

    made: BoolArray
    open: BoolArray

    @property
    def left_out(self) -> BoolArray | None:
        """Rows that are neither made nor known, (N,); None if there are no such."""
        missing = ~(self.made | self.open)
        return missing if missing.any() else None


class SomeRows:
    """A `RowMaker` that makes only some of another's rows.

    The light of rows that are left out goes to black backs, so that no row lacks anything, and light that never leaves
    those patches is right.

    Parameters
    ----------
    maker : RowMaker
    choice : RowChoice
    """

    def __init__(self, maker: RowMaker, choice: RowChoice) -> None:
        self.maker, self.choice = maker, choice
        self.rows_at_once, self.most, self.divisor = maker.rows_at_once, maker.most, maker.divisor
        self.exact_columns = maker.exact_columns

    def __call__(self, span: tuple[int, int]) -> RowBlock:
        """The rows begin … end, some of them empty."""
        begin, end = span
        made = self.choice.made
        borders = begin + 1 + np.flatnonzero(np.diff(made[begin:end]))
        ends = [begin, *borders.tolist(), end]
        parts = pairwise(ends)
        return joined([self.maker(part) if made[part[0]] else self._empty(part) for part in parts])

    def _empty(self, span: tuple[int, int]) -> RowBlock:
        begin, end = span
        lengths = np.zeros(end - begin, dtype=np.int64)
        to_sky = np.where(self.choice.open[begin:end], self.divisor, 0.0)
        return RowBlock(begin, lengths, np.empty(0, dtype=np.int32), np.empty(0), to_sky, self.divisor - to_sky)
