"""A temporary file for what is read: in memory while it is small, on disk beyond; gone with its last user."""

from __future__ import annotations

import os
import tempfile
import weakref
from pathlib import Path
from typing import IO

IN_MEMORY = 1 << 23
"""Bytes up to which nothing is written to disk."""
LARGE = Path("/var/tmp")  # noqa: S108 - files in it have no name
"""For large temporary files (Filesystem Hierarchy Standard); ``/tmp`` is memory on many machines."""


class Spool:
    """Bytes that are written once, piece by piece, and read in any order."""

    def __init__(self) -> None:
        """Make an empty one, in TMPDIR where that is set."""
        there = "TMPDIR" not in os.environ and os.access(LARGE, os.W_OK)
        self._file = tempfile.SpooledTemporaryFile(IN_MEMORY, dir=str(LARGE) if there else None)  # noqa: SIM115
        self._end = 0
        self._ended = weakref.finalize(self, self._file.close)

    def put(self, piece: bytes) -> int:
        """Append a piece; return where it begins."""
        begin, self._end = self._end, self._end + len(piece)
        self._file.seek(begin)
        self._file.write(piece)
        return begin

    def get(self, begin: int, size: int) -> bytes:
        """Return so many bytes from there on."""
        self._file.seek(begin)
        return self._file.read(size)

    def reader(self) -> IO[bytes]:
        """Return it as a file to read from its start; whoever has it closes it, and nothing more is put."""
        self._ended.detach()
        self._file.seek(0)
        return self._file
