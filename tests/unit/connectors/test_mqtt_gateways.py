"""Messages of gateways: what the page of how-to shows is read, and what a gateway may send else."""

import json
import math
import re
from pathlib import Path

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from connectors.base import LoopRole, Quality
from connectors.mqtt.messages.malformed import MalformedPayloadError
from connectors.mqtt.messages.payload import field, seconds
from connectors.mqtt.messages.quality import quality
from connectors.mqtt.messages.reader import TopicReader
from connectors.mqtt.options import MqttTag

PAGE = (Path(__file__).parents[3] / "docs" / "howto" / "mqtt_gateways.md").read_text()
EXAMPLES = re.findall(r"## ([^\n]+)\n[^#]*?```(?:json|text)\n(.*?)```\n\n```yaml\n(.*?)```", PAGE, re.DOTALL)
NEW_YEAR = 1767225600.0
"""2026-01-01, UTC."""
ARRIVAL = NEW_YEAR + 1000.0
KEPWARE = {"topic": "x", "entry": "values", "field": "v", "time_field": "t", "quality_field": "q"}


def reader(**tags):
    return TopicReader({LoopRole("FIC101", role): MqttTag(**tag) for role, tag in tags.items()})


def kepware():
    return reader(
        pv={**KEPWARE, "where": {"id": "Plant.FIC101.PV"}}, op={**KEPWARE, "where": {"id": "Plant.FIC101.OP"}}
    )


def read(source, message):
    payload = message if isinstance(message, bytes) else json.dumps(message).encode()
    samples = source.readings(payload, ARRIVAL, retained=False)
    return [(s.tag.role, s.value, s.time, s.quality) for s in samples]


def entry(role, value, at, *, good=True):
    return {"id": f"Plant.FIC101.{role}", "v": value, "q": good, "t": at}


def test_the_page_shows_all_its_forms():
    assert len(EXAMPLES) == PAGE.count("```yaml") == 10


@pytest.mark.parametrize(("name", "message", "tags"), EXAMPLES, ids=[name for name, *_ in EXAMPLES])
def test_each_form_of_the_page_is_read(name, message, tags):
    source = reader(**yaml.safe_load(tags))
    found = read(source, message.encode())
    assert ("pv", 4.2, NEW_YEAR, Quality.GOOD) in found
    assert ("op", 51.0, NEW_YEAR, Quality.GOOD) in found
    assert len(found) == (4 if "rows" in name else 2)
    assert source.malformed == 0


def test_a_message_says_nothing_of_a_tag_that_is_not_in_it():
    source = kepware()
    assert read(source, {"values": [entry("PV", 4.2, 5.0)]}) == [("pv", 4.2, 5.0, Quality.GOOD)]
    assert read(source, {"values": []}) == []
    assert read(source, {"status": "online"}) == []
    assert source.malformed == 0


def test_a_tag_may_come_twice_in_one_message():
    found = read(kepware(), {"values": [entry("PV", 4.2, 5.0), entry("OP", 9, 5.5), entry("PV", 4.3, 6.0)]})
    assert found == [
        ("pv", 4.2, 5.0, Quality.GOOD),
        ("op", 9.0, 5.5, Quality.GOOD),
        ("pv", 4.3, 6.0, Quality.GOOD),
    ]


def test_two_loops_may_read_one_entry():
    tag = MqttTag(**KEPWARE, where={"id": "Plant.FIC101.PV"})
    source = TopicReader({LoopRole("FIC101", "pv"): tag, LoopRole("FIC102", "sp"): tag})
    payload = json.dumps({"values": [entry("PV", 4.2, 5.0)]}).encode()
    found = [(s.tag, s.value) for s in source.samples(payload, ARRIVAL, retained=False)]
    assert found == [(("FIC101", "pv"), 4.2), (("FIC102", "sp"), 4.2)]


def test_a_bad_value_of_a_gateway_is_bad():
    assert read(kepware(), {"values": [entry("PV", 4.2, 5.0, good=False)]}) == [("pv", 4.2, 5.0, Quality.BAD)]


def test_what_a_message_says_of_a_bad_value_is_shown():
    tag = {**KEPWARE, "where": {"id": "Plant.FIC101.PV"}}
    message = {"values": [{"id": "Plant.FIC101.PV", "v": 1, "q": {"Code": 2147483648}, "t": 5.0}]}
    (sample,) = reader(pv=tag).samples(json.dumps(message).encode(), ARRIVAL, retained=False)
    assert sample.why == 'its quality is {"Code": 2147483648}'


