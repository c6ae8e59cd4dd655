"""Recordings of control loops: OP, PV and what else there is, from files of one loop or of many."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from connectors.exports.fault import RecordingError
from connectors.exports.reading import read_export
from connectors.exports.recorded import STANDARD, Columns, Export, ReadOptions, RecordedLoop

if TYPE_CHECKING:
    from pathlib import Path

__all__ = [
    "STANDARD",
    "Columns",
    "Export",
    "ReadOptions",
    "RecordedLoop",
    "RecordingError",
    "read_export",
    "read_recording",
]


def read_recording(
    path: Path, columns: Columns = STANDARD, options: ReadOptions | None = None
) -> RecordedLoop:
    """Read a file of one loop.

    Empty cells, words of a historian and infinite values are gaps, NaN. SP, MV and mode may be absent,
    unless their column was named otherwise than by the standard.

    Args:
        path: The file.
        columns: Names of its columns.
        options: What else is known of the file; None: recognised.

    Raises:
        RecordingError: one line that names the file, the line and what was expected.
    """
    export = read_export(path, replace(options or ReadOptions(), columns=columns))
    if len(export.loops) > 1:
        names = ", ".join(loop.name for loop in export.loops[:10])
        raise RecordingError(
            f"{path}: holds {len(export.loops)} loops ({names}), expected one: name it by --loop"
        )
    return export.loops[0]
