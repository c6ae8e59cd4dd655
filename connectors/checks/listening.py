"""Checks of kinds that are servers themselves."""

from __future__ import annotations

import socket

from connectors.checks.peer import PeerFactory
from connectors.checks.session import Kind, connector_to, enter, expect_loss


async def a_port_in_use_is_reported(kind: Kind, peers: PeerFactory) -> None:
    """A port that another program has is a ConnectionLostError; once it is free, a session opens."""
    async with peers() as peer:
        connector = connector_to(kind, peer)
        with socket.socket() as other:
            other.bind(("127.0.0.1", peer.port))
            other.listen()
            await expect_loss("listening on a port in use", enter(connector))
        await enter(connector)
