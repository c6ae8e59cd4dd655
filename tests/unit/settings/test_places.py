"""Faults of a configuration name line and loop; PV and OP of one tag are named."""

from __future__ import annotations

import textwrap

import pytest

from agent.settings import load_settings
from agent.settings.load import settings_of
from agent.settings.places import Places
from agent.settings.same_tags import same_tags
from connectors.base import ConfigError

TEXT = textwrap.dedent(
    """\
    agent: {workers: 0}
    connections:
      unit1: {kind: modbus, port: 99999}
    loops:
      - name: FIC 101
        connection: unit1
        ts: 1.0
        tags:
          pv: {table: input, address: 0}
          op: {table: input, address: 2, order: ABDC}
      - connection: nowhere
        ts: -1
        tags:
          pv: {table: input, address: 4}
    more: 1
    """
)
WRONG = [
    "line 1: agent.workers: input should be greater than or equal to 1",
    "line 3: connection unit1: port: input should be less than or equal to 65535",
    "line 5: loop FIC 101: name: 'FIC 101' cannot be used here, expected: Tag name without spaces",
    "line 10: loop FIC 101: tags.op.order: input should be 'ABCD'",
    "line 11: loop number 2: connection: no connection is called nowhere",
    "line 12: loop number 2: ts: input should be greater than 0",
    "line 13: loop number 2: tags.op: is missing",
    "line 15: more: unknown key",
]


def test_every_fault_has_its_line_and_no_regular_expression(tmp_path):
    path = tmp_path / "plant.yaml"
    path.write_text(TEXT)
    with pytest.raises(ConfigError) as caught:
        load_settings(path)
    faults = sorted(each.removeprefix(f"{path}, ") for each in caught.value.faults)
    for expected in WRONG:
        assert any(each.startswith(expected) for each in faults), (expected, faults)
    assert all(each.startswith("line ") for each in faults)
    assert not any("pattern" in each or "[^" in each or "loops." in each for each in faults)


def test_loops_of_one_name_are_given_with_their_lines():
    text = "loops:\n  - {name: A}\n  - {name: A}\n"
    (fault,) = Places.of(text).located(["loops: 2 loops are called A (loops.0; loops.1)"])
    assert fault == "line 1: loops: 2 loops are called A (line 2; line 3)"


@pytest.mark.parametrize("fault", ["many.csv, line 2, column pv: type: x", "loops.FIC9.tags.pv: y", "z"])
def test_what_is_not_in_the_file_stays(fault):
    assert Places.of(TEXT).located([fault]) == [fault]
    assert Places.of("loops: [").located([fault]) == [fault]


@pytest.mark.parametrize(
    ("pv", "op", "words"),
    [
        ({"table": "input", "address": 0}, {"table": "input", "address": 0, "order": "CDAB"}, "the same tag"),
        ({"table": "input", "address": 0}, {"table": "input", "address": 1}, "share a register"),
        ({"table": "input", "address": 0}, {"table": "input", "address": 2}, None),
        ({"table": "input", "address": 0}, {"table": "holding", "address": 0}, None),
        ({"node": "i=5"}, {"node": "ns=0;i=5"}, "the same tag (i=5)"),
        ({"node": "ns=2;s=PV"}, {"node": "ns=2;s=OP"}, None),
        ({"topic": "plant/F", "field": "pv"}, {"topic": "plant/F", "field": "pv"}, "the same tag"),
        ({"topic": "plant/F", "field": "pv"}, {"topic": "plant/F", "field": "op"}, None),
    ],
)
def test_pv_and_op_of_one_tag(pv, op, words):
    kind = "modbus" if "table" in pv else "opcua" if "node" in pv else "mqtt"
    options = {"url": "opc.tcp://127.0.0.1:4840"} if kind == "opcua" else {"host": "127.0.0.1"}
    loop = {"name": "F", "connection": "c", "ts": 1.0, "tags": {"pv": pv, "op": op}}
    found = same_tags(settings_of({"connections": {"c": {"kind": kind, **options}}, "loops": [loop]}))
    assert (words is None) == (found == {})
    assert words is None or words in found["F"]
