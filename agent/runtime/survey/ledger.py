"""The ledger of a survey: every loop that is done, in an SQLite file, so that a survey can be resumed.

A loop is there with all of its results or not at all, and once: its place is the primary key.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from agent.runtime.store.database import Database, Format
from connectors.base import ConfigError

if TYPE_CHECKING:
    from pathlib import Path

TABLES = """
CREATE TABLE archive (name TEXT NOT NULL);
CREATE TABLE loop (
    recording TEXT NOT NULL,
    loop TEXT NOT NULL,
    stamp TEXT NOT NULL,
    row TEXT NOT NULL,
    finding TEXT NOT NULL,
    PRIMARY KEY (recording, loop)
) WITHOUT ROWID;
"""
"""``stamp``: of all on which the result depends. ``row`` and ``finding`` are JSON."""
FORMAT = Format(application=0x736C6A73, version=1, tables=TABLES, synchronous="NORMAL")
"""The application is "sljs". A power failure may undo the last loops: they are done again."""
WANTED = "CREATE TEMP TABLE wanted (place INTEGER PRIMARY KEY, recording TEXT, loop TEXT, stamp TEXT)"
JOINED = (
    "FROM wanted JOIN loop ON loop.recording = wanted.recording AND loop.loop = wanted.loop "
    "AND loop.stamp = wanted.stamp ORDER BY wanted.place"
)


@dataclass(frozen=True, slots=True)
class LoopKey:
    """One loop of an archive."""

    recording: str
    """Path within the archive, or address."""
    loop: str
    stamp: str
    """A result with another stamp is out of date."""


class Ledger:
    """An open ledger. Each method raises StoreError where the file fails."""

    def __init__(self, path: Path, archive: Sequence[str]) -> None:
        """Open it, or make it.

        Args:
            path: Of the file.
            archive: What is surveyed.

        Raises:
            ConfigError: It holds the survey of another archive.
        """
        self._database = Database(path, FORMAT)
        name = "\n".join(archive)
        with self._database.transaction("IMMEDIATE") as database:
            held = database.execute("SELECT name FROM archive").fetchone()
            if held is None:
                database.execute("INSERT INTO archive VALUES (?)", (name,))
            database.execute(WANTED)
        if held is not None and held[0] != name:
            self.close()
            other = held[0].replace("\n", " ")
            raise ConfigError([f"{path.parent}: holds the survey of {other}: name another folder"])

    def close(self) -> None:
        """Let go of the file."""
        self._database.close()

    def plan(self, places: Iterable[LoopKey]) -> None:
        """Set which loops are there to be done; results of others stay and do not count."""
        with self._database.transaction("IMMEDIATE") as database:
            database.execute("DELETE FROM wanted")
            rows = ((each.recording, each.loop, each.stamp) for each in places)
            database.executemany("INSERT INTO wanted (recording, loop, stamp) VALUES (?, ?, ?)", rows)

    def done(self) -> set[tuple[str, str]]:
        """Return recording and loop of the planned ones that are done."""
        with self._database.reading() as database:
            return set(database.execute(f"SELECT loop.recording, loop.loop {JOINED}"))

    def write(self, place: LoopKey, row: dict[str, object], finding: dict[str, object]) -> None:
        """Keep the result of one loop."""
        values = (place.recording, place.loop, place.stamp, _text(row), _text(finding))
        with self._database.transaction("IMMEDIATE") as database:
            database.execute("INSERT OR REPLACE INTO loop VALUES (?, ?, ?, ?, ?)", values)

    def rows(self) -> Iterator[dict[str, Any]]:
        """Yield the results of the planned loops, in the order of the plan, one at a time from disk."""
        yield from self._column("row")

    def findings(self) -> Iterator[dict[str, Any]]:
        """Yield what the ranking needs of them, in the same order."""
        yield from self._column("finding")

    def _column(self, name: str) -> Iterator[dict[str, Any]]:
        with self._database.reading() as database:
            for (text,) in database.execute(f"SELECT loop.{name} {JOINED}"):
                yield json.loads(text)


def _text(content: dict[str, object]) -> str:
    return json.dumps(content, allow_nan=False)
