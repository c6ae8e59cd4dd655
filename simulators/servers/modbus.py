"""Plants on Modbus TCP: values in input registers, alarms back into coils and holding registers."""

from __future__ import annotations

import asyncio
import logging
import math
from collections.abc import AsyncIterator, Mapping, Sequence
from typing import Self

from pymodbus.client import AsyncModbusTcpClient
from pymodbus.server import ModbusTcpServer
from pymodbus.simulator import DataType, SimData, SimDevice

from connectors.cancellation import obey_cancellation
from connectors.modbus.codec import encode
from simulators.plant import Row
from simulators.servers.loop_server import ALARM_FIELDS, Entry, loop_entry

logging.getLogger("pymodbus").setLevel(
    logging.CRITICAL
)  # a client that comes and goes is not worth a log line

UNIT = 1
READ_INPUT_REGISTERS = 4
BLOCK = 16
"""Registers of a loop, one loop after the other in both tables."""
VALUES = {"pv": 0, "op": 2, "sp": 4, "mv": 6}
MODE = 8
TIME = 10
AUTOMATIC = ("AUTO", "CAS", "RCAS")
POLL = 0.005
"""How often a reader looks for a new row, and a watcher for an alarm, s of wall time."""


class ModbusServer:
    """One device with all loops.

    The input registers of loop i, from 16 i:

    ====== ======= ===============================
    offset type    value
    ====== ======= ===============================
    0 to 7 float32 pv, op, sp, mv
    8      uint16  mode: 1 automatic, 0 any other
    10     float64 source time, s UTC; NaN: no row
    ====== ======= ===============================

    The alarm of loop i is coil i; its f_s, f_d, s and j are float32 in the holding registers from 16 i.
    """

    name = "modbus"
    lead = 0

    def __init__(self, loops: Mapping[str, Sequence[str]], host: str = "127.0.0.1", port: int = 0) -> None:
        """Prepare to serve ``loops``, each with its roles; port 0 takes any that is free."""
        self._roles = loops
        self._base = {loop: BLOCK * index for index, loop in enumerate(loops)}
        self._host = host
        self.port = port
        self._server: ModbusTcpServer

    async def __aenter__(self) -> Self:
        """Listen; raises OSError."""
        registers = BLOCK * len(self._roles)
        self._server = ModbusTcpServer(
            SimDevice(
                UNIT,
                simdata=(
                    [
                        SimData(
                            0, values=[False] * 16 * math.ceil(len(self._roles) / 16), datatype=DataType.BITS
                        )
                    ],
                    [SimData(0, values=[False] * 16, datatype=DataType.BITS)],
                    [SimData(0, count=registers, values=0, datatype=DataType.REGISTERS)],
                    [SimData(0, count=registers, values=0, datatype=DataType.REGISTERS)],
                ),
            ),
            address=(self._host, self.port),
        )
        try:
            await self._server.serve_forever(background=True)
        except RuntimeError as error:
            raise OSError(f"Modbus server: cannot listen on {self._host}:{self.port}") from error
        self.port = self._server.transport.sockets[0].getsockname()[1]
        for loop in self._roles:
            await self.put(loop, Row(math.nan, {}))
        return self

    async def __aexit__(self, *_: object) -> None:
        """Stop to listen and drop every client."""
        await self._server.shutdown()

    async def put(self, loop: str, row: Row) -> None:
        """Show this row, all of it at once."""
        registers = [0] * BLOCK
        for role, offset in VALUES.items():
            registers[offset : offset + 2] = encode(float(row.values.get(role, math.nan)), "float32")
        registers[MODE] = int(str(row.values.get("mode", "")).upper() in AUTOMATIC)
        registers[TIME : TIME + 4] = encode(row.time, "float64")
        await self._server.async_setValues(UNIT, READ_INPUT_REGISTERS, self._base[loop], registers)

    def connection_settings(self) -> Entry:
        """Return the entry of ``connections``."""
        return {"kind": "modbus", "host": self._host, "port": self.port, "unit": UNIT, "poll": POLL}

    def loop_settings(self, loop: str, ts: float) -> Entry:
        """Return the entry of ``loops``."""
        base = self._base[loop]
        tags: dict[str, Entry] = {
            role: {"table": "input", "address": base + VALUES[role], "type": "float32"}
            for role in self._roles[loop]
            if role in VALUES
        }
        if "mode" in self._roles[loop]:
            tags["mode"] = {"table": "input", "address": base + MODE, "type": "uint16"}
        tags["time"] = {"table": "input", "address": base + TIME, "type": "float64"}
        fields = {
            field: {"table": "holding", "address": base + 2 * index, "type": "float32"}
            for index, field in enumerate(ALARM_FIELDS)
        }
        active = {"table": "coil", "address": base // BLOCK}
        entry = loop_entry(self.name, loop, ts, tags, {"active": active, "fields": fields})
        return {**entry, "automatic": [1]}

    async def watch_alarms(self) -> AsyncIterator[tuple[str, bool]]:
        """Yield (loop, active) from polling the coils with a client of its own."""
        known: dict[str, bool] = {}
        async with AsyncModbusTcpClient(self._host, port=self.port, reconnect_delay=0) as client:
            while True:
                answer = await client.read_coils(0, count=len(self._roles), device_id=UNIT)
                obey_cancellation()
                for loop, active in zip(self._roles, answer.bits, strict=False):
                    if known.get(loop) != active:
                        known[loop] = active
                        yield loop, active
                await asyncio.sleep(POLL)
