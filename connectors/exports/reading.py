"""One reader for every export: unpack, decode, find header, layout, times and numbers, then the loops."""

from __future__ import annotations

import io
from contextlib import ExitStack
from typing import IO, TYPE_CHECKING

from connectors.exports.cells.tagging import suited, tagger_of
from connectors.exports.fault import RecordingError
from connectors.exports.layout import short_names, time_columns, wide_layout
from connectors.exports.long_table import long_layout
from connectors.exports.loops_of_columns import loops_of_columns
from connectors.exports.loops_of_rows import loops_of_rows
from connectors.exports.plain_table import plain_layout
from connectors.exports.recorded import Export, ReadOptions
from connectors.exports.tables.decoded import decoded
from connectors.exports.tables.delimited import rows_of
from connectors.exports.tables.header import sheet_of
from connectors.exports.tables.joined_times import with_joined_times
from connectors.exports.tables.matlab import is_matlab, sheets_of_matlab
from connectors.exports.tables.parquet import is_parquet, sheet_of_parquet
from connectors.exports.tables.unpacked import GZIP, ZIP, is_workbook, unpacked
from connectors.exports.tables.workbook import rows_of_workbook
from connectors.exports.together import together

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from connectors.exports.tables.sheet import Sheet

STANDARD_OPTIONS = ReadOptions()
HEAD = 1 << 15
"""Bytes of a text file in which its names are looked for before all of it is read."""


def read_export(path: Path, options: ReadOptions = STANDARD_OPTIONS) -> Export:
    """Read every loop of a file.

    Raises:
        RecordingError: One line that names the file, the line and what was expected, and where two readings
            are possible the option that settles it.
    """
    return _export(path, unpacked(path), options)


def names_of_loops(path: Path, options: ReadOptions = STANDARD_OPTIONS) -> tuple[str, ...]:
    """Return the names of the loops of a file.

    A plain table has one, whatever its values are; they are not read, and of long text only its head.

    Raises:
        RecordingError: As ``read_export``, for any other table.
    """
    head = _head(path)
    tables = () if head is not None else unpacked(path)
    if len(tables) > 1:
        return _export(path, tables, options).loops.names
    sheets = (head,) if head is not None else _sheets(*tables[0])
    sheet = with_joined_times(sheets[0])
    plain = plain_layout(sheet, time_columns(sheet), options) if len(sheets) == 1 else None
    if plain is None:
        return read_export(path, options).loops.names
    return tuple(short_names(list(plain.loops)).values())


def _head(path: Path) -> Sheet | None:
    """Return the first rows of long text; None where a file is short, packed, or has no table there."""
    if not path.is_file():
        return None
    with path.open("rb") as file:
        start = file.read(HEAD + 1)
    if len(start) <= HEAD or b"\0" in start or start.startswith((GZIP, ZIP)):
        return None
    content = start[: start.rfind(b"\n") + 1]
    try:
        return sheet_of(path, rows_of(path, decoded(path, io.BytesIO(content))), "line", "csv")
    except RecordingError:
        return None


def _export(path: Path, tables: Sequence[tuple[Path, IO[bytes]]], options: ReadOptions) -> Export:
    exports: list[Export] = []
    faults: list[str] = []
    for place, file in tables:
        try:
            sheets = _sheets(place, file)
        except RecordingError as error:
            faults += error.faults
            continue
        if len(tables) == len(sheets) == 1:
            return _of_sheet(sheets[0], options)
        for sheet in sheets:
            try:
                exports.append(_of_sheet(sheet, options))
            except RecordingError as error:
                faults += error.faults
    if not exports:
        raise RecordingError(faults[0])
    return together(path, exports, faults)


def _of_sheet(sheet: Sheet, options: ReadOptions) -> Export:
    path, sheet = sheet.path, with_joined_times(sheet)
    times = time_columns(sheet)
    plain = plain_layout(sheet, times, options)
    if plain is not None:
        return loops_of_columns(sheet, plain, options)
    tagger = tagger_of(path, options)
    long = long_layout(sheet, times, tagger)
    if long is not None:
        return loops_of_rows(sheet, long, options, tagger)
    tagger = suited(tagger, (column.name for column in sheet.columns))
    return loops_of_columns(sheet, wide_layout(sheet, times, tagger), options)


def sheets_of_file(path: Path) -> tuple[Sheet, ...]:
    """Return the tables of a file of any kind: one, or those of an archive; raises RecordingError."""
    return tuple(sheet for place, file in unpacked(path) for sheet in _sheets(place, file))


def _sheets(path: Path, file: IO[bytes]) -> tuple[Sheet, ...]:
    """Return the table of a file, or the tables of its structures."""
    with ExitStack() as open_files:
        open_files.enter_context(file)
        head = file.read(4)
        file.seek(0)
        if is_parquet(path, head):
            sheet = sheet_of_parquet(path, file)
            open_files.pop_all()  # its columns read from it
            return (sheet,)
        if is_matlab(head):
            return sheets_of_matlab(path, file)
        if is_workbook(path, file):
            return (sheet_of(path, rows_of_workbook(path, file), "row", "xlsx"),)
        return (sheet_of(path, rows_of(path, decoded(path, file)), "line", "csv"),)
