"""Plays plants or recordings on a bus, in time order, and never faster than their reader takes them."""

from __future__ import annotations

import asyncio
import heapq
import logging
import math
from collections import deque
from collections.abc import Callable, Iterator, Sequence

from connectors.cancellation import obey_cancellation
from simulators.clock import Clock
from simulators.plant import Row
from simulators.servers.loop_server import LoopServer
from simulators.source import Source

_LOG = logging.getLogger(__name__)
_FIRST_WAIT = 30.0
"""Longest wait for the reader to take the first row: it may still have to connect, s."""
_WAIT = 5.0
"""Longest wait for it to take any other, s."""
_LOOK = 0.001
"""Time between two looks at what the reader has, s."""

Seen = Callable[[str], float | None]
"""Newest source time that the reader has of a loop, s UTC; None: nothing yet."""


async def play(sources: Sequence[Source], server: LoopServer, clock: Clock, seen: Seen | None = None) -> None:
    """Put all rows of all sources on the server, in step with the clock, each source from its own start.

    With ``seen``, no row is put while more than ``server.lead`` rows of its loop wait for the reader, and the
    last rows are waited for as well. After 5 s without progress of the reader the next row is put and a
    warning is logged.
    """
    readers = {
        source.loop: UnreadRows(source.loop, server.lead, seen) for source in sources if seen is not None
    }
    for elapsed, loop, row in _in_time_order(sources):
        await clock.wait_until(elapsed)
        if loop in readers:
            await readers[loop].ready()
        await server.put(loop, row)
        obey_cancellation()
        if loop in readers:
            readers[loop].put(row.time)
    for reader in readers.values():
        await reader.finished()
        if reader.slips:
            _LOG.warning("%s: the reader was too slow %d times", reader.loop, reader.slips)


class UnreadRows:
    """The rows of one loop that its reader has not yet taken."""

    def __init__(self, loop: str, lead: int, seen: Seen) -> None:
        self.loop = loop
        self.slips = 0
        self._lead = lead
        self._seen = seen
        self._waiting: deque[float] = deque()
        self._started = False

    def put(self, time: float) -> None:
        """Note that a row of this source time (s UTC) is out."""
        self._waiting.append(time)

    async def ready(self) -> None:
        """Return when the next row may go out: after the first row, only when the reader has begun."""
        await self._until(self._lead if self._started else 0)

    async def finished(self) -> None:
        """Return when the reader has all."""
        await self._until(0)

    async def _until(self, most: int) -> None:
        clock = asyncio.get_running_loop()
        deadline = clock.time() + (_WAIT if self._started else _FIRST_WAIT)
        while self._left() > most:
            if clock.time() > deadline:
                self._waiting.clear()
                self.slips += 1
                break
            await asyncio.sleep(_LOOK)
        self._started = self._started or self._seen(self.loop) is not None

    def _left(self) -> int:
        newest = self._seen(self.loop)
        while self._waiting and newest is not None and self._waiting[0] <= newest:
            self._waiting.popleft()
        return len(self._waiting)


def _in_time_order(sources: Sequence[Source]) -> Iterator[tuple[float, str, Row]]:
    """Merge the rows of all sources by the time since each one's first row, s."""
    return heapq.merge(*(_elapsed(source) for source in sources), key=lambda item: item[0])


def _elapsed(source: Source) -> Iterator[tuple[float, str, Row]]:
    start = math.nan
    for row in source.rows():
        start = row.time if math.isnan(start) else start
        yield row.time - start, source.loop, row
