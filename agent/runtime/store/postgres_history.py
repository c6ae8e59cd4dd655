"""The history in PostgreSQL or TimescaleDB: entries of many agents with their windows, each once."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, LiteralString
from uuid import UUID

import numpy as np
from psycopg.types.json import Jsonb

from agent.runtime.store.forwarder import Forwarder
from agent.runtime.store.history_file import Entry, HistoryFile, NumberedEntry
from agent.runtime.store.kept_window import COLUMNS, KeptWindow, ListedWindow
from agent.runtime.store.postgres import PostgresDatabase, clean_text, moment, named

if TYPE_CHECKING:
    from pathlib import Path

    from agent.settings import HistoryDatabase

TABLES = """
CREATE TABLE IF NOT EXISTS slipjump_entry (
    time timestamptz NOT NULL,
    written timestamptz NOT NULL,
    origin uuid NOT NULL,
    number bigint NOT NULL,
    loop text NOT NULL,
    kind text NOT NULL,
    content jsonb NOT NULL
);
CREATE INDEX IF NOT EXISTS slipjump_entry_loop ON slipjump_entry (loop, time DESC);
CREATE INDEX IF NOT EXISTS slipjump_entry_time ON slipjump_entry (time DESC);
CREATE TABLE IF NOT EXISTS slipjump_window (
    time timestamptz NOT NULL,
    origin uuid NOT NULL,
    number bigint NOT NULL,
    loop text NOT NULL,
    start timestamptz NOT NULL,
    ts float8 NOT NULL,
    op real[] NOT NULL,
    pv real[] NOT NULL,
    sp real[],
    mv real[],
    automatic real[]
);
CREATE INDEX IF NOT EXISTS slipjump_window_loop ON slipjump_window (loop, time DESC);
"""
COPY = (
    "COPY slipjump_entry (time, written, origin, number, loop, kind, content) FROM STDIN WITH (FORMAT BINARY)"
)
TYPES = ("timestamptz", "timestamptz", "uuid", "int8", "text", "text", "jsonb")
COPY_WINDOWS = (
    "COPY slipjump_window (time, origin, number, loop, start, ts, op, pv, sp, mv, automatic) "
    "FROM STDIN WITH (FORMAT BINARY)"
)
WINDOW_TYPES = ("timestamptz", "uuid", "int8", "text", "timestamptz", "float8", *["float4[]"] * len(COLUMNS))


class PostgresHistory(PostgresDatabase):
    """Entries and windows there."""

    def __init__(self, settings: HistoryDatabase, *, create: bool = True) -> None:
        """Connect, and make the tables where ``create`` says so."""
        super().__init__(settings, TABLES, create=create)

    def take(self, origin: str, entries: Sequence[NumberedEntry]) -> None:
        """Keep entries of one file, all or none; those that are there already are left out."""
        self.take_once(origin, entries, lambda new: self._put(origin, new))

    def _put(self, origin: str, entries: Sequence[NumberedEntry]) -> None:
        self.copy(COPY, TYPES, [_row(origin, each) for each in entries])
        windows = [
            _window_row(origin, each, each.entry.window)
            for each in entries
            if each.entry.window is not None and len(each.entry.window)
        ]
        if windows:
            self.copy(COPY_WINDOWS, WINDOW_TYPES, windows)

    def read(
        self, loop: str | None = None, since: float | None = None, limit: int | None = None
    ) -> tuple[Entry, ...]:
        """Return the newest ``limit`` entries, the oldest first: of one loop, from a time on (s UTC)."""
        rows = self._newest("SELECT time, loop, kind, content FROM slipjump_entry", loop, since, limit)
        return tuple(
            Entry(time.timestamp(), name, kind, content) for time, name, kind, content in reversed(rows)
        )

    def windows(
        self, loop: str | None = None, since: float | None = None, limit: int | None = None
    ) -> tuple[ListedWindow, ...]:
        """Return the newest ``limit`` windows, the oldest first: of one loop, from a time on (s UTC)."""
        rows = self._newest(
            "SELECT loop, time, start, ts, array_length(pv, 1) FROM slipjump_window", loop, since, limit
        )
        return tuple(
            ListedWindow(name, time.timestamp(), first.timestamp(), ts, samples)
            for name, time, first, ts, samples in reversed(rows)
        )

    def _newest(
        self, select: LiteralString, loop: str | None, since: float | None, limit: int | None
    ) -> list[tuple[Any, ...]]:
        """Return the newest ``limit`` rows, the newest first: of one loop, from a time on (s UTC)."""
        with named(self.settings):
            return self.connection.execute(
                f"{select} WHERE (%(loop)s::text IS NULL OR loop = %(loop)s) "
                "AND (%(start)s::timestamptz IS NULL OR time >= %(start)s) "
                "ORDER BY time DESC, number DESC LIMIT %(limit)s",
                {"loop": loop, "start": None if since is None else moment(since), "limit": limit},
            ).fetchall()

    def window(self, loop: str, start: float, before: float) -> KeptWindow | None:
        """Return the newest window of a loop that ended from ``start`` to before ``before``, s UTC."""
        with named(self.settings):
            row = self.connection.execute(
                "SELECT start, ts, op, pv, sp, mv, automatic FROM slipjump_window "
                "WHERE loop = %s AND time >= %s AND time < %s ORDER BY time DESC, number DESC LIMIT 1",
                (loop, moment(start), moment(before)),
                binary=True,
            ).fetchone()
        if row is None:
            return None
        columns = dict(zip(COLUMNS, row[2:], strict=True))
        there = {name: np.array(c, dtype=np.float32) for name, c in columns.items() if c is not None}
        return KeptWindow(row[0].timestamp(), row[1], there)


def _row(origin: str, numbered: NumberedEntry) -> tuple[Any, ...]:
    entry = numbered.entry
    moments = moment(entry.time), moment(numbered.written)
    return (
        *moments,
        UUID(origin),
        numbered.number,
        clean_text(entry.loop),
        entry.kind,
        Jsonb(_clean(entry.content)),
    )


def _window_row(origin: str, numbered: NumberedEntry, window: KeptWindow) -> tuple[Any, ...]:
    entry = numbered.entry
    return (
        moment(entry.time),
        UUID(origin),
        numbered.number,
        clean_text(entry.loop),
        moment(window.start),
        window.ts,
        *(window.columns.get(name) for name in COLUMNS),
    )


def _clean(content: Any) -> Any:  # noqa: ANN401 - JSON
    """Return JSON as PostgreSQL takes it: without NaN, and without the character 0 in texts.

    One entry that is refused would hold up all that come after it.
    """
    match content:
        case str():
            return clean_text(content)
        case dict():
            return {_clean(key): _clean(value) for key, value in content.items()}
        case list():
            return [_clean(each) for each in content]
        case float() if not math.isfinite(content):
            return None
    return content


def history_forwarder(path: Path, settings: HistoryDatabase) -> Forwarder[NumberedEntry]:
    """Return what sends the history, from the file at ``path``."""
    return Forwarder(path, settings, lambda file: HistoryFile(file, create=False), PostgresHistory, "entries")
