"""Which registers are asked for together."""

import struct

import pytest

from connectors.base import ConfigError
from connectors.modbus.blocks import plan
from connectors.modbus.connector import ModbusConnector
from connectors.modbus.options import ModbusOptions, ModbusTag, ModbusTarget
from connectors.options import LoopTags


def tag(address, table="input", **more):
    return ModbusTag(table=table, address=address, **more)


def registers(value):
    return list(struct.unpack(">2H", struct.pack(">f", value)))


def test_a_loop_is_one_request():
    blocks = plan({"pv": tag(40), "op": tag(2, type="int16"), "time": tag(60, type="float64")}, 0)
    assert [(block.table, block.address, block.count) for block in blocks] == [("input", 2, 62)]


def test_addresses_from_one_are_one_less_on_the_wire():
    (block,) = plan({"pv": tag(1), "op": tag(3)}, 1)
    assert (block.address, block.count) == (0, 4)
    assert block.values([*registers(1.5), *registers(-2.0)]) == {"pv": 1.5, "op": -2.0}


def test_values_are_scaled():
    (block,) = plan({"op": tag(7, type="uint16", scale=0.1, offset=-5.0)}, 0)
    assert block.values([1000]) == {"op": 95.0}


@pytest.mark.parametrize(("last", "requests"), [(123, 1), (124, 2)])
def test_only_what_is_too_far_apart_is_split(last, requests):
    assert len(plan({"pv": tag(0), "op": tag(last)}, 0)) == requests


def test_tables_are_requested_one_by_one_and_bits_may_span_more():
    tags = {"pv": tag(0), "op": tag(0, "holding"), "mode": tag(0, "coil"), "sp": tag(1999, "coil")}
    assert {block.table: block.count for block in plan(tags, 0)} == {"input": 2, "holding": 2, "coil": 2000}


def test_overlapping_tags_share_their_registers():
    (block,) = plan({"pv": tag(0), "mode": tag(1, type="uint16")}, 0)
    assert block.values([0x3F80, 0x0000]) == {"pv": 1.0, "mode": 0.0}


def test_every_impossible_address_is_reported():
    target = ModbusTarget.model_validate(
        {"connection": "x", "active": {"address": 0}, "fields": {"s": {"address": 65536}}}
    )
    loops = {"FIC101": LoopTags({"pv": tag(0), "op": tag(1)}, [target])}
    with pytest.raises(ConfigError) as error:
        ModbusConnector("x", ModbusOptions(address_base=1), loops)
    assert [fault.split(":")[0] for fault in error.value.faults] == [
        "loops.FIC101.tags.pv.address",
        "loops.FIC101.publish.active.address",
        "loops.FIC101.publish.fields.s.address",
    ]
