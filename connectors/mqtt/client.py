"""One MQTT connection: a fresh client, and in plain words why it could not connect."""

from __future__ import annotations

import asyncio
import logging
import ssl
from collections.abc import AsyncIterator, Iterable, Iterator
from contextlib import AsyncExitStack, asynccontextmanager, contextmanager
from dataclasses import dataclass
from functools import partial
from typing import Any, Self

from aiomqtt import Client, Message, MqttCodeError, MqttError, ProtocolVersion, Will
from paho.mqtt.packettypes import PacketTypes
from paho.mqtt.properties import Properties

from connectors.base import AccessDeniedError, ConnectionLostError, RefusedError
from connectors.mqtt.inbox import Inbox, Losses
from connectors.mqtt.options import Broker
from connectors.mqtt.paho_private import FastReading
from connectors.tls import explain, refusal

logging.getLogger("mqtt").setLevel(logging.CRITICAL)  # what it logs, the session raises

_VERSIONS = {"3.1.1": ProtocolVersion.V311, "5": ProtocolVersion.V5}
AT_LEAST_ONCE = 1
AT_ONCE = 500
"""Messages that are taken from those that wait before others have their turn: some ten milliseconds."""
_NOT_LET_IN = (0x86, 0x87, 0x8A, 0x8C)
"""Bad user or password, not authorized, banned, bad method (MQTT 5, 3.2.2.2); those of 3.1.1 become these."""


class TidySocket(ssl.SSLSocket):
    """Closes itself where the handshake fails; paho would leave that to the garbage collector."""

    def do_handshake(self, block: bool = False) -> None:  # noqa: FBT001, FBT002 - as ssl calls it
        """Agree with the broker; raises OSError."""
        try:
            super().do_handshake(block)
        except OSError:
            self.close()
            raise


@dataclass(frozen=True, slots=True)
class Outgoing:
    """A message to the broker, at least once."""

    topic: str
    payload: bytes
    retain: bool = False
    """Whether the broker keeps it for who comes late."""
    qos: int = AT_LEAST_ONCE
    content: str = "application/json"
    """MIME type, sent with MQTT 5."""
    schema: str | None = None
    """Version of the payload's fields, sent with MQTT 5."""

    def will(self, version: str) -> Will:
        """Return it as what the broker says when we are gone without a word."""
        properties = self.properties(PacketTypes.WILLMESSAGE) if version == "5" else None
        return Will(self.topic, self.payload, self.qos, self.retain, properties)

    def properties(self, packet: int = PacketTypes.PUBLISH) -> Properties:
        """Return what MQTT 5 says of it. It never expires: a consumer that comes late must learn of it."""
        properties = Properties(packet)
        properties.ContentType = self.content
        properties.PayloadFormatIndicator = int(self.content == "application/json")
        if self.schema is not None:
            properties.UserProperty = ("schema", self.schema)
        return properties


