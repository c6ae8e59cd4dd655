"""``slipjump demo`` as a newcomer starts it."""

import json
import os
import subprocess
import sys

import pytest
import yaml

from simulators.scenario import load_scenario
from tests.conftest import ROOT

CONFIG = ROOT / "config"
DEMO = [sys.executable, "-c", "from agent.cli import main; main()", "demo"]


def demo(*words, cwd, timeout):
    wide = {**os.environ, "COLUMNS": "120"}
    return subprocess.run(
        [*DEMO, *words], capture_output=True, text=True, check=False, timeout=timeout, cwd=cwd, env=wide
    )


@pytest.mark.slow
@pytest.mark.timeout(420)  # a slow machine takes its time; it ends as soon as all is told
def test_every_verdict_is_the_truth_and_every_bus_has_an_alarm_that_was_seen(tmp_path):
    done = demo("--seconds", "300", "--no-web", "--json", cwd=tmp_path, timeout=380)
    assert done.returncode == 0, done.stderr
    assert "Traceback" not in done.stderr
    told = json.loads(done.stdout)
    assert set(told) == {"loops", "seconds"}
    assert 0 < told["seconds"] < 302
    assert len(told["loops"]) >= 6
    for loop in told["loops"]:
        assert set(loop) == {"loop", "bus", "truth", "verdict", "alarm", "alarm_seen_on_bus"}
        sticks = loop["truth"] == "stiction"
        assert loop["verdict"] == loop["truth"], loop
        assert (loop["alarm"], loop["alarm_seen_on_bus"]) == ("active" if sticks else "normal", sticks), loop
    alarmed = [loop["bus"] for loop in told["loops"] if loop["alarm_seen_on_bus"]]
    assert set(alarmed) == {"modbus", "opcua", "mqtt"}
    assert len(alarmed) >= 3


def test_a_demo_that_is_cut_short_says_what_is_missing_and_fails(tmp_path):
    done = demo("--seconds", "1", cwd=tmp_path, timeout=200)
    assert done.returncode == 1, done.stderr
    assert done.stderr.count(": no verdict yet\n") >= 6
    assert "on bus" in done.stdout
    loops = [line for line in done.stdout.splitlines() if line.startswith(("FIC", "LIC", "TIC", "PIC"))]
    assert len(loops) >= 6
    assert all("..." in line and "ALARM" not in line for line in loops)


@pytest.mark.parametrize(
    ("words", "expected"), [(["--seconds", "0"], "--seconds"), (["--second", "9"], "--second")]
)
def test_bad_usage(tmp_path, words, expected):
    done = demo(*words, cwd=tmp_path, timeout=120)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.count("\n") == 1
    assert expected in done.stderr


def test_the_demo_shows_each_kind_of_loop():
    """Three that stick to different degrees; one healthy, one disturbed and one badly tuned."""
    plan = yaml.safe_load((CONFIG / "demo.yaml").read_text())
    scenarios = [load_scenario(CONFIG / "scenarios" / entry["scenario"]) for entry in plan["loops"]]
    degrees = {s.truth.f_s + s.truth.f_d for s in scenarios if s.truth.verdict == "stiction"}
    assert len(degrees) >= 3
    assert {s.truth.cause for s in scenarios} == {
        "stiction",
        "no_oscillation",
        "external_disturbance",
        "tight_tuning",
    }
