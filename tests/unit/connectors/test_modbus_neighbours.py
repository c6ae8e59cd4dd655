"""Loops side by side share a request, and several requests may be under way."""

import asyncio

import numpy as np
import pytest

from connectors.base import ConnectionLostError, Quality
from connectors.modbus.blocks import plan
from connectors.modbus.client import DeviceError
from connectors.modbus.neighbours import spans
from connectors.modbus.options import ModbusTag
from connectors.modbus.parking import Parking
from connectors.modbus.polling import Rounds
from connectors.readings import one_by_one
from tests.unit.runtime.agents import virtual

ROUND_TRIP = 0.01


class Device:
    """Answers with the address of each register after a round trip."""

    timeout = 1.0
    silent = False

    def __init__(self, refuses=lambda *_: 0, mute=()):
        self.asked = []
        self.refuses = refuses
        self.mute = mute

    async def read(self, table, address, count):
        await asyncio.sleep(ROUND_TRIP)
        self.asked.append((table, address, count))
        self.silent = bool(set(range(address, address + count)) & set(self.mute))
        if self.silent:
            raise ConnectionLostError("no answer")
        if code := self.refuses(address, count):
            raise DeviceError(code)
        return list(range(address, address + count))


def loops(n, apart=2, first=0, table="input"):
    """Loops of two integers each."""
    tags = {}
    for k in range(n):
        at = first + k * apart
        tags[f"L{k}"] = {
            "pv": ModbusTag(table=table, address=at, type="uint16"),
            "op": ModbusTag(table=table, address=at + 1, type="uint16"),
        }
    return tags


async def read(rounds):
    return [sample async for sample in one_by_one(rounds.read())]


def test_a_hundred_neighbours_are_two_requests_and_each_has_its_own_values():
    device = Device()
    rounds = Rounds([device], loops(100), 0, Parking("unit1"))
    for _ in range(2):
        got = virtual(read(rounds))
        assert {(each.tag.loop, each.tag.role): each.value for each in got} == {
            (f"L{k}", role): 2 * k + (role == "op") for k in range(100) for role in ("pv", "op")
        }
    assert device.asked == 2 * [("input", 0, 124), ("input", 124, 76)]


def test_what_lies_apart_or_in_another_table_is_read_apart():
    device = Device()
    tags = {**loops(2, apart=19), "other": loops(1, table="holding")["L0"]}
    virtual(read(Rounds([device], tags, 0, Parking("unit1"))))
    assert sorted(device.asked) == [("holding", 0, 2), ("input", 0, 2), ("input", 19, 2)]


def test_a_loop_of_two_tables_is_read_at_once_and_not_with_neighbours():
    device = Device()
    tags = loops(3)
    tags["L1"]["op"] = ModbusTag(table="holding", address=0, type="uint16")
    virtual(read(Rounds([device], tags, 0, Parking("unit1"))))
    assert [each[0] for each in device.asked] == ["input", "holding", "input"]


@pytest.mark.parametrize("code", [2, 3])
def test_a_device_that_refuses_so_many_is_asked_for_each_loop(code):
    device = Device(lambda _, count: code if count > 2 else 0)
    rounds = Rounds([device], loops(3), 0, Parking("unit1"))
    for asked in (4, 3):
        device.asked.clear()
        got = virtual(read(rounds))
        assert all(each.quality is Quality.GOOD for each in got)
        assert len(device.asked) == asked


def test_one_address_that_is_not_there_costs_its_own_loop_only():
    device = Device(lambda address, count: 2 if address <= 3 < address + count else 0)
    rounds = Rounds([device], loops(3), 0, Parking("unit1"))
    virtual(read(rounds))
    bad = {str(each.tag) for each in virtual(read(rounds)) if each.quality is Quality.BAD}
    assert bad == {"L1.op"}


def test_one_register_that_gives_no_answer_costs_its_own_loop_only():
    device = Device(mute=[2])
    parking = Parking("unit1")
    rounds = Rounds([device], loops(3), 0, parking)
    got = virtual(read(rounds))
    assert {each.tag.loop for each in got if each.quality is Quality.BAD} == {"L1"}
    assert len(parking._blocks) == 1


def test_a_unit_that_its_gateway_cannot_reach_is_asked_once():
    device = Device(lambda _, __: 11)
    got = virtual(read(Rounds([device], loops(3), 0, Parking("unit1"))))
    assert [each.code for each in got] == 6 * [11]
    assert len(device.asked) == 1


def test_four_connections_take_a_quarter_of_the_time():
    async def seconds(n):
        clock = asyncio.get_running_loop()
        devices = [Device() for _ in range(n)]
        began = clock.time()
        got = await read(Rounds(devices, loops(40, apart=100), 0, Parking("unit1")))
        assert len({each.tag for each in got}) == 80
        return clock.time() - began

    assert virtual(seconds(1)) == pytest.approx(40 * ROUND_TRIP, rel=0.01)
    assert virtual(seconds(4)) == pytest.approx(10 * ROUND_TRIP, rel=0.01)


def test_what_one_connection_reads_does_not_wait_for_another_that_is_slow():
    class Slow(Device):
        async def read(self, *request):
            await asyncio.sleep(99 * ROUND_TRIP)
            return await super().read(*request)

    async def waits():
        clock = asyncio.get_running_loop()
        began = clock.time()
        pieces = Rounds([Device(), Slow()], loops(9, apart=100), 0, Parking("unit1")).read()
        return np.array([clock.time() - began async for _ in pieces]) / ROUND_TRIP

    np.testing.assert_allclose(virtual(waits()), np.repeat([*range(1, 9), 100], 2), rtol=0.01)


def test_a_connection_that_breaks_ends_the_round():
    class Broken(Device):
        async def read(self, *_):
            raise ConnectionLostError("closed")

    with pytest.raises(ConnectionLostError, match="closed"):
        virtual(read(Rounds([Device(), Broken()], loops(9, apart=100), 0, Parking("unit1"))))


def test_blocks_that_overlap_are_one_span():
    tags = loops(4, apart=1)
    blocks = [plan(each, 0)[0] for each in tags.values()]
    (span,) = spans(blocks)
    assert (span.whole.address, span.whole.count) == (0, 5)
    assert [span.part(list(range(5)), block) for block in blocks] == [[0, 1], [1, 2], [2, 3], [3, 4]]
