"""Sparkplug's payload: as others write and read it, and nothing that breaks it."""

import math
import struct

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from connectors.sparkplug.payload import DataType, MalformedMetricsError, Metric, Payload, decode, encode

BY_PYSPARKPLUG = bytes.fromhex(
    "08fba0f1c2b134121e0a11416c61726d2f41636b6e6f776c656467651880a0f1c2b134200b7001121f0a0e416c61726d2f4f7065"
    "7261746f721880a0f1c2b134200c7a046a616e6512120a016e1880a0f1c2b134200350fbffffff0f12170a016d1880a0f1c2b134"
    "200458faffffffffffffffff0112150a01641880a0f1c2b134200a69000000000000f83f120e0a01781880a0f1c2b134200c3801"
)
"""A DCMD written by pysparkplug 0.6.1 with the protobuf code generated from Eclipse Tahu's definition."""
NOW = 1.8e9


def test_what_another_library_wrote_is_read():
    assert decode(BY_PYSPARKPLUG) == Payload(
        (
            Metric("Alarm/Acknowledge", value=True, type=DataType.BOOLEAN, time=NOW),
            Metric("Alarm/Operator", "jane", DataType.STRING, NOW),
            Metric("n", -5, DataType.INT32, NOW),
            Metric("m", -6, DataType.INT64, NOW),
            Metric("d", 1.5, DataType.DOUBLE, NOW),
            Metric("x", None, DataType.STRING, NOW),
        ),
        time=NOW + 0.123,
    )


def test_what_is_written_is_byte_for_byte_what_another_library_writes():
    read = decode(BY_PYSPARKPLUG)
    assert encode(read.metrics, read.time) == BY_PYSPARKPLUG


def fields(raw):
    """Read the wire format without any library: field number -> values."""

    def varint():
        value = shift = 0
        while True:
            byte = next(stream)
            value |= (byte & 0x7F) << shift
            shift += 7
            if byte < 0x80:
                return value

    found, stream = {}, iter(raw)
    for tag in stream:
        kind = tag & 7
        if kind == 0:
            value = varint()
        elif kind == 1:
            value = struct.unpack("<d", bytes(next(stream) for _ in range(8)))[0]
        else:
            value = bytes(next(stream) for _ in range(varint()))
        found.setdefault(tag >> 3, []).append(value)
    return found


def test_numbers_of_fields_are_those_of_the_specification():
    historical = Metric("a", 1.5, DataType.DOUBLE, 2.0, historical=True)
    until = Metric("b", 3.0, DataType.DATE_TIME, 2.0)
    payload = fields(encode([historical, until, Metric("c", None, DataType.STRING)], 1.0, 255))
    assert payload.keys() == {1, 2, 3}
    assert (payload[1], payload[3]) == ([1000], [255])
    a, b, c = map(fields, payload[2])
    assert a == {1: [b"a"], 3: [2000], 4: [10], 5: [1], 13: [1.5]}
    assert b == {1: [b"b"], 3: [2000], 4: [13], 11: [3000]}
    assert c == {1: [b"c"], 4: [12], 7: [1]}


VALUES = {
    DataType.INT32: st.integers(-(2**31), 2**31 - 1),
    DataType.INT64: st.integers(-(2**63), 2**63 - 1),
    DataType.DOUBLE: st.floats(allow_nan=False, allow_infinity=False),
    DataType.BOOLEAN: st.booleans(),
    DataType.STRING: st.text(st.characters(exclude_categories=["Cs"])),
    DataType.DATE_TIME: st.integers(0, 2**42).map(lambda ms: ms / 1000),
}


@given(
    st.sampled_from(DataType).flatmap(lambda kind: st.tuples(st.just(kind), st.none() | VALUES[kind])),
    st.none() | st.integers(0, 255),
)
def test_what_was_written_is_read_again(typed, seq):
    kind, value = typed
    metric = Metric("any", value, kind, 1.5)
    assert decode(encode([metric], 2.5, seq)) == Payload((metric,), 2.5, seq)


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_what_is_no_number_is_null(value):
    (metric,) = decode(encode([Metric("s", value, DataType.DOUBLE)], 1.0)).metrics
    assert metric.value is None


@given(st.binary(max_size=300) | st.integers(0, len(BY_PYSPARKPLUG)).map(lambda n: BY_PYSPARKPLUG[:n]))
@example(b"\x12\x04\n\x02n\x80")  # a name that is no UTF-8; protobuf lets it pass
@example(b"\x12\x06\n\x01n\x7a\x01\x80")  # a value
def test_nothing_that_comes_breaks_it(raw):
    try:
        payload = decode(raw)
    except MalformedMetricsError:
        return
    assert all(metric.name and isinstance(metric.name, str) for metric in payload.metrics)
    assert not any(isinstance(metric.value, bytes) for metric in payload.metrics)
