"""The peer of the Sparkplug connector: a broker, and a host that listens to it."""

from __future__ import annotations

from collections.abc import AsyncIterator, Mapping
from contextlib import AsyncExitStack, asynccontextmanager
from typing import Self

from aiomqtt import Client

from connectors.checks.peer import Entry
from connectors.sparkplug.payload import decode
from simulators.servers.broker import embedded_broker
from simulators.servers.peers.mqtt import WELCOME

GROUP = "check"


class SparkplugPeer:
    """A broker; nothing is read from it."""

    lead = 0
    precision = 0.0
    frames: tuple[bytes, ...] = (WELCOME,)
    header = 4

    def __init__(self) -> None:
        self.port = 0
        self._broker = AsyncExitStack()

    async def __aenter__(self) -> Self:
        """Start."""
        await self.start()
        return self

    async def __aexit__(self, *_: object) -> None:
        """Stop for good."""
        await self.stop()

    async def start(self) -> None:
        """Start the broker, on the same port as before."""
        self.port = await self._broker.enter_async_context(embedded_broker(port=self.port))

    async def stop(self) -> None:
        """Stop the broker."""
        await self._broker.aclose()

    async def put(self, loop: str, time: float, values: Mapping[str, float | str]) -> None:
        """Refuse: nothing is read from Sparkplug."""
        raise NotImplementedError

    def connection(self, port: int | None = None, *, wait: float = 1.0) -> Entry:
        """Return the entry of ``connections``."""
        place = self.port if port is None else port
        return {"port": place, "group": GROUP, "node": "gate", "timeout": wait, "keepalive": 1}

    def loop(self, name: str) -> Entry:
        """Return the target of a loop."""
        return {"tags": {}, "publish": [{"device": name}]}

    @asynccontextmanager
    async def alarms(self) -> AsyncIterator[AsyncIterator[tuple[str, bool]]]:
        """Observe births and data of all devices."""
        async with Client("127.0.0.1", self.port) as client:
            await client.subscribe([(f"spBv1.0/{GROUP}/{verb}/#", 1) for verb in ("DBIRTH", "DDATA")])

            async def alarms() -> AsyncIterator[tuple[str, bool]]:
                async for message in client.messages:
                    loop = message.topic.value.rsplit("/", 1)[-1]
                    for metric in decode(bytes(message.payload)).metrics:
                        if metric.name == "Alarm/Active" and metric.value is not None:
                            yield loop, bool(metric.value)

            yield alarms()
