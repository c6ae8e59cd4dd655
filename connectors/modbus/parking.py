"""Blocks that a device leaves without an answer while it answers others: parked, so that they hold up none.

A parked block is requested every 2 s over a connection of its own, until it is answered.
"""

from __future__ import annotations

import asyncio
import logging
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from typing import NoReturn

from connectors.base import ConnectionLostError
from connectors.cancellation import obey_cancellation
from connectors.modbus.blocks import Block
from connectors.modbus.client import DeviceError, connected
from connectors.modbus.options import ModbusOptions

_LOG = logging.getLogger(__name__)
PROBE = 2.0
"""Time between two questions to what gave no answer, s."""


class Parking:
    """What is parked of one device; it outlasts the sessions, so that the next does not begin with it."""

    def __init__(self, name: str) -> None:
        """Make it for the connection ``name``."""
        self._name = name
        self._blocks: dict[str, Block] = {}
        self._told: set[str] = set()
        self._filled = asyncio.Event()

    def __contains__(self, block: Block) -> bool:
        return bool(self._blocks) and str(block) in self._blocks

    def park(self, block: Block) -> None:
        """Take it in."""
        self._blocks[str(block)] = block
        self._filled.set()

    def tell(self, block: Block, why: str) -> None:
        """Log, once, that it is parked although the device answers."""
        if str(block) not in self._told:
            self._told.add(str(block))
            _LOG.warning(
                "connection %s: %s: %s; it is requested every %g s apart from the others",
                self._name,
                block,
                why,
                PROBE,
                extra={"event": "parked", "connection": self._name},
            )

    def release(self, block: Block) -> None:
        """Let it go: it is read with all others again."""
        self._blocks.pop(str(block), None)
        if not self._blocks:
            self._filled.clear()

    def answered(self, block: Block) -> None:
        """Log, once, that it is answered among all others again."""
        if self._told and str(block) in self._told:
            self._told.discard(str(block))
            _LOG.info(
                "connection %s: %s answers again",
                self._name,
                block,
                extra={"event": "released", "connection": self._name},
            )

    async def probe(self, options: ModbusOptions) -> NoReturn:
        """Request what is parked, until cancelled."""
        while True:
            await self._filled.wait()
            await asyncio.sleep(PROBE)
            for block in list(self._blocks.values()):
                if not await _is_silent(options, block):
                    self.release(block)
            obey_cancellation()


@asynccontextmanager
async def probed(parking: Parking, options: ModbusOptions) -> AsyncIterator[None]:
    """Request what is parked, beside all else."""
    probing = asyncio.create_task(parking.probe(options), name="probe what is parked")
    try:
        yield
    finally:
        probing.cancel()
        await asyncio.wait({probing})
        if not probing.cancelled():
            probing.result()  # it never ends by itself: raise what ended it


async def _is_silent(options: ModbusOptions, block: Block) -> bool:
    """Whether the device leaves it unanswered; no where it allows no second connection to request it on."""
    try:
        async with connected(options) as client:
            try:
                await client.read(block.table, block.address, block.count)
            except DeviceError:
                return False  # its loop gets the reason when it reads the block
            except ConnectionLostError:
                return client.silent
    except ConnectionLostError:
        return False
    return False
