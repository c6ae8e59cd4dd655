"""Loops from a CSV list: each line a loop, each fault with its line and column."""

import contextlib
import json
import re

import pytest
from hypothesis import HealthCheck, given
from hypothesis import settings as limits
from hypothesis import strategies as st

from agent.settings import load_settings
from connectors.base import ConfigError

CONNECTIONS = {
    "dcs": {"kind": "opcua", "url": "opc.tcp://192.0.2.1:4840"},
    "unit1": {"kind": "modbus"},
    "broker": {"kind": "mqtt"},
}


@pytest.fixture
def load(tmp_path):
    def load(defaults, text, *more):
        (tmp_path / "loops.csv").write_text(text)
        loops = [*more, {"from": "loops.csv", "defaults": defaults}]
        path = tmp_path / "plant.yaml"
        path.write_text(json.dumps({"connections": CONNECTIONS, "loops": loops}))  # JSON is YAML
        return load_settings(path)

    return load


@pytest.fixture
def faults_of(load, tmp_path):
    def faults_of(*args):
        with pytest.raises(ConfigError) as caught:
            load(*args)
        before = re.compile(rf"{re.escape(str(tmp_path / 'plant.yaml'))}(, line \d+)?: ")
        assert all(before.match(fault) for fault in caught.value.faults)
        return [before.sub("", fault, count=1).replace(f"{tmp_path}/", "") for fault in caught.value.faults]

    return faults_of


def test_every_column_ends_where_it_belongs(load, tmp_path):
    settings = load(
        {"connection": "unit1", "ts": 1.0, "tags": {"pv": {"table": "input", "order": "CDAB"}}},
        "name;ts;pv;op;mode;time;op_low;op_high;automatic;integrating;window.seconds;alarm.priority;# note\n"
        "FIC1;;100;input 102 uint16;coil 7;input 110 float64;0;100;AUTO 1;TRUE;3000;high;steam\n"
        "\n"
        "FIC2;2.5;200 int16;input 202;;;;;;;;;\n",
    )
    one, two = settings.loops
    assert (one.ts, two.ts) == (1.0, 2.5)
    assert one.tags["pv"].model_dump() == {
        "type": "float32",
        "order": "CDAB",
        "scale": 1.0,
        "offset": 0.0,
        "table": "input",
        "address": 100,
    }
    assert (two.tags["pv"].address, two.tags["pv"].type, two.tags["pv"].order) == (200, "int16", "CDAB")
    assert (one.tags["op"].type, one.tags["time"].type) == ("uint16", "float64")
    assert two.roles == ("pv", "op")
    assert (one.op_range, two.op_range) == ((0.0, 100.0), None)
    assert one.automatic == ("AUTO", 1.0)
    assert (one.integrating, two.integrating) == (True, None)
    assert (one.window.seconds, one.alarm.priority) == (3000.0, "high")
    assert settings.lists == (tmp_path / "loops.csv",)


def test_defaults_get_the_name_and_cells_take_their_place(load):
    tags = {"pv": {"topic": "a"}, "op": {"topic": "b"}}
    by_hand, first, second = load(
        {
            "connection": "dcs",
            "ts": 1.0,
            "op_range": [0, 100],
            "tags": {"pv": {"node": "ns=2;s={loop}.PV"}, "op": {"node": "ns=2;s={loop}.OP"}},
            "publish": [{"connection": "dcs", "active": {"node": "ns=2;s={loop}.STICTION"}}],
        },
        "name,op_high,pv\nFIC1,90,\nFIC2,,i=7\n",
        {"name": "LIC9", "connection": "broker", "ts": 1.0, "tags": tags},
    ).loops
    assert by_hand.name == "LIC9"
    assert (first.tags["pv"].node, second.tags["pv"].node) == ("ns=2;s=FIC1.PV", "i=7")
    assert (first.op_range, second.op_range) == ((0.0, 90.0), (0.0, 100.0))
    assert second.publish[0].active.node == "ns=2;s=FIC2.STICTION"


def test_an_mqtt_address_is_topic_and_field(load):
    (loop,) = load({"connection": "broker", "ts": 1.0}, "name,pv,op\nF1,plant/F1#v.pv,plant/F1/OP\n").loops
    assert (loop.tags["pv"].topic, loop.tags["pv"].field) == ("plant/F1", "v.pv")
    assert (loop.tags["op"].topic, loop.tags["op"].field) == ("plant/F1/OP", None)


