"""The newest values of one role, one for each point of the grid, in a ring that never grows.

A value is a float of 32 bits, as controllers and field buses have it, and when it was reported is a byte:
five bytes a sample. Ten thousand loops with an hour of three roles at 1 Hz so need 560 MB (decision 70).
"""

from __future__ import annotations

import math
from array import array
from enum import Enum
from typing import TYPE_CHECKING

import numpy as np

from agent.runtime.intake.rows import FINE, HELD

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from agent.runtime.intake.rows import GridPlaces

NEVER = int(np.iinfo(np.int64).min)
"""Slot of a value that is older than all."""
FOREVER = int(np.iinfo(np.int64).max)
"""Slot of a value that is still to come."""


class Taken(Enum):
    """What became of a value."""

    NEW = "new"
    DUPLICATE = "duplicate"
    BACKWARD = "backward"


class SlotRing:
    """Values of one role by slot, the number of their point on the grid. A value holds until the next one.

    A bus that reports changes only sends nothing while a value stays the same, so silence is not a gap. It
    is one after ``interrupt``: whether the value is the same is then unknown until it is reported again.
    """

    __slots__ = (
        "_before",
        "_capacity",
        "_reports",
        "_unknown_from",
        "_values",
        "first",
        "newest",
        "time",
    )

    def __init__(self, capacity: int) -> None:
        self._capacity = capacity
        self._values = array("f", [math.nan]) * capacity
        """That which holds at each slot, at ``slot % capacity``."""
        self._reports = array("b", [HELD]) * capacity
        """When a value was reported, from its slot, in parts of a sampling time; else ``HELD``."""
        self._before: int | None = None
        """When the newest one was reported that the ring has no room for, as in ``reports``."""
        self._unknown_from: int | None = None
        self.time = -math.inf
        """Source time of the newest value, s UTC."""
        self.first = FOREVER
        """Slot of the first value."""
        self.newest = NEVER
        """Slot of the newest value, ``NEVER`` before the first."""

    @property
    def known(self) -> bool:
        """Whether the newest value is one, and not that it is missing."""
        return math.isfinite(self._values[self.newest % self._capacity])

    def put(self, time: float, place: float, value: float) -> Taken:
        """Take a value; what is not newer than the last one is dropped.

        Args:
            time: Source time, s UTC.
            place: The same on the grid, sampling times from slot 0.
            value: NaN where it is missing.
        """
        if time <= self.time:
            # Reported again after an interruption: it has not changed since.
            self._unknown_from = None
            return Taken.DUPLICATE if time == self.time else Taken.BACKWARD
        slot = round(place)
        if self._unknown_from is not None:
            if slot > self._unknown_from:
                self._append(self._unknown_from, math.nan, HELD)
            self._unknown_from = None
        self.time = time
        self.first = min(self.first, slot)
        self._append(slot, value, round((place - slot) * FINE))
        return Taken.NEW

    def can_take(self, places: GridPlaces) -> bool:
        """Whether ``take`` does what ``put`` would do with each: all are newer, nothing is interrupted."""
        return (
            self._unknown_from is None
            and self.newest != NEVER
            and places.earliest > self.time
            and places.last - self.newest < self._capacity
        )

    def take(self, places: GridPlaces, values: NDArray[np.float32]) -> None:
        """Take values at places for which ``can_take`` holds; (1 + n,), the first of any value."""
        source, reports, at, added = places.filled(self.newest, self._capacity)
        values[0] = self._values[self.newest % self._capacity]
        told = np.frombuffer(self._reports, np.int8)
        over = (told[at[len(at) - added :]] != HELD).nonzero()[0]
        if over.size:
            slot = self.newest + 1 + int(over[-1])
            self._before = (slot - self._capacity) * FINE + int(told[slot % self._capacity])
        np.frombuffer(self._values, np.float32)[at] = values[source]
        told[at] = reports
        self.time, self.newest = places.latest, places.last

    def interrupt(self, slot: int) -> None:
        """From ``slot`` on the value is unknown until it is reported again."""
        if self._unknown_from is None and self.newest != NEVER:
            self._unknown_from = max(slot, self.newest + 1)

    def column(self, first: int, n: int) -> NDArray[np.float32]:
        """Values at the slots ``first`` to ``first + n - 1``, NaN where unknown, shape (n,)."""
        column = np.full(n, np.nan, dtype=np.float32)
        if self.newest == NEVER:
            return column
        values = np.frombuffer(self._values, dtype=np.float32)
        begin, end = max(first, self.newest - self._capacity + 1), min(first + n, self.newest + 1)
        if begin < end:
            column[begin - first : end - first] = values[np.arange(begin, end) % self._capacity]
        column[max(self.newest + 1 - first, 0) :] = values[self.newest % self._capacity]
        if self._unknown_from is not None:
            column[max(self._unknown_from - first, 0) :] = np.nan
        return column

    def reports(self) -> NDArray[np.int64]:
        """Return when values were reported, oldest first, (m,): parts of a sampling time from slot 0.

        Those of the values that it still has, and the newest before.
        """
        kept = self._reports_in(self.newest - self._capacity + 1, self.newest + 1)
        return kept if self._before is None else np.concatenate([[self._before], kept])

    def _reports_in(self, begin: int, end: int) -> NDArray[np.int64]:
        """Return when the values at the slots ``begin`` to ``end - 1`` were reported, oldest first, (m,)."""
        if self.newest == NEVER:
            return np.empty(0, dtype=np.int64)
        slots = np.arange(begin, end)
        parts = np.frombuffer(self._reports, dtype=np.int8)[slots % self._capacity]
        there = parts != HELD
        return np.asarray(slots[there] * FINE + parts[there], dtype=np.int64)

    def _append(self, slot: int, value: float, report: int) -> None:
        place = slot % self._capacity
        if slot != self.newest:  # else faster than the grid: the last one counts
            if slot != self.newest + 1 and self.newest != NEVER:
                self._hold_until(slot)
            if self._reports[place] != HELD:
                self._before = (slot - self._capacity) * FINE + self._reports[place]
        self._values[place], self._reports[place] = value, report
        self.newest = slot

    def _hold_until(self, slot: int) -> None:
        """Hold the newest value at all slots before this one."""
        oldest = self.newest - self._capacity + 1
        gone = self._reports_in(oldest, min(slot - self._capacity, self.newest + 1))
        if gone.size:
            self._before = int(gone[-1])
        places = np.arange(max(self.newest + 1, slot - self._capacity), slot) % self._capacity
        np.frombuffer(self._values, dtype=np.float32)[places] = self._values[self.newest % self._capacity]
        np.frombuffer(self._reports, dtype=np.int8)[places] = HELD
