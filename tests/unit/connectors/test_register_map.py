"""The served map: what is told stands where it says, what is written becomes an order, nothing breaks it."""

import math
import struct

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from connectors.base import Publication
from connectors.modbus.codec import decode
from connectors.modbus_server import register_map as at
from connectors.modbus_server.image import IllegalError, Image
from connectors.modbus_server.pdu import answer

NOW = 1_700_000_000.0
LOOPS = ("FIC1", "LIC2", "TIC3")
TOLD = {
    "state": "acked_active",
    "active": True,
    "health": 4,
    "verdict": "stiction",
    "priority": "high",
    "time": NOW - 60,
    "until": None,
    "s": 4.5,
    "j": 1.25,
    "f_s": 2.875,
    "f_d": 1.625,
}


def image(**more):
    return Image(LOOPS, clock=lambda: NOW, **{"takes_orders": True, **more})


def state(loop, **fields):
    return Publication(loop, "state", "1", {**TOLD, **fields})


def loop_registers(of, index):
    return of.read_registers(at.block(index), at.BLOCK)


def number(registers, offset, type_="float32", order="ABCD"):
    return decode(registers[offset : offset + 2], type_, order)


@pytest.mark.parametrize("order", ["ABCD", "CDAB", "BADC", "DCBA"])
def test_a_state_stands_where_the_map_says(order):
    served = image(byte_order=order)
    served.show(state("LIC2"))
    registers = loop_registers(served, 1)
    assert registers[at.STATUS] == 0b1000_1000_0000_0011
    assert (registers[at.STATE], registers[at.NE107], registers[at.VERDICT]) == (2, 4, 1)
    assert (registers[at.PRIORITY], registers[at.QUALITY]) == (3, 0)
    assert [number(registers, at.NUMBERS[n], order=order) for n in ("s", "j", "f_s", "f_d")] == [
        4.5,
        1.25,
        2.875,
        1.625,
    ]
    assert number(registers, at.TOLD, "uint32", order) == NOW - 60
    assert number(registers, at.UNTIL, "uint32", order) == 0
    assert registers[at.MINUTES] == at.SHELVING
    assert served.read_registers(0, 6) == [1, 0, 3, at.BLOCK, at.block(0), 1]
    bits = served.read_discrete_inputs(at.BITS, at.BITS)
    assert [at.STATUS_BITS[i] for i, bit in enumerate(bits) if bit] == [
        "alarm is active",
        "alarm is active and acknowledged",
        "NE 107 maintenance required",
        "known: something was published of this loop since the agent started",
    ]


def test_what_was_never_reported_is_not_known():
    registers = loop_registers(image(), 0)
    assert registers[at.STATUS] == 0
    assert registers[at.QUALITY] == 2
    assert math.isnan(number(registers, at.NUMBERS["s"]))


@pytest.mark.parametrize(
    ("fields", "bits", "quality"),
    [
        ({"state": "normal", "active": False, "health": 0, "verdict": "no_stiction", "s": None}, [15], 1),
        ({"state": "shelved", "active": False, "health": 3}, [2, 10, 15], 0),
        ({"state": "out_of_service", "active": False, "health": 2}, [3, 9, 15], 0),
        ({"state": "returned_unacked", "active": False, "health": 1}, [4, 8, 15], 0),
        ({"state": "unacked_active", "health": 4, "verdict": "undecided"}, [0, 11, 15], 1),
        ({"state": "new word", "health": 99, "verdict": None, "active": None}, [15], 1),
    ],
)
def test_the_status_word(fields, bits, quality):
    served = image()
    served.show(state("FIC1", **fields))
    registers = loop_registers(served, 0)
    assert [bit for bit in range(16) if registers[at.STATUS] >> bit & 1] == bits
    assert registers[at.QUALITY] == quality


def test_events_and_loops_that_are_not_on_the_map_are_left_out():
    served = image()
    before = served.read_registers(0, 60)
    served.show(Publication("FIC1", "event", "1", TOLD))
    served.show(state("FIC9"))
    assert served.read_registers(0, 60) == before


def test_the_heartbeat_rises_and_starts_anew():
    served = image()
    beats = []
    for _ in range(0x10000 + 1):
        served.beat()
        beats.append(served.read_registers(at.HEARTBEAT, 1)[0])
    assert beats[:2] == [1, 2]
    assert beats[-3:] == [65535, 0, 1]
    assert decode(served.read_registers(at.TIME, 2), "uint32") == NOW


def test_an_order_waits_until_it_is_taken():
    served = image()
    served.write_coils(1, [True, False], "modbus 10.0.0.5")
    served.write_registers(at.block(0) + at.ORDER, [2, 30], "modbus 10.0.0.6")
    assert served.read_coils(0, 3) == [False, True, False]
    assert served.read_registers(at.block(0) + at.ORDER, 2) == [2, 30]
    first = served.oldest()
    assert (first.order.subject, first.order.action, first.order.by) == (
        "LIC2",
        "acknowledge",
        "modbus 10.0.0.5",
    )
    served.taken(first)
    second = served.oldest()
    assert (second.order.subject, second.order.action, second.order.until) == ("FIC1", "shelve", NOW + 1800)
    served.taken(second)
    assert served.oldest() is None
    assert served.read_coils(0, 3) == [False] * 3
    assert served.read_registers(at.block(0) + at.ORDER, 2) == [0, 30]


