"""The newest values of one role, at most one a grid point, in a ring that never grows."""

from __future__ import annotations

from enum import Enum
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray

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

    def __init__(self, capacity: int) -> None:
        self._slots = np.full(capacity, NEVER, dtype=np.int64)
        self._values = np.full(capacity, np.nan)
        self._times = np.full(capacity, np.nan)
        self._next = 0
        self._unknown_from: int | None = None
        self.time = -np.inf
        """Source time of the newest value, s UTC."""
        self.first = FOREVER
        """Slot of the first value."""
        self.newest = NEVER
        """Slot of the newest value, ``NEVER`` before the first."""

    @property
    def known(self) -> bool:
        """Whether the newest value is one, and not that it is missing."""
        return bool(np.isfinite(self._values[self._next - 1]))

    def put(self, time: float, slot: int, value: float) -> Taken:
        """Take a value of source time ``time`` (s UTC); what is not newer than the last one is dropped."""
        if time <= self.time:
            # Reported again after an interruption: it has not changed since.
            self._unknown_from = None
            return Taken.DUPLICATE if time == self.time else Taken.BACKWARD
        if self._unknown_from is not None and slot > self._unknown_from:
            self._append(np.nan, self._unknown_from, np.nan)
        self._unknown_from = None
        self.time = time
        self.first = min(self.first, slot)
        self._append(time, slot, value)
        return Taken.NEW

    def interrupt(self, slot: int) -> None:
        """From ``slot`` on the value is unknown until it is reported again."""
        if self._unknown_from is None and self.newest != NEVER:
            self._unknown_from = max(slot, self.newest + 1)

    def column(self, first: int, n: int) -> FloatArray:
        """Values at the slots ``first`` to ``first + n - 1``, NaN where unknown, shape (n,)."""
        wanted = np.arange(first, first + n)
        slots = np.roll(self._slots, -self._next)  # oldest first
        values = np.roll(self._values, -self._next)
        held = np.searchsorted(slots, wanted, side="right") - 1
        column = np.where(held < 0, np.nan, values[held])
        if self._unknown_from is not None:
            column[wanted >= self._unknown_from] = np.nan
        return column

    def times(self) -> FloatArray:
        """Source times of the values it still has, s UTC, oldest first, shape (m,)."""
        times = np.roll(self._times, -self._next)
        return times[np.isfinite(times)]

    def _append(self, time: float, slot: int, value: float) -> None:
        if slot != self.newest:  # faster than the grid: the last one counts
            self._next = (self._next + 1) % len(self._slots)
            self.newest = slot
        self._slots[self._next - 1] = slot
        self._values[self._next - 1] = value
        self._times[self._next - 1] = time
