"""A file as a source: CSV, Parquet or a spreadsheet, of one loop or of many."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from connectors.exports.fault import RecordingError
from connectors.exports.reading import read_export
from connectors.sources.source import Closing, Held

if TYPE_CHECKING:
    from connectors.exports.recorded import Export, ReadOptions, RecordedLoop


class ExportFile(Closing):
    """A file, read once: it stays in memory until it is closed."""

    def __init__(self, name: str, options: ReadOptions) -> None:
        """Make it; nothing is read yet."""
        self._path = Path(name)
        self._options = options
        self._read: Export | None = None

    def loops(self) -> Held:
        """Return the names of its loops."""
        export = self._export()
        problems = tuple(f"{self._path}: {each}" for each in export.problems)
        return Held(tuple(each.name for each in export.loops), problems)

    def read(self, loop: str) -> RecordedLoop:
        """Return one loop."""
        export = self._export()
        found = next((each for each in export.loops if each.name == loop), None)
        if found is None:
            names = ", ".join(each.name for each in export.loops[:10])
            raise RecordingError(f"{self._path}: has no loop {loop!r}, it holds: {names}")
        return found

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
