"""The file in which alarms, what waits to be told, and commands outlive the process: SQLite.

Write-ahead log with ``synchronous=FULL``: what a transaction wrote is there after SIGKILL, and after a power
failure too. NORMAL would do for SIGKILL, but plants lose power, and an acknowledgement must not come undone
then. FULL costs an fsync a transaction, some 4 ms, which is why the daemon writes in a thread
(``journal.py``).
"""

from __future__ import annotations

import logging
import sqlite3
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal, TypeVar

from pydantic import TypeAdapter, ValidationError

from agent.alarms import Alarm, Command
from agent.runtime.change import Change, Waiting
from connectors.base import Publication

LOG = logging.getLogger(__name__)
APPLICATION = 0x736C6A70
"""``application_id`` of the file, "sljp": tells it from the database of another program."""
VERSION = 1
"""``user_version`` of the file."""
BUSY = 1.0
"""How long to wait for another process that writes, s; it needs milliseconds."""
LARGEST_LOG = 1_000_000
"""Bytes to which the write-ahead log is cut back."""
TABLES = f"""
BEGIN IMMEDIATE;
CREATE TABLE alarm (loop TEXT PRIMARY KEY, content TEXT NOT NULL);
CREATE TABLE outbox (sequence INTEGER PRIMARY KEY AUTOINCREMENT, target TEXT NOT NULL, content TEXT NOT NULL);
CREATE TABLE command (number INTEGER PRIMARY KEY AUTOINCREMENT, loop TEXT NOT NULL, content TEXT NOT NULL);
PRAGMA application_id = {APPLICATION};
PRAGMA user_version = {VERSION};
COMMIT;
"""
"""Each ``content`` is JSON."""
T = TypeVar("T")
_UNREADABLE = {sqlite3.SQLITE_CORRUPT, sqlite3.SQLITE_NOTADB}
_ALARM = TypeAdapter(Alarm)
_PUBLICATION = TypeAdapter(Publication)
_COMMAND = TypeAdapter(Command)


class StoreError(Exception):
    """The file cannot be used now: disk full, no permission, locked, damaged, or of another program."""


@dataclass(frozen=True, slots=True)
class Told:
    """A command that waits for the agent."""

    number: int
    loop: str
    command: Command | None
    """None where it cannot be read."""


@dataclass(frozen=True, slots=True)
class Kept:
    """What was in the store."""

    alarms: Mapping[str, Alarm] = field(default_factory=dict)
    """By loop."""
    waiting: Mapping[int, Waiting] = field(default_factory=dict)
    """By sequence number, ascending."""
    sequence: int = 0
    """The highest sequence number there ever was."""


