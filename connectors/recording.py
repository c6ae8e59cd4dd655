"""Recordings of control loops: OP, PV and what else there is, from files and addresses."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from connectors.base import ConfigError
from connectors.exports.fault import RecordingError
from connectors.exports.reading import names_of_loops, read_export
from connectors.exports.recorded import STANDARD, Columns, Export, ReadOptions, RecordedLoop
from connectors.sources.kinds import address_in, opened
from connectors.sources.last_source import LastSource

if TYPE_CHECKING:
    from pathlib import Path

__all__ = [
    "STANDARD",
    "Columns",
    "Export",
    "LastSource",
    "ReadOptions",
    "RecordedLoop",
    "RecordingError",
    "loops_in",
    "read_export",
    "read_recording",
]


def read_recording(
    path: Path,
    columns: Columns = STANDARD,
    options: ReadOptions | None = None,
    loop: str | None = None,
    last: LastSource | None = None,
) -> RecordedLoop:
    """Read one loop of a file.

    Empty cells, words of a historian and infinite values are gaps, NaN. SP, MV and mode may be absent,
    unless their column was named otherwise than by the standard.

    Args:
        path: The file, or an address of ``connectors.sources``.
        columns: Names of its columns.
        options: What else is known of the file; None: recognised.
        loop: Which loop; None: the file has one.
        last: Keeps the file as it was read, for its next loop; None: nothing is kept.

    Raises:
        RecordingError: one line that names the file, the line and what was expected.
    """
    known, address = options or ReadOptions(), address_in(path)
    if address is None:
        ts = columns.ts if columns.ts is not None else known.columns.ts
        known = replace(known, columns=replace(columns, ts=ts))
    held = LastSource() if last is None else last
    try:
        source = held.get(address or str(path), known)
        return source.read(loop or _only(path, source.loops().loops))
    except ConfigError:
        held.close()  # what failed is opened again
        raise
    finally:
        if last is None:
            held.close()


def _only(path: Path, names: tuple[str, ...]) -> str:
    if len(names) != 1:
        shown = ", ".join(names[:10])
        raise RecordingError(f"{path}: holds {len(names)} loops ({shown}), expected one: name it by --loop")
    return names[0]


def loops_in(path: Path, options: ReadOptions) -> tuple[str, ...]:
    """Return the names of the loops of a file; raises RecordingError where they are not known."""
    address = address_in(path)
    if address is not None:
        with opened(address, options) as source:
            return source.loops().loops
    return names_of_loops(path, options)
