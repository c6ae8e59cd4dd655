"""MQTT as a connector: every session is a fresh client with a clean session."""

from __future__ import annotations

import asyncio
import json
import logging
import math
import ssl
import time
from collections.abc import AsyncIterator, Iterator, Mapping
from contextlib import AbstractAsyncContextManager, AsyncExitStack, asynccontextmanager, contextmanager

from aiomqtt import Client, Message, MqttCodeError, MqttError, ProtocolVersion

from connectors.base import AccessDeniedError, ConnectionLostError, Publication, Sample, Session
from connectors.mqtt.options import MqttOptions, MqttTag, MqttTarget
from connectors.mqtt.reader import TopicReader
from connectors.options import LoopTags
from connectors.tls import explain, refusal

logging.getLogger("mqtt").setLevel(logging.CRITICAL)  # what it logs, the session raises

_LOG = logging.getLogger(__name__)
_VERSIONS = {"3.1.1": ProtocolVersion.V311, "5": ProtocolVersion.V5}
_AT_LEAST_ONCE = 1
_NOT_LET_IN = (0x86, 0x87, 0x8A, 0x8C)
"""Bad user or password, not authorized, banned, bad method (MQTT 5, 3.2.2.2); those of 3.1.1 become these."""

MqttLoops = Mapping[str, LoopTags[MqttTag, MqttTarget]]


class MqttConnector:
    """An MQTT broker, what is read from it and published to it."""

    takes_orders = False

    def __init__(self, name: str, options: MqttOptions, loops: MqttLoops) -> None:
        self.name = name
        self._options = options
        self._loops = loops

    def session(self) -> AbstractAsyncContextManager[Session]:
        """Connect; raises ConnectionLostError."""
        return self._session()

    @asynccontextmanager
    async def _session(self) -> AsyncIterator[Session]:
        async with connected(self._options) as client:
            yield MqttSession(client, self._loops)


class MqttSession:
    """An open connection."""

    def __init__(self, client: Client, loops: MqttLoops) -> None:
        self._client = client
        self._loops = loops
        topics: dict[str, dict[str, MqttTag]] = {}
        for name, loop in loops.items():
            for role, tag in loop.tags.items():
                topics.setdefault(tag.topic, {})[f"{name}.{role}"] = tag
        self._tags = topics
        self._readers = {topic: TopicReader(tags) for topic, tags in topics.items()}

    async def samples(self) -> AsyncIterator[Sample]:
        """Yield the samples of every message; a topic that the broker refuses is told once."""
        with _as_connection_lost():
            for topic, code in (await self._refused()).items():
                for name in self._tags[topic]:
                    yield Sample.missing(name, time.time(), code, f"the broker refuses topic {topic}")
            async for message in self._client.messages:
                reader = self._readers.get(message.topic.value)
                if reader is None:
                    continue  # amqtt was seen to send what nobody asked for
                malformed = reader.malformed
                for sample in reader.samples(bytes(message.payload), time.time(), retained=message.retain):
                    yield sample
                if malformed == 0 and reader.malformed:
                    _LOG.warning("topic %s: a message cannot be read as configured", message.topic)

    async def publish(self, publication: Publication) -> None:
        """Publish a state, retained, or an event, until the broker has it; raises ConnectionLostError."""
        loop = self._loops.get(publication.subject)
        payload = json.dumps({name: _json(value) for name, value in publication.fields.items()})
        for target in loop.targets if loop else ():
            topic = target.topic.replace("{loop}", publication.subject)
            is_state = publication.kind == "state"
            with _as_connection_lost():
                await self._client.publish(
                    topic if is_state else f"{topic}/event", payload, qos=_AT_LEAST_ONCE, retain=is_state
                )

    async def _refused(self) -> dict[str, int]:
        """Subscribe to all topics; return those the broker does not allow, with its reason code."""
        if not self._tags:
            return {}
        reasons = await self._client.subscribe([(topic, _AT_LEAST_ONCE) for topic in self._tags])
        codes = [getattr(reason, "value", reason) for reason in reasons]
        return {topic: code for topic, code in zip(self._tags, codes, strict=True) if code >= 0x80}


class Inbox(asyncio.Queue[Message]):
    """Messages that wait to be read; while it is full, new ones are dropped, and that is logged once."""

    _dropped = 0

    def put_nowait(self, item: Message) -> None:
        """Keep a message, or count it as dropped."""
        if not self.full():
            super().put_nowait(item)
            return
        if self._dropped == 0:
            _LOG.warning("topic %s: messages are dropped, the reader is too slow", item.topic)
        self._dropped += 1


class TidySocket(ssl.SSLSocket):
    """Closes itself where the handshake fails; paho would leave that to the garbage collector."""

    def do_handshake(self, block: bool = False) -> None:  # noqa: FBT001, FBT002 - as ssl calls it
        """Agree with the broker; raises OSError."""
        try:
            super().do_handshake(block)
        except OSError:
            self.close()
            raise


@asynccontextmanager
async def connected(options: MqttOptions) -> AsyncIterator[Client]:
    """Connect a fresh client; raises ConnectionLostError, AccessDeniedError."""
    peer = f"MQTT broker at {options.host}:{options.port}: "
    tls = None if options.tls is None else options.tls.context()
    if tls is not None:
        tls.sslsocket_class = TidySocket
    password = None if options.password is None else options.password.read("password")
    client = Client(
        options.host,
        options.port,
        username=options.user,
        password=password,
        tls_context=tls,
        protocol=_VERSIONS[options.version],
        timeout=options.timeout,
        keepalive=options.keepalive,
        queue_type=Inbox,
        max_queued_incoming_messages=options.queue,
    )
    with _as_connection_lost():
        async with AsyncExitStack() as stack:
            try:
                await stack.enter_async_context(client)
            except MqttError as error:
                why = _denial(error, options)
                if why is None and tls is not None:
                    why = await explain(options.host, options.port, tls, options.timeout)
                if why is not None:
                    raise AccessDeniedError(peer + why) from error
                raise ConnectionLostError(f"{peer}{error}") from error
            yield client


def _denial(error: MqttError, options: MqttOptions) -> str | None:
    """Return what the user must change; None if the broker was only not there."""
    if isinstance(error, MqttCodeError) and getattr(error.rc, "value", None) in _NOT_LET_IN:
        who = "anonymous clients" if options.user is None else f"user {options.user}"
        return f"it does not let {who} in ({error}); check user and password"
    return refusal(error.__context__, options.host)  # aiomqtt hides the cause of its errors there


@contextmanager
def _as_connection_lost() -> Iterator[None]:
    try:
        yield
    except (MqttError, OSError) as error:
        raise ConnectionLostError(str(error)) from error


def _json(value: object) -> object:
    """JSON has no NaN: what is not known is null."""
    return None if isinstance(value, float) and not math.isfinite(value) else value
