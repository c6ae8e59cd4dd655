"""What is wrong with a file, and the limits of what is read."""

from __future__ import annotations

from connectors.base import ConfigError

MOST_BYTES = 1 << 31
"""Bytes of one file, unpacked, which a temporary file holds: a week of 100 loops at 1 s is 0.8 GB as text."""
MOST_ROWS = 10_000_000
"""Rows of one file: four months at 1 s."""
MOST_CELLS = 200_000_000
"""Cells of one file: a week of 100 loops with OP, PV and SP at 1 s."""
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
