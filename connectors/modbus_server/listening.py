"""Clients of the server: one request after the other each, and none that can hold up or exhaust the others.

The reason for it: ``docs/decisions/0022-own-modbus-server.md``.
"""

from __future__ import annotations

import asyncio
import contextlib
import ipaddress
import logging
import math
import ssl
import struct
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from typing import Any

from connectors.base import ConnectionLostError
from connectors.malformed import Malformed
from connectors.modbus_server.image import Image
from connectors.modbus_server.options import ModbusServerOptions
from connectors.modbus_server.pdu import answer

_LOG = logging.getLogger(__name__)
_HEADER = struct.Struct(">HHHB")
"""Transaction, protocol (0), bytes that follow, unit (Modbus Messaging on TCP/IP 1.0b, 3.1)."""
_LONGEST = 254
"""Bytes after the length field, the unit's among them."""
_READ_WITHIN = 10.0
"""s that a client may take to send a request to its end, and to take its answer."""
_GIVES_WAY = 10.0
"""Silence after which a client gives way to one that comes, where there are as many as may be, s."""
_TARGET_FAILED = 0x0B
"""Exception: no such unit behind this gateway."""


class Clients:
    """All connections of one server."""

    def __init__(self, options: ModbusServerOptions, image: Image, malformed: Malformed) -> None:
        self.turned_away = 0
        """Those that may not connect, or were too many."""
        self._options = options
        self._image = image
        self._malformed = malformed
        self._open: dict[asyncio.Task[None] | None, asyncio.StreamWriter] = {}
        self._told: set[str] = set()
        self._silent_since: dict[asyncio.Task[None] | None, float] = {}
        """Those that have no request under way, the longest silence first."""

    async def serve(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        """Answer one client until it goes, is silent for too long or speaks nonsense."""
        task: asyncio.Task[None] | None = asyncio.current_task()
        peer = writer.get_extra_info("peername")  # None where it was gone before we looked
        address = "" if peer is None else str(peer[0])
        try:
            if peer is None or not self._may_connect(address):
                return
            self._open[task] = writer
            await self._converse(reader, writer, _name(writer, address))
        except (OSError, asyncio.IncompleteReadError, TimeoutError):
            pass  # it is gone, and may come again
        finally:
            self._open.pop(task, None)
            self._silent_since.pop(task, None)
            writer.transport.abort()
            with contextlib.suppress(OSError):
                await writer.wait_closed()

    async def end(self) -> None:
        """Drop every client."""
        tasks = [task for task in self._open if task is not None]
        for writer in self._open.values():
            writer.transport.abort()  # their tasks end by themselves; streams log those that are cancelled
        if tasks:
            await asyncio.wait(tasks)

    async def _converse(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter, name: str) -> None:
        task = asyncio.current_task()
        while True:
            self._silent_since[task] = asyncio.get_running_loop().time()
            async with asyncio.timeout(self._options.idle):
                first = await reader.readexactly(1)
            self._silent_since.pop(task, None)
            try:
                async with asyncio.timeout(_READ_WITHIN):
                    head = first + await reader.readexactly(_HEADER.size - 1)
                    transaction, protocol, length, unit = _HEADER.unpack(head)
                    if protocol != 0 or not 2 <= length <= _LONGEST:
                        self._malformed.note(name, "does not speak Modbus TCP and is dropped")
                        return
                    request = await reader.readexactly(length - 1)
            except (asyncio.IncompleteReadError, TimeoutError):
                self._malformed.note(name, "does not end its request and is dropped")
                raise
            if self._options.unit in (None, unit):
                said = answer(
                    request,
                    self._image,
                    name,
                    lambda: self._malformed.note(name, "sends what is no request to this server"),
                )
            else:
                said = bytes([request[0] | 0x80, _TARGET_FAILED])
            writer.write(_HEADER.pack(transaction, 0, len(said) + 1, unit) + said)
            async with asyncio.timeout(_READ_WITHIN):
                await writer.drain()

    def _may_connect(self, address: str) -> bool:
        allowed = self._options.allow
        peer = ipaddress.ip_address(address.partition("%")[0])
        known = not allowed or any(peer in network for network in allowed)
        if known and (len(self._open) < self._options.clients or self._one_gave_way()):
            return True
        self.turned_away += 1
        why = f"there are {self._options.clients} already" if known else "it is not in allow"
        self._tell(f"modbus {address} is turned away: {why}")
        return False

    def _one_gave_way(self) -> bool:
        """Drop the client that was silent for longest; return whether one was for long enough."""
        task, since = next(iter(self._silent_since.items()), (None, math.inf))
        if asyncio.get_running_loop().time() - since < _GIVES_WAY:
            return False
        del self._silent_since[task]
        self._open.pop(task).transport.abort()
        return True

    def _tell(self, what: str) -> None:
        """Log what happens for the first time; peers can repeat it as often as they like."""
        if what not in self._told and len(self._told) < 100:
            self._told.add(what)
            _LOG.warning("Modbus server: %s", what)


@asynccontextmanager
async def listening(
    options: ModbusServerOptions, image: Image, malformed: Malformed
) -> AsyncIterator[asyncio.Server]:
    """Let clients come in; raises ConnectionLostError, AccessDeniedError."""
    tls = None if options.tls is None else options.tls.context()
    clients = Clients(options, image, malformed)
    try:
        server = await asyncio.start_server(
            clients.serve,
            options.host,
            options.port,
            ssl=tls,
            ssl_handshake_timeout=None if tls is None else _READ_WITHIN,
            limit=4096,
        )
    except OSError as error:
        place = f"Modbus server: cannot listen on {options.host}:{options.port}"
        raise ConnectionLostError(f"{place}: {error.strerror or error}") from error
    try:
        yield server
    finally:
        server.close()
        await clients.end()
        await server.wait_closed()


def _name(writer: asyncio.StreamWriter, address: str) -> str:
    """Return who a client is: its address, and the name in its certificate where it showed one."""
    tls: ssl.SSLObject | None = writer.get_extra_info("ssl_object")
    shown: dict[str, Any] = (tls.getpeercert() if tls is not None else None) or {}
    subject = (pair for part in shown.get("subject", ()) for pair in part)
    names = [str(value) for key, value in subject if key == "commonName"]
    return " ".join(["modbus", address, *names[:1]])
