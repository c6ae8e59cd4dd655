"""Readings of neighbouring loops that wait, so that the loops take them in many rows at once.

They wait until there are ``ROWS``, until a window of one of the loops may be due, or until anybody looks at
one. Nothing that is seen of a loop depends on it: where a row needs a look of its own, its values are taken
one by one.
"""

from __future__ import annotations

import math
from array import array
from dataclasses import dataclass
from itertools import groupby
from typing import TYPE_CHECKING

import numpy as np

from agent.runtime.intake.rows import RowTimes, ValueRows, short_of
from connectors.base import Sample

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from agent.runtime.intake.intake import Intake
    from connectors.base import LoopRole
    from connectors.readings import Readings

ROWS = 60
"""Readings that wait at most: what an array costs is then shared by as many values, and memory is small."""
FEW = 4
"""Readings that are taken in value by value all the same: arrays cost more than so many of them."""
SPREAD = 30
"""By how many less than that some settle: thousands of loops that began together must not settle together."""


@dataclass(frozen=True, slots=True)
class LoopColumns:
    """What is one loop's of readings."""

    intake: Intake
    tags: tuple[LoopRole, ...]
    roles: tuple[str, ...]
    columns: slice


class Gathering:
    """Readings with the same tags that wait."""

    def __init__(self, tags: tuple[LoopRole, ...], parts: Sequence[LoopColumns], number: int = 0) -> None:
        """Make it of the tags and what each loop has of them, as the one of this number."""
        self.tags = tags
        self._parts = parts
        self._most = ROWS - number % SPREAD
        self._longest = min((part.intake.longest_wait for part in parts), default=math.inf)
        self._times, self._arrivals, self._values = array("d"), array("d"), array("d")
        """Of readings that wait: source times (s UTC), arrivals (monotonic, s), values; 40 bytes for 3."""
        self._settles = -math.inf
        """Source time from which readings are taken in at once, s UTC: a window may be due."""

    def put(self, readings: Readings, arrival: float) -> None:
        """Take readings that arrived at ``arrival`` (monotonic, s).

        A loop may have others, of other roles: what came before comes first.
        """
        for part in self._parts:
            if part.intake.gathering is not self:
                part.intake.settle()
                part.intake.gathering = self
                self.hurry()
        self._times.append(readings.time)
        self._arrivals.append(arrival)
        self._values.frombytes(readings.values.tobytes())
        late = arrival - self._arrivals[0] >= self._longest
        if readings.time >= self._settles or len(self._times) >= self._most or late:
            self.settle()

    def settle(self) -> None:
        """Have the loops take in what waits."""
        if not self._times:
            return
        times = RowTimes(np.array(self._times), np.array(self._arrivals))
        values = np.array(self._values).reshape(len(times.source), -1).T
        for each in (self._times, self._arrivals, self._values):
            del each[:]
        finite = np.isfinite(values).all(axis=1).tolist()
        short = short_of(values)
        few = len(times.source) < FEW
        for part in self._parts:
            rows = ValueRows(part.roles, times, values[part.columns], short[part.columns])
            plain = not few and times.increasing and all(finite[part.columns])
            if not (plain and part.intake.take(rows)):
                _one_by_one(part, rows)
        self._settles = min((part.intake.window.due_from for part in self._parts), default=math.inf)

    def hurry(self) -> None:
        """Take the next readings in at once: something else came of one of the loops."""
        self._settles = -math.inf


class Gatherings:
    """Gives readings to the loops that they are of."""

    def __init__(self, intake_of: Callable[[str], Intake | None]) -> None:
        """Make it for loops, by name; ``end`` before one of them is replaced."""
        self._intake_of = intake_of
        self._known: dict[int, Gathering] = {}
        """By the ``id`` of its tags, which it keeps, so that no others get the same."""

    def put(self, readings: Readings, arrival: float) -> None:
        """Take what arrived at ``arrival`` (monotonic, s)."""
        known = self._known.get(id(readings.tags))
        if known is None:
            known = self._known[id(readings.tags)] = self._begun(readings.tags)
        known.put(readings, arrival)

    def end(self) -> None:
        """Have all taken in and begin anew: loops are replaced, or a session ended and its tags with it."""
        for gathering in self._known.values():
            gathering.settle()
        self._known.clear()

    def _begun(self, tags: tuple[LoopRole, ...]) -> Gathering:
        parts: list[LoopColumns] = []
        first = 0
        for loop, each in groupby(tags, key=lambda tag: tag.loop):
            own = tuple(each)
            columns = slice(first, first + len(own))
            first = columns.stop
            intake = self._intake_of(loop)
            if intake is not None:
                parts.append(LoopColumns(intake, own, tuple(tag.role for tag in own), columns))
        return Gathering(tags, parts, len(self._known))


def _one_by_one(part: LoopColumns, rows: ValueRows) -> None:
    columns = (each.tolist() for each in (rows.times.source, rows.times.arrivals, rows.values.T))
    for time, arrival, values in zip(*columns, strict=True):
        for tag, value in zip(part.tags, values, strict=True):
            part.intake.push_one(Sample.measured(tag, time, value), arrival)
