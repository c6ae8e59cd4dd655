"""A file as rows of cells, whatever format it came in."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from pathlib import Path

FloatArray = NDArray[np.float64]
Cells = Sequence[str] | FloatArray
"""One column: text as it stands in the file, or numbers where the file itself has types."""


@dataclass(frozen=True, slots=True)
class Column:
    """One column of a table."""

    name: str
    """As the header has it, outer blanks removed; empty where the header has none."""
    held: Cells | Callable[[], Cells]
    """``cells``, or what reads them where they are needed."""
    unit: str = ""
    """From a row of units below the names; empty where there is none."""
    moments: bool = False
    """Whether ``cells`` are times by the file's own type, s UTC (or local time where ``local``)."""
    local: bool = False
    """Whether the file's own time type has no zone."""

    @property
    def cells(self) -> Cells:
        """The cells, shape (n,)."""
        return self.held() if callable(self.held) else self.held


@dataclass(frozen=True, slots=True)
class Sheet:
    """Columns of one file, all of the same length."""

    path: Path
    columns: tuple[Column, ...]
    lines: Sequence[int]
    """Line of the file (row of a Parquet file or a spreadsheet) that each row came from, counted from 1."""
    place: str
    """What ``lines`` counts: ``line`` or ``row``."""
    header: int
    """Line that holds the names of the columns."""
    kind: str
    """``csv``, ``xlsx``, ``parquet`` or ``matlab``."""
    bad_lines: tuple[int, ...] = ()
    """Lines that are no rows of this table; each is a gap."""

    def where(self, row: int) -> str:
        """Return file and line of a row, to open a message with."""
        return f"{self.path}, {self.place} {self.lines[row]}"

    def text(self, column: Column, rows: NDArray[np.intp] | None = None) -> Sequence[str]:
        """Return the cells of a column as text: those of some rows, shape (m,), or all, shape (n,)."""
        cells = column.cells
        if isinstance(cells, np.ndarray):
            numbers = cells if rows is None else cells[rows]
            return ["" if value != value else f"{value:g}" for value in numbers.tolist()]  # noqa: PLR0124 - NaN
        return cells if rows is None else [cells[row] for row in rows.tolist()]
