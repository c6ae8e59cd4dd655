"""The history: diagnoses and changes of alarms in an SQLite file; the oldest are deleted first.

A separate file beside the store: large, and less valuable. ``synchronous=NORMAL``: a power failure may lose
the newest entries, and writing is cheap for the disk.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

from agent.runtime.store.database import Database, Format
from agent.runtime.store.kept_window import KeptWindow, ListedWindow

TABLES = """
CREATE TABLE entry (
    number INTEGER PRIMARY KEY,
    written REAL NOT NULL,
    time REAL NOT NULL,
    loop TEXT NOT NULL,
    kind TEXT NOT NULL,
    content TEXT NOT NULL
);
CREATE INDEX entry_time ON entry (loop, time);
CREATE INDEX entry_written ON entry (written);
"""
"""``written``: when, by this machine's clock, s UTC; retention goes by it, as a source may have any.
``content`` is JSON."""
WINDOWS = """
CREATE TABLE IF NOT EXISTS window (
    number INTEGER PRIMARY KEY,
    start REAL NOT NULL,
    ts REAL NOT NULL,
    samples INTEGER NOT NULL,
    content BLOB NOT NULL
);
CREATE TRIGGER IF NOT EXISTS window_of_entry AFTER DELETE ON entry
BEGIN DELETE FROM window WHERE number = old.number; END;
"""
"""Of a window, by the number of its verdict; no samples where they were dropped for want of room."""
FORMAT = Format(application=0x736C6A68, version=1, tables=TABLES, added=WINDOWS, synchronous="NORMAL")
"""The application is "sljh"."""
AT_ONCE = 0.05
"""Part of the windows, or of the entries, that goes where the file is too large."""
MOST_BYTES = 8_000_000
"""Of windows that are read together to be sent."""


@dataclass(frozen=True, slots=True)
class Entry:
    """One thing that happened to a loop."""

    time: float
    """End of the window, or time of the decision, s UTC."""
    loop: str
    kind: Literal["diagnosis", "alarm", "note"]
    content: dict[str, Any]
    """As JSON: of `slipjump diagnose` without its methods, the published fields of the alarm, or the decision
    of a person on the page, with the comment."""
    window: KeptWindow | None = field(default=None, compare=False)
    """Of a diagnosis of interest, its values; None also where entries are read to be shown."""


@dataclass(frozen=True, slots=True)
class NumberedEntry:
    """An entry with its place in the file."""

    number: int
    """Rises from one entry to the next."""
    written: float
    """When, by this machine's clock, s UTC."""
    entry: Entry


def history_path(state: Path) -> Path:
    """Return the path of the history of the agent that keeps its alarms in ``state``."""
    return state.with_suffix(".history.sqlite")


