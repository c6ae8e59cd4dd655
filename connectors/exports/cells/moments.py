"""A column of dates and times as numbers, and what its cells leave open, gathered in one pass."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Self

import numpy as np

if TYPE_CHECKING:
    from connectors.exports.cells.calendar_times import Moment
    from connectors.exports.cells.date_order import Numbers
    from connectors.exports.tables.sheet import FloatArray


@dataclass(frozen=True, slots=True)
class Moments:
    """The moments of a column's cells, of which no more is kept than decides how they are read."""

    utc: FloatArray
    """s, a time without a zone as UTC, shape (n,); NaN where a cell names no moment."""
    aware: bool
    """Whether each moment has its zone."""
    dates: tuple[Numbers, ...]
    """Dates whose order of day, month and year is open, each once, in the order of the column."""
    dotted: bool
    """Whether points stand between the numbers of one of them."""
    first: int
    """Row of the first moment; 0 where there is none."""

    @classmethod
    def of(cls, cells: Sequence[str], moment: Callable[[str], Moment | None]) -> Self:
        """Read each cell by ``moment``."""
        utc = np.full(len(cells), np.nan)
        dates: dict[Numbers, None] = {}
        aware, dotted, first = True, False, -1
        last = None
        for row, cell in enumerate(cells):
            if cell == last:  # rows of many tags have one time
                utc[row] = utc[row - 1]
                continue
            last, found = cell, moment(cell)
            if found is None:
                continue
            first = row if first < 0 else first
            utc[row] = found.utc
            aware = aware and found.offset is not None
            if found.numbers is not None:
                dates[found.numbers] = None
                dotted = dotted or found.dotted
        return cls(utc, aware, tuple(dates), dotted, max(first, 0))