def test_the_same_again_is_one_order_and_another_has_to_wait():
    served = image()
    place = at.block(2) + at.ORDER
    for _ in range(3):
        served.write_registers(place, [4], "modbus a")
    with pytest.raises(IllegalError) as told:
        served.write_registers(place, [5], "modbus a")
    assert told.value.code == 6
    served.taken(served.oldest())
    assert served.oldest() is None


@pytest.mark.parametrize(
    ("address", "values", "code"),
    [
        (0, [1], 2),
        (at.MINUTES, [1], 2),
        (at.block(0) + at.NUMBERS["s"], [1], 2),
        (at.block(0) + at.ORDER, [1, 5, 1], 2),
        (at.block(2) + at.MINUTES, [5, 5], 2),
        (65535, [1], 2),
        (at.block(0) + at.ORDER, [6], 3),
        (at.block(0) + at.ORDER, [1, 0], 3),
    ],
)
def test_nothing_else_can_be_written(address, values, code):
    served = image()
    before = served.read_registers(0, 80)
    with pytest.raises(IllegalError) as told:
        served.write_registers(address, values, "modbus a")
    assert told.value.code == code
    assert served.read_registers(0, 80) == before
    assert served.oldest() is None


def test_without_orders_every_write_is_an_unknown_function():
    served = image(takes_orders=False)
    for request in (b"\x05\x00\x00\xff\x00", b"\x06\x00\x26\x00\x01", b"\x0f\x00\x00\x00\x01\x01\x01"):
        assert answered(request, served) == (bytes([request[0] | 0x80, 1]), 0)
    assert served.oldest() is None


def test_every_place_of_the_map_is_there_once_and_nothing_lies_over_another():
    served = image()
    taken = {}
    for place in at.places(LOOPS):
        for address in range(
            place.address, place.address + (2 if place.type in ("uint32", "float32") else 1)
        ):
            assert (place.table, address) not in taken
            taken[place.table, address] = place
        read = {
            "register": served.read_registers,
            "discrete input": served.read_discrete_inputs,
            "coil": served.read_coils,
        }[place.table]
        read(place.address, 1)
    writable = {(place.table, place.address) for place in at.places(LOOPS) if place.writable}
    for address in range(at.block(3)):
        try:
            served.write_registers(address, [1], "modbus a")
        except IllegalError:
            assert ("register", address) not in writable
        else:
            assert ("register", address) in writable


def answered(request, served):
    """The answer, and how often the request was told to be none."""
    malformed = []
    said = answer(request, served, "modbus a", lambda: malformed.append(1))
    return said, len(malformed)


def asked(function, *words, data=b""):
    return bytes([function]) + struct.pack(f">{len(words)}H", *words) + data


@pytest.mark.parametrize(
    ("request_", "said"),
    [
        (asked(3, 0, 3), bytes([3, 6]) + struct.pack(">3H", 1, 0, 3)),
        (asked(4, 2, 1), b"\x04\x02\x00\x03"),
        (asked(1, 0, 3), b"\x01\x01\x00"),
        (asked(2, 0, 48), b"\x02\x06" + bytes(6)),
        (asked(5, 1, 0xFF00), asked(5, 1, 0xFF00)),
        (asked(5, 1, 0x0001), b"\x85\x03"),
        (asked(15, 0, 3, data=b"\x01\x02"), asked(15, 0, 3)),
        (asked(15, 0, 3, data=b"\x02\x02\x00"), b"\x8f\x03"),
        (asked(16, 38, 2, data=b"\x04\x00\x02\x00\x0a"), asked(16, 38, 2)),
        (asked(16, 38, 2, data=b"\x04\x00\x02\x00"), b"\x90\x03"),
        (asked(3, 0, 0), b"\x83\x03"),
        (asked(3, 0, 126), b"\x83\x03"),
        (asked(3, 0, 81), b"\x83\x02"),
        (asked(3, 65535, 125), b"\x83\x02"),
        (asked(1, 3, 1), b"\x81\x02"),
        (asked(3, 0), b"\x83\x03"),
        (b"\x2b\x0e\x01\x00", b"\xab\x01"),
        (b"\x00", b"\x80\x01"),
    ],
)
def test_requests_and_answers_byte_by_byte(request_, said):
    is_no_request = said[0] >= 0x80 and said[1] != 2
    assert answered(request_, image()) == (said, is_no_request)


@given(st.binary(min_size=1, max_size=253))
@example(b"\xff")
@example(b"\x10" + b"\xff" * 252)
def test_no_bytes_break_it_and_every_answer_fits_a_frame(request_):
    said, _ = answered(request_, image())
    assert said[0] & 0x7F == request_[0] & 0x7F
    assert 2 <= len(said) <= 253
