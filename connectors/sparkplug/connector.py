"""Sparkplug B as a connector: every session is a fresh client that is born, publishes data and dies."""

from __future__ import annotations

import asyncio
import contextlib
import logging
import socket
import time
from collections import Counter
from collections.abc import AsyncIterator, Iterator, Mapping
from contextlib import asynccontextmanager

from aiomqtt import Message

from connectors.base import ConfigError, ConnectionLostError, Order, Publication, RefusedError, Session
from connectors.mqtt.client import StrictClient, as_connection_lost, connected, subscribe
from connectors.mqtt.inbox import Losses
from connectors.options import LoopTags, NoTag
from connectors.sparkplug.metrics import REBIRTH, orders
from connectors.sparkplug.node import EdgeNode
from connectors.sparkplug.options import SparkplugOptions, SparkplugTarget
from connectors.sparkplug.payload import MalformedMetricsError, decode

_LOG = logging.getLogger(__name__)
_FAREWELL = 1.0
"""Longest time to say that this node dies, s; where the broker does not hear it, its will is published."""

SparkplugLoops = Mapping[str, LoopTags[NoTag, SparkplugTarget]]


class SparkplugConnector:
    """An edge node; ConfigError where two loops would be one device."""

    takes_orders = True  # a host may request births anew, so its commands are always read

    def __init__(self, name: str, options: SparkplugOptions, loops: SparkplugLoops) -> None:
        self.name = name
        self.malformed = 0
        """Commands that cannot be read."""
        self.retained = 0
        """Commands that the broker had kept: nobody knows whether they are still meant."""
        self._losses = Losses()
        self._options = options
        group, node = options.group, options.node or socket.gethostname()
        devices = {loop: each.targets[0].device or loop for loop, each in loops.items() if each.targets}
        if faults := list(_faults(name, loops, devices)):
            raise ConfigError(faults)
        self._node = EdgeNode(group, node, devices, writable=options.orders)
        # The broker lets go of a former connection with the same name, and sends its death before our birth.
        self._identifier = f"slipjump-{group}-{node}"

    @property
    def lost(self) -> int:
        """Commands that were discarded because too many waited to be read, since the start."""
        return self._losses.count

    @asynccontextmanager
    async def session(self) -> AsyncIterator[Session]:
        """Connect; raises ConnectionLostError."""
        if self._options.is_guest:
            async with connected(self._options) as client:
                yield SparkplugSession(client, self, self._node, orders=False)
            return
        will = self._node.will(time.time())
        async with connected(self._options, self._identifier, will, self._losses) as client:
            session = SparkplugSession(client, self, self._node, orders=self._options.orders)
            await session.born()
            try:
                yield session
            finally:
                with contextlib.suppress(ConnectionLostError, RefusedError, TimeoutError):
                    async with asyncio.timeout(_FAREWELL):
                        await client.send(self._node.death(time.time()))


class SparkplugSession:
    """An open connection."""

    def __init__(
        self, client: StrictClient, counts: SparkplugConnector, node: EdgeNode, *, orders: bool
    ) -> None:
        self._client = client
        self._counts = counts
        self._node = node
        self._orders = orders
        self._in_order = asyncio.Lock()
        """Held while messages are numbered and sent: a birth must not overtake data."""
        self._subjects = {node.topic("DCMD", device): subject for device, subject in node.subjects.items()}

    async def born(self) -> None:
        """Listen for commands, then publish the births; raises ConnectionLostError."""
        for topic in await subscribe(self._client, self._command_topics()):
            _LOG.warning("topic %s: the broker refuses it, no host can command there", topic)
        await self._births()

    async def samples(self) -> AsyncIterator[Order]:
        """Answer requests for births, and yield what a host orders; nothing is read here."""
        with as_connection_lost():
            async for message in self._client.messages:
                for order in await self._obeyed(message):
                    yield order

    async def publish(self, publication: Publication) -> None:
        """Publish what has changed and return when the broker has it; raises ConnectionLostError."""
        async with self._in_order:
            message = self._node.data(publication, time.time())
            if message is None:
                return
            await self._client.send(message)
            # Sparkplug sends data with QoS 0, which nobody answers; a broker answers this only after it.
            await subscribe(self._client, self._command_topics()[:1])

    async def _births(self) -> None:
        async with self._in_order:
            for message in self._node.births(time.time()):
                await self._client.send(message)

    async def _obeyed(self, message: Message) -> list[Order]:
        topic = message.topic.value
        if topic != self._node.topic("NCMD") and topic not in self._subjects:
            return []  # amqtt was seen to send what nobody subscribed to
        if message.retain:
            self._counts.retained += 1
            if self._counts.retained == 1:
                _LOG.warning("topic %s: a retained command is not obeyed", topic)
            return []
        try:
            metrics = decode(bytes(message.payload)).metrics
            if topic in self._subjects:
                return orders(self._subjects[topic], metrics, time.time()) if self._orders else []
        except MalformedMetricsError as error:
            self._counts.malformed += 1
            if self._counts.malformed == 1:
                _LOG.warning("topic %s: a command cannot be obeyed: %s", topic, error)
            return []
        if any(each.name == REBIRTH and each.value is True for each in metrics):
            await self._births()
        return []

    def _command_topics(self) -> list[str]:
        return [self._node.topic("NCMD"), self._node.topic("DCMD", "+")]


def _faults(name: str, loops: SparkplugLoops, devices: Mapping[str, str]) -> Iterator[str]:
    for loop, each in loops.items():
        if len(each.targets) > 1:
            yield f"loops.{loop}.publish: connection {name} is named twice, a loop is one device"
    for device, count in Counter(devices.values()).items():
        if count > 1:
            yield f"connections.{name}: {count} loops would be device {device}"
