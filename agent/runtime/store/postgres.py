"""A database of PostgreSQL or TimescaleDB that takes what files of agents hold, each row once.

How far a file is, is a number in the same transaction as the rows: whatever breaks between them and the
agent's own memory of it, nothing is there twice.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from datetime import UTC, datetime
from typing import TYPE_CHECKING, Any

import numpy as np
import psycopg
from psycopg.adapt import Dumper
from psycopg.pq import Format

from agent.runtime.store.database import StoreError
from agent.runtime.store.forwarder import RowT
from connectors.base import AccessDeniedError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from agent.settings import HistoryDatabase

ORIGIN = """
CREATE TABLE IF NOT EXISTS slipjump_origin (origin uuid PRIMARY KEY, position bigint NOT NULL);
"""
"""No table has a unique constraint but this one: a hypertable would want the time in it, and ``position``
does the same."""
CONNECT, STATEMENT, DEAD = 5, 20_000, 10_000
"""Longest wait: for a connection, s; for a statement, ms; for a peer that went away, ms."""
EARLIEST, LATEST = datetime(1, 1, 2, tzinfo=UTC), datetime(9999, 12, 30, tzinfo=UTC)
NULL = -1
"""In place of the length of a value."""
LENGTH = 4
"""Bytes of the length of a value."""


class PostgresDatabase:
    """One connection; each method raises StoreError where it fails. To be used from one thread only."""

    def __init__(self, settings: HistoryDatabase, tables: str, *, create: bool = True) -> None:
        """Connect, and make the tables where ``create`` says so."""
        with named(settings):
            password = None if settings.password is None else settings.password.read("database.password")
            given: dict[str, Any] = {} if password is None else {"password": password}
            self.connection = psycopg.connect(
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
            for dumper in (_Reals, _Integers, _Smalls):
                self.connection.adapters.register_dumper(None, dumper)
        self.settings = settings
        if create:
            with named(settings), self.connection.transaction():
                self.connection.execute("SELECT pg_advisory_xact_lock(hashtext('slipjump'))")
                self.connection.execute(f"{tables}{ORIGIN}")

    def close(self) -> None:
        """Close the connection."""
        self.connection.close()

    def position(self, origin: str) -> int:
        """Return the number of the last row of a file that is there; 0: none."""
        with named(self.settings):
            row = self.connection.execute(
                "SELECT position FROM slipjump_origin WHERE origin = %s", (origin,)
            ).fetchone()
        return 0 if row is None else int(row[0])

    def take_once(self, origin: str, rows: Sequence[RowT], put: Callable[[list[RowT]], None]) -> None:
        """Keep rows of one file, all or none; those that are there already are left out.

        Args:
            origin: Identity of the file.
            rows: In the order of their numbers.
            put: Writes those that are new, within the transaction.
        """
        with named(self.settings), self.connection.transaction():
            self.connection.execute(
                "INSERT INTO slipjump_origin VALUES (%s, 0) ON CONFLICT DO NOTHING", (origin,)
            )
            row = self.connection.execute(
                "SELECT position FROM slipjump_origin WHERE origin = %s FOR UPDATE", (origin,)
            ).fetchone()
            there = 0 if row is None else int(row[0])
            new = [each for each in rows if each.number > there]
            if not new:
                return
            put(new)
            self.connection.execute(
                "UPDATE slipjump_origin SET position = %s WHERE origin = %s", (new[-1].number, origin)
            )

    def copy(self, statement: str, types: Sequence[str], rows: Sequence[Sequence[Any]]) -> None:
        """Write rows by a binary COPY; arrays are those of numpy, but for texts."""
        with self.connection.cursor() as cursor, cursor.copy(statement.encode()) as copy:
            copy.set_types(types)
            for each in rows:
                copy.write_row(each)


class _Numbers(Dumper):
    """An array of numpy as an array of PostgreSQL, without a Python object for each value; masked: NULL."""

    format = Format.BINARY
    element: int
    """Oid of a value."""
    kind: str
    """Its type as the protocol has it."""

    def dump(self, obj: NDArray[np.generic]) -> bytes:
        """Return the array as the protocol has it: its shape, then length and bytes of each value."""
        table = np.empty(len(obj), dtype=[("length", ">i4"), ("value", self.kind)])
        table["length"], table["value"] = np.dtype(self.kind).itemsize, np.ma.getdata(obj)
        missing = np.ma.getmaskarray(obj)
        head = [1, int(missing.any()), self.element, len(obj), 1] if len(obj) else [0, 0, self.element]
        body = table.tobytes()
        if missing.any():
            table["length"][missing] = NULL
            whole = np.frombuffer(table.tobytes(), dtype=np.uint8).reshape(len(obj), -1)
            kept = np.ones(whole.shape, dtype=np.bool_)
            kept[missing, LENGTH:] = False
            body = whole[kept].tobytes()
        return np.array(head, dtype=">i4").tobytes() + body


class _Reals(_Numbers):
    oid, element, kind = 1021, 700, ">f4"  # real[]


class _Integers(_Numbers):
    oid, element, kind = 1007, 23, ">i4"  # integer[]


class _Smalls(_Numbers):
    oid, element, kind = 1005, 21, ">i2"  # smallint[]


@contextmanager
def named(settings: HistoryDatabase) -> Iterator[None]:
    """Make a StoreError that names the database, and no password, of what goes wrong."""
    try:
        yield
    except (psycopg.Error, AccessDeniedError) as error:
        words = " ".join(str(error).split()) or type(error).__name__
        raise StoreError(f"{settings.url}: {words}") from error


def moment(time: float) -> datetime:
    """Return a time, the nearest that a database has: a source may send any."""
    try:
        return min(max(datetime.fromtimestamp(time, UTC), EARLIEST), LATEST)
    except (OverflowError, ValueError, OSError):
        return LATEST if time > 0 else EARLIEST


def clean_text(text: str) -> str:
    """Return a text as PostgreSQL takes it, without the character 0 and half surrogates."""
    return text.replace("\0", "").encode("utf-8", "replace").decode()