def test_all_faults_are_reported_at_once_with_line_and_column(faults_of):
    faults = faults_of(
        {"connection": "unit1", "hold": -3, "tags": {"op": {"table": "input", "address": 0}}},
        "name,ts,acting,pv,op_low,op_high,window.seconds,tags.pv.scale,description\n"
        "FIC1,1,revers,input 0 float65,0,,,,flow\n"
        "F 2,1,,coils 1,100,0,soon,0,flow\n"
        "FIC1,,,,,,,,flow\n",
    )
    expected = [
        "loops.csv, line 1, column description: unknown; begin its name with # to have it ignored",
        "list loops.csv: defaults.hold: input should be greater than 0",
        "loops.csv, line 2, column acting: input should be 'reverse' or 'direct'",
        "loops.csv, line 2, column pv: type: ",
        "loops.csv, line 2, column op_high: input should be a valid number",
        "loops.csv, line 3, column name: ",
        "loops.csv, line 3, column pv: table: ",
        "loops.csv, line 3, column op_low and op_high: the lower end 100 must be below the upper end 0",
        "loops.csv, line 3, column window.seconds: ",
        "loops.csv, line 4: ts: is missing",
        "loops.csv, line 4: tags.pv: is missing",
        "loops: 2 loops are called FIC1 (loops.csv, line 2; loops.csv, line 4)",
    ]
    for each in expected:
        assert len([fault for fault in faults if fault.startswith(each)]) == 1, (each, faults)
    assert len(faults) == len(expected)


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("name,pv,op\nFIC1,i=1\n", "loops.csv, line 2: 2 cells, expected 3"),
        ("name,pv,op\n", "loops.csv: no loop in it"),
        ("", "loops.csv: is empty"),
        ("name,name\na,b\n", "loops.csv, line 1: column 'name' is there twice"),
        (
            "name,connection\nFIC1,nowhere\n",
            "loops.csv, line 2, column connection: no connection is called nowhere",
        ),
    ],
)
def test_a_list_that_is_none(faults_of, text, fault):
    assert any(each.startswith(fault) for each in faults_of({"connection": "dcs", "ts": 1}, text))


def test_a_list_that_is_not_there(tmp_path):
    path = tmp_path / "plant.yaml"
    path.write_text(
        json.dumps({"connections": CONNECTIONS, "loops": [{"from": "missing.csv", "default": {}}]})
    )
    with pytest.raises(ConfigError, match=r"line 1: list missing\.csv: default: unknown key"):
        load_settings(path)
    path.write_text(json.dumps({"connections": CONNECTIONS, "loops": [{"from": "missing.csv"}]}))
    with pytest.raises(ConfigError, match=r"missing\.csv: cannot be read: No such file"):
        load_settings(path)


COLUMNS = [
    "name",
    "connection",
    "ts",
    "pv",
    "op",
    "mode",
    "time",
    "op_low",
    "pv_high",
    "automatic",
    "window.seconds",
]
COLUMNS += [
    "op_range.0",
    "op_range.x",
    "tags",
    "tags.pv",
    "tags.pv.table.x",
    "publish.0.connection",
    "automatic.7",
]
CELLS = [
    "",
    "F1",
    "dcs",
    "unit1",
    "1",
    "-1",
    "input 0",
    "ns=1;s=x",
    "a#b",
    "AUTO 1",
    "0 0 0 0 0 0",
    "{loop}",
    "nan",
    "\u00b2",
]
TREES = st.recursive(
    st.none() | st.floats() | st.sampled_from(["dcs", "{loop}", "input"]),
    lambda inner: st.lists(inner, max_size=2) | st.dictionaries(st.sampled_from(COLUMNS), inner, max_size=3),
    max_leaves=6,
)


@limits(max_examples=100, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    columns=st.lists(st.sampled_from(COLUMNS), min_size=1, unique=True),
    cells=st.lists(st.lists(st.sampled_from(CELLS), min_size=20, max_size=20), max_size=3),
    defaults=st.dictionaries(st.sampled_from([*COLUMNS, "op_range", "publish"]), TREES, max_size=4),
)
def test_any_content_is_loaded_or_reported(load, columns, cells, defaults):
    rows = "".join(",".join(row[: len(columns)]) + "\n" for row in cells)
    with contextlib.suppress(ConfigError):
        load(defaults, ",".join(columns) + "\n" + rows)
