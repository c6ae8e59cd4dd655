"""Reads that bear numbers, so that several may be under way on one connection.

pymodbus has one request under way, and makes a number of each register by a call of its own; connecting, TLS
and writing stay with it. An answer goes to the request that has its transaction number (Modbus messaging on
TCP/IP 1.0b, 4.2); one that nobody waits for any more is left out.
"""

from __future__ import annotations

import asyncio
import math
import struct
from collections.abc import Callable
from typing import Any, NamedTuple

from pymodbus.exceptions import ConnectionException, ModbusException, ModbusIOException

HEAD = struct.Struct(">HHH")
"""Transaction, protocol, length of what follows."""
REQUEST = struct.Struct(">HHHBBHH")
"""The head, unit, function, address, count."""
LENGTHS = range(3, 255)
"""Of what follows the head: unit, function and a byte at least, 254 bytes at most."""
NUMBERS = range(65_001, 65_536)
"""Transaction numbers that pymodbus never uses: it begins anew after 65,000."""


class _UnderWay(NamedTuple):
    """A read that is under way."""

    answer: asyncio.Future[bytes]
    until: float
    """s of the event loop's clock."""

    def fail(self, error: ModbusException) -> None:
        """Have it raise an error, unless it has ended."""
        if not self.answer.done():
            self.answer.set_exception(error)
            self.answer.exception()  # it was noticed, though nobody may be waiting


class NumberedReads:
    """Reads over the connection that pymodbus has made; all it receives passes here first."""

    def __init__(self, context: Any, unit: int, timeout: float) -> None:  # noqa: ANN401 - pymodbus changes it
        """Take over what the connection receives.

        Args:
            context: pymodbus' protocol object.
            unit: Unit identifier.
            timeout: Longest wait for an answer, s.
        """
        self._context = context
        self._unit = unit
        self._timeout = timeout
        self._waiting: dict[int, _UnderWay] = {}
        """By number; the one that has waited longest first."""
        self._patience: asyncio.TimerHandle | None = None
        """Ends the wait of the first of them. One timer for all: most are answered within a millisecond."""
        self._number = NUMBERS.start
        self._rest = b""
        self._others: Callable[[bytes], int] = context.callback_data
        disconnected = context.callback_disconnected

        def on_disconnected(error: Exception | None) -> None:
            disconnected(error)
            self._end(ConnectionException(f"the device closed the connection{f': {error}' if error else ''}"))

        context.data_received, context.callback_disconnected = self._received, on_disconnected

    async def ask(self, function: int, address: int, count: int) -> bytes:
        """Return the answer from the function code on; raises ModbusException."""
        if self._context.transport is None:
            raise ConnectionException("the connection is closed")
        number, loop = self._next(), asyncio.get_running_loop()
        waiting = self._waiting[number] = _UnderWay(loop.create_future(), loop.time() + self._timeout)
        if self._patience is None:
            self._patience = loop.call_at(waiting.until, self._look)
        try:
            self._context.transport.write(
                REQUEST.pack(number, 0, REQUEST.size - HEAD.size, self._unit, function, address, count)
            )
            found = await waiting.answer
        finally:
            self._waiting.pop(number, None)
        if found[0] != self._unit or found[1] & 0x7F != function:
            raise ModbusIOException(f"unit {found[0]} answered with function {found[1]}")
        return found[1:]

    def _next(self) -> int:
        """Return a number that no request under way has: there are more of them than may be under way."""
        while True:
            self._number = NUMBERS.start + (self._number + 1 - NUMBERS.start) % len(NUMBERS)
            if self._number not in self._waiting:
                return self._number

    def _look(self) -> None:
        """End the waits that are too long; look again at the end of the next."""
        self._patience, loop = None, asyncio.get_running_loop()
        for waiting in self._waiting.values():
            if waiting.until > loop.time():
                self._patience = loop.call_at(waiting.until, self._look)
                return
            waiting.fail(ModbusIOException(f"no answer within {self._timeout:g} s"))

    def _received(self, data: bytes) -> None:
        data = self._rest + data
        begin = 0
        while len(data) - begin >= HEAD.size:
            number, protocol, length = HEAD.unpack_from(data, begin)
            if protocol != 0 or length not in LENGTHS:
                self._rest = b""
                self._end(ModbusIOException("what the device sent is not Modbus"))
                return
            end = begin + HEAD.size + length
            if end > len(data):
                break
            self._give(number, data[begin:end])
            begin = end
        self._rest = data[begin:]

    def _give(self, number: int, frame: bytes) -> None:
        waiting = self._waiting.get(number)
        if waiting is not None:
            if not waiting.answer.done():
                waiting.answer.set_result(frame[HEAD.size :])
        elif number not in NUMBERS:
            try:
                self._others(frame)
            except ModbusException as error:
                self._end(error)

    def _end(self, error: ModbusException) -> None:
        """Have all that wait raise an error: pymodbus would let them wait for their whole timeout."""
        for waiting in [*self._waiting.values(), _UnderWay(self._context.response_future, math.inf)]:
            waiting.fail(error)
