"""A Modbus TCP server that costs next to nothing: all registers of a plant in one piece of memory."""

from __future__ import annotations

import asyncio
import struct
import time
from multiprocessing.synchronize import Event

import numpy as np

from benchmarks.plant.values import values_at

REGISTERS = 2
"""Of a 32-bit float."""
HEAD = 7
"""Bytes before the function code: transaction, protocol, length, unit."""
REQUEST = 12
"""Bytes of a request to read registers."""


class _Answers(asyncio.Protocol):
    """One client; it is answered from what the registers hold at that moment."""

    def __init__(self, loops: int) -> None:
        self._loops = loops
        self._rest = b""
        self._registers, self._second = b"", -1.0

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        self._transport = transport

    def data_received(self, data: bytes) -> None:
        second = float(int(time.time()))
        if second != self._second:
            self._registers = values_at(second, self._loops).astype(np.dtype(">f4")).tobytes()
            self._second = second
        data = self._rest + data
        answers = []
        while len(data) >= REQUEST:
            transaction, _, _, unit, function, address, count = struct.unpack(">HHHBBHH", data[:REQUEST])
            data = data[REQUEST:]
            body = self._registers[2 * address : 2 * (address + count)]
            head = struct.pack(">HHHBBB", transaction, 0, 3 + len(body), unit, function, len(body))
            answers.append(head + body)
        self._rest = data
        self._transport.write(b"".join(answers))  # type: ignore[attr-defined]


def serve_modbus(port: int, loops: int, listens: Event) -> None:
    """Serve OP, PV and SP of the loops, three floats each, in holding registers from 0 on."""

    async def serve() -> None:
        loop = asyncio.get_running_loop()
        server = await loop.create_server(lambda: _Answers(loops), "127.0.0.1", port)
        listens.set()
        await server.serve_forever()

    asyncio.run(serve())
