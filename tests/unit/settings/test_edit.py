"""A configuration file with one entry changed: comments and all else stay."""

import pytest
import yaml

from agent.settings.edit import EditError, edited, entry_yaml, written
from tests.conftest import ROOT

EXAMPLE = (ROOT / "config" / "example.yaml").read_text(encoding="utf-8")
RAW = yaml.safe_load(EXAMPLE)
ENTRIES = [("connections", name) for name in RAW["connections"]] + [
    ("loops", each["name"]) for each in RAW["loops"] if "name" in each
]


@pytest.mark.parametrize(("part", "name"), ENTRIES)
def test_what_is_written_again_changes_nothing(part, name):
    assert edited(EXAMPLE, part, name, written(EXAMPLE)[part][name]) == EXAMPLE


@pytest.mark.parametrize("part", ["loops", "connections"])
def test_a_new_entry_is_added_and_each_line_before_stays(part):
    entry = {"name": "NEW1", "connection": "dcs", "ts": 1.0, "tags": {"pv": {"node": "ns=2;s=a#b"}}}
    changed = edited(EXAMPLE, part, "NEW1", entry_yaml(entry))
    lines = iter(changed.splitlines())
    assert all(line in lines for line in EXAMPLE.splitlines())  # in their order
    found = yaml.safe_load(changed)[part]
    assert (found[-1] if part == "loops" else found["NEW1"]) == entry


def test_a_file_is_read_once_however_many_entries_it_has(monkeypatch):
    many = [{"name": f"F{i}", "tags": {"pv": i}} for i in range(200)]
    text = yaml.safe_dump({"connections": {"plant": {"kind": "mqtt"}}, "loops": many}, sort_keys=False)
    composed, compose = [], yaml.compose
    monkeypatch.setattr(yaml, "compose", lambda *given: composed.append(1) or compose(*given))
    found = written(text)
    assert len(composed) == 1
    assert found["loops"].keys() == {each["name"] for each in many}
    assert yaml.safe_load(found["loops"]["F7"]) == many[7]


def test_a_file_without_loops_has_none():
    assert written("connections:\n  a: {kind: mqtt}\n") == {
        "connections": {"a": "{kind: mqtt}\n"},
        "loops": {},
    }
    with pytest.raises(EditError, match="the file has no loops"):
        edited("connections:\n  a: {kind: mqtt}\n", "loops", "F1", "name: F1")


def test_comments_of_an_edited_entry_stay_where_they_are():
    text = written(EXAMPLE)["loops"]["LIC205"].replace("ts: 2.0", "ts: 5.0")
    changed = edited(EXAMPLE, "loops", "LIC205", text)
    different = [
        pair for pair in zip(EXAMPLE.splitlines(), changed.splitlines(), strict=True) if pair[0] != pair[1]
    ]
    assert different == [("    ts: 2.0", "    ts: 5.0")]


def test_the_last_line_may_lack_its_end():
    text = "connections:\n  a: {kind: mqtt}\nloops:\n- name: F1\n  ts: 1"
    assert yaml.safe_load(edited(text, "loops", "F2", "name: F2"))["loops"] == [
        {"name": "F1", "ts": 1},
        {"name": "F2"},
    ]
    assert yaml.safe_load(edited(text, "connections", "a", "kind: modbus\nhost: h"))["connections"] == {
        "a": {"kind": "modbus", "host": "h"}
    }


@pytest.mark.parametrize(
    ("text", "entry", "why"),
    [
        ("loops: [{name: F1}]\n", "name: F2", "dash"),
        ("loops:\n  - name: F1\n", "- a list", "mapping"),
        ("loops:\n  - name: F1\n", "", "mapping"),
        ("connections: {}\n", "name: F2", "no loops"),
    ],
)
def test_what_cannot_be_edited_is_said(text, entry, why):
    with pytest.raises(EditError, match=why):
        edited(text, "loops", "F2", entry)
