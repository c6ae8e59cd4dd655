"""A bus in memory: a script of samples and disasters, played in the time of the event loop."""

import asyncio
from contextlib import asynccontextmanager

from connectors.base import ConnectionLostError


class FakeBus:
    """Each session plays what ``source`` yields: samples, orders, seconds to wait, exceptions to raise."""

    def __init__(self, source, name="bus", *, takes_orders=False):
        self.name = name
        self.takes_orders = takes_orders
        self.source = source
        self.opened = []
        """Loop times at which a session was opened."""
        self.attempts = []
        """Loop times at which one was tried."""
        self.open = 0
        """Sessions open now."""
        self.published = []
        self.refuses_connection = False
        self.publish_fault = None
        self.close_takes = 0.0

    def session(self):
        return self._session()

    @asynccontextmanager
    async def _session(self):
        now = asyncio.get_running_loop().time()
        self.attempts.append(now)
        if self.refuses_connection:
            raise ConnectionLostError("refused")
        self.opened.append(now)
        self.open += 1
        try:
            yield self
        finally:
            self.open -= 1
            await asyncio.sleep(self.close_takes)

    async def samples(self):
        for step in self.source(len(self.opened) - 1):
            if isinstance(step, (int, float)):
                await asyncio.sleep(step)
            elif isinstance(step, BaseException):
                raise step
            else:
                yield step
        await asyncio.Event().wait()

    async def publish(self, publication):
        await asyncio.sleep(0.01)
        if self.publish_fault is not None:
            raise self.publish_fault
        self.published.append(publication)
