"""What is wrong with a file, and the limits of what is read."""

from __future__ import annotations

from connectors.base import ConfigError

MOST_BYTES = 1 << 28
"""Bytes of text that are read of one file, unpacked: cells take ten times as much memory as text."""
MOST_ROWS = 10_000_000
"""Rows of one file: four months at 1 s."""
MOST_CELLS = 100_000_000
"""Cells of one file: 800 MB as numbers."""
MOST_TEXT_CELLS = 20_000_000
"""Cells of one file of text: as text each takes about 70 bytes, 1.4 GB."""
LONGEST_CELL = 10_000
"""Characters of one cell of a Parquet file, which stores a text once and may repeat it without end."""
MOST_COLUMNS = 20_000
"""Columns of one file: 5000 loops with four tags each."""


class RecordingError(ConfigError):
    """A recording that cannot be read: one line with file, line and what was expected."""

    def __init__(self, fault: str) -> None:
        super().__init__([fault])


def shown(cell: str) -> str:
    """Return a cell short and on one line, for a message."""
    return repr(cell if len(cell) <= 40 else cell[:40] + "...")
