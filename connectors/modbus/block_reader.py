"""Reads blocks so that one without an answer, or a unit that its gateway cannot reach, holds up no others."""

from __future__ import annotations

import asyncio
from collections.abc import Sequence

from connectors.base import ConnectionLostError
from connectors.modbus.blocks import Block
from connectors.modbus.client import DeviceError, ModbusClient, SilentBlockError
from connectors.modbus.parking import PROBE, Parking

UNREACHABLE = (10, 11)
"""What a gateway says of a unit that it cannot reach. All others behind it had to wait for that."""


class BlockReader:
    """The blocks of one session."""

    def __init__(self, client: ModbusClient, blocks: Sequence[Block], parking: Parking) -> None:
        """Make it.

        Args:
            client: To the device.
            blocks: All that are read.
            parking: Of the device, from earlier sessions.
        """
        self._client = client
        self._blocks = blocks
        self._parking = parking
        self._answered: Block | None = None
        """The newest that was."""
        self._unreachable: DeviceError | None = None
        self._due = 0.0
        """When a unit that cannot be reached is tried again, s of the event loop's clock."""
        if all(block in parking for block in blocks):
            for block in blocks:
                parking.release(block)

    async def read(self, block: Block) -> Sequence[int]:
        """Return its registers or bits; raises DeviceError, and ConnectionLostError where all are silent."""
        clock = asyncio.get_running_loop()
        if block in self._parking:
            raise SilentBlockError(self._client.timeout)
        if self._unreachable is not None and clock.time() < self._due:
            raise self._unreachable
        self._unreachable = None
        try:
            answer = await self._client.read(block.table, block.address, block.count)
        except DeviceError as error:
            self._parking.answered(block)
            if error.code in UNREACHABLE:
                self._unreachable, self._due = error, clock.time() + PROBE
            raise
        except ConnectionLostError:
            if not self._client.silent:
                raise
        else:
            self._answered = block
            self._parking.answered(block)
            return answer
        self._parking.park(block)
        await self._ask_another()
        silent = SilentBlockError(self._client.timeout)
        self._parking.tell(block, str(silent))
        raise silent

    async def _ask_another(self) -> None:
        """Return if the device still answers; raises ConnectionLostError."""
        known = [*filter(None, [self._answered]), *self._blocks]
        other = next((block for block in known if block not in self._parking), None)
        if other is None:
            raise ConnectionLostError(str(SilentBlockError(self._client.timeout)))
        try:
            await self._client.read(other.table, other.address, 1)
        except DeviceError:
            return
