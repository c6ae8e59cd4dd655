"""One connection: open, read, publish, and detect a peer that is silently dead."""

from __future__ import annotations

import asyncio
import logging
import sys
from collections import deque
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import AbstractAsyncContextManager, asynccontextmanager

from agent.runtime.link.outbox import Outbox
from agent.runtime.link.silence import unless_silent
from agent.runtime.supervisor import MARGIN, Health
from connectors.base import (
    ConnectionLostError,
    Connector,
    CountsLost,
    CountsMalformed,
    OpensSlowly,
    Order,
    Publication,
    RefusedError,
    Sample,
    Session,
)
from connectors.cancellation import obey_cancellation
from connectors.readings import Readings, incoming

LOG = logging.getLogger(__name__)
OPEN_WITHIN = 30.0
"""s; connectors have shorter limits of their own, this one is for those that exceed them."""
PUBLISH_WITHIN = 30.0
"""s; likewise."""
SIGNS_APART = 0.01
"""Time within which samples count as one sign of life, s: thousands come a second."""
CLOSE_WITHIN = 2.0
"""s; a peer that does not answer must not delay the end of the program."""


class Connection:
    """A connector in use. ``attempt`` is one session; the supervisor starts the next."""

    def __init__(
        self,
        connector: Connector,
        outbox: Outbox,
        deliver: Callable[[Sample | Readings], None] | None,
        interrupted: Callable[[], None],
        data_age: float,
        obey: Callable[[Order], Awaitable[None]] | None = None,
    ) -> None:
        """Make a connection.

        Args:
            connector: The bus.
            outbox: Publications for it.
            deliver: Takes each sample, or readings; None where nothing is read from this connection.
            interrupted: Called when a session ends, as samples may be lost from then on.
            data_age: Time without a sample after which the peer counts as gone, s.
            obey: Executes an order; None where this connection takes no orders.
        """
        self.health = Health(f"connection {connector.name}", about={"connection": connector.name})
        self._connector = connector
        self._outbox = outbox
        self._deliver = deliver
        self._obey = obey
        self._interrupted = interrupted
        self._data_age = data_age
        self._malformed_before = 0
        self._lost_before = 0
        self._works = False
        """Whether the peer sent or accepted anything in this session."""
        self._under_way: Publication | None = None
        """What the peer was given and has not answered."""

    def count_on(self, former: Connection) -> None:
        """Continue the counters of the connection that this one replaces."""
        self.health.count_on(former.health)
        self._malformed_before = former.malformed
        self._lost_before = former.lost

    @property
    def malformed(self) -> int:
        """Messages that could not be read since the start; 0 on buses that do not count them."""
        now = self._connector.malformed if isinstance(self._connector, CountsMalformed) else 0
        return self._malformed_before + now

    @property
    def lost(self) -> int:
        """Messages that were discarded before they were read, since the start; 0 on buses without a queue."""
        now = self._connector.lost if isinstance(self._connector, CountsLost) else 0
        return self._lost_before + now

    async def attempt(self) -> None:
        """Open a fresh session and use it until it fails."""
        name = self._connector.name
        self._works, self._under_way = False, None
        within = OPEN_WITHIN
        if isinstance(self._connector, OpensSlowly):
            within = max(within, self._connector.opens_within)
        self.health.expect("open", within + MARGIN)
        try:
            async with _opened(self._connector.session(), within) as session, asyncio.TaskGroup() as tasks:
                self.health.expect("open", None)
                tasks.create_task(self._publish(session), name=f"publish {name}")
                if self._deliver is None:
                    self.health.works()
                if self._deliver is not None or self._obey is not None:
                    tasks.create_task(self._read(session, self._deliver), name=f"read {name}")
        except* ConnectionLostError:
            # The reader may have noticed it first, and ended the publisher.
            if self._under_way is not None:
                self._outbox.hung_up(self._under_way, works=self._works)
            raise
        finally:
            self._interrupted()

    async def _read(self, session: Session, deliver: Callable[[Sample | Readings], None] | None) -> None:
        """Deliver samples and orders. Orders are no sign of life: people may send none for months."""
        self._expect_data()
        clock, again = asyncio.get_running_loop(), 0.0
        try:
            async with unless_silent(None if deliver is None else self._data_age) as sign_of_life:
                async for each in incoming(session):
                    if isinstance(each, Order):
                        if self._obey is not None:
                            await self._obey(each)
                    elif deliver is not None:
                        if clock.time() >= again:
                            again = clock.time() + SIGNS_APART
                            sign_of_life()
                            self._expect_data()
                            self.health.works()
                            self._works = True
                        deliver(each)
                    obey_cancellation()
        except TimeoutError as error:
            raise ConnectionLostError(f"no data for {self._data_age:g} s") from error
        raise ConnectionLostError("the stream of samples ended")

    def _expect_data(self) -> None:
        if self._deliver is not None:
            self.health.expect("data", self._data_age + MARGIN)

    async def _publish(self, session: Session) -> None:
        refusals, again = self._outbox.refusals, deque(self._outbox.published())
        while True:
            if again and (self._outbox.in_doubt or not len(self._outbox)):
                # What was published before this session opened: the peer may have forgotten it.
                state = again.popleft()
                if self._outbox.stands(state):
                    await self._send(session, state)
                continue
            try:
                async with asyncio.timeout_at(refusals.due):
                    publication = await self._outbox.first()
            except TimeoutError:
                publication = refusals.next()
            await self._send(session, publication)
            obey_cancellation()

    async def _send(self, session: Session, publication: Publication) -> None:
        self.health.expect("publish", PUBLISH_WITHIN + MARGIN)
        self._under_way = publication
        try:
            async with asyncio.timeout(PUBLISH_WITHIN):
                await session.publish(publication)
        except RefusedError as error:
            self._outbox.refused(publication, error)
        except TimeoutError as error:
            self._under_way = None  # it is silent, which is no answer to this one
            raise ConnectionLostError(f"accepted no publication within {PUBLISH_WITHIN:.0f} s") from error
        else:
            self._works = True
            self._outbox.taken(publication)
        self._under_way = None
        self.health.expect("publish", None)


@asynccontextmanager
async def _opened(session: AbstractAsyncContextManager[Session], within: float) -> AsyncIterator[Session]:
    """Open and close with a time limit each, which a plain ``async with`` cannot separate."""
    try:
        async with asyncio.timeout(within):
            opened = await session.__aenter__()
    except TimeoutError as error:
        raise ConnectionLostError(f"no answer within {within:.0f} s") from error
    try:
        obey_cancellation()
        yield opened
    finally:
        try:
            async with asyncio.timeout(CLOSE_WITHIN):
                await session.__aexit__(*sys.exc_info())
        except TimeoutError:
            LOG.debug("a session did not close within %.0f s and was abandoned", CLOSE_WITHIN)
