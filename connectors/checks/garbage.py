"""Checks of every kind: bytes that are no message never crash it and never become a good value."""

from __future__ import annotations

import asyncio
import contextlib
import random
from collections.abc import AsyncIterator

from connectors.base import ConnectionLostError, Connector, Order, Quality, Sample
from connectors.checks.peer import LOOPS, Peer, PeerFactory
from connectors.checks.publishing import expect_alarm, observing
from connectors.checks.session import (
    DEADLINE,
    Kind,
    Reader,
    alarm,
    connector_to,
    no_escaped_exception,
    require,
)
from connectors.checks.sessions import require_end

_FIRST_WORD = 0.02
"""Longest wait for the first bytes of a client, s."""


def garbage(peer: Peer, chance: random.Random) -> bytes:
    """Return bytes of any kind, or a frame of the peer with some of its header changed, or one cut short."""
    kind = chance.randrange(3) if peer.frames else 0
    if kind == 0:
        return chance.randbytes(chance.randint(1, 300))
    frame = bytearray(chance.choice(peer.frames))
    if kind == 1:
        return bytes(frame[: chance.randrange(1, len(frame))])
    for _ in range(chance.randint(1, 4)):
        frame[chance.randrange(min(len(frame), peer.header))] ^= chance.randrange(1, 256)
    return bytes(frame)


@contextlib.asynccontextmanager
async def _babbler(peer: Peer) -> AsyncIterator[int]:
    """Answer each client's first bytes with garbage and hang up; yields the port."""
    chance = random.Random(7)

    async def answer(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        with contextlib.suppress(OSError):  # a client may wait for the first word; a timeout is an OSError
            async with asyncio.timeout(_FIRST_WORD):
                await reader.read(4096)
        writer.write(garbage(peer, chance))
        writer.close()

    server = await asyncio.start_server(answer, "127.0.0.1", 0)
    try:
        yield server.sockets[0].getsockname()[1]
    finally:
        server.close()


async def _read(connector: Connector, read: list[Sample | Order]) -> None:
    async with connector.session() as session:
        async for each in session.samples():
            read.append(each)  # noqa: PERF401 - what was read before an error counts


async def garbage_is_a_loss(kind: Kind, peers: PeerFactory, times: int = 40) -> None:
    """A peer that answers garbage and hangs up is lost each time: no other error, no good value."""
    async with peers() as peer, _babbler(peer) as port, no_escaped_exception():
        connector = connector_to(kind, peer, port, wait=0.1)
        for k in range(times):
            read: list[Sample | Order] = []
            task = asyncio.create_task(_read(connector, read))
            await require_end(task, f"reading garbage number {k + 1}", DEADLINE, cancel=False)
            raised = "nothing" if task.cancelled() else repr(task.exception())
            is_loss = not task.cancelled() and isinstance(task.exception(), ConnectionLostError)
            require(is_loss, f"garbage number {k + 1} raised {raised}, expected ConnectionLostError")
            bad = [each for each in read if isinstance(each, Order) or each.quality is not Quality.BAD]
            require(not bad, f"garbage number {k + 1} became {bad[:1]}")


async def clients_may_send_garbage(kind: Kind, peers: PeerFactory, times: int = 40) -> None:
    """Clients that send garbage disturb neither the server nor other clients, and give no order."""
    async with peers() as peer, no_escaped_exception():
        chance = random.Random(7)
        async with connector_to(kind, peer).session() as session, Reader(session) as reader:
            for _ in range(times):
                with contextlib.suppress(OSError):
                    _, writer = await asyncio.open_connection("127.0.0.1", peer.port)
                    writer.write(garbage(peer, chance))
                    with contextlib.suppress(OSError):
                        writer.write_eof()
                    writer.close()
                    await writer.wait_closed()
            async with observing(peer) as observer:
                await session.publish(alarm(LOOPS[0], active=True))
                await expect_alarm(observer, LOOPS[0], active=True)
            require(not reader.orders, f"garbage became the order {reader.orders[:1]}")
