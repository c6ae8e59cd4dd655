"""Raw samples in PostgreSQL or TimescaleDB: a row a loop and minute, each once, and gaps that are marked."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any
from uuid import UUID

from agent.runtime.samples.minute import NUMBERS, Minute
from agent.runtime.samples.sample_file import NumberedMinute, SampleFile, SampleGap
from agent.runtime.store.forwarder import Forwarder
from agent.runtime.store.postgres import PostgresDatabase, clean_text, moment

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

    def __init__(self, settings: HistoryDatabase) -> None:
        """Connect, and make the tables."""
        super().__init__(settings, TABLES)

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
