"""A file as a source: CSV, Parquet or a spreadsheet, of one loop or of many."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from connectors.exports.fault import RecordingError
from connectors.exports.reading import read_export
from connectors.sources.source import Closing, Held

if TYPE_CHECKING:
    from connectors.exports.recorded import Export, ReadOptions, RecordedLoop


class ExportFile(Closing):
    """A file, read once: it stays in a temporary file, or in memory where it is small, until it is closed."""

    def __init__(self, name: str, options: ReadOptions) -> None:
        """Make it; nothing is read yet."""
        self._path = Path(name)
        self._options = options
        self._read: Export | None = None

    def loops(self) -> Held:
        """Return the names of its loops."""
        export = self._export()
        problems = tuple(f"{self._path}: {each}" for each in export.problems)
        return Held(export.loops.names, problems)

    def read(self, loop: str) -> RecordedLoop:
        """Return one loop, with what was left out of the file."""
        export = self._export()
        names = export.loops.names
        if loop not in names:
            raise RecordingError(f"{self._path}: has no loop {loop!r}, it holds: {', '.join(names[:10])}")
        return replace(export.loops[names.index(loop)], problems=export.problems)

    def version(self) -> str:
        """Return size and time of the last change."""
        try:
            found = self._path.stat()
        except OSError as error:
            raise RecordingError(f"{self._path}: cannot be read: {error.strerror}") from error
        return f"{found.st_size} {found.st_mtime_ns}"

    def close(self) -> None:
        """Release the memory of its cells."""
        self._read = None

    def _export(self) -> Export:
        if self._read is None:
            self._read = read_export(self._path, self._options)
        return self._read
