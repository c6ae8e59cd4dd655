"""A TCP proxy that does to connections what happens to them in a plant. Loopback only.

    async with FaultProxy(port_of_the_peer) as proxy:
        ...  # clients connect to proxy.port
        async with proxy.suffering(STALL):
            ...

TCP loses no byte amid a connection, so this proxy does not either: bytes come late, in other pieces,
with flipped bits (as bad hardware behind the checksum makes them), or the connection ends.
"""

from __future__ import annotations

import asyncio
import contextlib
import random
import socket
import struct
from collections.abc import AsyncIterator, Coroutine
from dataclasses import dataclass
from typing import Any, Literal, Self

CHUNK = 4096
RESET_ON_CLOSE = struct.pack("ii", 1, 0)
"""SO_LINGER: on, 0 s."""


@dataclass(frozen=True, slots=True)
class Fault:
    """What the proxy does from now on; by default it passes everything on."""

    name: str
    resets: bool = False
    """Connections that are open when it begins get an RST."""
    listens: bool = True
    """Whether new connections are accepted; if not, they are refused."""
    answers: bool = True
    """Whether new connections reach the peer; if not, they are accepted and never hear anything."""
    flows: bool = True
    """Whether bytes are passed on; if not, they wait, and sockets stay open."""
    latency: float = 0.0
    """By how much each byte is late, each way, s."""
    rate: float | None = None
    """Most bytes a second, each way; None: any."""
    slices: bool = False
    """Pass bytes on in pieces of 1 to 3."""
    corrupt: float = 0.0
    """Probability that a chunk from the peer has one bit flipped."""
    ends: Literal["fin", "rst"] | None = None
    """How each connection ends after 1 to 200 bytes from the peer, mostly amid a frame."""


HEALTHY = Fault("healthy")
RESET = Fault("reset", resets=True)
REFUSE = Fault("refuse", resets=True, listens=False)
STALL = Fault("stall", flows=False)
BLACK_HOLE = Fault("black_hole", resets=True, answers=False)
LATENCY = Fault("latency", latency=0.15)
SLICES = Fault("slices", slices=True)
CORRUPT = Fault("corrupt", corrupt=0.3)
TRUNCATE = Fault("truncate", ends="fin")
CUT = Fault("cut", ends="rst")
THROTTLE = Fault("throttle", rate=400.0)


class FaultProxy:
    """Passes connections on to a port of this machine, through the fault of the moment."""

    def __init__(self, upstream: int, seed: int = 1) -> None:
        self.upstream = upstream
        self.port = 0
        self.accepted = 0
        """Connections since the start."""
        self._fault = HEALTHY
        self._chance = random.Random(seed)
        self._flowing = asyncio.Event()
        self._links: dict[asyncio.Task[Any] | None, list[asyncio.StreamWriter]] = {}

    @property
    def open(self) -> int:
        """Connections that clients have now."""
        return len(self._links)

    async def __aenter__(self) -> Self:
        """Begin to listen."""
        self._flowing.set()
        await self._listen()
        return self

    async def __aexit__(self, *_: object) -> None:
        """Stop to listen and close every connection."""
        self._server.close()
        links = [task for task in self._links if task is not None]
        for task in links:
            task.cancel()
        await asyncio.gather(*links, return_exceptions=True)
        await self._server.wait_closed()

    async def begin(self, fault: Fault) -> None:
        """Let a fault begin; the one before ends."""
        self._fault = fault
        if fault.listens and not self._server.is_serving():
            await self._listen()
        elif not fault.listens:
            self._server.close()
        if fault.flows:
            self._flowing.set()
        else:
            self._flowing.clear()
        if fault.resets:
            for writers in self._links.values():
                for writer in writers:
                    _reset(writer)

    async def end(self) -> None:
        """Pass everything on again; what waits arrives now."""
        await self.begin(HEALTHY)

    @contextlib.asynccontextmanager
    async def suffering(self, fault: Fault) -> AsyncIterator[None]:
        """Have a fault for a while."""
        await self.begin(fault)
        try:
            yield
        finally:
            await self.end()

    async def _listen(self) -> None:
        self._server = await asyncio.start_server(self._accept, "127.0.0.1", self.port)
        self.port = self._server.sockets[0].getsockname()[1]

    async def _accept(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self.accepted += 1
        task = asyncio.current_task()
        writers = self._links[task] = [writer]
        if task is not None:
            task.add_done_callback(self._links.pop)
        try:
            if not self._fault.answers:
                await reader.read()  # until the client gives up
                return
            up_reader, up_writer = await asyncio.open_connection("127.0.0.1", self.upstream)
            writers.append(up_writer)
            await _first_of(
                self._pump(reader, up_writer, down=False), self._pump(up_reader, writer, down=True)
            )
        except (OSError, asyncio.CancelledError):
            pass  # a peer that is not there, or the end of the test
        finally:
            for each in writers:
                each.close()

    async def _pump(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter, *, down: bool) -> None:
        left = self._chance.randint(1, 200)
        while data := await reader.read(CHUNK):
            await self._flowing.wait()
            fault = self._fault
            if fault.latency:
                # a chunk at a time is enough: what comes meanwhile is late by as much, and not twice as much
                await asyncio.sleep(fault.latency)
            if down and fault.corrupt and self._chance.random() < fault.corrupt:
                data = self._flipped(data)
            if down and fault.ends:
                writer.write(data[:left])
                left -= len(data)
                if left <= 0:
                    await writer.drain()
                    if fault.ends == "rst":
                        _reset(writer)
                    return
                continue
            await self._write(writer, data, fault)

    async def _write(self, writer: asyncio.StreamWriter, data: bytes, fault: Fault) -> None:
        while data:
            size = self._chance.randint(1, 3) if fault.slices else len(data)
            if fault.rate is not None:
                size = min(size, max(1, round(fault.rate / 10)))
                await asyncio.sleep(size / fault.rate)
            writer.write(data[:size])
            await writer.drain()
            if fault.slices:
                await asyncio.sleep(0)  # the loop sends this piece before it gets the next
            data = data[size:]

    def _flipped(self, data: bytes) -> bytes:
        at = self._chance.randrange(len(data))
        return data[:at] + bytes([data[at] ^ (1 << self._chance.randrange(8))]) + data[at + 1 :]


async def _first_of(*pumps: Coroutine[Any, Any, None]) -> None:
    """Run all until one ends; raise what it raised."""
    tasks = [asyncio.ensure_future(pump) for pump in pumps]
    try:
        done, _ = await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
    finally:
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
    for task in done:
        task.result()


def _reset(writer: asyncio.StreamWriter) -> None:
    """Close with an RST instead of a FIN."""
    sock = writer.get_extra_info("socket")
    if sock is not None and sock.fileno() >= 0:
        sock.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, RESET_ON_CLOSE)
    writer.transport.abort()
