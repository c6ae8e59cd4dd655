"""Numbers in registers, compared with a slow twin that permutes bytes by the letters of the order."""

import math
import struct

import pytest
from hypothesis import given
from hypothesis import strategies as st

from connectors.modbus.codec import decode, encode, register_count, scaled, unscaled

FORMATS = {
    "int16": ">h",
    "uint16": ">H",
    "int32": ">i",
    "uint32": ">I",
    "int64": ">q",
    "uint64": ">Q",
    "float32": ">f",
    "float64": ">d",
}
LETTERS = {
    2: {"ABCD": "AB", "CDAB": "AB", "BADC": "BA", "DCBA": "BA"},
    4: {"ABCD": "ABCD", "CDAB": "CDAB", "BADC": "BADC", "DCBA": "DCBA"},
    8: {"ABCD": "ABCDEFGH", "CDAB": "GHEFCDAB", "BADC": "BADCFEHG", "DCBA": "HGFEDCBA"},
}
TYPES = st.sampled_from(list(FORMATS))
ORDERS = st.sampled_from(["ABCD", "CDAB", "BADC", "DCBA"])


def naive_decode(registers, type_, order):
    arrived = struct.pack(f">{len(registers)}H", *registers)
    letters = LETTERS[len(arrived)][order]
    big_endian = bytes(arrived[letters.index(letter)] for letter in sorted(letters))
    return float(struct.unpack(FORMATS[type_], big_endian)[0])


def same(a, b):
    return a == b or (math.isnan(a) and math.isnan(b))


@given(st.data(), TYPES, ORDERS)
def test_decodes_as_the_naive_twin(data, type_, order):
    count = register_count(type_)
    registers = data.draw(st.lists(st.integers(0, 0xFFFF), min_size=count, max_size=count))
    assert same(decode(registers, type_, order), naive_decode(registers, type_, order))


@given(st.data(), TYPES, ORDERS)
def test_what_is_encoded_comes_back(data, type_, order):
    if type_.startswith("float"):
        value = data.draw(st.floats(width=int(type_[5:])))
    else:
        bits = min(16 * register_count(type_), 53)
        low = 0 if type_.startswith("u") else 1 - 2 ** (bits - 1)
        value = float(data.draw(st.integers(low, 2 ** (bits - 1) - 1)))
    assert same(decode(encode(value, type_, order), type_, order), value)


@pytest.mark.parametrize(
    ("order", "registers"),
    [
        ("ABCD", [0x3FC0, 0x1234]),
        ("CDAB", [0x1234, 0x3FC0]),
        ("BADC", [0xC03F, 0x3412]),
        ("DCBA", [0x3412, 0xC03F]),
    ],
)
def test_the_four_orders_of_a_float(order, registers):
    (expected,) = struct.unpack(">f", bytes.fromhex("3fc01234"))
    assert decode(registers, "float32", order) == expected
    assert encode(expected, "float32", order) == registers


@pytest.mark.parametrize(
    ("type_", "low", "high", "nothing"),
    [
        ("int16", -(2**15), 2**15 - 1, -(2**15)),
        ("uint16", 0, 2**16 - 1, 2**16 - 1),
        ("int32", -(2**31), 2**31 - 1, -(2**31)),
        ("uint32", 0, 2**32 - 1, 2**32 - 1),
    ],
)
def test_an_integer_stops_at_the_ends_of_its_range(type_, low, high, nothing):
    assert decode(encode(1e30, type_), type_) == high
    assert decode(encode(math.inf, type_), type_) == high
    assert decode(encode(-1e30, type_), type_) == low
    assert decode(encode(math.nan, type_), type_) == nothing
    assert decode(encode(2.6, type_), type_) == 3.0


def test_too_large_for_float32_is_infinite():
    assert decode(encode(-1e300, "float32"), "float32") == -math.inf


@given(st.floats(-1e6, 1e6), st.floats(0.001, 1e3), st.floats(-1e3, 1e3))
def test_scale_and_offset_are_undone(value, scale, offset):
    assert scaled(unscaled(value, scale, offset), scale, offset) == pytest.approx(value, abs=1e-6)
