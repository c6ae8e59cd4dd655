"""The bytes of a file, unpacked within a bound: plain, gzip or the tables of a zip archive."""

from __future__ import annotations

import gzip
import io
import stat
import zipfile
import zlib
from typing import IO, TYPE_CHECKING

from connectors.exports.fault import MOST_BYTES, RecordingError

if TYPE_CHECKING:
    from pathlib import Path

GZIP, ZIP = b"\x1f\x8b", b"PK\x03\x04"
OLD_WORKBOOK = b"\xd0\xcf\x11\xe0"
WORKBOOK_SUFFIXES = {".xlsx", ".xlsm", ".xls", ".xlsb", ".ods"}
TABLES = (".csv", ".txt", ".tsv", ".dat")
WORKBOOK = "xl/workbook.xml"
"""Member of a zip archive that is a spreadsheet."""


def unpacked(path: Path) -> tuple[tuple[Path, bytes], ...]:
    """Return the tables of a file, each with its path: one, or those of a zip archive of several.

    The path of one among several goes on within the archive: ``export.zip/area1/FIC101.csv``.

    Raises:
        RecordingError: It cannot be read, is no regular file, is packed wrongly, or is larger than
            ``MOST_BYTES``; never more than that is held.
    """
    try:
        if not stat.S_ISREG(path.stat().st_mode):
            kind = "a directory" if path.is_dir() else "no regular file"
            raise RecordingError(f"{path}: cannot be read: it is {kind}")
        with path.open("rb") as file:
            head = file.read(4)
            file.seek(0)
            if head.startswith(GZIP):
                with gzip.open(file) as content:
                    return ((path, _bounded(path, content)),)
            if head == ZIP:
                return _members(path, file)
            return ((path, _bounded(path, file)),)
    except (OSError, EOFError, zlib.error, zipfile.BadZipFile) as error:
        raise RecordingError(f"{path}: cannot be read: {_words(error)}") from error


def is_workbook(path: Path, content: bytes) -> bool:
    """Return whether a file is a spreadsheet, by its content or its name."""
    if content.startswith(ZIP):
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            names = set(archive.namelist())
        return WORKBOOK in names or "content.xml" in names
    return content.startswith(OLD_WORKBOOK) or path.suffix.lower() in WORKBOOK_SUFFIXES


def _bounded(path: Path, file: IO[bytes] | gzip.GzipFile, there: int = 0) -> bytes:
    """Return the content; ``there`` bytes of the same file are held already."""
    content = file.read(MOST_BYTES - there + 1)
    if len(content) + there > MOST_BYTES:
        raise RecordingError(
            f"{path}: is larger than {MOST_BYTES >> 20} MiB unpacked: split it by time or by loop"
        )
    return content


def _members(path: Path, file: IO[bytes]) -> tuple[tuple[Path, bytes], ...]:
    with zipfile.ZipFile(file) as archive:
        names = archive.namelist()
        if WORKBOOK in names or "content.xml" in names:
            file.seek(0)
            return ((path, _bounded(path, file)),)
        tables = sorted(
            name for name in names if name.lower().endswith(TABLES) and not name.startswith("__MACOSX")
        )
        if not tables:
            raise RecordingError(f"{path}: expected a table ({', '.join(TABLES)}) in the archive, found none")
        found: list[tuple[Path, bytes]] = []
        for name in tables:
            if archive.getinfo(name).flag_bits & 1:
                raise RecordingError(f"{path}: the archive is encrypted: unpack it")
            with archive.open(name) as content:
                there = sum(len(each) for _, each in found)
                found.append((path / name if len(tables) > 1 else path, _bounded(path, content, there)))
        return tuple(found)


def _words(error: Exception) -> str:
    return getattr(error, "strerror", None) or str(error) or type(error).__name__
