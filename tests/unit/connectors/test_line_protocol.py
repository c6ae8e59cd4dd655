"""Line protocol: what InfluxDB's own page shows, and what nobody should send."""

import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from connectors.mqtt.messages.line_protocol import LONGEST, objects_of_lines
from connectors.mqtt.messages.malformed import MalformedPayloadError
from connectors.mqtt.messages.payload import parse


def test_a_line_has_name_tags_fields_and_time():
    text = 'loop,area=A1,host=h pv=4.2,op=51i,on=true,mode="AUTO, local" 1767225600000000000\n'
    assert objects_of_lines(text) == [
        {
            "name": "loop",
            "tags": {"area": "A1", "host": "h"},
            "fields": {"pv": 4.2, "op": 51.0, "on": True, "mode": "AUTO, local"},
            "timestamp": 1767225600000000000,
        }
    ]


def test_tags_time_and_comments_may_be_missing_or_there():
    assert objects_of_lines("# a comment\n\nloop pv=1\r\nloop pv=2 7") == [
        {"name": "loop", "tags": {}, "fields": {"pv": 1.0}},
        {"name": "loop", "tags": {}, "fields": {"pv": 2.0}, "timestamp": 7.0},
    ]


def test_what_is_escaped_is_plain():
    (found,) = objects_of_lines(r'my\ loop,id=ns\=2;s\=F\,1 a\=b="say \"hi\" \\ there",c=5u')
    assert found == {
        "name": "my loop",
        "tags": {"id": "ns=2;s=F,1"},
        "fields": {"a=b": 'say "hi" \\ there', "c": 5.0},
    }


@pytest.mark.parametrize(
    "text",
    [
        "",
        "# only",
        "word",
        "two words",
        "a b=",
        'a b="open',
        "a b=1 then",
        "a,b c=1",
        "a b=1,c",
        ", b=1",
        "\\ b=1",
    ],
)
def test_what_is_no_line_protocol(text):
    with pytest.raises(MalformedPayloadError):
        objects_of_lines(text)


@given(st.text(alphabet='ab=, "\\\n1.5it#', max_size=40) | st.text())
def test_no_text_breaks_it(text):
    try:
        found = parse(text.encode())
    except MalformedPayloadError:
        return
    json.dumps(found)


@pytest.mark.parametrize("rest", ['"' + "x" * LONGEST, "\\" * LONGEST, "=" * LONGEST])
def test_a_line_that_no_device_sends_is_rejected(rest):
    with pytest.raises(MalformedPayloadError):
        objects_of_lines(f"a b={rest}")
    with pytest.raises(MalformedPayloadError):
        objects_of_lines(f"a b={rest[: LONGEST - 10]}")
