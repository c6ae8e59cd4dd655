"""Tags in messages that were heard: the entry that is written reads the value that was published."""

import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from agent.runtime.commission.heard_tags import _of_rows, heard_tags, name_in_id
from agent.settings.tag_names import NamedTag, groups_by_convention
from connectors.base import LoopRole, Quality
from connectors.mqtt.messages.reader import TopicReader
from connectors.mqtt.options import MqttTag
from tests.unit.connectors.test_mqtt_gateways import EXAMPLES, NEW_YEAR


def groups(names):
    return groups_by_convention([NamedTag(each, (each,)) for each in names])


def heard(topic, *messages):
    payloads = [each if isinstance(each, bytes) else json.dumps(each).encode() for each in messages]
    return {each.name: each for each in heard_tags(topic, payloads, lambda names: len(groups(names)))}


def read_back(tag, message):
    payload = message if isinstance(message, bytes) else json.dumps(message).encode()
    source = TopicReader({LoopRole("FIC101", "pv"): MqttTag.model_validate(tag)})
    return [(s.value, s.time, s.quality) for s in source.samples(payload, 0.0, retained=False)]


NAMED = [each for each in EXAMPLES if "Industrial Edge" not in each[0]]
"""Those whose entries have names, not numbers."""


@pytest.mark.parametrize(("name", "message"), [each[:2] for each in NAMED], ids=[each[0] for each in NAMED])
def test_each_form_of_the_page_is_recognised(name, message):
    found = heard("plant/FIC101" if "rows" in name else "x", message.encode())
    (loop,) = groups(found)
    for role, value in (("pv", 4.2), ("op", 51.0)):
        samples = read_back(found[loop.tags[role].address].tag, message.encode())
        assert samples[0] == (value, NEW_YEAR, Quality.GOOD)


def test_a_topic_for_each_value():
    assert heard("plant/FIC101/PV", b"4.2")["plant/FIC101/PV"].tag == {"topic": "plant/FIC101/PV"}
    found = heard("plant/FIC101/PV", {"value": 4.2, "ts": 5, "q": "Bad"})["plant/FIC101/PV"]
    assert read_back(found.tag, {"value": 4.2, "ts": 5, "q": "Bad"}) == [(4.2, 5.0, Quality.BAD)]


def test_an_object_for_each_loop():
    found = heard("plant/FIC101", {"t": 5.0, "values": {"pv": 4.2, "op": 51.0}, "mode": "AUTO"})
    (loop,) = groups(found)
    assert loop.name == "FIC101"
    assert found[loop.tags["pv"].address].tag == {
        "topic": "plant/FIC101",
        "field": "values.pv",
        "time_field": "t",
    }


def test_messages_of_one_tag_each_on_one_topic():
    messages = [
        {"fields": {"value": value}, "name": "opcua", "tags": {"id": name, "host": "h"}, "timestamp": 5}
        for name, value in (("FIC1.PV", 1.0), ("FIC1.OP", 2.0), ("FIC2.PV", 3.0), ("FIC2.OP", 4.0))
    ]
    found = heard("telegraf", *messages)
    assert len(groups(found)) == 2
    assert read_back(found["FIC2.PV"].tag, messages[2]) == [(3.0, 5.0, Quality.GOOD)]
    assert read_back(found["FIC2.PV"].tag, messages[0]) == []


def test_only_changes_are_seen_as_such():
    found = heard("x", {"ts": 5, "FIC1.PV": 1.0, "FIC1.OP": 2.0}, {"ts": 6, "FIC1.PV": 1.5})
    assert found["x/FIC1.OP"].tag["absent"] == "unchanged"
    assert "absent" not in found["x/FIC1.PV"].tag
    assert found["x/FIC1.PV"].value == 1.5


def test_a_large_gateway_is_looked_at_in_proportion():
    """Each value is looked at some times, not once for each of the others."""
    looks = 0

    class Counted(str):
        __slots__ = ()

        def rpartition(self, mark):
            nonlocal looks
            looks += 1
            return tuple(map(Counted, str.rpartition(self, mark)))

    leaves = {Counted(f"F{k}.PV.{end}"): 1.0 for k in range(300) for end in ("Value", "SourceTimestamp")}
    found = _of_rows({"topic": "x"}, [leaves] * 3, {})
    assert len(found) == 300
    assert looks < 20 * len(leaves)


def test_the_name_in_a_node_id():
    assert name_in_id("nsu=http://plant/;s=FIC101.PV") == name_in_id("ns=2;s=FIC101.PV") == "FIC101.PV"
    assert name_in_id("FIC101.PV") == "FIC101.PV"


KEYS = st.sampled_from(["values", "id", "v", "t", "FIC101.PV", "FIC101.OP", "Value", "StatusCode", ""])
LEAVES = st.none() | st.booleans() | st.floats() | st.integers() | st.sampled_from(["FIC1.PV", "FIC1.OP", ""])
TREES = st.recursive(
    LEAVES,
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(KEYS, inner, max_size=5),
    max_leaves=25,
)


@given(st.lists(TREES.map(lambda tree: json.dumps(tree).encode()) | st.binary(), max_size=4))
def test_no_message_breaks_it_and_each_entry_is_valid(messages):
    for each in heard("x", *messages).values():
        if each.tag.get("field") != "":
            MqttTag.model_validate(each.tag)
