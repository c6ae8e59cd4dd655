"""What only Modbus has: one request a loop, exception codes, every table, source time in registers."""

import asyncio
import math
import time

import pytest
from buses import connector_of, connector_to, wave
from pymodbus.client import AsyncModbusTcpClient
from pymodbus.server import ModbusTcpServer
from pymodbus.simulator import DataType, SimData, SimDevice

from connectors.base import LoopRole, Publication, Quality, RefusedError
from connectors.checks import Reader
from connectors.checks.session import until
from connectors.modbus.codec import decode
from simulators.servers.modbus import ModbusServer


class Device:
    """A device with 100 coils (bit 3 set) and 60 holding registers that counts its requests."""

    async def __aenter__(self):
        self.requests = []
        registers = [0] * 60
        registers[10:12] = [0x1234, 0x3FC0]  # 1.5 and a bit, low word first
        registers[20] = 500
        bits = [index == 3 for index in range(112)]
        empty = [SimData(0, values=[False] * 16, datatype=DataType.BITS)]
        self._server = ModbusTcpServer(
            SimDevice(
                7,
                simdata=(
                    [SimData(0, values=bits, datatype=DataType.BITS)],
                    empty,
                    [SimData(0, values=registers, datatype=DataType.REGISTERS)],
                    [SimData(0, values=[0], datatype=DataType.REGISTERS)],
                ),
                action=self._count,
            ),
            address=("127.0.0.1", 0),
        )
        await self._server.serve_forever(background=True)
        self.port = self._server.transport.sockets[0].getsockname()[1]
        return self

    async def __aexit__(self, *_):
        await self._server.shutdown()

    async def _count(self, function, _start, address, count, *_):
        self.requests.append((function, address, count))

    def connection(self, **options):
        return {"kind": "modbus", "port": self.port, "unit": 7, "poll": 0.01, **options}


def loop(publish=(), **tags):
    return {
        "name": "FIC101",
        "tags": tags,
        "publish": [{"connection": "plant", **target} for target in publish],
    }


PV = {"table": "holding", "address": 11, "type": "float32", "order": "CDAB"}
OP = {"table": "holding", "address": 21, "type": "uint16", "scale": 0.1}


async def test_all_tags_of_a_loop_come_in_one_request_and_have_one_time():
    async with Device() as device:
        connector = connector_of(device.connection(address_base=1), [loop(pv=PV, op=OP)])
        async with connector.session() as session, Reader(session) as reading:
            await until(lambda: len(reading.samples) >= 4)
        assert set(device.requests) == {(3, 10, 11)}
    pv, op = reading.samples[:2]
    assert (pv.tag, pv.value) == (LoopRole("FIC101", "pv"), pytest.approx(1.5, abs=1e-3))
    assert (op.tag, op.value) == (LoopRole("FIC101", "op"), 50.0)
    assert pv.time == op.time == pytest.approx(time.time(), abs=30)
    assert reading.samples[2].time > pv.time


async def test_polls_keep_their_distance():
    async with Device() as device:
        connector = connector_of(device.connection(poll=0.05), [loop(pv=PV)])
        async with connector.session() as session, Reader(session) as reading:
            await until(lambda: len(reading.samples) >= 6)
        times = [sample.time for sample in reading.samples]
        assert times[5] - times[0] > 0.2


async def test_an_illegal_address_is_a_bad_value_with_the_code_and_spares_the_others():
    async with Device() as device:
        outside = {"table": "holding", "address": 70, "type": "int16"}
        connector = connector_of(device.connection(address_base=1), [loop(pv=PV, op=OP, sp=outside)])
        async with connector.session() as session, Reader(session) as reading:
            await until(
                lambda: any(sample.quality is Quality.GOOD for sample in reading.of(LoopRole("FIC101", "pv")))
            )
            await until(lambda: len(reading.of(LoopRole("FIC101", "sp"))) >= 3)
    assert all((s.quality, s.code) == (Quality.BAD, 2) for s in reading.of(LoopRole("FIC101", "sp")))
    assert [sample.quality for sample in reading.of(LoopRole("FIC101", "pv"))].count(Quality.BAD) == 1


async def test_a_coil_is_a_mode():
    async with Device() as device:
        connector = connector_of(device.connection(), [loop(pv=PV, mode={"table": "coil", "address": 3})])
        async with connector.session() as session, Reader(session) as reading:
            await until(lambda: reading.of(LoopRole("FIC101", "mode")))
    assert reading.of(LoopRole("FIC101", "mode"))[0].value == 1.0


async def test_a_source_time_seen_before_is_no_new_sample_and_none_is_no_sample():
    async with ModbusServer({"FIC101": ("pv", "op")}) as server:
        first, second = wave("FIC101", 2, roles=("pv", "op")).rows()
        async with connector_to(server, ["FIC101"]).session() as session, Reader(session) as reading:
            await asyncio.sleep(0.05)
            assert reading.samples == []
            await server.put("FIC101", first)
            await until(lambda: reading.samples)
            await asyncio.sleep(0.05)
            assert [sample.time for sample in reading.samples] == [first.time] * 2
            await server.put("FIC101", second)
            await until(lambda: len(reading.samples) == 4)


async def test_an_alarm_writes_numbers_and_flag():
    target = {
        "active": {"table": "holding", "address": 30},
        "fields": {
            "s": {"address": 32, "type": "float32", "order": "CDAB"},
            "j": {"address": 34, "type": "float32"},
            "f_s": {"address": 36, "type": "int16", "scale": 0.01},
        },
    }
    async with Device() as device:
        connector = connector_of(device.connection(), [loop([target, {"active": {"address": 5}}], pv=PV)])
        async with connector.session() as session:
            fields = {"active": True, "s": 4.5, "j": None, "f_s": 2.5}
            await session.publish(Publication("FIC101", "state", "1", fields))
            device.requests.clear()
            await session.publish(Publication("FIC101", "event", "2", {**fields, "active": False}))
            assert device.requests == []
        async with AsyncModbusTcpClient("127.0.0.1", port=device.port) as client:
            got = (await client.read_holding_registers(30, count=7, device_id=7)).registers
            coil = (await client.read_coils(5, count=1, device_id=7)).bits[0]
    assert (got[0], coil) == (1, True)
    assert decode(got[2:4], "float32", "CDAB") == 4.5
    assert math.isnan(decode(got[4:6], "float32"))
    assert got[6] == 250


@pytest.mark.parametrize(
    "target", [{"active": {"address": 900}}, {"fields": {"s": {"address": 900}}}], ids=["coil", "register"]
)
async def test_an_alarm_the_device_refuses_is_reported(target):
    async with (
        Device() as device,
        connector_of(device.connection(), [loop([target], pv=PV)]).session() as session,
    ):
        with pytest.raises(RefusedError, match="900: Modbus exception 2"):
            await session.publish(Publication("FIC101", "state", "1", {"active": True, "s": 1.0}))
