"""Messages become samples, and no message breaks anything."""

import json
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from connectors.base import LoopRole, Quality
from connectors.mqtt.messages.malformed import MalformedPayloadError
from connectors.mqtt.messages.payload import seconds
from connectors.mqtt.messages.reader import TopicReader
from connectors.mqtt.options import MqttTag

ARRIVAL = 1000.0


def reader(**fields):
    """A reader of one JSON topic with source times in ``t``; role -> path."""
    return TopicReader(
        {
            LoopRole("FIC101", role): MqttTag(topic="x", field=path, time_field="t")
            for role, path in fields.items()
        }
    )


def bare_reader(role="pv"):
    return TopicReader({LoopRole("FIC101", role): MqttTag(topic="x")})


def read(reader, message, *, retained=False):
    payload = message if isinstance(message, bytes) else json.dumps(message).encode()
    return [(s.value, s.time, s.quality) for s in reader.samples(payload, ARRIVAL, retained=retained)]


def test_a_bare_number_arrives_now():
    assert read(bare_reader(), b" 12.5 \n") == [(12.5, ARRIVAL, Quality.GOOD)]


def test_nobody_knows_how_old_a_kept_bare_number_is():
    assert read(bare_reader(), b"12.5", retained=True) == [(12.5, ARRIVAL, Quality.UNCERTAIN)]


def test_a_kept_message_with_its_own_time_is_good():
    assert read(reader(pv="pv"), {"t": 5.0, "pv": 1}, retained=True) == [(1.0, 5.0, Quality.GOOD)]


def test_a_mode_may_be_text_a_measurement_may_not():
    assert read(bare_reader("mode"), b"AUTO") == [("AUTO", ARRIVAL, Quality.GOOD)]
    ((value, _, quality),) = read(bare_reader(), b"AUTO")
    assert math.isnan(value)
    assert quality is Quality.BAD


def test_fields_lie_deep():
    message = {"t": "2023-11-14T22:13:20Z", "values": [{"pv": 3}, {"pv": "4.5"}]}
    assert read(reader(pv="values.0.pv", op="values.1.pv"), message) == [
        (3.0, 1.7e9, Quality.GOOD),
        (4.5, 1.7e9, Quality.GOOD),
    ]


def test_one_missing_field_leaves_the_others():
    source = reader(pv="pv", op="op")
    (pv, op) = read(source, {"t": 5.0, "pv": 1.0})
    assert pv == (1.0, 5.0, Quality.GOOD)
    assert op[1:] == (5.0, Quality.BAD)
    assert source.malformed == 1


def test_null_is_a_missing_value_and_no_fault():
    source = reader(pv="pv")
    ((value, at, quality),) = read(source, {"t": 5.0, "pv": None})
    assert math.isnan(value)
    assert (at, quality, source.malformed) == (5.0, Quality.BAD, 0)


def test_an_unreadable_message_does_not_move_time():
    source = reader(pv="pv")
    read(source, {"t": 5.0, "pv": 1.0})
    assert read(source, b"{broken")[0][1:] == (5.0, Quality.BAD)
    assert read(source, {"t": "yesterday", "pv": 1.0})[0][1:] == (5.0, Quality.BAD)
    assert source.malformed == 2


def test_an_empty_payload_says_nothing():
    assert read(reader(pv="pv"), b"") == []


@pytest.mark.parametrize(
    "payload",
    [b"[" * 100_000, b"1e999", b'{"t": NaN, "pv": 1}', b"\xff\xfe", b"1" * 5000, b'{"t": true, "pv": 1}'],
)
def test_nasty_messages_are_bad_values(payload):
    ((_, _, quality),) = read(reader(pv="pv"), payload)
    assert quality is Quality.BAD


def test_a_number_that_no_float_holds_is_a_bad_value():
    ((_, _, quality),) = read(reader(pv="pv"), b'{"t": 1, "pv": 1' + b"0" * 400 + b"}")
    assert quality is Quality.BAD


@given(
    st.binary() | st.recursive(st.none() | st.floats() | st.text(), lambda x: st.dictionaries(st.text(), x))
)
def test_any_message_gives_one_sample_a_tag(message):
    for source in (reader(pv="pv", op="a.b"), bare_reader()):
        if message != b"":
            samples = read(source, message)
            assert len(samples) == len(source._tags)
            assert all(math.isfinite(value) or quality is Quality.BAD for value, _, quality in samples)


def test_a_time_without_zone_is_utc():
    assert seconds("2023-11-14T22:13:20") == seconds("2023-11-14T23:13:20+01:00") == 1.7e9
    with pytest.raises(MalformedPayloadError):
        seconds(math.inf)


@pytest.mark.parametrize("topic", ["", "plant/+/PV", "plant/#"])
def test_a_tag_has_one_topic(topic):
    with pytest.raises(ValidationError):
        MqttTag(topic=topic)


def test_a_bare_value_has_no_time_field():
    with pytest.raises(ValidationError, match="time_field needs field"):
        MqttTag(topic="x", time_field="t")
