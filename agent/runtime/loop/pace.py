"""How often something may begin: a few times at once, and then at a steady pace (token bucket)."""

from __future__ import annotations

LEAST_APART = 1.0
"""Time between two diagnoses of a loop, s. A plant needs minutes for a window; a source whose clock races, or
that sends old and new times in turn, would else have one begin every 0.1 s."""
AT_ONCE = 5
"""Diagnoses that may begin without this distance: after a start, and in a recording that is played fast."""


class Pace:
    """Counts what began."""

    def __init__(self, apart: float = LEAST_APART, at_once: int = AT_ONCE) -> None:
        """Allow ``at_once`` beginnings, and one more every ``apart`` s."""
        self._apart = apart
        self._ahead = (at_once - 1) * apart
        self._next = 0.0
        """When the next would be due if none came early, monotonic, s."""

    def wait(self, now: float) -> float:
        """Return how long to wait at ``now`` (monotonic, s) before the next may begin, s; 0 where it may."""
        return max(self._next - self._ahead - now, 0.0)

    def begin(self, now: float) -> None:
        """Note that one begins at ``now``."""
        self._next = max(self._next, now) + self._apart
