"""Every member of paho-mqtt that its documentation does not list and fast reading needs: here only.

paho 2.2 calls ``recv`` for the first byte of a packet, for each byte of its length and for the rest: three or
more system calls a message. Here one brings all that has come, publications are read out of it, and the rest
is handed to paho as if it came from the socket. ``missing`` names what a newer version has not got any more.
"""

from __future__ import annotations

import contextlib
import struct
import time
from collections.abc import Callable
from typing import Any

from aiomqtt import Message
from paho.mqtt.client import Client
from paho.mqtt.enums import MessageType, MQTTErrorCode

from connectors.mqtt.publications import Publications

MEMBERS = ("_create_socket", "_in_packet", "_last_bytes_received", "_packet_queue", "_sock")
"""Of paho's client, used below."""
AT_ONCE = 16_384
"""Bytes of one system call: some hundred messages. A record of TLS has no more, so none is left behind in
OpenSSL where nobody would look for it."""
IN_A_TURN = 4
"""System calls before others have their turn: some ten milliseconds. In a large plant a turn of the event
loop may take a tenth of a second, and what comes meanwhile is read in the next one."""


def missing() -> list[str]:
    """Return the members that the installed paho does not have."""
    made = Client.__init__.__code__.co_names
    return [name for name in MEMBERS if not (hasattr(Client, name) or name in made)]


class BufferedSocket:
    """A socket that paho reads from, and of which more was read than paho wanted.

    Only ``fill`` reads more than was wanted; who calls it leaves nothing held, or the event loop, which
    looks at the descriptor, would not see that there is something.
    """

    def __init__(self, sock: Any) -> None:  # noqa: ANN401 - plain, or of TLS
        self._sock = sock
        self.held = b""
        self.at = 0
        """Where what was not read begins."""

    @property
    def has_more(self) -> bool:
        """Whether some of what is held was not read."""
        return self.at < len(self.held)

    def fill(self) -> None:
        """Hold what has come, at most ``AT_ONCE`` bytes; after it nothing is held where nothing came."""
        with contextlib.suppress(OSError):  # paho meets it again, and says what becomes of it
            self.held, self.at = b"", 0
            self.held = self._sock.recv(AT_ONCE)

    def recv(self, size: int) -> bytes:
        """Return what is held, else what has come, at most ``size`` bytes; raises OSError."""
        if not self.has_more:
            received: bytes = self._sock.recv(size)
            return received
        found = self.held[self.at : self.at + size]
        self.at += len(found)
        return found

    def __getattr__(self, name: str) -> Any:  # noqa: ANN401 - all else is the socket's
        return getattr(self._sock, name)


class FastReading:
    """Reads in place of ``loop_read`` of a client of paho."""

    def __init__(self, client: Client, put: Callable[[Message], None], *, speaks_5: bool) -> None:
        """Have the client read through a buffer from its next connection on; ``put`` takes publications."""
        self._client: Any = client
        self._put = put
        self._publications = Publications(speaks_5=speaks_5)
        self._read_packet = client.loop_read
        create_socket = self._client._create_socket  # noqa: SLF001
        self._client._create_socket = lambda: BufferedSocket(create_socket())  # noqa: SLF001

    def read(self, _most: int = 1) -> MQTTErrorCode:
        """Read what has come; returns what ``loop_read`` does."""
        for _ in range(IN_A_TURN):
            socket = self._client._sock  # noqa: SLF001
            found = self._read_once(socket)
            if found is not MQTTErrorCode.MQTT_ERR_SUCCESS or socket is None or len(socket.held) < AT_ONCE:
                break
        return found

    def _read_once(self, socket: BufferedSocket | None) -> MQTTErrorCode:
        if socket is None:
            return self._read_packet()
        socket.fill()
        if not socket.has_more:
            return self._read_packet()
        while socket.has_more:
            if self._client._in_packet["command"] == 0:  # noqa: SLF001 - paho is not amid a packet
                self._take(socket)
            if socket.has_more and (found := self._read_packet()) is not MQTTErrorCode.MQTT_ERR_SUCCESS:
                return found
        return MQTTErrorCode.MQTT_ERR_SUCCESS

    def _take(self, socket: BufferedSocket) -> None:
        """Take publications until there is something else."""
        acknowledged = []
        held, at, there = socket.held, socket.at, len(socket.held)
        while at < there and (found := self._publications.read(held, at)) is not None:
            message, at = found
            self._put(message)
            if message.qos:
                acknowledged.append(struct.pack(">BBH", MessageType.PUBACK, 2, message.mid))
        if at > socket.at:
            socket.at = at
            self._client._last_bytes_received = time.monotonic()  # noqa: SLF001
        if acknowledged:
            packet = b"".join(acknowledged)
            self._client._packet_queue(MessageType.PUBACK, packet, 0, 1)  # noqa: SLF001
