"""A date column and a column with the time of day become one column of times."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np

from connectors.exports.cells.tag_roles import is_time
from connectors.exports.tables.sheet import Column, Sheet
from connectors.exports.tables.stored_cells import StoredTable

CLOCK = re.compile(r"\d{1,2}:\d{2}(:\d{2}([.,]\d+)?)?(\s*[AaPp]\.?[Mm]\.?)?")
LOOKED_AT = 20


def with_joined_times(sheet: Sheet) -> Sheet:
    """Return the sheet with date and time of day in one column, where they stand in two."""
    named = [k for k, column in enumerate(sheet.columns) if is_time(column.name)]
    clocks = [k for k in named if _are(sheet.columns[k], clock=True)]
    dates = [k for k in named if k not in clocks and _are(sheet.columns[k], clock=False)]
    if len(clocks) != 1 or len(dates) != 1:
        return sheet
    day, clock = sheet.columns[dates[0]], sheet.columns[clocks[0]]
    both = StoredTable(1)
    for date, time in zip(sheet.text(day), sheet.text(clock), strict=True):
        both.append([f"{_day(date)} {time}"])
    columns = list(sheet.columns)
    columns[dates[0]] = Column("time", both.columns()[0])
    del columns[clocks[0]]
    return replace(sheet, columns=tuple(columns))


def _day(cell: str) -> str:
    """Return a date without the midnight that spreadsheets write behind it."""
    return re.sub(r"[T ]00:00:00$", "", cell)


def _are(column: Column, *, clock: bool) -> bool:
    if isinstance(column.cells, np.ndarray):
        return False
    cells = [cell for cell in column.cells[:LOOKED_AT] if cell]
    return bool(cells) and all((CLOCK.fullmatch(_day(cell)) is not None) == clock for cell in cells)
