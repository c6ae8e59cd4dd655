"""A Modbus server of our own as a connector: publications fill its registers, people's orders come out."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Mapping
from contextlib import asynccontextmanager

from connectors.base import ConfigError, ConnectionLostError, Order, Publication, Session, TargetReport
from connectors.cancellation import obey_cancellation
from connectors.malformed import Malformed
from connectors.modbus_server import register_map as at
from connectors.modbus_server.image import Image
from connectors.modbus_server.listening import listening
from connectors.modbus_server.options import ModbusServerOptions, ModbusServerTarget
from connectors.options import LoopTags, NoTag

BEAT = 1.0
"""s from one heartbeat to the next."""

ServedLoops = Mapping[str, LoopTags[NoTag, ModbusServerTarget]]


class ModbusServerConnector:
    """A server that others connect to. What it shows outlives its sessions, and orders that wait do, too."""

    takes_orders = True  # its samples also let the heart beat, so they are read even where orders are refused

    def __init__(self, name: str, options: ModbusServerOptions, loops: ServedLoops) -> None:
        if len(loops) > at.MOST_LOOPS:
            raise ConfigError([f"connections.{name}: {len(loops)} loops, and its map holds {at.MOST_LOOPS}"])
        self.name = name
        self.loops = tuple(loops)
        """In the order of their blocks."""
        self._options = options
        self._image = Image(self.loops, options.order, takes_orders=options.orders)
        self._malformed = Malformed("Modbus server")

    @property
    def malformed(self) -> int:
        """What clients sent that could not be read, since the start."""
        return self._malformed.count

    @asynccontextmanager
    async def session(self) -> AsyncIterator[Session]:
        """Listen; raises ConnectionLostError where the port is taken, AccessDeniedError."""
        async with listening(self._options, self._image, self._malformed) as server:
            yield ModbusServerSession(server, self._image, self.loops)


class ModbusServerSession:
    """A server at work."""

    def __init__(self, server: asyncio.Server, image: Image, loops: tuple[str, ...]) -> None:
        self.port: int = server.sockets[0].getsockname()[1]
        self._server = server
        self._image = image
        self._loops = loops

    async def samples(self) -> AsyncIterator[Order]:
        """Yield the orders of operators; raises ConnectionLostError when the server no longer listens."""
        clock = asyncio.get_running_loop()
        due = clock.time()
        while True:
            asked = self._image.oldest()
            if asked is not None:
                yield asked.order
                self._image.taken(asked)  # whoever requests the next one has obeyed this one
            if clock.time() >= due:
                self._image.beat()
                due = max(due + BEAT, clock.time())
                if not self._server.is_serving():
                    raise ConnectionLostError("the Modbus server no longer listens")
            elif asked is None:
                await self._image.order_within(due - clock.time())
            obey_cancellation()

    async def check_targets(self) -> list[TargetReport]:
        """Report where each loop is shown; nothing can speak against it, as the server is ours."""
        return [
            TargetReport(
                loop,
                f"registers {at.block(index)} to {at.block(index) + at.BLOCK - 1}, "
                f"discrete inputs {at.BITS * index} to {at.BITS * index + at.BITS - 1}, coil {index}",
            )
            for index, loop in enumerate(self._loops)
        ]

    async def publish(self, publication: Publication) -> None:
        """Show a state of a loop; events are not, as a register keeps only the newest."""
        self._image.show(publication)
