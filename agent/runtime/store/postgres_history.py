"""The history in PostgreSQL or TimescaleDB: entries of many agents, each once.

What an agent has sent is a number in the same transaction as the entries: whatever breaks between them and
the agent's own memory of it, nothing is there twice.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from datetime import UTC, datetime
from typing import TYPE_CHECKING, Any
from uuid import UUID

import psycopg
from psycopg.types.json import Jsonb

from agent.runtime.store.database import StoreError
from agent.runtime.store.history_file import Entry, NumberedEntry
from connectors.base import AccessDeniedError

if TYPE_CHECKING:
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
CREATE TABLE IF NOT EXISTS slipjump_origin (origin uuid PRIMARY KEY, position bigint NOT NULL);
"""
"""No unique constraint: a hypertable would want the time in it, and ``position`` does the same."""
COPY = (
    "COPY slipjump_entry (time, written, origin, number, loop, kind, content) FROM STDIN WITH (FORMAT BINARY)"
)
TYPES = ("timestamptz", "timestamptz", "uuid", "int8", "text", "text", "jsonb")
CONNECT, STATEMENT, DEAD = 5, 20_000, 10_000
"""Longest wait: for a connection, s; for a statement, ms; for a peer that went away, ms."""
EARLIEST, LATEST = datetime(1, 1, 2, tzinfo=UTC), datetime(9999, 12, 30, tzinfo=UTC)


class PostgresHistory:
    """One connection; each method raises StoreError where it fails. To be used from one thread only."""

    def __init__(self, settings: HistoryDatabase, *, create: bool = True) -> None:
        """Connect, and make the tables where ``create`` says so."""
        with _named(settings):
            password = None if settings.password is None else settings.password.read("database.password")
            given: dict[str, Any] = {} if password is None else {"password": password}
            self._connection = psycopg.connect(
                settings.url,
                autocommit=True,
                application_name="slipjump",
                connect_timeout=CONNECT,
                tcp_user_timeout=DEAD,
                keepalives_idle=CONNECT,
                options=f"-c statement_timeout={STATEMENT}",
                sslmode="require" if settings.tls else "prefer",
                **given,
            )
        self._settings = settings
        if create:
            with _named(settings), self._connection.transaction():
                self._connection.execute("SELECT pg_advisory_xact_lock(hashtext('slipjump'))")
                self._connection.execute(TABLES)

    def close(self) -> None:
        """Close the connection."""
        self._connection.close()

    def position(self, origin: str) -> int:
        """Return the number of the last entry of a file that is there; 0: none."""
        with _named(self._settings):
            row = self._connection.execute(
                "SELECT position FROM slipjump_origin WHERE origin = %s", (origin,)
            ).fetchone()
        return 0 if row is None else int(row[0])

    def take(self, origin: str, entries: Sequence[NumberedEntry]) -> None:
        """Keep entries of one file, all or none; those that are there already are left out."""
        with _named(self._settings), self._connection.transaction():
            self._connection.execute(
                "INSERT INTO slipjump_origin VALUES (%s, 0) ON CONFLICT DO NOTHING", (origin,)
            )
            row = self._connection.execute(
                "SELECT position FROM slipjump_origin WHERE origin = %s FOR UPDATE", (origin,)
            ).fetchone()
            there = 0 if row is None else int(row[0])
            new = [each for each in entries if each.number > there]
            if not new:
                return
            with self._connection.cursor() as cursor, cursor.copy(COPY) as copy:
                copy.set_types(TYPES)
                for each in new:
                    copy.write_row(_row(origin, each))
            self._connection.execute(
                "UPDATE slipjump_origin SET position = %s WHERE origin = %s", (new[-1].number, origin)
            )

    def read(
        self, loop: str | None = None, since: float | None = None, limit: int | None = None
    ) -> tuple[Entry, ...]:
        """Return the newest ``limit`` entries, the oldest first: of one loop, from a time on (s UTC)."""
        start = None if since is None else _moment(since)
        with _named(self._settings):
            rows = self._connection.execute(
                "SELECT time, loop, kind, content FROM slipjump_entry "
                "WHERE (%(loop)s::text IS NULL OR loop = %(loop)s) "
                "AND (%(start)s::timestamptz IS NULL OR time >= %(start)s) "
                "ORDER BY time DESC, number DESC LIMIT %(limit)s",
                {"loop": loop, "start": start, "limit": limit},
            ).fetchall()
        return tuple(
            Entry(time.timestamp(), name, kind, content) for time, name, kind, content in reversed(rows)
        )


@contextmanager
def _named(settings: HistoryDatabase) -> Iterator[None]:
    try:
        yield
    except (psycopg.Error, AccessDeniedError) as error:
        words = " ".join(str(error).split()) or type(error).__name__
        raise StoreError(f"{settings.url}: {words}") from error


def _row(origin: str, numbered: NumberedEntry) -> tuple[Any, ...]:
    entry = numbered.entry
    moments = _moment(entry.time), _moment(numbered.written)
    return (
        *moments,
        UUID(origin),
        numbered.number,
        _clean(entry.loop),
        entry.kind,
        Jsonb(_clean(entry.content)),
    )


def _moment(time: float) -> datetime:
    """Return a time, the nearest that a database has: a source may send any."""
    try:
        return min(max(datetime.fromtimestamp(time, UTC), EARLIEST), LATEST)
    except (OverflowError, ValueError, OSError):
        return LATEST if time > 0 else EARLIEST


def _clean(content: Any) -> Any:  # noqa: ANN401 - JSON
    """Return JSON as PostgreSQL takes it: without NaN, and without the character 0 in texts.

    One entry that is refused would hold up all that come after it.
    """
    match content:
        case str():
            return content.replace("\0", "").encode("utf-8", "replace").decode()
        case dict():
            return {_clean(key): _clean(value) for key, value in content.items()}
        case list():
            return [_clean(each) for each in content]
        case float() if not math.isfinite(content):
            return None
    return content
