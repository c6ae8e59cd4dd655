"""The peer of our OPC UA server: a client that subscribes to the state of every alarm."""

from __future__ import annotations

import struct
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

from asyncua import Client, ua
from asyncua.common.subscription import DataChangeEvent

from connectors.checks.peer import LOOPS
from connectors.opcua_server.space.names import NAMESPACE
from simulators.servers.peers.client import ClientPeer

_URL = b"opc.tcp://127.0.0.1:4840"
_HELLO = struct.pack("<IIIIII", 0, 65535, 65535, 0, 0, len(_URL)) + _URL
_INTERVAL = 50.0
"""Publishing interval, ms."""


class OpcUaServerPeer(ClientPeer):
    """A client."""

    frames = (b"HELF" + struct.pack("<I", 8 + len(_HELLO)) + _HELLO,)

    @asynccontextmanager
    async def alarms(self) -> AsyncIterator[AsyncIterator[tuple[str, bool]]]:
        """Subscribe to ``LOOP.Active``."""
        async with Client(f"opc.tcp://127.0.0.1:{self.port}", timeout=30) as client:
            index = await client.get_namespace_index(NAMESPACE)
            loops = {ua.NodeId(f"{loop}.Active", index): loop for loop in LOOPS}
            changes = await client.create_subscription(_INTERVAL)
            await changes.subscribe_data_change([client.get_node(node) for node in loops])

            async def alarms() -> AsyncIterator[tuple[str, bool]]:
                async for event in changes:
                    if isinstance(event, DataChangeEvent):
                        yield loops[event.node.nodeid], bool(event.value)

            yield alarms()
