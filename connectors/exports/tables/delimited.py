"""Text to rows of cells: which character separates them."""

from __future__ import annotations

import csv
import io
from collections import Counter
from collections.abc import Iterator
from typing import TYPE_CHECKING

from connectors.exports.fault import RecordingError

if TYPE_CHECKING:
    from pathlib import Path

DELIMITERS = "\t;|,"
"""In the order in which they win: a comma may be a decimal comma, the others are nothing else."""
LOOKED_AT = 200
"""Lines from which the delimiter is found."""
MOST_OF = 0.6
"""Share of the lines that must have the usual number of cells; the others are header and notes."""
LARGEST_CELL = 1 << 20


def rows_of(path: Path, text: str) -> Iterator[tuple[int, list[str]]]:
    """Yield line (of its end) and cells of each row that is not empty; outer blanks are removed.

    Raises:
        RecordingError: It is no CSV.
    """
    csv.field_size_limit(LARGEST_CELL)
    reader = csv.reader(io.StringIO(text, newline=""), delimiter=delimiter_of(text), skipinitialspace=True)
    try:
        for cells in reader:
            stripped = [cell.strip() for cell in cells]
            if any(stripped):
                yield reader.line_num, stripped
    except csv.Error as error:
        raise RecordingError(f"{path}, line {reader.line_num}: expected CSV, {error}") from error


def delimiter_of(text: str) -> str:
    """Return the delimiter that cuts most lines into the same number of cells."""
    lines = [line for line in io.StringIO(text).readlines(LOOKED_AT * 1000)[:LOOKED_AT] if line.strip()]
    for delimiter in DELIMITERS:
        counts = Counter(_cells(line, delimiter) for line in lines)
        width, share = counts.most_common(1)[0] if counts else (1, 0)
        if width > 1 and share >= MOST_OF * len(lines):
            return delimiter
    return max(DELIMITERS, key=(lines or [""])[0].count)


def _cells(line: str, delimiter: str) -> int:
    """Return how many cells a line has; delimiters within quotes do not count."""
    outside = line.split('"')[::2]
    return 1 + sum(part.count(delimiter) for part in outside)
