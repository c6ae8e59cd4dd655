"""Whose turn it is: a few places, many calculations; looks first, and of the fits the one that is worth most.

A first look at a window is quick and is never held up by fits, however many wait: where there is too much to
do, fits are what is not done. They have at least the ``PATIENCE``-th part of the time, so an alarm comes
also then. Of several that wait, the next one has the highest response ratio, ``1 + waited / expected``
(P. Brinch Hansen, "Short-term scheduling in multiprogramming systems", SOSP 1971), times the worth of its
answer: it grows as it waits, so whoever waits is served.
"""

from __future__ import annotations

import asyncio
from collections import deque
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import dataclass

PATIENCE = 20.0
"""Seconds that a fit lets looks pass for each second that it takes itself."""
LONGEST_PATIENCE = 300.0
"""Longest time for which looks may pass, s: also a loop with slow fits has its alarm."""
SLOW = 1.0
"""Time from which a fit is slow, s. Where there are several places, one is never given to those."""


@dataclass(eq=False, slots=True)
class _Waiting:
    expected: float
    worth: float
    since: float
    granted: asyncio.Future[None]

    @property
    def slow(self) -> bool:
        return self.expected >= SLOW

    def urgency(self, now: float) -> float:
        return self.worth * (1 + (now - self.since) / self.expected)


class Turns:
    """Places for so many calculations at a time."""

    def __init__(self, places: int) -> None:
        self._free = places
        self._free_for_slow = max(places - 1, 1)
        self._looks: deque[_Waiting] = deque()
        self._fits: list[_Waiting] = []
        self._fit_from = 0.0
        """When a fit may pass looks again, s of the event loop's clock."""

    @property
    def waiting(self) -> int:
        """Calculations that wait for their turn."""
        return len(self._looks) + len(self._fits)

    @asynccontextmanager
    async def turn(self, expected: float, worth: float = 1.0) -> AsyncIterator[None]:
        """Wait for a place and hold it.

        Args:
            expected: Time that a fit should take, s; 0 for a look, or whatever is quick.
            worth: Of its answer, over that of a usual one, > 0.
        """
        clock = asyncio.get_running_loop()
        mine = _Waiting(expected, worth, clock.time(), clock.create_future())
        waiting: deque[_Waiting] | list[_Waiting] = self._fits if expected > 0 else self._looks
        waiting.append(mine)
        self._grant()
        try:
            await mine.granted
            yield
        finally:
            if mine.granted.done() and not mine.granted.cancelled():
                self._free += 1
                self._free_for_slow += mine.slow
            elif mine in waiting:
                waiting.remove(mine)
            self._grant()

    def _grant(self) -> None:
        """Give the places that are free."""
        now = asyncio.get_running_loop().time()
        while self._free:
            while self._looks and self._looks[0].granted.done():  # nobody waits for it any more
                self._looks.popleft()
            fit = None if self._looks and now < self._fit_from else self._next_fit(now)
            if fit is not None and (not self._looks or _was_patient(fit, now)):
                self._fits.remove(fit)
                self._fit_from = now + _patience(fit)
                given = fit
            elif self._looks:
                given = self._looks.popleft()
            else:
                return
            self._free -= 1
            self._free_for_slow -= given.slow
            given.granted.set_result(None)

    def _next_fit(self, now: float) -> _Waiting | None:
        """Return the most urgent fit for which there is a place."""
        wait = (each for each in self._fits if not each.granted.done())
        may = (each for each in wait if self._free_for_slow or not each.slow)
        return max(may, key=lambda each: each.urgency(now), default=None)


def _patience(fit: _Waiting) -> float:
    return min(PATIENCE * fit.expected, LONGEST_PATIENCE)


def _was_patient(fit: _Waiting, now: float) -> bool:
    return now >= fit.since + _patience(fit)
