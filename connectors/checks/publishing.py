"""Checks of every kind: an alarm reaches an observer, and nothing else is written."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import AsyncIterator

from connectors.base import WITHDRAWN, Publication
from connectors.checks.peer import LOOPS, Peer, PeerFactory
from connectors.checks.session import DEADLINE, Kind, Reader, alarm, connector_to, expect, require


class AlarmsSeen:
    """What a client of the peer saw: (loop, whether its alarm is active), in order."""

    def __init__(self) -> None:
        self.seen: list[tuple[str, bool]] = []

    def newest(self, loop: str) -> bool | None:
        """Return the state of a loop's alarm that was seen last."""
        return next((active for name, active in reversed(self.seen) if name == loop), None)


@contextlib.asynccontextmanager
async def observing(peer: Peer) -> AsyncIterator[AlarmsSeen]:
    """Observe the alarms of a peer meanwhile."""
    observer = AlarmsSeen()

    async def run(alarms: AsyncIterator[tuple[str, bool]]) -> None:
        async for seen in alarms:
            observer.seen.append(seen)

    async with asyncio.timeout(3 * DEADLINE), peer.alarms() as alarms:
        task = asyncio.create_task(run(alarms), name="observer of a check")
        try:
            yield observer
        finally:
            task.cancel()
            with contextlib.suppress(asyncio.CancelledError):
                await task


async def expect_alarm(observer: AlarmsSeen, loop: str, *, active: bool) -> None:
    """Wait until this is the newest state of a loop's alarm; raises AssertionError."""

    def failure() -> str:
        return f"{loop}: an observer did not see its alarm become active={active}; it saw {observer.seen}"

    await expect(lambda: observer.newest(loop) is active, failure)


async def an_alarm_comes_and_goes(kind: Kind, peers: PeerFactory) -> None:
    """An observer sees the alarm of the loop that is meant, and of no other, come and go."""
    loop, other = LOOPS
    async with peers() as peer, connector_to(kind, peer).session() as session, Reader(session):
        async with observing(peer) as observer:
            await session.publish(alarm("a loop of another connection", active=True))
            for time, active in enumerate((True, False, True), start=1_700_000_000):
                await session.publish(alarm(loop, active=active, time=float(time)))
                await session.publish(alarm(loop, active=active, time=float(time)))  # as after a retry
                await expect_alarm(observer, loop, active=active)
            require((other, True) not in observer.seen, f"{other}: its alarm was written, {loop} was meant")
        await session.publish(Publication(loop, WITHDRAWN, f"{loop}/withdrawn", {}))
