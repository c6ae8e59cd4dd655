"""The first table of a spreadsheet (.xlsx, .xls, .ods) as rows of text."""

from __future__ import annotations

import io
import zipfile
from datetime import date, datetime, time, timedelta
from typing import IO, TYPE_CHECKING

from connectors.exports.fault import RecordingError

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

MOST_UNPACKED = 1 << 29
"""Bytes of a workbook, or of its members, unpacked."""
MOST_CELLS = 10_000_000
"""Cells of its largest sheet: the library has them all in memory."""


def rows_of_workbook(path: Path, file: IO[bytes]) -> Iterator[tuple[int, list[str]]]:
    """Yield row number and cells of the sheet with the most rows; dates become ISO 8601.

    Raises:
        RecordingError: It is no workbook, or unpacks to more than is read.
    """
    from python_calamine import CalamineError, CalamineWorkbook  # noqa: PLC0415 - only for spreadsheets

    _bounded(path, file)
    try:
        book = CalamineWorkbook.from_filelike(file)
        sheets = [book.get_sheet_by_name(name) for name in book.sheet_names]
    except (CalamineError, ValueError, OSError) as error:
        raise RecordingError(f"{path}: expected a spreadsheet: {error}") from error
    if not sheets:
        raise RecordingError(f"{path}: is empty, expected a sheet with column names and one row a sample")
    sheet = max(sheets, key=lambda each: each.total_height)
    if sheet.total_height * sheet.total_width > MOST_CELLS:
        raise RecordingError(f"{path}: has more than {MOST_CELLS} cells: export it as CSV")
    for number, cells in enumerate(sheet.to_python(skip_empty_area=False), start=1):
        row = [_text(cell) for cell in cells]
        while row and not row[-1]:
            row.pop()
        if row:
            yield number, row


def _bounded(path: Path, file: IO[bytes]) -> None:
    size = file.seek(0, io.SEEK_END)
    file.seek(0)
    if zipfile.is_zipfile(file):
        with zipfile.ZipFile(file) as archive:
            size = max(size, sum(each.file_size for each in archive.infolist()))
    file.seek(0)
    if size > MOST_UNPACKED:
        raise RecordingError(f"{path}: is larger than {MOST_UNPACKED >> 20} MiB unpacked: export it as CSV")


def _text(cell: object) -> str:
    if isinstance(cell, datetime):
        return cell.isoformat()
    if isinstance(cell, (date, time)):
        return cell.isoformat()
    if isinstance(cell, timedelta):
        return repr(cell.total_seconds())
    if isinstance(cell, float):
        return repr(cell) if cell != int(cell) or abs(cell) > 1e15 else str(int(cell))
    return str(cell).strip()
