"""Columns of text that are not held in memory: a table is cut into pieces of rows, a piece into columns.

A cell in a list takes some 70 bytes, here only its letters, and beyond ``spool.IN_MEMORY`` on disk.
"""

from __future__ import annotations

from array import array
from bisect import bisect_right
from collections.abc import Iterator, Sequence
from typing import overload

from connectors.exports.tables.spool import Spool

PIECE = 100_000
"""Cells that are gathered before they are stored."""
END = "\0"
"""Between two cells; no text has it (``decoded``)."""


class StoredTable:
    """Takes rows one by one and gives columns."""

    def __init__(self, width: int) -> None:
        """Make an empty table of so many columns."""
        self._width = width
        self._spool = Spool()
        self._rows: list[list[str]] = []
        self._firsts = array("q")
        self._places: list[array[int]] = []
        """Of each piece: where each column begins, and where the last one ends."""
        self.length = 0
        """Rows."""

    def append(self, cells: list[str]) -> None:
        """Take a row; cells beyond the width are left out."""
        self._rows.append(cells)
        self.length += 1
        if len(self._rows) * self._width >= PIECE:
            self._store()

    def columns(self) -> tuple[StoredCells, ...]:
        """Return the columns of all rows that were taken."""
        if self._rows:
            self._store()
        return tuple(StoredCells(self, k) for k in range(self._width))

    def piece_of(self, row: int) -> int:
        """Return the piece that has a row."""
        return bisect_right(self._firsts, row) - 1

    def first(self, piece: int) -> int:
        """Return the first row of a piece; the number of rows behind the last one."""
        return self._firsts[piece] if piece < len(self._firsts) else self.length

    def cells(self, piece: int, column: int) -> list[str]:
        """Return the cells of a column in one piece."""
        begin, end = self._places[piece][column : column + 2]
        return self._spool.get(begin, end - begin).decode("utf-8", "surrogatepass").split(END)

    def _store(self) -> None:
        self._firsts.append(self.length - len(self._rows))
        places = array("q")
        end = 0
        for k in range(self._width):
            text = END.join([row[k] for row in self._rows]).encode("utf-8", "surrogatepass")
            places.append(self._spool.put(text))
            end = places[-1] + len(text)
        places.append(end)
        self._places.append(places)
        self._rows = []


class StoredCells(Sequence[str]):
    """One column of a stored table, shape (n,)."""

    def __init__(self, table: StoredTable, column: int) -> None:
        """Make the view; nothing is read yet."""
        self._table, self._column = table, column
        self._piece, self._cells = -1, list[str]()

    def __len__(self) -> int:
        """Rows."""
        return self._table.length

    def __iter__(self) -> Iterator[str]:
        """Cells from the first to the last, a piece at a time."""
        return self._from(0)

    @overload
    def __getitem__(self, place: int) -> str: ...

    @overload
    def __getitem__(self, place: slice) -> list[str]: ...

    def __getitem__(self, place: int | slice) -> str | list[str]:
        """Return a cell, or several."""
        if isinstance(place, slice):
            rows = range(len(self))[place]
            if rows.step == 1:
                from_there = self._from(rows.start)
                return [cell for _, cell in zip(rows, from_there, strict=False)]
            return [self[row] for row in rows]
        row = range(len(self))[place]
        piece = self._table.piece_of(row)
        if piece != self._piece:
            self._piece, self._cells = piece, self._table.cells(piece, self._column)
        return self._cells[row - self._table.first(piece)]

    def _from(self, row: int) -> Iterator[str]:
        while row < len(self):
            piece = self._table.piece_of(row)
            yield from self._table.cells(piece, self._column)[row - self._table.first(piece) :]
            row = self._table.first(piece + 1)
