"""Whose turn it is: a few places, many calculations, the quick ones first and of the slow ones the worthiest.

Each that waits has a deadline: now, plus ``PATIENCE`` times what it should take, less where its answer is
worth more than a usual one and more where it is worth less, at most ``LONGEST_PATIENCE``; the earliest goes
next. So windows without a fit pass those whose fit is slow, and no loop whose answer is a usual one has more
than the ``PATIENCE``-th part of a place while others wait. A deadline never moves, so whatever waits is
served: nothing that comes later than it passes it (earliest deadline first; Liu and Layland, J. ACM 20(1),
1973).
"""

from __future__ import annotations

import asyncio
import heapq
import itertools
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import dataclass, field

PATIENCE = 20.0
"""Seconds that a calculation lets others pass for each second that it takes itself."""
LONGEST_PATIENCE = 300.0
"""Longest time for which others may pass, s: also a loop with slow fits has its alarm."""
SLOW = 1.0
"""Time from which a calculation is slow, s. Where there are several places, one is never given to those."""


@dataclass(order=True, slots=True)
class _Waiting:
    deadline: float
    number: int
    slow: bool = field(compare=False)
    granted: asyncio.Future[None] = field(compare=False)


class Turns:
    """Places for so many calculations at a time."""

    def __init__(self, places: int) -> None:
        self._free = places
        self._free_for_slow = max(places - 1, 1)
        self._number = itertools.count()
        self._waiting: list[_Waiting] = []

    @property
    def waiting(self) -> int:
        """Calculations that wait for their turn."""
        return sum(not each.granted.done() for each in self._waiting)

    @asynccontextmanager
    async def turn(self, expected: float, worth: float = 1.0) -> AsyncIterator[None]:
        """Wait for a place and hold it.

        Args:
            expected: Time that the calculation should take, s.
            worth: Of its answer, over that of a usual one, > 0.
        """
        clock = asyncio.get_running_loop()
        deadline = clock.time() + min(PATIENCE * expected / worth, LONGEST_PATIENCE)
        mine = _Waiting(deadline, next(self._number), expected >= SLOW, clock.create_future())
        heapq.heappush(self._waiting, mine)
        self._grant()
        try:
            await mine.granted
            yield
        finally:
            if mine.granted.done() and not mine.granted.cancelled():
                self._free += 1
                self._free_for_slow += mine.slow
            self._grant()

    def _grant(self) -> None:
        """Give the places that are free to those whose deadline is the earliest."""
        passed: list[_Waiting] = []
        while self._free and self._waiting:
            first = heapq.heappop(self._waiting)
            if first.granted.done():  # nobody waits for it any more
                continue
            if first.slow and not self._free_for_slow:
                passed.append(first)
                continue
            self._free -= 1
            self._free_for_slow -= first.slow
            first.granted.set_result(None)
        for each in passed:
            heapq.heappush(self._waiting, each)
