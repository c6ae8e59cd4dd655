"""An SQLite file of this program: checked when opened, recognised by its application id, kept intact."""

from __future__ import annotations

import logging
import os
import sqlite3
import time
from collections.abc import Iterator
from contextlib import ExitStack, closing, contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal, Protocol, TypeVar
from uuid import uuid4

LOG = logging.getLogger(__name__)
BUSY = 1.0
"""How long to wait for another process that writes, s; it needs milliseconds."""
CACHE = 256
"""KiB of memory for pages of the file; SQLite's own 2000 fill over days, and hardly a page is read again."""
PRIVATE = 0o600
"""Of a new file: alarms carry names and comments of people."""
LARGEST_LOG = 1_000_000
"""Bytes to which the write-ahead log is cut back."""
_UNREADABLE = {sqlite3.SQLITE_CORRUPT, sqlite3.SQLITE_NOTADB}


class StoreError(Exception):
    """The file cannot be used now: disk full, no permission, locked, damaged, or of another program."""


class Removable(Protocol):
    """A file that is kept open, and may be removed or replaced by somebody else."""

    def is_gone(self) -> bool:
        """Return whether it was."""
        ...

    def close(self) -> None:
        """Let go of it."""
        ...


RemovableT = TypeVar("RemovableT", bound=Removable)


def unless_gone(file: RemovableT | None, path: Path) -> RemovableT | None:
    """Return an open file; None, and let go of it, where its place at ``path`` is not its own any more."""
    if file is None or not file.is_gone():
        return file
    LOG.error("%s was removed or replaced; it is begun anew", path, extra={"event": "history"})
    file.close()
    return None


@dataclass(frozen=True, slots=True)
class Format:
    """What is in a file."""

    application: int
    """``application_id``: distinguishes it from the database of another program."""
    version: int
    """``user_version``."""
    tables: str
    """SQL that makes its tables."""
    added: str = field(default="", kw_only=True)
    """SQL that makes tables which came later, ``IF NOT EXISTS``: older files get them when they are opened,
    and older programs do not see them."""
    synchronous: Literal["FULL", "NORMAL"]
    """FULL: what a transaction wrote is there after a power failure, at the price of an fsync each. NORMAL:
    after SIGKILL, but a power failure may undo the last ones."""


def _made_private(path: Path) -> None:
    """Make a file that is not there for its owner only; SQLite's own would be readable by everybody."""
    with suppress(FileExistsError, OSError):  # SQLite reports what is wrong with the path
        os.close(os.open(path, os.O_RDWR | os.O_CREAT | os.O_EXCL, PRIVATE))


