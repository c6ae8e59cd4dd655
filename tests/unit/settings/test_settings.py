"""The configuration file: read, merged with the options of each bus, and all its faults reported at once."""

import copy
import json
import os

import pytest
import yaml

from agent.settings import connectors_of, load_settings, settings_of
from agent.settings.schema import json_schema
from connectors.base import ConfigError
from connectors.kinds import KINDS
from tests.conftest import ROOT

EXAMPLE = ROOT / "config" / "example.yaml"
SCHEMA = ROOT / "config" / "schema.json"


@pytest.fixture
def raw():
    return {
        "connections": {
            "unit1": {"kind": "modbus", "host": "192.0.2.1"},
            "broker": {"kind": "mqtt"},
        },
        "loops": [
            {
                "name": "FIC101",
                "connection": "unit1",
                "ts": 1.0,
                "tags": {
                    "pv": {"table": "input", "address": 0},
                    "op": {"table": "input", "address": 2},
                },
                "publish": [{"connection": "broker"}],
            }
        ],
    }


def faults_of(raw):
    with pytest.raises(ConfigError) as caught:
        settings_of(raw)
    return caught.value.faults


@pytest.mark.parametrize("name", ["demo.yaml", "scenarios/fic101_stick_slip.yaml"])
def test_another_file_of_slipjump_is_reported_in_one_line(name):
    with pytest.raises(ConfigError) as caught:
        load_settings(ROOT / "config" / name)
    (fault,) = caught.value.faults
    assert "not a configuration of slipjump" in fault


def test_the_example_is_right_and_shows_every_bus():
    settings = load_settings(EXAMPLE)
    assert {c.kind for c in settings.connections.values()} == {kind.kind for kind in KINDS}
    assert [loop.name for loop in settings.loops] == ["FIC101", "LIC205", "TIC310", "FIC401", "PIC402"]
    fic101 = settings.loops[0]
    assert fic101.roles == ("pv", "op", "sp", "mv", "mode")
    assert (fic101.hints.acting, fic101.hints.op_range) == ("reverse", (0.0, 100.0))
    assert [target.connection for target in fic101.publish] == ["unit1", "broker", "scada", "panel", "ours"]
    assert settings.loops[1].window.shortest == settings.loops[1].window.longest == 3000.0


def keys_of(node):
    """All keys of a YAML file or a schema's properties."""
    if isinstance(node, dict):
        return set(node).union(*(keys_of(value) for value in node.values()))
    if isinstance(node, list):
        return set().union(*(keys_of(value) for value in node))
    return set()


def test_the_example_shows_every_setting():
    settings = {name for model in json_schema()["$defs"].values() for name in model.get("properties", {})}
    assert settings - keys_of(yaml.safe_load(EXAMPLE.read_text())) == set()


def test_a_minimal_file_is_enough(raw):
    settings = settings_of(raw)
    assert settings.agent.workers == 1
    assert settings.loops[0].alarm.on_delay == 3
    assert [connector.name for connector in connectors_of(settings)] == ["unit1", "broker"]


def test_all_faults_are_reported_at_once_with_their_paths(raw):
    raw["agent"] = {"workers": 0, "colour": "red"}
    raw["more"] = 1
    raw["connections"]["unit1"]["port"] = 99999
    raw["connections"]["field"] = {"kind": "hart"}
    loop = raw["loops"][0]
    loop["ts"] = -1
    loop["op_range"] = [100, 0]
    loop["tags"]["pv"]["order"] = "ABDC"
    loop["tags"]["xv"] = {"address": 3}
    loop["publish"][0]["topic"] = ""
    raw["loops"].append({"name": "bad name", "connection": "nowhere", "tags": {"pv": 5}})
    faults = faults_of(raw)
    places = [fault.split(": ")[0] for fault in faults]
    assert sorted(places) == sorted(
        [
            "more",
            "agent.workers",
            "agent.colour",
            "connections.unit1.port",
            "connections.field.kind",
            "loops.0.ts",
            "loops.0.op_range",
            "loops.0.tags.pv.order",
            "loops.0.tags.xv",
            "loops.0.publish.0.topic",
            "loops.1.name",
            "loops.1.connection",
            "loops.1.ts",
            "loops.1.tags.op",
        ]
    )
    assert "loops.0.op_range: the lower end 100 must be below the upper end 0" in faults
    assert "loops.1.connection: no connection is called nowhere (there are: unit1, broker, field)" in faults


def test_loops_of_one_name_are_a_fault(raw):
    raw["loops"].append(copy.deepcopy(raw["loops"][0]))
    assert faults_of(raw) == ["loops: 2 loops are called FIC101 (loops.0; loops.1)"]


