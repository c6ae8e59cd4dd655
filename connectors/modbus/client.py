"""The only file that touches pymodbus, whose interface changes with every minor release."""

from __future__ import annotations

import logging
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager

from pymodbus.client import AsyncModbusTcpClient
from pymodbus.exceptions import ModbusException
from pymodbus.pdu import ModbusPDU

from connectors.base import ConnectionLostError
from connectors.cancellation import obey_cancellation
from connectors.modbus.options import Table

logging.getLogger("pymodbus").setLevel(logging.CRITICAL)  # what it logs, the session raises

ILLEGAL_ADDRESS = 2
Request = Callable[..., Awaitable[ModbusPDU]]


class DeviceError(Exception):
    """The device answered with a Modbus exception."""

    def __init__(self, code: int) -> None:
        super().__init__(f"Modbus exception {code}")
        self.code = code


class ModbusClient:
    """A connection to one device. Every failure to get an answer in time is a ConnectionLostError."""

    def __init__(self, client: AsyncModbusTcpClient, unit: int) -> None:
        self._client = client
        self._unit = unit

    async def read(self, table: Table, address: int, count: int) -> list[int]:
        """Return ``count`` registers, or bits as 0 and 1; ``address`` as on the wire. Raises DeviceError."""
        read = {
            "holding": self._client.read_holding_registers,
            "input": self._client.read_input_registers,
            "coil": self._client.read_coils,
            "discrete": self._client.read_discrete_inputs,
        }[table]
        answer = await self._ask(read, address, count=count)
        values = answer.bits[:count] if table in ("coil", "discrete") else answer.registers
        if len(values) != count:
            raise ConnectionLostError(f"the device sent {len(values)} values of {count} asked for")
        return [int(value) for value in values]

    async def write_coil(self, address: int, value: bool) -> None:  # noqa: FBT001 - the value is what it is
        """Set one coil; raises DeviceError."""
        await self._ask(self._client.write_coil, address, value)

    async def write_registers(self, address: int, values: list[int]) -> None:
        """Set adjacent holding registers; raises DeviceError."""
        await self._ask(self._client.write_registers, address, values)

    async def _ask(self, request: Request, *args: int | list[int], **more: int) -> ModbusPDU:
        try:
            answer = await request(*args, device_id=self._unit, **more)
        except (ModbusException, OSError) as error:
            raise ConnectionLostError(str(error)) from error
        obey_cancellation()
        if answer.isError():
            raise DeviceError(answer.exception_code)
        return answer


@asynccontextmanager
async def connected(host: str, port: int, unit: int, timeout: float) -> AsyncIterator[ModbusClient]:  # noqa: ASYNC109
    """Connect to a device; ``timeout`` (s) bounds this and every request. Raises ConnectionLostError."""
    # retrying and reconnecting are the supervisor's; pymodbus would do both in silence, for minutes
    client = AsyncModbusTcpClient(host, port=port, timeout=timeout, retries=0, reconnect_delay=0)
    try:
        if not await client.connect():
            raise ConnectionLostError(f"no Modbus device answers at {host}:{port}")
        yield ModbusClient(client, unit)
    finally:
        client.close()
