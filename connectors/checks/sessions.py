"""Checks of every kind: sessions open on demand, end when cancelled, and leave nothing running."""

from __future__ import annotations

import asyncio
from typing import Any

from connectors.base import Connector
from connectors.checks.peer import LOOPS, PeerFactory
from connectors.checks.reading import START, expect_row, row
from connectors.checks.session import PROMPT, Kind, Reader, alarm, connector_to, expect, require

_MORE_CANCELLATIONS = 20


async def require_end(task: asyncio.Task[Any], what: str, within: float, *, cancel: bool = True) -> None:
    """Cancel a task and require that it ends in time; one that does not is cancelled until it ends.

    Args:
        task: That is to end.
        what: Its name in the message of the AssertionError.
        within: s.
        cancel: Whether to cancel it first; otherwise it must end by itself.
    """
    if cancel:
        task.cancel()
    done, _ = await asyncio.wait({task}, timeout=within)
    for _ in range(_MORE_CANCELLATIONS):
        if task.done():
            break
        task.cancel()
        await asyncio.wait({task}, timeout=0.1)
    require(done, f"{what} did not end within {within:g} s{' of its cancellation' if cancel else ''}")


async def nothing_opens_before_a_session(kind: Kind, peers: PeerFactory) -> None:
    """A connector can be made while its peer is away, and has the name that the configuration gave it."""
    async with peers() as peer:
        await peer.stop()
        before = asyncio.all_tasks()
        connector: Connector = connector_to(kind, peer)
        await asyncio.sleep(0)
        require(connector.name == "check", f"name is {connector.name!r}, expected that of the connection")
        require(isinstance(connector.takes_orders, bool), "takes_orders is no bool")
        require(asyncio.all_tasks() == before, "the connector started a task before its first session")


async def reading_ends_when_cancelled(kind: Kind, peers: PeerFactory) -> None:
    """A cancelled reader ends within seconds, at whatever moment it is cancelled."""
    async with peers() as peer:
        for steps in (1, 20, 200):
            async with connector_to(kind, peer).session() as session, Reader(session) as reader:
                for _ in range(steps):
                    await asyncio.sleep(0)
                await require_end(reader.task, "a reader", PROMPT)


async def sessions_follow_each_other(kind: Kind, peers: PeerFactory, count: int = 3) -> None:
    """A connector opens one session after the other; none leaves a task, each reads and publishes."""
    before = asyncio.all_tasks()
    async with peers() as peer:
        connector = connector_to(kind, peer)
        for k in range(count):
            async with connector.session() as session, Reader(session) as reader:
                await session.publish(alarm(LOOPS[0], active=bool(k % 2), time=START + k))
                if kind.roles:
                    await peer.put(LOOPS[0], START + k, row(k))
                    await expect_row(reader, LOOPS[0], START + k)
    await expect(
        lambda: not (asyncio.all_tasks() - before),
        lambda: f"sessions or their peer left tasks running: {asyncio.all_tasks() - before}",
    )
