"""MQTT as a connector: every session is a fresh client with a clean session."""

from __future__ import annotations

import asyncio
import contextlib
import json
import logging
import math
import secrets
import time
from collections.abc import AsyncGenerator, AsyncIterator, Mapping, Sequence
from contextlib import asynccontextmanager

from aiomqtt import Message

from connectors.base import (
    WITHDRAWN,
    ConnectionLostError,
    Order,
    Publication,
    RefusedError,
    Sample,
    Session,
)
from connectors.mqtt.client import Outgoing, StrictClient, as_connection_lost, connected, subscribe
from connectors.mqtt.inbox import Losses
from connectors.mqtt.messages.reader import TopicReader, readers_of
from connectors.mqtt.options import MqttOptions
from connectors.mqtt.orders import OrderReader
from connectors.mqtt.status import status
from connectors.mqtt.topics import MqttLoops, Topics, topics_of
from connectors.readings import Readings, one_by_one

_LOG = logging.getLogger(__name__)
_FAREWELL = 1.0
"""Longest time to say that this goes offline, s; where the broker does not hear it, its will is published."""

WAITING = 5
"""Messages of each topic that may wait, where that is more than ``queue``: some seconds of a large plant."""


class MqttConnector:
    """An MQTT broker, what is read from it and published to it; ConfigError for topics that make no sense."""

    def __init__(self, name: str, options: MqttOptions, loops: MqttLoops) -> None:
        self.name = name
        self._topics = topics_of(name, options, loops)
        self._readers = readers_of(loops)
        queue = max(options.queue, WAITING * len(self._readers))
        self._options = options.model_copy(update={"queue": queue})
        self.orders = OrderReader(self._topics.orders)
        self._losses = Losses()
        # The broker lets go of a former connection with the same name, and says its will before ours is up.
        self._identifier = options.client or f"slipjump-{secrets.token_hex(7)}"

    @property
    def takes_orders(self) -> bool:
        """Whether people may order something here."""
        return bool(self._topics.orders)

    @property
    def malformed(self) -> int:
        """Messages that could not be read as configured, orders among them, since the start."""
        return self.orders.malformed + sum(reader.malformed for reader in self._readers.values())

    @property
    def lost(self) -> int:
        """Messages that were discarded because too many waited to be read, since the start."""
        return self._losses.count

    @asynccontextmanager
    async def session(self) -> AsyncIterator[Session]:
        """Connect; raises ConnectionLostError."""
        async with online(self._options, self._topics, self._identifier, self._losses) as client:
            yield MqttSession(client, self._readers, self._topics, self.orders)


@asynccontextmanager
async def online(
    options: MqttOptions, topics: Topics, identifier: str, losses: Losses
) -> AsyncIterator[StrictClient]:
    """Connect, and say on the status topic that this is online, and that it is not at the end."""
    if topics.status is None:
        async with connected(options, identifier, losses=losses) as client:
            yield client
        return
    topic, who, began = topics.status, topics.client, time.time()
    will = status(topic, who, "offline", began, None)
    async with connected(options, identifier, will, losses) as client:
        await _say(client, status(topic, who, "online", began, time.time()))
        try:
            yield client
        finally:
            with contextlib.suppress(ConnectionLostError, TimeoutError):
                async with asyncio.timeout(_FAREWELL):
                    await _say(client, status(topic, who, "offline", began, time.time()))


async def _say(client: StrictClient, message: Outgoing) -> None:
    try:
        await client.send(message)
    except RefusedError as error:
        _LOG.warning("the status cannot be published: %s", error)


class MqttSession:
    """An open connection."""

    def __init__(
        self, client: StrictClient, readers: Mapping[str, TopicReader], topics: Topics, orders: OrderReader
    ) -> None:
        self._client = client
        self._readers = readers
        self._topics = topics
        self._orders = orders

    async def samples(self) -> AsyncIterator[Sample | Order]:
        """Yield the samples and orders of every message; a topic that the broker refuses is reported once."""
        async for each in one_by_one(self.readings()):
            yield each

    async def readings(self) -> AsyncGenerator[Sample | Order | Readings]:
        """Yield the same, a message in one piece where it can be."""
        refused = await subscribe(self._client, dict.fromkeys([*self._readers, *self._topics.orders]))
        for topic, code in refused.items():
            for name in self._readers[topic].names if topic in self._readers else ():
                yield Sample.missing(name, time.time(), code, f"the broker refuses topic {topic}")
            if topic in self._topics.orders:
                _LOG.warning("topic %s: the broker refuses it, nobody can order there", topic)
        with as_connection_lost():
            async for message in self._client.received():
                for each in self._read(message):
                    yield each

    def _read(self, message: Message) -> Sequence[Sample | Order | Readings]:
        topic, payload, arrival = message.topic.value, bytes(message.payload), time.time()
        retained = bool(message.retain)
        found: list[Sample | Order | Readings] = []
        if topic in self._topics.orders:
            order = self._orders.order(topic, payload, arrival, retained=retained)
            if order is not None:
                found.append(order)
        reader = self._readers.get(topic)
        if reader is None:
            return found  # amqtt was seen to send what nobody subscribed to
        malformed = reader.malformed
        read = reader.readings(payload, arrival, retained=retained)
        if malformed == 0 and reader.malformed:
            _LOG.warning("topic %s: a message cannot be read as configured", topic)
        return [*found, read] if isinstance(read, Readings) else [*found, *read]

    async def publish(self, publication: Publication) -> None:
        """Publish a state, retained, or an event, until the broker has it; an end takes the state back.

        Raises ConnectionLostError, RefusedError.
        """
        is_event = publication.kind == "event"
        fields = publication.fields
        payload = json.dumps({name: _json(value) for name, value in fields.items()}).encode()
        if publication.kind == WITHDRAWN:
            payload = b""
        schema = str(fields["schema"]) if "schema" in fields else None
        refused = []
        for topic in self._topics.alarms.get(publication.subject, ()):
            place = f"{topic}/event" if is_event else topic
            try:
                await self._client.send(Outgoing(place, payload, retain=not is_event, schema=schema))
            except RefusedError as error:
                refused.append(str(error))
        if refused:
            raise RefusedError("; ".join(refused))


def _json(value: object) -> object:
    """JSON has no NaN: what is not known is null."""
    return None if isinstance(value, float) and not math.isfinite(value) else value