class Store:
    """An open file. Each method is one transaction and raises StoreError where it fails.

    To be used from one thread only.
    """

    def __init__(self, path: Path, *, create: bool = True) -> None:
        """Open ``path``. A file that is damaged is moved aside, where ``create`` allows a new one."""
        self.path = path
        try:
            self._database = self._opened(create=create)
        except StoreError as error:
            if not create or not _is_damaged(error):
                raise
            LOG.error("%s; it is moved to %s, and a new one begins", error, _moved_aside(path))  # noqa: TRY400
            self._database = self._opened(create=True)

    def close(self) -> None:
        """Let go of the file."""
        self._database.close()

    def write(self, change: Change) -> None:
        """Write all of a change or nothing; what was written already does no harm."""
        with self._transaction("IMMEDIATE") as database:
            database.executemany(
                "INSERT OR REPLACE INTO alarm VALUES (?, ?)",
                [(loop, _text(_ALARM, alarm)) for loop, alarm in change.alarms.items()],
            )
            database.executemany(
                "INSERT OR REPLACE INTO outbox VALUES (?, ?, ?)",
                [(n, each.target, _text(_PUBLICATION, each.publication)) for n, each in change.put.items()],
            )
            database.executemany("DELETE FROM outbox WHERE sequence = ?", [(n,) for n in change.removed])
            database.executemany("DELETE FROM command WHERE number = ?", [(n,) for n in change.taken])

    def read(self) -> Kept:
        """Return alarms and what waits; a row that cannot be read is told in the log and left out."""
        with self._transaction("DEFERRED") as database:
            alarms = database.execute("SELECT * FROM alarm ORDER BY loop").fetchall()
            waiting = database.execute("SELECT * FROM outbox ORDER BY sequence").fetchall()
            highest = database.execute("SELECT seq FROM sqlite_sequence WHERE name = 'outbox'").fetchone()
        return Kept(
            {loop: alarm for loop, text in alarms if (alarm := self._value(_ALARM, text))},
            {
                number: Waiting(target, publication)
                for number, target, text in waiting
                if (publication := self._value(_PUBLICATION, text))
            },
            highest[0] if highest else 0,
        )

    def command(self, loop: str, command: Command) -> int:
        """Leave a command for the agent; return its number."""
        with self._transaction("IMMEDIATE") as database:
            row = (loop, _text(_COMMAND, command))
            return database.execute("INSERT INTO command (loop, content) VALUES (?, ?)", row).lastrowid or 0

    def commands(self) -> tuple[Told, ...]:
        """Return the commands that wait, the oldest first."""
        with self._transaction("DEFERRED") as database:
            rows = database.execute("SELECT * FROM command ORDER BY number").fetchall()
        return tuple(Told(number, loop, self._value(_COMMAND, text)) for number, loop, text in rows)

    def _value(self, adapter: TypeAdapter[T], text: str) -> T | None:
        try:
            return adapter.validate_json(text)
        except ValidationError as error:
            LOG.error("%s: cannot read %.200s: %s", self.path, text, error)  # noqa: TRY400
            return None

    def _opened(self, *, create: bool) -> sqlite3.Connection:
        with self._told():
            mode = "rwc" if create else "rw"
            database = sqlite3.connect(
                f"{self.path.absolute().as_uri()}?mode={mode}", uri=True, timeout=BUSY, isolation_level=None
            )
            try:
                self._prepare(database)
            except BaseException:
                database.close()
                raise
            return database

    def _prepare(self, database: sqlite3.Connection) -> None:
        faults = [row[0] for row in database.execute("PRAGMA quick_check(1)")]
        if faults != ["ok"]:
            fault = sqlite3.DatabaseError(faults[0])
            fault.sqlite_errorcode = sqlite3.SQLITE_CORRUPT
            raise fault
        if database.execute("SELECT name FROM sqlite_schema").fetchone():
            self._recognise(database)
        database.execute("PRAGMA journal_mode = WAL")
        database.execute("PRAGMA synchronous = FULL")
        database.execute(f"PRAGMA journal_size_limit = {LARGEST_LOG}")
        if not database.execute("SELECT name FROM sqlite_schema").fetchone():
            database.executescript(TABLES)

    def _recognise(self, database: sqlite3.Connection) -> None:
        application, version = (
            database.execute(f"PRAGMA {name}").fetchone()[0] for name in ("application_id", "user_version")
        )
        if application != APPLICATION:
            raise StoreError(f"{self.path}: belongs to another program")
        if version != VERSION:
            raise StoreError(f"{self.path}: has version {version}, this slipjump reads version {VERSION}")

    @contextmanager
    def _transaction(self, kind: Literal["DEFERRED", "IMMEDIATE"]) -> Iterator[sqlite3.Connection]:
        with self._told(), self._database as database:
            database.execute(f"BEGIN {kind}")
            yield database

    @contextmanager
    def _told(self) -> Iterator[None]:
        try:
            yield
        except sqlite3.Error as error:
            raise StoreError(f"{self.path}: {error}") from error


def _text(adapter: TypeAdapter[T], value: T) -> str:
    return adapter.dump_json(value).decode()


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
