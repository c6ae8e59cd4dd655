"""With ``numbered.py`` all that touches pymodbus, whose interface changes with every minor release."""

from __future__ import annotations

import asyncio
import logging
import ssl
import struct
from collections.abc import AsyncIterator, Awaitable, Callable, Sequence
from contextlib import asynccontextmanager
from typing import TypeVar

import numpy as np
from pymodbus.client import AsyncModbusTcpClient, AsyncModbusTlsClient
from pymodbus.exceptions import ModbusException
from pymodbus.pdu import ModbusPDU

from connectors.base import AccessDeniedError, ConnectionLostError
from connectors.cancellation import ends_when_cancelled, obey_cancellation
from connectors.modbus.numbered import NumberedReads
from connectors.modbus.options import ModbusOptions, Table
from connectors.tls import explain

logging.getLogger("pymodbus").setLevel(logging.CRITICAL)  # what it logs, the session raises

ILLEGAL_ADDRESS = 2
EXCEPTIONS = {
    1: "it does not know this function",
    ILLEGAL_ADDRESS: "it has no such address",
    3: "it does not take this value or this number of registers",
    4: "it failed",
    6: "it is busy",
    10: "the gateway has no way to this unit",
    11: "the unit behind the gateway does not answer",
}
"""Of the Modbus application protocol 1.1b3, 7, as messages about a device."""
_READS = {"coil": 1, "discrete": 2, "holding": 3, "input": 4}
"""Function that reads a table."""
_EXCEPTION = 0x80
"""Is added to the function where the device refuses."""
_BYTE = 8
"""Bits come in whole bytes."""
Request = Callable[..., Awaitable[ModbusPDU]]
AnswerT = TypeVar("AnswerT")


class DeviceError(Exception):
    """The device answered with a Modbus exception."""

    def __init__(self, code: int) -> None:
        known = f", {EXCEPTIONS[code]}" if code in EXCEPTIONS else ""
        super().__init__(f"Modbus exception {code}{known}")
        self.code = code


class SilentBlockError(DeviceError):
    """The device gave no answer to this, and did to other requests."""

    def __init__(self, within: float) -> None:
        Exception.__init__(self, f"no answer within {within:g} s")
        self.code = 0


class ModbusClient:
    """A connection to one device. Every failure to get an answer in time is a ConnectionLostError."""

    def __init__(
        self, client: AsyncModbusTcpClient, options: ModbusOptions, tls: ssl.SSLContext | None
    ) -> None:
        self._client = client
        self._options = options
        self._tls = tls
        self._numbered = NumberedReads(client.ctx, options.unit, options.timeout)
        self._turns = asyncio.Semaphore(options.requests)
        """Of reads and writes: many a device does not see the second of two requests that come together."""
        self._answered = False
        self.timeout = options.timeout
        """Longest wait for an answer, s."""
        self.silent = False
        """Whether what failed last had no answer on a connection that stands."""

    async def read(self, table: Table, address: int, count: int) -> Sequence[int]:
        """Return ``count`` registers, or bits as 0 and 1; ``address`` as on the wire. Raises DeviceError."""
        pdu = await self._answer(lambda: self._numbered.ask(_READS[table], address, count))
        if pdu[0] & _EXCEPTION:
            raise DeviceError(pdu[1])
        data = pdu[2:]
        if len(data) != pdu[1]:
            raise ConnectionLostError(f"the device sent {len(data)} bytes of {pdu[1]} announced")
        values: Sequence[int]
        if table in ("coil", "discrete"):
            bits = np.unpackbits(np.frombuffer(data, np.uint8), bitorder="little").tolist()
            values = bits[:count] if len(bits) - count in range(_BYTE) else bits
        else:
            values = struct.unpack(f">{len(data) // 2}H", data[: len(data) // 2 * 2])
        if len(values) != count:
            raise ConnectionLostError(f"the device sent {len(values)} values of {count} requested")
        return values

    async def write_coil(self, address: int, value: bool) -> None:  # noqa: FBT001 - the value is what it is
        """Set one coil; raises DeviceError."""
        await self._ask(self._client.write_coil, address, value)

    async def write_registers(self, address: int, values: list[int]) -> None:
        """Set adjacent holding registers; raises DeviceError."""
        await self._ask(self._client.write_registers, address, values)

    async def _ask(self, request: Request, *args: int | list[int]) -> None:
        async def asked() -> ModbusPDU:  # pymodbus raises before there is anything to await
            return await request(*args, device_id=self._options.unit)

        answer = await self._answer(asked)
        if answer.isError():
            raise DeviceError(answer.exception_code)

    async def _answer(self, request: Callable[[], Awaitable[AnswerT]]) -> AnswerT:
        async with self._turns:
            return await self._answer_now(request)

    async def _answer_now(self, request: Callable[[], Awaitable[AnswerT]]) -> AnswerT:
        clock = asyncio.get_running_loop()
        began = clock.time()
        try:
            answer = await request()
        except (ModbusException, OSError) as error:
            self.silent = self._client.connected and clock.time() - began >= self.timeout
            if not self._answered:
                await _raise_denial(self._options, self._tls)
            raise ConnectionLostError(str(error)) from error
        self._answered = True
        obey_cancellation()
        return answer


@asynccontextmanager
async def connected(options: ModbusOptions) -> AsyncIterator[ModbusClient]:
    """Connect to a device; raises ConnectionLostError, AccessDeniedError."""
    tls = None if options.tls is None else options.tls.context()
    # retrying and reconnecting are the supervisor's; pymodbus would do both in silence, for minutes
    common = {"port": options.port, "timeout": options.timeout, "retries": 0, "reconnect_delay": 0}
    client = (
        AsyncModbusTcpClient(options.host, **common)
        if tls is None
        else AsyncModbusTlsClient(options.host, sslctx=tls, **common)
    )
    try:
        if not await ends_when_cancelled(client.connect()):
            await _raise_denial(options, tls)
            raise ConnectionLostError(f"no Modbus device answers at {options.host}:{options.port}")
        yield ModbusClient(client, options, tls)
    finally:
        client.close()


async def _raise_denial(options: ModbusOptions, tls: ssl.SSLContext | None) -> None:
    """Raise AccessDeniedError if TLS is why there was no answer."""
    why = None if tls is None else await explain(options.host, options.port, tls, options.timeout)
    if why is not None:
        raise AccessDeniedError(f"Modbus device at {options.host}:{options.port}: {why}")