class HistoryFile:
    """An open file. Each method raises StoreError where it fails. To be used from one thread only."""

    def __init__(self, path: Path, *, create: bool = True) -> None:
        """Open ``path``; without ``create`` to read, and then without the check that takes long."""
        self._database = Database(path, FORMAT, create=create, check=create)

    def close(self) -> None:
        """Let go of the file."""
        self._database.close()

    def is_gone(self) -> bool:
        """Return whether the file was removed or replaced since it was opened."""
        return self._database.is_gone()

    def write(self, entries: Sequence[Entry], now: float) -> None:
        """Add entries, all or none, at ``now``, s UTC."""
        rows = [
            (now, each.time, each.loop, each.kind, json.dumps(each.content, separators=(",", ":")))
            for each in entries
        ]
        windows = [None if each.window is None else (each.window, each.window.packed()) for each in entries]
        with self._database.transaction("IMMEDIATE") as database:
            for row, kept in zip(rows, windows, strict=True):
                number = database.execute(
                    "INSERT INTO entry (written, time, loop, kind, content) VALUES (?, ?, ?, ?, ?)", row
                ).lastrowid
                if kept is not None:
                    window, content = kept
                    database.execute(
                        "INSERT INTO window VALUES (?, ?, ?, ?, ?)",
                        (number, window.start, window.ts, len(window), content),
                    )

    def forget(self, before: float, max_bytes: float) -> None:
        """Drop what was written before a time (s UTC), and the oldest while the file is too large.

        Values of windows go before any verdict does: they are a hundred times as large.
        """
        with self._database.transaction("IMMEDIATE") as database:
            # the newest stays: numbers would begin anew in an empty table
            database.execute(
                "DELETE FROM entry WHERE written < ? AND number < (SELECT max(number) FROM entry)", (before,)
            )
        while self._database.used() > max_bytes:
            with self._database.transaction("IMMEDIATE") as database:
                windows = database.execute("SELECT count(*) FROM window WHERE samples > 0").fetchone()[0]
                if windows:
                    database.execute(
                        "UPDATE window SET samples = 0, content = x'' WHERE number IN "
                        "(SELECT number FROM window WHERE samples > 0 ORDER BY number LIMIT ?)",
                        (max(1, int(AT_ONCE * windows)),),
                    )
                    continue
                count = database.execute("SELECT count(*) FROM entry").fetchone()[0]
                if count <= 1:
                    break
                database.execute(
                    "DELETE FROM entry WHERE number IN (SELECT number FROM entry ORDER BY number LIMIT ?)",
                    (max(1, int(AT_ONCE * count)),),
                )
        self._database.give_back()

    def read(
        self, loop: str | None = None, since: float | None = None, limit: int | None = None
    ) -> tuple[Entry, ...]:
        """Return the newest ``limit`` entries, the oldest first: of one loop, from a time on (s UTC)."""
        with self._database.transaction("DEFERRED") as database:
            rows = database.execute(
                "SELECT time, loop, kind, content FROM entry WHERE (?1 IS NULL OR loop = ?1) "
                "AND (?2 IS NULL OR time >= ?2) ORDER BY time DESC, number DESC LIMIT ?3",
                (loop, since, -1 if limit is None else limit),
            ).fetchall()
        return tuple(Entry(time, name, kind, json.loads(text)) for time, name, kind, text in reversed(rows))

    def origin(self) -> str:
        """Return the identity of this file: its numbers mean nothing in another one."""
        return self._database.origin()

    def after(self, number: int, limit: int) -> tuple[NumberedEntry, ...]:
        """Return the next entries behind a number, with their windows, in the order of their writing.

        They are fewer than ``limit`` also where their windows are large.
        """
        found: list[NumberedEntry] = []
        size = 0
        with self._database.transaction("DEFERRED") as database:
            for row in database.execute(
                "SELECT number, written, time, loop, kind, entry.content, start, ts, window.content "
                "FROM entry LEFT JOIN window USING (number) WHERE number > ? ORDER BY number LIMIT ?",
                (number, limit),
            ):
                place, written, time, name, kind, text, start, ts, content = row
                window = None if content is None else KeptWindow.unpacked(start, ts, content)
                found.append(NumberedEntry(place, written, Entry(time, name, kind, json.loads(text), window)))
                size += len(content or b"")
                if size > MOST_BYTES:
                    break
        return tuple(found)

    def windows(
        self, loop: str | None = None, since: float | None = None, limit: int | None = None
    ) -> tuple[ListedWindow, ...]:
        """Return the newest ``limit`` windows whose values are there, the oldest first."""
        with self._database.transaction("DEFERRED") as database:
            rows = database.execute(
                "SELECT loop, time, start, ts, samples FROM entry JOIN window USING (number) "
                "WHERE samples > 0 AND (?1 IS NULL OR loop = ?1) AND (?2 IS NULL OR time >= ?2) "
                "ORDER BY time DESC, number DESC LIMIT ?3",
                (loop, since, -1 if limit is None else limit),
            ).fetchall()
        return tuple(ListedWindow(*row) for row in reversed(rows))

    def window(self, loop: str, start: float, before: float) -> KeptWindow | None:
        """Return the newest window of a loop that ended from ``start`` to before ``before``, s UTC."""
        with self._database.transaction("DEFERRED") as database:
            row = database.execute(
                "SELECT start, ts, window.content FROM entry JOIN window USING (number) "
                "WHERE samples > 0 AND loop = ? AND time >= ? AND time < ? "
                "ORDER BY time DESC, number DESC LIMIT 1",
                (loop, start, before),
            ).fetchone()
        return None if row is None else KeptWindow.unpacked(*row)

    def lost(self, number: int, rows: Sequence[NumberedEntry]) -> int:
        """Return how many entries and windows the file dropped before they were read behind a number."""
        entries = rows[0].number - number - 1 if number else 0
        return entries + sum(each.entry.window is not None and not len(each.entry.window) for each in rows)

    def delivered(self, number: int) -> None:
        """Do nothing: what was sent is still shown on the page."""

    def notes(self) -> tuple[Entry, ...]:
        """Return what people decided, the oldest first."""
        with self._database.transaction("DEFERRED") as database:
            rows = database.execute(
                "SELECT time, loop, content FROM entry WHERE kind = 'note' ORDER BY time, number"
            ).fetchall()
        return tuple(Entry(time, name, "note", json.loads(text)) for time, name, text in rows)
