"""The peer of the Modbus connector."""

from __future__ import annotations

import struct

from connectors.checks.peer import Entry
from simulators.servers.loop_server import LoopServer
from simulators.servers.modbus import ModbusServer
from simulators.servers.peers.plant import ROLES_OF, PlantPeer


class ModbusPeer(PlantPeer):
    """A device with every loop in its input registers."""

    precision = 1e-6  # float32
    frames = (struct.pack(">HHHBBB", 1, 0, 31, 1, 4, 28) + bytes(28),)
    """An answer with 14 input registers."""
    header = 9
    """What follows are values, of which all are valid."""

    def _make(self) -> LoopServer:
        return ModbusServer(ROLES_OF, port=self.port)

    def _quick(self, wait: float) -> Entry:
        return {"timeout": wait}
