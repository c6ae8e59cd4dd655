"""The SQLite file that keeps alarms, unpublished messages and commands over a restart.

Write-ahead log with ``synchronous=FULL``: what a transaction wrote is there after SIGKILL, and after a power
failure too. NORMAL would do for SIGKILL, but plants lose power, and an acknowledgement must not come undone
then. FULL costs an fsync a transaction, some 4 ms, which is why the daemon writes in a thread
(``journal.py``).
"""

from __future__ import annotations

import logging
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TypeVar

from pydantic import TypeAdapter, ValidationError

from agent.alarms import Alarm, Command
from agent.analysis.memory.state import from_state, to_state
from agent.analysis.memory.valve_memory import ValveMemory
from agent.runtime.store.change import Change, Waiting
from agent.runtime.store.database import Database, Format, StoreError
from connectors.base import Publication

LOG = logging.getLogger(__name__)
TABLES = """
CREATE TABLE alarm (loop TEXT PRIMARY KEY, content TEXT NOT NULL);
CREATE TABLE outbox (sequence INTEGER PRIMARY KEY AUTOINCREMENT, target TEXT NOT NULL, content TEXT NOT NULL);
CREATE TABLE command (number INTEGER PRIMARY KEY AUTOINCREMENT, loop TEXT NOT NULL, content TEXT NOT NULL);
"""
"""Each ``content`` is JSON."""
ADDED = "CREATE TABLE IF NOT EXISTS memory (loop TEXT PRIMARY KEY, content TEXT NOT NULL);"
FORMAT = Format(application=0x736C6A70, version=1, tables=TABLES, synchronous="FULL", added=ADDED)
"""The application is "sljp"."""
__all__ = ["Kept", "Store", "StoreError", "StoredCommand"]
T = TypeVar("T")
_ALARM = TypeAdapter(Alarm)
_PUBLICATION = TypeAdapter(Publication)
_COMMAND = TypeAdapter(Command)


@dataclass(frozen=True, slots=True)
class StoredCommand:
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
    memories: Mapping[str, ValveMemory] = field(default_factory=dict)
    """By loop."""
    sequence: int = 0
    """The highest sequence number there ever was."""


class Store:
    """An open file. Each method is one transaction and raises StoreError where it fails.

    To be used from one thread only.
    """

    def __init__(self, path: Path, *, create: bool = True) -> None:
        """Open ``path``. A file that is damaged is moved aside, where ``create`` allows a new one."""
        self.path = path
        self._database = Database(path, FORMAT, create=create)

    def close(self) -> None:
        """Let go of the file."""
        self._database.close()

    def is_foreign(self) -> bool:
        """Return whether the file was removed, replaced or overwritten since it was opened."""
        return self._database.is_foreign()

    def write(self, change: Change) -> None:
        """Write all of a change or nothing; what was written already does no harm."""
        with self._database.transaction("IMMEDIATE") as database:
            database.executemany(
                "INSERT OR REPLACE INTO alarm VALUES (?, ?)",
                [(loop, _text(_ALARM, alarm)) for loop, alarm in change.alarms.items()],
            )
            database.executemany(
                "INSERT OR REPLACE INTO memory VALUES (?, ?)",
                [(loop, to_state(memory)) for loop, memory in change.memories.items()],
            )
            database.executemany(
                "INSERT OR REPLACE INTO outbox VALUES (?, ?, ?)",
                [(n, each.target, _text(_PUBLICATION, each.publication)) for n, each in change.put.items()],
            )
            database.executemany("DELETE FROM outbox WHERE sequence = ?", [(n,) for n in change.removed])
            database.executemany("DELETE FROM command WHERE number = ?", [(n,) for n in change.taken])

    def read(self) -> Kept:
        """Return alarms and waiting publications; a row that cannot be read is logged and skipped."""
        with self._database.transaction("DEFERRED") as database:
            alarms = database.execute("SELECT * FROM alarm ORDER BY loop").fetchall()
            waiting = database.execute("SELECT * FROM outbox ORDER BY sequence").fetchall()
            memories = database.execute("SELECT * FROM memory ORDER BY loop").fetchall()
            highest = database.execute("SELECT seq FROM sqlite_sequence WHERE name = 'outbox'").fetchone()
        return Kept(
            {loop: alarm for loop, text in alarms if (alarm := self._value(_ALARM, text))},
            {
                number: Waiting(target, publication)
                for number, target, text in waiting
                if (publication := self._value(_PUBLICATION, text))
            },
            {loop: memory for loop, text in memories if (memory := self._memory(loop, text)) is not None},
            highest[0] if highest else 0,
        )

    def command(self, loop: str, command: Command) -> int:
        """Leave a command for the agent; return its number."""
        with self._database.transaction("IMMEDIATE") as database:
            row = (loop, _text(_COMMAND, command))
            return database.execute("INSERT INTO command (loop, content) VALUES (?, ?)", row).lastrowid or 0

    def commands(self) -> tuple[StoredCommand, ...]:
        """Return the waiting commands, the oldest first."""
        with self._database.transaction("DEFERRED") as database:
            rows = database.execute("SELECT * FROM command ORDER BY number").fetchall()
        return tuple(StoredCommand(number, loop, self._value(_COMMAND, text)) for number, loop, text in rows)

    def _memory(self, loop: str, text: str) -> ValveMemory | None:
        try:
            return from_state(text)
        except ValueError as error:
            LOG.error("%s: cannot read what is remembered of %s: %s", self.path, loop, error)  # noqa: TRY400
            return None

    def _value(self, adapter: TypeAdapter[T], text: str) -> T | None:
        try:
            return adapter.validate_json(text)
        except ValidationError as error:
            LOG.error("%s: cannot read %.200s: %s", self.path, text, error)  # noqa: TRY400
            return None


def _text(adapter: TypeAdapter[T], value: T) -> str:
    return adapter.dump_json(value).decode()
