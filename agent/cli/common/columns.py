"""Plain columns for a terminal, a pipe and a log alike."""

from __future__ import annotations

import shutil
import sys
from collections.abc import Sequence


def aligned(rows: Sequence[Sequence[str]], gap: str = "  ") -> list[str]:
    """Return one line a row with the columns below each other; the last column may be of any length."""
    widths = [max(len(cell) for cell in column) for column in zip(*rows, strict=True)][:-1]
    return [
        gap.join([*(cell.ljust(width) for cell, width in zip(row, widths, strict=False)), row[-1]]).rstrip()
        for row in rows
    ]


def terminal_width() -> int | None:
    """Return the characters of a line where stdout is a terminal; None in a pipe, where no line is cut."""
    return shutil.get_terminal_size().columns if sys.stdout.isatty() else None