class StrictClient(Client):
    """aiomqtt's, which keeps some things to itself, and may write to a socket that is closed already.

    A broker that answers that it does not take a message (MQTT 5), and one that hangs up before it lets us
    in, or at that moment.
    """

    _queue: Inbox

    def __init__(self, *args: Any, **kwargs: Any) -> None:  # noqa: ANN401 - all that aiomqtt takes
        super().__init__(*args, **kwargs)
        self._speaks_5 = kwargs.get("protocol") is ProtocolVersion.V5
        reading = FastReading(self._client, self._queue.put_nowait, speaks_5=self._speaks_5)
        self._client.loop_read = reading.read
        self._one_at_a_time = asyncio.Lock()
        self._refusal: str | None = None

    async def __aenter__(self) -> Self:
        """Connect; raises MqttError."""
        lost = self._disconnected
        lost.add_done_callback(_noticed)
        await super().__aenter__()
        if self._disconnected is not lost:  # aiomqtt has thrown away that it was lost meanwhile
            raise MqttError("the broker hung up at once")
        return self

    async def received(self) -> AsyncIterator[Message]:
        """Yield messages for ever; raises MqttError when the broker is gone.

        aiomqtt makes a task for each; those that have come already are taken without.
        """
        async for message in self.messages:
            yield message
            for _ in range(min(self._queue.qsize(), AT_ONCE)):
                yield self._queue.get_nowait()

    async def send(self, message: Outgoing) -> None:
        """Publish and return when the broker has it; raises ConnectionLostError, RefusedError."""
        properties = message.properties() if self._speaks_5 else None
        async with self._one_at_a_time:
            self._refusal = None
            with as_connection_lost():
                await self.publish(
                    message.topic,
                    message.payload,
                    qos=message.qos,
                    retain=message.retain,
                    properties=properties,
                )
            if self._refusal is not None:
                raise RefusedError(f"topic {message.topic}: {self._refusal}")

    def _on_socket_register_write(self, client: Any, userdata: Any, sock: Any) -> None:  # noqa: ANN401, ARG002
        """Write when the socket can take it; aiomqtt's does not look whether it is still open by then."""

        def write() -> None:
            try:
                client.loop_write()
            except (OSError, ValueError) as error:
                if not self._disconnected.done():
                    self._disconnected.set_exception(error)

        def register() -> None:
            if sock.fileno() >= 0:
                self._loop.add_writer(sock.fileno(), write)

        self._loop.call_soon_threadsafe(register)  # paho may be in another thread

    def _on_disconnect(
        self,
        client: Any,  # noqa: ANN401
        userdata: Any,  # noqa: ANN401
        flags: Any,  # noqa: ANN401
        reason_code: Any,  # noqa: ANN401
        properties: Any = None,  # noqa: ANN401
    ) -> None:
        """Notice one that hangs up before it lets us in, too; aiomqtt waits on for its whole timeout."""
        if not self._connected.done():
            self._connected.set_exception(MqttError("the broker hung up before it let us in"))
        super()._on_disconnect(client, userdata, flags, reason_code, properties)

    def _on_publish(self, client: Any, userdata: Any, mid: int, reason_code: Any, properties: Any) -> None:  # noqa: ANN401
        if reason_code.is_failure:
            self._refusal = str(reason_code)
        super()._on_publish(client, userdata, mid, reason_code, properties)


def _noticed(future: asyncio.Future[None]) -> None:
    """Take a loss out of its future, or asyncio logs that nobody did."""
    if not future.cancelled():
        future.exception()


@asynccontextmanager
async def connected(
    options: Broker,
    identifier: str | None = None,
    will: Outgoing | None = None,
    losses: Losses | None = None,
) -> AsyncIterator[StrictClient]:
    """Connect a fresh client; raises ConnectionLostError, AccessDeniedError.

    Args:
        options: Where and how.
        identifier: Name of the client to the broker, which lets go of a former one of that name.
        will: What the broker says when the connection breaks.
        losses: Counts what comes in and cannot wait to be read.
    """
    peer = f"MQTT broker at {options.host}:{options.port}: "
    tls = None if options.tls is None else options.tls.context()
    if tls is not None:
        tls.sslsocket_class = TidySocket
    password = None if options.password is None else options.password.read("password")
    client = StrictClient(
        options.host,
        options.port,
        identifier=identifier,
        will=None if will is None else will.will(options.version),
        username=options.user,
        password=password,
        tls_context=tls,
        protocol=_VERSIONS[options.version],
        timeout=options.timeout,
        keepalive=options.keepalive,
        queue_type=partial(Inbox, losses=losses),
        max_queued_incoming_messages=options.queue,
    )
    with as_connection_lost():
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


async def subscribe(client: Client, topics: Iterable[str]) -> dict[str, int]:
    """Subscribe to all topics; return those the broker does not allow, with its reason code."""
    topics = list(topics)
    if not topics:
        return {}
    with as_connection_lost():
        reasons = await client.subscribe([(topic, AT_LEAST_ONCE) for topic in topics])
    codes = [getattr(reason, "value", reason) for reason in reasons]
    return {topic: code for topic, code in zip(topics, codes, strict=True) if code >= 0x80}


def _denial(error: MqttError, options: Broker) -> str | None:
    """Return what the user must change; None if the broker was only not there."""
    if isinstance(error, MqttCodeError) and getattr(error.rc, "value", None) in _NOT_LET_IN:
        who = "anonymous clients" if options.user is None else f"user {options.user}"
        return f"it does not let {who} in ({error}); check user and password"
    return refusal(error.__context__, options.host)  # aiomqtt hides the cause of its errors there


@contextmanager
def as_connection_lost() -> Iterator[None]:
    """Raise the library's errors as ConnectionLostError."""
    try:
        yield
    except (MqttError, OSError) as error:
        raise ConnectionLostError(str(error)) from error
