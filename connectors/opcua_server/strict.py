"""Clients that send what is no OPC UA: counted, logged, dropped. asyncua lets them stay and says nothing.

A frame that cannot be read ends its connection (OPC UA Part 6, 7.1.5); a request that cannot is answered with
a fault, as asyncua does. What a server may refuse in good order is neither.
"""

from __future__ import annotations

import asyncio
import struct
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from asyncua import Server, ua
from asyncua.common.utils import ServiceError
from asyncua.server.binary_server_asyncio import BinaryServer

from connectors.malformed import Malformed
from connectors.opcua_server.asyncua_private import (
    ConnectionProtocol,
    MessageProcessor,
    make_connections_with,
)

_PLAIN = (b"HEL", b"ACK", b"ERR")
_SECURE = (b"OPN", b"MSG", b"CLO")
"""Types of messages; those of a secure channel have its number behind their length."""
_CHUNKS = b"FCA"
_NO_OPCUA = "does not speak OPC UA and is dropped"
_ENDS_AMID = "ends amid a message"
_NO_REQUEST = "sends what is no request"


class StrictServer(Server):  # type: ignore[misc]
    """asyncua's server, which looks at what its clients send."""

    def __init__(self, malformed: Malformed, **options: Any) -> None:  # noqa: ANN401 - asyncua's own
        self._malformed = malformed
        self._bserver: BinaryServer | None = None
        super().__init__(**options)

    @property
    def bserver(self) -> BinaryServer | None:
        """What listens. ``start`` makes it and lets clients in at once: only here one can come between."""
        return self._bserver

    @bserver.setter
    def bserver(self, made: BinaryServer | None) -> None:
        self._bserver = made
        if made is not None:
            make_connections_with(made, lambda: StrictProtocol(made, self._malformed))


class StrictProtocol(ConnectionProtocol):
    """One connection."""

    def __init__(self, listener: BinaryServer, malformed: Malformed) -> None:
        super().__init__(listener)
        self._malformed = malformed
        self.processor: StrictProcessor | None

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Let the client in, or turn it away where there are too many."""
        super().connection_made(transport)
        if self.processor is not None:
            self.processor = StrictProcessor(self.iserver, transport, self.limits, self._note)
            self.processor.set_policies(self.policies)

    def data_received(self, data: bytes) -> None:
        """Take bytes; those that cannot become a message end the connection."""
        super().data_received(data)
        frame = self.incomplete_frame
        if frame and not _may_become_a_message(frame, self.limits.max_recv_buffer):
            self.discard_frame()
            self._note(_NO_OPCUA)
            self.transport.abort()

    def connection_lost(self, ex: BaseException | None) -> None:
        """Note a client that went amid a message."""
        incomplete = self.processor is not None and self.processor.has_incomplete_message
        if self.incomplete_frame or incomplete:
            self._note(_ENDS_AMID)
        super().connection_lost(ex)

    def _note(self, what: str) -> None:
        address = self.peer_name[0] if self.peer_name else "that is gone"
        self._malformed.note(f"client {address}", what)


class StrictProcessor(MessageProcessor):
    """Reads the messages of one connection."""

    def __init__(self, server: Any, transport: Any, limits: Any, note: Callable[[str], None]) -> None:  # noqa: ANN401
        super().__init__(server, transport, limits)
        self._note = note

    async def process(self, header: Any, body: Any) -> bool:  # noqa: ANN401
        """Obey a frame; return whether the connection goes on."""
        going_on = False
        try:
            with self._noted(_NO_OPCUA, ua.uaerrors.UaStatusCodeError):
                if header.MessageType in _PLAIN and header.ChunkType != ua.ChunkType.Single:
                    raise ServiceError(ua.StatusCodes.BadTcpMessageTypeInvalid)
                going_on = bool(await super().process(header, body))
        finally:
            if not going_on:
                self.close_transport()
        return going_on

    async def answer(self, *message: Any) -> Any:  # noqa: ANN401
        """Answer a request, and count one that is none."""
        with self._noted(_NO_REQUEST, ua.uaerrors.UaStatusCodeError, ServiceError):
            return await super().answer(*message)

    @contextmanager
    def _noted(self, what: str, *refusals: type[Exception]) -> Iterator[None]:
        """Note any exception that is no refusal in good order; whatever it is, asyncua goes on with it."""
        in_order = False
        try:
            yield
            in_order = True
        finally:
            if not (in_order or isinstance(sys.exception(), (*refusals, asyncio.CancelledError))):
                self._note(what)


def _may_become_a_message(start: bytes, longest: int) -> bool:
    """Whether more bytes may follow that make a message of at most ``longest`` bytes (Part 6, 7.1.2)."""
    kind = start[:3]
    if not any(each.startswith(kind) for each in (*_PLAIN, *_SECURE)):
        return False
    if len(start) < 8:
        return len(start) < 4 or start[3] in _CHUNKS
    (size,) = struct.unpack_from("<I", start, 4)
    return start[3] in _CHUNKS and (12 if kind in _SECURE else 8) < size <= longest
