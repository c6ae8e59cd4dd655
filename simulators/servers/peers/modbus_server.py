"""The peer of our Modbus server: a master that polls it."""

from __future__ import annotations

import asyncio
import struct
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

from pymodbus.client import AsyncModbusTcpClient

from connectors.cancellation import obey_cancellation
from connectors.checks.peer import LOOPS
from connectors.modbus_server.register_map import BITS
from simulators.servers.modbus import POLL
from simulators.servers.peers.client import ClientPeer

_REQUESTS = (
    b"\x03\x00\x00\x00\x08",
    b"\x02\x00\x00\x00\x10",
    b"\x06\x00\x00\x00\x01",
    b"\x10\x00\x00\x00\x01\x02\x00\x01",
)
_WAIT = 30.0
"""Longest wait for an answer, s."""


class ModbusServerPeer(ClientPeer):
    """A master."""

    frames = tuple(struct.pack(">HHHB", 7, 0, len(pdu) + 1, 1) + pdu for pdu in _REQUESTS)

    @asynccontextmanager
    async def alarms(self) -> AsyncIterator[AsyncIterator[tuple[str, bool]]]:
        """Poll the discrete inputs."""
        async with AsyncModbusTcpClient(
            "127.0.0.1", port=self.port, timeout=_WAIT, reconnect_delay=0
        ) as client:

            async def alarms() -> AsyncIterator[tuple[str, bool]]:
                while True:
                    answer = await client.read_discrete_inputs(0, count=BITS * len(LOOPS))
                    obey_cancellation()
                    for index, loop in enumerate(LOOPS):
                        yield loop, bool(answer.bits[BITS * index])
                    await asyncio.sleep(POLL)

            yield alarms()
