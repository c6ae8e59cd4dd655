"""How far the clocks behind PV and OP are apart: source time against arrival, each role for itself.

A source that is late with one value is not late with all, so the least delay of the newest values is that of
its clock. Where both clocks keep pace with ours, the difference of these delays is that of the clocks. A
recording that is played fast does not keep pace, and says nothing.
"""

from __future__ import annotations

import math
from collections import deque

COMPARED = ("pv", "op")
NEWEST = 30
"""Samples of each role that are compared; one set right is believed after as many."""
FEWEST = 5
"""Samples of each from which there is an answer: the first may have waited at its source for hours."""
AT_PACE = 0.5
"""Most by which the source's clock may run faster or slower than ours, as a part of the time that passed."""
SAMPLES, SECONDS = 2.0, 2.0
"""Difference that counts: sampling times, and not less than so many seconds, as a bus takes its time."""


class TagClocks:
    """Delays of the newest samples of PV and OP."""

    def __init__(self, ts: float) -> None:
        """Begin without any; ``ts`` is the sampling time, s."""
        self._least = max(SAMPLES * ts, SECONDS)
        self._seen: dict[str, deque[tuple[float, float]]] = {role: deque(maxlen=NEWEST) for role in COMPARED}
        self._ahead: dict[str, deque[float]] = {role: deque(maxlen=NEWEST) for role in COMPARED}
        """Time less arrival of the same; every look at a plant takes the largest of each loop."""

    def see(self, role: str, time: float, arrival: float) -> None:
        """Take the time of a new value (s UTC) that arrived at ``arrival`` (monotonic, s)."""
        if role in self._seen:
            self._seen[role].append((time, arrival))
            self._ahead[role].append(time - arrival)

    @property
    def apart(self) -> float:
        """How far PV's clock is ahead of OP's, s; 0 where they agree, or where that is not known."""
        ahead, behind = (self._offset(role) for role in COMPARED)
        difference = ahead - behind
        return difference if abs(difference) > self._least else 0.0  # NaN is not

    def _offset(self, role: str) -> float:
        """Return how far a role's clock is ahead of this machine's monotonic one, s; NaN where not known."""
        seen = self._seen[role]
        if len(seen) < FEWEST:
            return math.nan
        ticked, passed = seen[-1][0] - seen[0][0], seen[-1][1] - seen[0][1]
        if abs(ticked - passed) > AT_PACE * passed:
            return math.nan
        return max(self._ahead[role])
