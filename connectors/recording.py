"""Recordings of control loops: OP, PV and what else there is, from files and addresses."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from connectors.exports.fault import RecordingError
from connectors.exports.reading import names_of_loops, read_export
from connectors.exports.recorded import STANDARD, Columns, Export, ReadOptions, RecordedLoop
from connectors.sources.kinds import address_in, opened

if TYPE_CHECKING:
    from pathlib import Path

__all__ = [
    "STANDARD",
    "Columns",
    "Export",
    "ReadOptions",
    "RecordedLoop",
    "RecordingError",
    "loops_in",
    "read_export",
    "read_recording",
]


def read_recording(
    path: Path, columns: Columns = STANDARD, options: ReadOptions | None = None, loop: str | None = None
) -> RecordedLoop:
    """Read one loop of a file.

    Empty cells, words of a historian and infinite values are gaps, NaN. SP, MV and mode may be absent,
    unless their column was named otherwise than by the standard.

    Args:
        path: The file, or an address of ``connectors.sources``.
        columns: Names of its columns.
        options: What else is known of the file; None: recognised.
        loop: Which loop; None: the file has one.

    Raises:
        RecordingError: one line that names the file, the line and what was expected.
    """
    known = options or ReadOptions()
    address = address_in(path)
    if address is not None:
        with opened(address, known) as source:
            return source.read(loop or _only(path, source.loops().loops))
    ts = columns.ts if columns.ts is not None else known.columns.ts
    export = read_export(path, replace(known, columns=replace(columns, ts=ts)))
    names = export.loops.names
    found = [place for place, name in enumerate(names) if loop in {None, name}]
    if len(found) == 1:
        return replace(export.loops[found[0]], problems=export.problems)
    if not found:
        raise RecordingError(f"{path}: has no loop {loop!r}, it holds: {', '.join(names[:10])}")
    _only(path, names)
    raise RecordingError(f"{path}: has no loop")


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