def test_faults_that_only_the_connector_can_find_are_reported_too(raw):
    raw["loops"][0]["tags"]["pv"]["address"] = 65535  # a float32 needs two registers
    (fault,) = faults_of(raw)
    assert fault.startswith("loops.FIC101.tags.pv.address")


@pytest.mark.parametrize(
    ("change", "fault"),
    [
        (lambda raw: raw.pop("loops"), "loops: expected a list"),
        (lambda raw: raw.pop("connections"), "connections: expected at least one"),
        (lambda raw: raw.update(connections={"unit1": None}), "connections.unit1: expected a mapping"),
        (lambda raw: raw.update(loops=[7]), "loops.0: expected a mapping"),
        (lambda raw: raw["loops"][0].pop("tags"), "loops.0.tags: expected a mapping"),
        (lambda raw: raw["loops"][0].update(publish=7), "loops.0.publish: expected a list"),
        (lambda raw: raw["loops"][0].update(publish=[7]), "loops.0.publish.0: expected a mapping"),
        (lambda raw: raw["loops"][0].update(window={"hop": 0}), "loops.0.window.hop: "),
        (
            lambda raw: raw["loops"][0].update(window={"min_seconds": 5000}),
            "loops.0.window: min_seconds",
        ),
        (lambda raw: raw["loops"][0].update(ts=100), "loops.0: a window of 300 s is shorter"),
        (lambda raw: raw["loops"][0].pop("connection"), "loops.0.connection: "),
        (lambda raw: raw["loops"][0]["tags"].update(pv=None), "loops.0.tags.pv: "),
    ],
)
def test_one_fault(raw, change, fault):
    change(raw)
    assert any(each.startswith(fault) for each in faults_of(raw))


@pytest.mark.parametrize("content", [None, [], "text", 7])
def test_a_file_that_holds_no_mapping(content):
    assert faults_of(content) == ["expected a mapping with the keys agent, connections and loops"]


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"loops:\n  - {name: FIC101\n", "line 3: not YAML"),
        (b"loops: \x00", "not YAML"),
        (b"\xff\xfe\xfa", "cannot be read"),
        (b"", "expected a mapping"),
    ],
)
def test_a_file_that_is_no_yaml(tmp_path, content, message):
    path = tmp_path / "plant.yaml"
    path.write_bytes(content)
    with pytest.raises(ConfigError) as caught:
        load_settings(path)
    (fault,) = caught.value.faults
    assert fault.startswith(f"{path}: ")
    assert message in fault
    assert "\n" not in fault


def test_a_file_that_is_not_there(tmp_path):
    with pytest.raises(ConfigError, match=r"plant\.yaml: cannot be read: No such file"):
        load_settings(tmp_path / "plant.yaml")


@pytest.mark.parametrize(
    ("mode", "automatic"),
    [("AUTO", True), (" auto ", True), ("cas", True), ("MAN", False), (1, True), (1.0, True), (0.0, False)],
)
def test_the_mode_that_counts_as_automatic(raw, mode, automatic):
    raw["loops"][0]["automatic"] = ["AUTO", "CAS", 1]
    assert settings_of(raw).loops[0].is_automatic(mode) is automatic


@pytest.mark.parametrize(("mode", "automatic"), [("aut", True), ("Hand", False), (1.0, True), (0, False)])
def test_modes_of_the_table_where_none_are_listed(raw, mode, automatic):
    assert settings_of(raw).loops[0].is_automatic(mode) is automatic


def test_modes_that_the_file_adds(raw):
    raw["loops"][0]["modes"] = {"PROG7": "automatic", 2: "manual"}
    loop = settings_of(raw).loops[0]
    assert [loop.is_automatic(mode) for mode in ("prog7", 2.0, "PROG8", "AUTO")] == [True, False, False, True]
    assert loop.mode_means("PROG8") is None
    raw["loops"][0]["modes"] = {"PROG7": "sometimes"}
    with pytest.raises(ConfigError, match="PROG7"):
        settings_of(raw)


def test_the_schema_in_the_folder_is_that_of_the_models():
    """To make it anew: .venv/bin/python -m agent.settings.schema > config/schema.json."""
    assert json.loads(SCHEMA.read_text()) == json_schema()


@pytest.mark.parametrize("hidden", ["\u202e", "\u200b", "\x1b[31m", "\x00", "\u2066", "\ufeff"])
def test_a_name_that_hides_or_turns_what_is_written_is_refused_in_words(raw, hidden):
    raw["loops"][0]["name"] = f"FIC{hidden}101"
    (line,) = [each for each in faults_of(raw) if "name" in each]
    assert "control and direction characters" in line.replace("\n", " ")
    assert hidden not in line


def test_a_pipe_as_configuration_is_refused_and_not_waited_for(tmp_path):
    os.mkfifo(tmp_path / "plant.yaml")
    with pytest.raises(ConfigError, match="is no regular file"):
        load_settings(tmp_path / "plant.yaml")
