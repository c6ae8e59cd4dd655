"""``slipjump replay``: recordings through a real bus to the agent, and its alarm back from that bus."""

import itertools
import json
import time

import numpy as np
import pytest

from agent.cli import main
from simulators.plant import rows
from simulators.record_file import write_rows
from simulators.scenario import load_scenario
from tests.conftest import ROOT

NAMES = ("modbus", "opcua", "mqtt")
BUSES = pytest.mark.parametrize("bus", NAMES)
KEYS = ["recording", "loop", "bus", "verdict", "alarm_seen_on_bus", "stiction", "seconds"]
SAMPLES = 600


@pytest.fixture
def replay(capfd):
    def _run(*words):
        with pytest.raises(SystemExit) as left:
            main(["replay", *map(str, words)])
        out, err = capfd.readouterr()
        assert "Traceback" not in err
        return left.value.code, out, err

    return _run


@pytest.fixture
def plant(tmp_path):
    """Write the first ten minutes of a shipped scenario as a recording."""

    def _plant(scenario):
        loaded = load_scenario(ROOT / "config" / "scenarios" / f"{scenario}.yaml")
        path = tmp_path / f"{loaded.loop}.csv"
        write_rows(path, itertools.islice(rows(loaded), SAMPLES))
        return path

    return _plant


@pytest.mark.parametrize(
    ("name", "bus"),
    [("PAP2", "opcua"), *(pytest.param("CHEM10", bus, marks=pytest.mark.bench) for bus in NAMES)],
)
def test_industrial_loops_end_as_labelled_on_each_bus(replay, recordings, name, bus):
    folder = recordings / "isdb"
    code, out, err = replay(folder / f"{name}.csv", folder / "CHEM13.csv", "--bus", bus, "--json")
    assert (code, err) == (0, "")
    sticking, other = [json.loads(line) for line in out.splitlines()]
    assert list(sticking) == list(other) == KEYS
    assert (sticking["recording"], sticking["loop"], sticking["bus"]) == (f"{name}.csv", name, bus)
    assert (sticking["verdict"], sticking["alarm_seen_on_bus"]) == ("stiction", True)
    assert set(sticking["stiction"]) == {"f_s", "f_d", "s", "j", "identifiable"}
    assert name != "CHEM10" or sticking["stiction"]["s"]["value"] == pytest.approx(1.7, abs=0.2)
    assert other["verdict"] != "stiction"
    assert not other["alarm_seen_on_bus"]


def test_a_bad_file_among_good_ones(replay, tmp_path):
    good = tmp_path / "FIC101.csv"
    good.write_text("time,OP,PV\n" + "".join(f"{k},42,{k % 9}\n" for k in range(60)))
    bad = tmp_path / "BAD.csv"
    bad.write_text("time,OP,PV\n0,1,2\n1,open,2\n")
    code, out, err = replay(bad, good, tmp_path / "none.csv", good, "--bus", "mqtt", "--json")
    assert code == 2
    assert [json.loads(line)["loop"] for line in out.splitlines()] == ["FIC101", "FIC101"]
    assert err.splitlines() == [
        f"slipjump: {bad}, line 3: OP is 'open', expected a number or an empty cell",
        f"slipjump: {tmp_path / 'none.csv'}: cannot be read: No such file or directory",
    ]


def test_speed_is_times_real_time(replay, plant):
    """A plant survives the way over MQTT, without any shared data."""
    began = time.monotonic()
    code, out, err = replay(plant("fic101_stick_slip"), "--speed", 150, "--bus", "mqtt", "--json")
    assert (code, err) == (0, "")
    told = json.loads(out)
    assert (told["verdict"], told["alarm_seen_on_bus"]) == ("stiction", True)
    assert time.monotonic() - began > SAMPLES / 150


def test_plain_text_goes_by_opc_ua(replay, plant):
    code, out, err = replay(plant("fic101_stick_slip"))
    assert (code, err) == (0, "")
    first, *reasons = out.splitlines()
    assert first == "FIC101: stiction, alarm seen on opcua"
    assert reasons
    assert all(reason.startswith("  - ") for reason in reasons)


UNTESTABLE = {  # names that are no topics and no nodes
    "constant OP": (["42"] * 60, [str(k % 9) for k in range(60)]),
    "no OP": (["Bad"] * 60, ["1"] * 60),
    "two samples": (["1", "2"], ["1", "2"]),
    "few samples": ([str(k % 7) if k > 45 else "" for k in range(60)], ["5"] * 60),
}


@BUSES
def test_what_cannot_be_tested_is_done_without_an_alarm(replay, tmp_path, bus):
    for name, (op, pv) in UNTESTABLE.items():
        lines = [f"{k},{u},{y}" for k, (u, y) in enumerate(zip(op, pv, strict=True))]
        (tmp_path / f"{name}.csv").write_text("\n".join(["time,OP,PV", *lines, ""]))
    code, out, err = replay(*(tmp_path / f"{name}.csv" for name in UNTESTABLE), "--bus", bus, "--json")
    assert (code, err) == (0, "")
    told = [json.loads(line) for line in out.splitlines()]
    assert [(each["loop"], each["verdict"], each["alarm_seen_on_bus"]) for each in told] == [
        (name, "not_testable", False) for name in UNTESTABLE
    ]


@pytest.mark.parametrize("bus", ["modbus", "opcua"])
def test_gaps_and_doubled_stamps_travel(replay, plant, tmp_path, bus):
    """Every twentieth sample is a word of the historian, and one stamp comes twice."""
    header, *lines = plant("fic101_stick_slip").read_text().splitlines()
    for k in range(0, len(lines), 20):
        stamp, _, *rest = lines[k].split(",")
        lines[k] = ",".join([stamp, "I/O Timeout", *rest])
    lines.insert(100, lines[99])
    path = tmp_path / "GAPS.csv"
    path.write_text("\n".join([header, *lines, ""]))
    code, out, err = replay(path, "--bus", bus, "--json")
    assert (code, err) == (0, "")
    told = json.loads(out)
    assert (told["verdict"], told["alarm_seen_on_bus"]) == ("stiction", True)
    assert np.isfinite(told["stiction"]["s"]["value"])


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        ([], "Missing argument"),
        (["x.csv", "--bus", "profibus"], "--bus"),
        (["x.csv", "--speed", "0"], "--speed"),
        (["x.csv", "--speed", "nan"], "--speed"),
        (["x.csv", "--ts", "-1"], "--ts"),
    ],
)
def test_bad_usage(replay, words, expected):
    code, out, err = replay(*words)
    assert (code, out) == (2, "")
    assert err.count("\n") == 1
    assert expected in err