def test_an_entry_without_its_value_is_a_gap_of_that_tag_alone():
    source = kepware()
    (pv, op) = read(source, {"values": [{"id": "Plant.FIC101.PV", "t": 5.0}, entry("OP", 9, 5.0)]})
    assert math.isnan(pv[1])
    assert pv[2:] == (5.0, Quality.BAD)
    assert op == ("op", 9.0, 5.0, Quality.GOOD)
    assert source.malformed == 1


def test_a_field_that_is_absent_is_a_gap_unless_only_changes_are_sent():
    row = {"topic": "x", "time_field": "t"}
    every = reader(pv={**row, "field": "pv"}, op={**row, "field": "op"})
    changes = reader(
        pv={**row, "field": "pv", "absent": "unchanged"}, op={**row, "field": "op", "absent": "unchanged"}
    )
    assert [role for role, *_ in read(every, {"t": 5.0, "pv": 1.0})] == ["pv", "op"]
    assert read(changes, {"t": 5.0, "pv": 1.0}) == [("pv", 1.0, 5.0, Quality.GOOD)]
    assert (every.malformed, changes.malformed) == (1, 0)


@pytest.mark.parametrize("at", [NEW_YEAR, 1e3 * NEW_YEAR, 1e6 * NEW_YEAR, 1e9 * NEW_YEAR, "1767225600000"])
def test_the_unit_of_a_time_is_recognised(at):
    assert seconds(at) == pytest.approx(NEW_YEAR, abs=1e-3)


def test_a_time_that_cannot_be_is_none():
    with pytest.raises(MalformedPayloadError, match="too large"):
        seconds(1e21)
    assert seconds("20260101") == NEW_YEAR


@pytest.mark.parametrize(
    ("said", "expected"),
    [
        (None, Quality.GOOD),
        (True, Quality.GOOD),
        (False, Quality.BAD),
        (192, Quality.GOOD),
        ("192", Quality.GOOD),
        (216, Quality.GOOD),
        (64, Quality.UNCERTAIN),
        (24, Quality.BAD),
        (0, Quality.BAD),
        (1, Quality.BAD),
        (512, Quality.BAD),
        (0x00960000, Quality.GOOD),
        (0x408F0000, Quality.UNCERTAIN),
        (0x80000000, Quality.BAD),
        ("0x80050000", Quality.BAD),
        ({"Code": 0x80000000, "Symbol": "Bad"}, Quality.BAD),
        ({"Symbol": "Good"}, Quality.GOOD),
        ({}, Quality.GOOD),
        ("Good", Quality.GOOD),
        ("Uncertain_LastUsable", Quality.UNCERTAIN),
        ("Bad_NoCommunication", Quality.BAD),
        ([], Quality.BAD),
        (1e300, Quality.BAD),
    ],
)
def test_qualities_of_gateways(said, expected):
    assert quality(said) is expected


def test_the_good_ones_may_be_named():
    tag = {"topic": "x", "field": "v", "quality_field": "q", "good": [0]}
    assert read(reader(pv=tag), {"v": 1, "q": 0})[0][3] is Quality.GOOD
    assert read(reader(pv=tag), {"v": 1, "q": 0.0})[0][3] is Quality.GOOD
    assert read(reader(pv=tag), {"v": 1, "q": 192})[0][3] is Quality.BAD
    assert read(reader(pv=tag), {"v": 1})[0][3] is Quality.GOOD


def test_keys_may_have_dots():
    tree = {"FIC101.PV": {"Value": 1}, "a": {"b.c": {"d": [2, {"e.f": 3}]}}}
    assert field(tree, "FIC101.PV.Value") == 1
    assert field(tree, "a.b.c.d.1.e.f") == 3
    with pytest.raises(MalformedPayloadError):
        field(tree, "a.b.c.x")


@pytest.mark.parametrize("key", ["time_field", "quality_field", "entry"])
def test_what_needs_json_needs_a_field(key):
    with pytest.raises(ValidationError, match=f"{key} needs field"):
        MqttTag(topic="x", **{key: "t"})


def test_good_ones_need_their_field():
    with pytest.raises(ValidationError, match="good needs quality_field"):
        MqttTag(topic="x", field="v", good=[0])


LEAVES = st.none() | st.booleans() | st.floats() | st.text(max_size=3) | st.integers()
KEYS = st.sampled_from(["values", "id", "v", "t", "q", "Plant.FIC101.PV", "Code"])
TREES = st.recursive(
    LEAVES | st.just("Plant.FIC101.PV"),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(KEYS, inner, max_size=5),
    max_leaves=25,
)


@given(st.dictionaries(KEYS, TREES) | st.fixed_dictionaries({"values": st.lists(TREES)}))
def test_no_message_breaks_it(message):
    for sample in kepware().samples(json.dumps(message).encode(), ARRIVAL, retained=False):
        assert math.isfinite(sample.time)
        assert math.isfinite(sample.value) or sample.quality is Quality.BAD
