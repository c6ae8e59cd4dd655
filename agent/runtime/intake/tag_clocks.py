"""How far the clocks behind PV and OP are apart: source time against arrival, each role for itself.

A source that is late with one value is not late with all, so the least delay of the newest values is that of
its clock. Where both clocks keep pace with ours, the difference of these delays is that of the clocks. A
recording that is played fast does not keep pace, and says nothing.
"""

from __future__ import annotations

import math
from array import array
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from agent.runtime.intake.rows import RowTimes

COMPARED = ("pv", "op")
NEWEST = 30
"""Samples of each role that are compared; one set right is believed after as many."""
FEWEST = 5
"""Samples of each from which there is an answer: the first may have waited at its source for hours."""
AT_PACE = 0.5
"""Most by which the source's clock may run faster or slower than ours, as a part of the time that passed."""
SAMPLES, SECONDS = 2.0, 2.0
"""Difference that counts: sampling times, and not less than so many seconds, as a bus takes its time."""


class _Newest:
    """Times of the newest samples of a role, in plain arrays: thousands of loops have them."""

    __slots__ = ("_ahead", "_count", "_times")

    def __init__(self) -> None:
        self._times = array("d", [0.0]) * NEWEST
        self._ahead = array("d", [0.0]) * NEWEST
        """Time less arrival of the same."""
        self._count = 0

    def see(self, time: float, arrival: float) -> None:
        place = self._count % NEWEST
        self._times[place], self._ahead[place] = time, time - arrival
        self._count += 1

    def take(self, times: RowTimes) -> None:
        n = len(times.source)
        self._count += n
        if n >= NEWEST:
            self._times[:], self._ahead[:] = times.newest(NEWEST, self._count % NEWEST)
            return
        places = np.arange(self._count - n, self._count) % NEWEST
        np.frombuffer(self._times)[places] = times.source
        np.frombuffer(self._ahead)[places] = times.ahead

    def offset(self) -> float:
        """Return how far the clock is ahead of this machine's monotonic one, s; NaN where not known."""
        there = min(self._count, NEWEST)
        if there < FEWEST:
            return math.nan
        oldest, newest = (self._count - there) % NEWEST, (self._count - 1) % NEWEST
        ticked = self._times[newest] - self._times[oldest]
        passed = ticked - (self._ahead[newest] - self._ahead[oldest])
        if abs(ticked - passed) > AT_PACE * passed:
            return math.nan
        return max(self._ahead[:there])


class TagClocks:
    """Delays of the newest samples of PV and OP."""

    __slots__ = ("_least", "_seen")

    def __init__(self, ts: float) -> None:
        """Begin without any; ``ts`` is the sampling time, s."""
        self._least = max(SAMPLES * ts, SECONDS)
        self._seen = {role: _Newest() for role in COMPARED}

    def see(self, role: str, time: float, arrival: float) -> None:
        """Take the time of a new value (s UTC) that arrived at ``arrival`` (monotonic, s)."""
        seen = self._seen.get(role)
        if seen is not None:
            seen.see(time, arrival)

    def take(self, role: str, times: RowTimes) -> None:
        """Take the times of many values, as ``see`` does one by one."""
        seen = self._seen.get(role)
        if seen is not None:
            seen.take(times)

    @property
    def apart(self) -> float:
        """How far PV's clock is ahead of OP's, s; 0 where they agree, or where that is not known."""
        ahead, behind = (self._seen[role].offset() for role in COMPARED)
        difference = ahead - behind
        return difference if abs(difference) > self._least else 0.0  # NaN is not
