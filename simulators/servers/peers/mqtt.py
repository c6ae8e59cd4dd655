"""The peer of the MQTT connector: a broker, and a plant that publishes to it."""

from __future__ import annotations

from contextlib import AsyncExitStack

from connectors.checks.peer import Entry
from simulators.servers.broker import embedded_broker
from simulators.servers.loop_server import LoopServer
from simulators.servers.mqtt import MqttServer
from simulators.servers.peers.plant import ROLES_OF, PlantPeer

WELCOME = b"\x20\x02\x00\x00"
"""CONNACK of MQTT 3.1.1: accepted."""
_SUBSCRIBED = b"\x90\x03\x00\x01\x01"
_MESSAGE = b"\x32\x1c\x00\x0cplant/FIC101\x00\x07" + b'{"t": 1, "p'


class MqttPeer(PlantPeer):
    """A broker whose messages hold a row each."""

    frames = (WELCOME, WELCOME + _SUBSCRIBED, WELCOME + _SUBSCRIBED + _MESSAGE)

    def __init__(self) -> None:
        super().__init__()
        self._broker = AsyncExitStack()

    async def start(self) -> None:
        """Start the broker, then the plant."""
        self.port = await self._broker.enter_async_context(embedded_broker(port=self.port))
        await super().start()

    async def stop(self) -> None:
        """Stop the plant, then the broker."""
        await super().stop()
        await self._broker.aclose()

    def _make(self) -> LoopServer:
        return MqttServer(ROLES_OF, port=self.port)

    def _quick(self, wait: float) -> Entry:
        return {"timeout": wait, "keepalive": 1}
