"""All values of an answer at once are those that each tag has by itself."""

import math
import struct

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from connectors.base import LoopRole, Quality
from connectors.modbus.blocks import plan
from connectors.modbus.neighbours import spans
from connectors.modbus.options import ModbusTag
from connectors.modbus.parking import Parking
from connectors.modbus.polling import Rounds
from connectors.modbus.whole import WholeAnswer
from connectors.readings import Readings, one_by_one
from tests.unit.connectors.test_modbus_neighbours import Device, loops
from tests.unit.runtime.agents import virtual

TYPES = ("int16", "uint16", "int32", "uint32", "int64", "uint64", "float32", "float64")
ORDERS = ("ABCD", "CDAB", "BADC", "DCBA")
TAGS = st.lists(
    st.builds(
        ModbusTag,
        table=st.just("input"),
        address=st.integers(1, 40),
        type=st.sampled_from(TYPES),
        order=st.sampled_from(ORDERS),
        scale=st.sampled_from([1.0, 0.1, -2.5]),
        offset=st.sampled_from([0.0, 7.0]),
    ),
    min_size=1,
    max_size=12,
)


@settings(max_examples=200, deadline=None)
@given(TAGS, st.lists(st.integers(0, 0xFFFF), min_size=50, max_size=50))
def test_numbers_are_those_of_each_tag(tags, registers):
    blocks = [plan({"pv": tag}, 1)[0] for tag in tags]
    found = WholeAnswer(0, blocks).values(registers)
    alone = [block.values(registers[block.address : block.address + block.count])["pv"] for block in blocks]
    assert np.array_equal(found, alone, equal_nan=True)


@pytest.mark.parametrize("registers", [(0x7F80, 1), (0x7FF0, 0, 0, 1), (0x7FEF, 0xFFFF, 0xFFFF, 0xFFFF)])
def test_what_is_no_number_for_the_processor_is_no_warning(registers):
    kind = f"float{16 * len(registers)}"
    blocks = plan({"pv": ModbusTag(table="input", address=0, type=kind, scale=-2.5)}, 0)
    (value,) = WholeAnswer(0, blocks).values(registers)
    assert not math.isfinite(value)


def test_bits_are_those_of_each_tag():
    blocks = [plan({"mode": ModbusTag(table="coil", address=at)}, 0)[0] for at in (100, 103, 101)]
    (span,) = spans(blocks)
    found = WholeAnswer(span.whole.address, blocks).values([1, 0, 0, 1])
    assert found.tolist() == [1.0, 1.0, 0.0]


async def _pieces(rounds):
    return [each async for each in rounds.read()]


def test_neighbours_come_in_one_piece_with_the_same_tags_each_time():
    rounds = Rounds([Device()], loops(10), 0, Parking("unit1"))
    (first,), (second,) = virtual(_pieces(rounds)), virtual(_pieces(rounds))
    assert isinstance(first, Readings)
    assert first.tags is second.tags
    assert first.tags[:3] == (LoopRole("L0", "pv"), LoopRole("L0", "op"), LoopRole("L1", "pv"))
    assert first.values.tolist() == [float(k) for k in range(20)]


class Ticking(Device):
    """Its registers have their addresses, those of ``clock`` the time that it gives."""

    def __init__(self, clock, now):
        super().__init__()
        self.clock, self.now = clock, now

    async def read(self, table, address, count):
        await super().read(table, address, count)
        return [self.now if place == self.clock else place for place in range(address, address + count)]


def test_a_loop_with_a_time_of_its_own_comes_in_a_piece_of_its_own():
    tags = loops(3)
    tags["L1"]["time"] = ModbusTag(table="input", address=6, type="uint16", scale=2.0)
    device = Ticking(6, 50)
    rounds = Rounds([device], tags, 0, Parking("unit1"))
    others, own = virtual(_pieces(rounds))
    assert [str(tag) for tag in own.tags] == ["L1.pv", "L1.op"]
    assert (own.time, own.values.tolist()) == (100.0, [2.0, 3.0])
    assert [str(tag) for tag in others.tags] == ["L0.pv", "L0.op", "L2.pv", "L2.op"]
    assert others.values.tolist() == [0.0, 1.0, 4.0, 5.0]
    (again,) = virtual(_pieces(rounds))
    assert again.tags is others.tags, "of L1 nothing is new"
    device.now = 51
    assert virtual(_pieces(rounds))[1].tags is own.tags


@settings(max_examples=50, deadline=None)
@given(st.lists(st.sampled_from([1.0, 2.0, math.nan, math.inf]), min_size=1, max_size=6))
def test_times_that_repeat_are_absent_or_are_none_mean_the_same_in_a_piece_and_alone(times):
    class Device64(Device):
        now = math.nan

        async def read(self, table, address, count):
            await super().read(table, address, count)
            whole = struct.unpack(">8H", struct.pack(">4f", 7.0, 8.0, self.now, 9.0))
            return whole[address : address + count]

    def tag(address):
        return ModbusTag(table="input", address=address)

    timed = {"pv": tag(0), "op": tag(2), "time": tag(4)}

    async def said(loops_, device):
        rounds, found = Rounds([device], loops_, 0, Parking("unit1")), []
        for device.now in times:
            found.append([each async for each in one_by_one(rounds.read()) if each.tag.loop == "L0"])
        return found

    together = virtual(said({"L0": timed, "L1": {"pv": tag(6)}}, Device64()))
    alone = virtual(said({"L0": timed}, Device64()))
    assert together == alone


def test_a_span_that_the_device_refuses_comes_by_samples_with_their_reasons():
    device = Device(lambda address, count: 2 if address <= 3 < address + count else 0)
    rounds = Rounds([device], loops(3), 0, Parking("unit1"))
    for _ in range(2):
        got = virtual(_pieces(rounds))
        assert not any(isinstance(each, Readings) for each in got)
    assert {str(each.tag): each.code for each in got if each.quality is Quality.BAD} == {"L1.op": 2}


@pytest.mark.parametrize("missing", [math.nan, math.inf])
def test_what_is_no_number_is_a_gap_of_its_own_tag(missing):
    class Floats(Device):
        async def read(self, table, address, count):
            await super().read(table, address, count)
            return struct.unpack(">8H", struct.pack(">4f", 1.0, 2.0, missing, 4.0))

    tags = {
        f"L{k}": {role: ModbusTag(table="input", address=4 * k + 2 * (role == "op")) for role in ("pv", "op")}
        for k in range(2)
    }

    async def samples():
        return [each async for each in one_by_one(Rounds([Floats()], tags, 0, Parking("unit1")).read())]

    got = virtual(samples())
    assert [each.value for each in got if each.quality is Quality.GOOD] == [1.0, 2.0, 4.0]
    assert [str(each.tag) for each in got if each.quality is Quality.BAD] == ["L1.pv"]
