"""The file in which minutes of samples wait for the database; where it is full, a gap is marked."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from agent.runtime.samples.minute import Minute, OpenMinute
from agent.runtime.store.database import Database, Format

TABLES = """
CREATE TABLE sample (
    number INTEGER PRIMARY KEY AUTOINCREMENT,
    loop TEXT NOT NULL,
    start REAL NOT NULL,
    until REAL NOT NULL,
    missing INTEGER NOT NULL,
    content BLOB NOT NULL
);
"""
"""A row is a minute, or, where ``missing`` is not 0, stands for that many minutes that were dropped."""
FORMAT = Format(application=0x736C6A73, version=1, tables=TABLES, synchronous="NORMAL")
"""The application is "sljs"."""
AT_ONCE = 0.05
"""Part of the minutes that goes where the file is too large."""


@dataclass(frozen=True, slots=True)
class SampleGap:
    """Minutes that were dropped; all loops may be concerned."""

    since: float
    """Start of the first, s UTC."""
    until: float
    """Start of the last, s UTC."""
    minutes: int
    """Minutes of loops."""


@dataclass(frozen=True, slots=True)
class NumberedMinute:
    """A minute, or a gap, with its place in the file."""

    number: int
    content: Minute | SampleGap


def samples_path(state: Path) -> Path:
    """Return the path of the samples of the agent that keeps its alarms in ``state``."""
    return state.with_suffix(".samples.sqlite")


class SampleFile:
    """An open file. Each method raises StoreError where it fails. To be used from one thread only."""

    def __init__(self, path: Path, *, create: bool = True) -> None:
        """Open ``path``; without ``create`` one that is there, unchecked."""
        self._database = Database(path, FORMAT, create=create, check=create)

    def close(self) -> None:
        """Let go of the file."""
        self._database.close()

    def is_gone(self) -> bool:
        """Return whether the file was removed or replaced since it was opened."""
        return self._database.is_gone()

    def write(self, minutes: Sequence[OpenMinute], gap: SampleGap | None) -> None:
        """Add minutes, all or none, behind a gap in which others were lost."""
        rows = [
            (each.loop, each.start, each.start, 0, each.packed())
            for each in (minute.table() for minute in minutes)
        ]
        if gap is not None:
            rows.insert(0, ("", gap.since, gap.until, gap.minutes, b""))
        with self._database.transaction("IMMEDIATE") as database:
            database.executemany(
                "INSERT INTO sample (loop, start, until, missing, content) VALUES (?, ?, ?, ?, ?)", rows
            )

    def forget(self, max_bytes: float) -> None:
        """While the file is too large, put one gap in place of the oldest minutes."""
        while self._database.used() > max_bytes:
            with self._database.transaction("IMMEDIATE") as database:
                count = database.execute("SELECT count(*) FROM sample").fetchone()[0]
                if count <= 1:
                    break
                last, since, until, missing = database.execute(
                    "SELECT max(number), min(start), max(until), sum(max(missing, 1)) "
                    "FROM (SELECT * FROM sample ORDER BY number LIMIT ?)",
                    (max(2, int(AT_ONCE * count)),),
                ).fetchone()
                database.execute("DELETE FROM sample WHERE number <= ?", (last,))
                database.execute(
                    "INSERT INTO sample VALUES (?, '', ?, ?, ?, x'')", (last, since, until, missing)
                )
        self._database.give_back()

    def origin(self) -> str:
        """Return the identity of this file: its numbers mean nothing in another one."""
        return self._database.origin()

    def after(self, number: int, limit: int) -> tuple[NumberedMinute, ...]:
        """Return the next minutes and gaps behind a number, in the order of their writing."""
        with self._database.transaction("DEFERRED") as database:
            rows = database.execute(
                "SELECT * FROM sample WHERE number > ? ORDER BY number LIMIT ?", (number, limit)
            ).fetchall()
        return tuple(
            NumberedMinute(
                place,
                SampleGap(start, until, missing) if missing else Minute.unpacked(loop, start, content),
            )
            for place, loop, start, until, missing, content in rows
        )

    def minutes(self, loop: str, since: float, before: float) -> Iterator[Minute]:
        """Yield the minutes of a loop that begin from ``since`` to before ``before`` (s UTC), by time."""
        with self._database.transaction("DEFERRED") as database:
            rows = database.execute(
                "SELECT start, content FROM sample WHERE missing = 0 AND loop = ? "
                "AND start >= ? AND start < ? ORDER BY start, number",
                (loop, since, before),
            ).fetchall()
        for start, content in rows:
            yield Minute.unpacked(loop, start, content)

    def gaps(self, since: float, before: float) -> tuple[SampleGap, ...]:
        """Return the gaps that overlap that time, of whatever loop."""
        with self._database.transaction("DEFERRED") as database:
            rows = database.execute(
                "SELECT start, until, missing FROM sample WHERE missing > 0 AND until >= ? AND start < ?",
                (since, before),
            ).fetchall()
        return tuple(SampleGap(*row) for row in rows)

    def lost(self, _: int, rows: Sequence[NumberedMinute]) -> int:
        """Return how many minutes the gaps in rows stand for."""
        return sum(each.content.minutes for each in rows if isinstance(each.content, SampleGap))

    def delivered(self, number: int) -> None:
        """Drop what the database has; numbers go on rising."""
        with self._database.transaction("IMMEDIATE") as database:
            database.execute("DELETE FROM sample WHERE number <= ?", (number,))
