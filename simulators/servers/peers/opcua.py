"""The peer of the OPC UA connector."""

from __future__ import annotations

import struct

from connectors.checks.peer import Entry
from simulators.servers.loop_server import LoopServer
from simulators.servers.opcua import OpcUaServer
from simulators.servers.peers.plant import ROLES_OF, PlantPeer

_ACKNOWLEDGE = b"ACKF" + struct.pack("<IIIIII", 28, 0, 65535, 65535, 0, 0)
"""Answer to Hello (Part 6, 7.1.2.4)."""
_OPEN = b"OPNF" + struct.pack("<II", 132, 1) + bytes(124)


class OpcUaPeer(PlantPeer):
    """A server with a node for every value."""

    frames = (_ACKNOWLEDGE, _ACKNOWLEDGE + _OPEN)

    def _make(self) -> LoopServer:
        return OpcUaServer(ROLES_OF, port=self.port)

    def _quick(self, wait: float) -> Entry:
        return {"timeout": wait, "keep_alive": 5}

    def _place(self, port: int) -> Entry:
        return {"url": f"opc.tcp://127.0.0.1:{port}"}