class Database:
    """An open file with a write-ahead log; every failure is a StoreError. To be used from one thread only."""

    def __init__(self, path: Path, content: Format, *, create: bool = True, check: bool = True) -> None:
        """Open ``path``. A file that is damaged is moved aside, where ``create`` allows a new one.

        ``check`` reads all of it first, some 2 s for 500 MB.
        """
        self.path = path
        self._content = content
        self._check = check
        self._identity = self._mark = (0, 0)
        """Device and number, and size and time in ns, of the file."""
        try:
            self._database = self._opened(create=create)
        except StoreError as error:
            if not create or not _is_damaged(error):
                raise
            LOG.error("%s; the file was moved to %s, a new one is made", error, _moved_aside(path))  # noqa: TRY400
            self._database = self._opened(create=True)

    def close(self) -> None:
        """Let go of the file."""
        self._database.close()

    def used(self) -> int:
        """Return how many bytes of the file hold something."""
        with self.reading() as database:
            pages, free, size = (
                database.execute(f"PRAGMA {name}").fetchone()[0]
                for name in ("page_count", "freelist_count", "page_size")
            )
        return int((pages - free) * size)

    def give_back(self) -> None:
        """Return to the disk what holds nothing any more."""
        with self.reading() as database:
            database.execute("PRAGMA incremental_vacuum").fetchall()

    def origin(self) -> str:
        """Return the identity of this file, made at need: its numbers mean nothing in another one."""
        with self.transaction("IMMEDIATE") as database:
            database.execute("CREATE TABLE IF NOT EXISTS origin (id TEXT NOT NULL)")
            held = database.execute("SELECT id FROM origin").fetchone()
            if held is None:
                held = (str(uuid4()),)
                database.execute("INSERT INTO origin VALUES (?)", held)
        return str(held[0])

    def is_gone(self) -> bool:
        """Return whether the file was removed or replaced since it was opened, as by a rotation of logs."""
        return self._in_place() is None

    def is_foreign(self) -> bool:
        """Return whether the file was removed, replaced or overwritten since it was opened.

        It is read only where somebody else wrote it: another process of this program may have.
        """
        found = self._in_place()
        if found is None:
            return True
        mark = found.st_size, found.st_mtime_ns
        if mark == self._mark:
            return False
        self._mark = mark
        try:
            self._database.execute("PRAGMA wal_checkpoint")  # what is in the log is written there again
            self._remember()
            with closing(self._connected("rw")) as fresh:
                return bool(fresh.execute("PRAGMA quick_check(1)").fetchone() != ("ok",))
        except sqlite3.Error as error:
            return error.sqlite_errorcode & 0xFF in _UNREADABLE

    @contextmanager
    def transaction(self, kind: Literal["DEFERRED", "IMMEDIATE"]) -> Iterator[sqlite3.Connection]:
        """Do all within or nothing: DEFERRED to read, IMMEDIATE to write."""
        with self.reading(), self._database as database:
            database.execute(f"BEGIN {kind}")
            yield database
        if kind == "IMMEDIATE":
            self._remember()

    @contextmanager
    def reading(self) -> Iterator[sqlite3.Connection]:
        """Use the database without a transaction; an SQLite error becomes a StoreError naming the file."""
        with _named(self.path):
            yield self._database

    def _opened(self, *, create: bool) -> sqlite3.Connection:
        with _named(self.path):
            mode = "rwc" if create else "rw"
            if create:
                _made_private(self.path)
            database = self._connected(mode)
            with ExitStack() as unless_prepared:
                unless_prepared.callback(database.close)
                self._prepare(database)
                unless_prepared.pop_all()
            found = self.path.stat()
            self._identity = found.st_dev, found.st_ino
            self._remember()
            return database

    def _connected(self, mode: str) -> sqlite3.Connection:
        place = f"{self.path.absolute().as_uri()}?mode={mode}"
        return sqlite3.connect(place, uri=True, timeout=BUSY, isolation_level=None)

    def _in_place(self) -> os.stat_result | None:
        """Return what its folder knows of the file; None where that is gone, or another one."""
        try:
            found = self.path.stat()
        except OSError:
            return None
        return found if (found.st_dev, found.st_ino) == self._identity else None

    def _remember(self) -> None:
        """Note how the file looks after what this one wrote."""
        with suppress(OSError):
            found = self.path.stat()
            self._mark = found.st_size, found.st_mtime_ns

    def _prepare(self, database: sqlite3.Connection) -> None:
        faults = [row[0] for row in database.execute("PRAGMA quick_check(1)")] if self._check else ["ok"]
        if faults != ["ok"]:
            fault = sqlite3.DatabaseError(faults[0])
            fault.sqlite_errorcode = sqlite3.SQLITE_CORRUPT
            raise fault
        is_new = _is_empty(database)
        if is_new:
            database.execute("PRAGMA auto_vacuum = INCREMENTAL")  # only a file without tables takes it
        else:
            self._recognise(database)
        database.execute("PRAGMA journal_mode = WAL")
        database.execute(f"PRAGMA cache_size = -{CACHE}")
        database.execute(f"PRAGMA synchronous = {self._content.synchronous}")
        database.execute(f"PRAGMA journal_size_limit = {LARGEST_LOG}")
        if is_new:
            self._make(database)
        if self._content.added:
            database.executescript(self._content.added)

    def _make(self, database: sqlite3.Connection) -> None:
        """Make the tables, unless another connection has made them since the file was seen to be empty."""
        content = self._content
        marks = f"PRAGMA application_id = {content.application}; PRAGMA user_version = {content.version}"
        with database:
            database.execute("BEGIN IMMEDIATE")
            if _is_empty(database):
                for statement in f"{content.tables}{marks}".split(";"):
                    database.execute(statement)
        self._recognise(database)

    def _recognise(self, database: sqlite3.Connection) -> None:
        application, version = (
            database.execute(f"PRAGMA {name}").fetchone()[0] for name in ("application_id", "user_version")
        )
        if application != self._content.application:
            raise StoreError(f"{self.path}: belongs to another program")
        if version != self._content.version:
            expected = self._content.version
            raise StoreError(f"{self.path}: has version {version}, this slipjump reads version {expected}")


@contextmanager
def _named(path: Path) -> Iterator[None]:
    try:
        yield
    except sqlite3.Error as error:
        raise StoreError(f"{path}: {error}") from error


def _is_empty(database: sqlite3.Connection) -> bool:
    return database.execute("SELECT name FROM sqlite_schema").fetchone() is None


def _is_damaged(error: StoreError) -> bool:
    code = getattr(error.__cause__, "sqlite_errorcode", 0)
    return code & 0xFF in _UNREADABLE


def _moved_aside(path: Path) -> Path:
    aside = path.with_name(f"{path.name}.damaged-{time.time():.0f}")
    for suffix in ("", "-wal", "-shm"):
        part = path.with_name(path.name + suffix)
        if part.exists():
            part.rename(aside.with_name(aside.name + suffix))
    return aside
