"""A file, unpacked within a bound: plain, gzip or the tables of a zip archive."""

from __future__ import annotations

import gzip
import stat
import zipfile
import zlib
from contextlib import ExitStack
from typing import IO, TYPE_CHECKING

from connectors.exports.fault import MOST_BYTES, RecordingError
from connectors.exports.tables.spool import Spool

if TYPE_CHECKING:
    from pathlib import Path

GZIP, ZIP = b"\x1f\x8b", b"PK\x03\x04"
OLD_WORKBOOK = b"\xd0\xcf\x11\xe0"
WORKBOOK_SUFFIXES = {".xlsx", ".xlsm", ".xls", ".xlsb", ".ods"}
TABLES = (".csv", ".txt", ".tsv", ".dat")
WORKBOOK = "xl/workbook.xml"
"""Member of a zip archive that is a spreadsheet."""
PIECE = 1 << 20
"""Bytes that are unpacked at a time."""


def unpacked(path: Path) -> tuple[tuple[Path, IO[bytes]], ...]:
    """Return the tables of a file, each with its path, to read from its start: one, or those of an archive.

    The path of one among several goes on within the archive: ``export.zip/area1/FIC101.csv``. What was packed
    is in a temporary file, in memory only while it is small. Whoever has the files closes them.

    Raises:
        RecordingError: It cannot be read, is no regular file, is packed wrongly, or is larger than
            ``MOST_BYTES``.
    """
    try:
        about = path.stat()
        if not stat.S_ISREG(about.st_mode):
            kind = "a directory" if path.is_dir() else "no regular file"
            raise RecordingError(f"{path}: cannot be read: it is {kind}")
        if about.st_size > MOST_BYTES:
            raise _too_large(path)
        with ExitStack() as open_files:
            file = open_files.enter_context(path.open("rb"))
            head = file.read(4)
            file.seek(0)
            if head.startswith(GZIP):
                return ((path, _bounded(path, open_files.enter_context(gzip.open(file)))),)
            if head == ZIP and not _is_workbook(file):
                return _members(path, file)
            open_files.pop_all()
            return ((path, file),)
    except (OSError, EOFError, zlib.error, zipfile.BadZipFile) as error:
        raise RecordingError(f"{path}: cannot be read: {_words(error)}") from error


def is_workbook(path: Path, file: IO[bytes]) -> bool:
    """Return whether a file is a spreadsheet, by its content or its name."""
    head = file.read(4)
    file.seek(0)
    if head == ZIP:
        return _is_workbook(file)
    return head.startswith(OLD_WORKBOOK) or path.suffix.lower() in WORKBOOK_SUFFIXES


def _is_workbook(file: IO[bytes]) -> bool:
    with zipfile.ZipFile(file) as archive:
        names = set(archive.namelist())
    file.seek(0)
    return WORKBOOK in names or "content.xml" in names


def _bounded(path: Path, content: IO[bytes] | gzip.GzipFile, there: int = 0) -> IO[bytes]:
    """Return the content as a temporary file; ``there`` bytes of the same file are held already."""
    spool = Spool()
    while piece := content.read(PIECE):
        there += len(piece)
        if there > MOST_BYTES:
            raise _too_large(path)
        spool.put(piece)
    return spool.reader()


def _too_large(path: Path) -> RecordingError:
    return RecordingError(
        f"{path}: is larger than {MOST_BYTES >> 20} MiB unpacked: split it by time or by loop"
    )


def _members(path: Path, file: IO[bytes]) -> tuple[tuple[Path, IO[bytes]], ...]:
    with zipfile.ZipFile(file) as archive, ExitStack() as found_files:
        tables = sorted(
            name
            for name in archive.namelist()
            if name.lower().endswith(TABLES) and not name.startswith("__MACOSX")
        )
        if not tables:
            raise RecordingError(f"{path}: expected a table ({', '.join(TABLES)}) in the archive, found none")
        found: list[tuple[Path, IO[bytes]]] = []
        there = 0
        for name in tables:
            if archive.getinfo(name).flag_bits & 1:
                raise RecordingError(f"{path}: the archive is encrypted: unpack it")
            with archive.open(name) as content:
                table = found_files.enter_context(_bounded(path, content, there))
            there += archive.getinfo(name).file_size
            found.append((path / name if len(tables) > 1 else path, table))
        found_files.pop_all()
        return tuple(found)


def _words(error: Exception) -> str:
    return getattr(error, "strerror", None) or str(error) or type(error).__name__
