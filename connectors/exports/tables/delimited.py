"""Lines of text to rows of cells: which character separates them."""

from __future__ import annotations

import csv
import re
from collections import Counter
from collections.abc import Iterator, Sequence
from itertools import chain, islice
from typing import TYPE_CHECKING

from connectors.exports.fault import MOST_CELLS, MOST_ROWS, RecordingError

if TYPE_CHECKING:
    from pathlib import Path

DELIMITERS = "\t;|,"
"""In the order in which they win: a comma may be a decimal comma, the others are nothing else."""
LOOKED_AT = 200
"""Lines from which the delimiter is found."""
MOST_OF = 0.6
"""Share of the lines that must have the usual number of cells; the others are header and notes."""
LARGEST_CELL = 1 << 20


def rows_of(path: Path, lines: Iterator[str]) -> Iterator[tuple[int, list[str]]]:
    """Yield line (of its end) and cells of each row that is not empty; outer blanks are removed.

    Raises:
        RecordingError: It is no CSV, or has more than ``MOST_ROWS`` or ``MOST_CELLS``.
    """
    csv.field_size_limit(LARGEST_CELL)
    cells = 0
    for rows, (line, row) in enumerate(_rows(path, lines), start=1):
        cells += len(row)
        if cells > MOST_CELLS or rows > MOST_ROWS:
            fault = f"{path}, line {line}: has more than {MOST_ROWS} rows or {MOST_CELLS} cells"
            raise RecordingError(f"{fault}: split it by time or by loop")
        yield line, row


def _rows(path: Path, lines: Iterator[str]) -> Iterator[tuple[int, list[str]]]:
    head = list(islice(lines, LOOKED_AT))
    blanks = blanks_of(head)
    if blanks is not None:
        for line, row in enumerate(chain(head, lines), start=1):
            if row.strip():
                yield line, blanks.split(row.strip())
        return
    reader = csv.reader(chain(head, lines), delimiter=delimiter_of(head), skipinitialspace=True)
    try:
        for cells in reader:
            stripped = [cell.strip() for cell in cells]
            if any(stripped):
                yield reader.line_num, stripped
    except csv.Error as error:
        raise RecordingError(f"{path}, line {reader.line_num}: expected CSV, {error}") from error


def blanks_of(head: Sequence[str]) -> re.Pattern[str] | None:
    """Return what separates the columns of a table of fixed width, or None where a delimiter does."""
    lines = [line.strip() for line in head if line.strip()]
    if any(_steady([_cells(line, mark) for line in lines]) for mark in DELIMITERS):
        return None
    for pattern in (re.compile(r"\s{2,}"), re.compile(r"\s+")):
        if _steady([len(pattern.split(line)) for line in lines]):
            return pattern
    return None


def _steady(widths: list[int]) -> bool:
    """Whether most lines have the same number of cells, at least two."""
    usual, share = Counter(widths).most_common(1)[0] if widths else (1, 0)
    return usual > 1 and share >= MOST_OF * len(widths)


def delimiter_of(head: Sequence[str]) -> str:
    """Return the delimiter that cuts most lines into the same number of cells."""
    lines = [line for line in head if line.strip()]
    for delimiter in DELIMITERS:
        if _steady([_cells(line, delimiter) for line in lines]):
            return delimiter
    return max(DELIMITERS, key=(lines or [""])[0].count)


def _cells(line: str, delimiter: str) -> int:
    """Return how many cells a line has; delimiters within quotes do not count."""
    outside = line.split('"')[::2]
    return 1 + sum(part.count(delimiter) for part in outside)
