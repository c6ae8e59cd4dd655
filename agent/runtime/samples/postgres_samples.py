"""Raw samples in PostgreSQL or TimescaleDB: a row a loop and minute, each once, and gaps that are marked."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any
from uuid import UUID

import numpy as np

from agent.runtime.samples.minute import NUMBERS, Minute
from agent.runtime.samples.sample_file import NumberedMinute, SampleFile, SampleGap
from agent.runtime.store.database import StoreError
from agent.runtime.store.forwarder import Forwarder
from agent.runtime.store.postgres import PostgresDatabase, clean_text, moment, named

if TYPE_CHECKING:
    from pathlib import Path

    from agent.settings import HistoryDatabase

TABLES = """
CREATE TABLE IF NOT EXISTS slipjump_sample (
    time timestamptz NOT NULL,
    origin uuid NOT NULL,
    number bigint NOT NULL,
    loop text NOT NULL,
    at integer[] NOT NULL,
    op real[],
    pv real[],
    sp real[],
    mv real[],
    mode text[],
    quality smallint[]
);
CREATE INDEX IF NOT EXISTS slipjump_sample_loop ON slipjump_sample (loop, time DESC);
CREATE TABLE IF NOT EXISTS slipjump_gap (
    time timestamptz NOT NULL,
    origin uuid NOT NULL,
    number bigint NOT NULL,
    until timestamptz NOT NULL,
    minutes bigint NOT NULL
);
"""
COPY = (
    "COPY slipjump_sample (time, origin, number, loop, at, op, pv, sp, mv, mode, quality) "
    "FROM STDIN WITH (FORMAT BINARY)"
)
TYPES = ("timestamptz", "uuid", "int8", "text", "int4[]", *["float4[]"] * len(NUMBERS), "text[]", "int2[]")
COPY_GAPS = "COPY slipjump_gap (time, origin, number, until, minutes) FROM STDIN WITH (FORMAT BINARY)"
GAP_TYPES = ("timestamptz", "uuid", "int8", "timestamptz", "int8")


class PostgresSamples(PostgresDatabase):
    """Minutes and gaps there."""

    def __init__(self, settings: HistoryDatabase, *, create: bool = True) -> None:
        """Connect, and make the tables where ``create`` says so; else StoreError where they are not there."""
        super().__init__(settings, TABLES, create=create)
        if create:
            return
        with named(settings):
            there = self.connection.execute("SELECT to_regclass('slipjump_sample')").fetchone()
        if there is None or there[0] is None:
            self.close()
            raise StoreError(f"{settings.url}: has no raw samples, see agent.history.database.samples")

    def minutes(self, loop: str, since: float, before: float) -> Iterator[Minute]:
        """Yield the minutes of a loop that begin from ``since`` to before ``before`` (s UTC), by time."""
        with (
            named(self.settings),
            self.connection.transaction(),
            self.connection.cursor("minutes", binary=True) as cursor,
        ):
            cursor.execute(
                "SELECT time, at, mode, quality, op, pv, sp, mv FROM slipjump_sample "
                "WHERE loop = %s AND time >= %s AND time < %s ORDER BY time, number",
                (loop, moment(since), moment(before)),
            )
            for time, at, mode, quality, *columns in cursor:
                yield Minute(
                    loop,
                    time.timestamp(),
                    np.array(at, dtype=np.int32),
                    {r: _masked(c) for r, c in zip(NUMBERS, columns, strict=True) if c is not None},
                    None if mode is None else tuple(mode),
                    None if quality is None else np.array(quality, dtype=np.int16),
                )

    def gaps(self, since: float, before: float) -> tuple[SampleGap, ...]:
        """Return the gaps that overlap that time, of whatever loop."""
        with named(self.settings):
            rows = self.connection.execute(
                "SELECT time, until, minutes FROM slipjump_gap WHERE until >= %s AND time < %s",
                (moment(since), moment(before)),
            ).fetchall()
        return tuple(SampleGap(time.timestamp(), until.timestamp(), count) for time, until, count in rows)

    def take(self, origin: str, minutes: Sequence[NumberedMinute]) -> None:
        """Keep minutes of one file, all or none; those that are there already are left out."""
        self.take_once(origin, minutes, lambda new: self._put(UUID(origin), new))

    def _put(self, origin: UUID, minutes: Sequence[NumberedMinute]) -> None:
        rows: list[tuple[Any, ...]] = []
        gaps: list[tuple[Any, ...]] = []
        for each in minutes:
            match each.content:
                case SampleGap(since, until, missing):
                    gaps.append((moment(since), origin, each.number, moment(until), missing))
                case Minute():
                    rows.append(_row(origin, each.number, each.content))
        self.copy(COPY, TYPES, rows)
        self.copy(COPY_GAPS, GAP_TYPES, gaps)


def _masked(values: Sequence[float | None]) -> np.ma.MaskedArray[tuple[int], np.dtype[np.float32]]:
    """Return values as a minute has them: null was not reported."""
    missing = [value is None for value in values]
    numbers = np.array([0.0 if value is None else value for value in values], dtype=np.float32)
    return np.ma.MaskedArray(numbers, missing)


def _row(origin: UUID, number: int, minute: Minute) -> tuple[Any, ...]:
    modes = minute.mode
    return (
        moment(minute.start),
        origin,
        number,
        clean_text(minute.loop),
        minute.at,
        *(minute.columns.get(role) for role in NUMBERS),
        None if modes is None else [None if each is None else clean_text(each) for each in modes],
        minute.quality,
    )


def samples_forwarder(path: Path, settings: HistoryDatabase) -> Forwarder[NumberedMinute]:
    """Return what sends samples, from the file at ``path``."""
    return Forwarder(
        path,
        settings,
        lambda file: SampleFile(file, create=False),
        PostgresSamples,
        "minutes of samples",
    )
