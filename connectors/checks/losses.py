"""Checks of kinds that connect to a peer: its loss is reported in time, and nothing is lost afterwards."""

from __future__ import annotations

import asyncio

from connectors.checks.peer import LOOPS, Peer, PeerFactory
from connectors.checks.proxy import STALL, FaultProxy
from connectors.checks.publishing import expect_alarm, observing
from connectors.checks.reading import START, put_rows, require_rows, row
from connectors.checks.session import (
    DEADLINE,
    Kind,
    Reader,
    alarm,
    connector_to,
    enter,
    expect,
    expect_loss,
    no_escaped_exception,
    open_and_read,
)
from connectors.checks.sessions import require_end

SILENCE = 10.0
"""Within this a peer that is silent counts as lost, s."""
_PASSES_TO_CONNECT = 30
"""Passes of the event loop in which a connection over loopback certainly stands."""


async def _first_sample(kind: Kind, peer: Peer, reader: Reader) -> None:
    if kind.roles:
        await peer.put(LOOPS[0], START, row(0))
        await expect(lambda: reader.samples, "nothing was read before the fault")


async def nobody_there_is_reported(kind: Kind, peers: PeerFactory) -> None:
    """Where nobody listens, opening a session raises ConnectionLostError with a text."""
    async with peers() as peer:
        await peer.stop()
        await expect_loss("a session to a port that nobody listens on", enter(connector_to(kind, peer)))


async def a_lost_peer_is_reported(kind: Kind, peers: PeerFactory) -> None:
    """Reading and publishing raise ConnectionLostError when the peer is gone, and leave no exception."""
    async with peers() as peer, no_escaped_exception():
        connector = connector_to(kind, peer)
        async with connector.session() as session, Reader(session) as reader:
            await _first_sample(kind, peer, reader)
            await peer.stop()
            await expect_loss("reading from a peer that is gone", reader.end(DEADLINE))
            lost = session.publish(alarm(LOOPS[0], active=True))
            await expect_loss("publishing to a peer that is gone", lost)


async def a_silent_peer_is_reported(kind: Kind, peers: PeerFactory) -> None:
    """A peer that is silent while its connection stays open is lost within seconds."""
    async with peers() as peer, FaultProxy(peer.port) as proxy:
        connector = connector_to(kind, peer, proxy.port)
        async with connector.session() as session, Reader(session) as reader:
            await _first_sample(kind, peer, reader)
            await proxy.begin(STALL)
            await expect_loss("reading from a silent peer", reader.end(SILENCE), SILENCE)
            silent = session.publish(alarm(LOOPS[0], active=True))
            await expect_loss("publishing to a silent peer", silent)
        await expect_loss("a session to a silent peer", open_and_read(connector), SILENCE)


async def opening_ends_when_cancelled(kind: Kind, peers: PeerFactory) -> None:
    """Opening a session to a silent peer, or reading from it, ends at whatever moment it is cancelled."""
    async with peers() as peer:
        await peer.stop()
        before = asyncio.all_tasks()
        accepted: list[asyncio.BaseTransport] = []
        silent = await asyncio.get_running_loop().create_server(lambda: _Silent(accepted), "127.0.0.1", 0)
        try:
            port = silent.sockets[0].getsockname()[1]
            connector = connector_to(kind, peer, port, wait=DEADLINE)
            for passes in range(_PASSES_TO_CONNECT):
                task = asyncio.create_task(open_and_read(connector))
                for _ in range(passes):
                    await asyncio.sleep(0)
                await require_end(task, f"opening a session, cancelled after {passes} passes,", SILENCE)
            before_it = len(accepted)
            task = asyncio.create_task(open_and_read(connector))
            await expect(lambda: len(accepted) > before_it, "opening a session did not connect")
            await require_end(task, "opening a session", SILENCE)
        finally:
            silent.close()
            for transport in accepted:
                transport.close()
        await expect(
            lambda: not (asyncio.all_tasks() - before),
            lambda: f"a cancelled session left tasks running: {asyncio.all_tasks() - before}",
        )


class _Silent(asyncio.Protocol):
    """A peer that accepts connections and never answers; it has no task of its own."""

    def __init__(self, accepted: list[asyncio.BaseTransport]) -> None:
        self._accepted = accepted

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Keep the connection open."""
        self._accepted.append(transport)


async def nothing_is_lost_after_a_reconnect(kind: Kind, peers: PeerFactory, count: int = 12) -> None:
    """After the peer was away, a new session of the same connector reads and publishes all there is."""
    async with peers() as peer:
        connector = connector_to(kind, peer)
        for turn in range(3):
            if turn:
                await peer.stop()
                await peer.start()
            async with connector.session() as session, Reader(session) as reader:
                async with observing(peer) as observer:
                    await session.publish(alarm(LOOPS[0], active=not turn % 2, time=START + turn))
                    await expect_alarm(observer, LOOPS[0], active=not turn % 2)
                if kind.roles:
                    await put_rows(peer, reader, turn * count, count)
                    require_rows(peer, reader, turn * count, count)
