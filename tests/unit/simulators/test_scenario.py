from pathlib import Path

import numpy as np
import pytest

from connectors.base import ConfigError
from simulators.draws.periodicity import period_and_strength
from simulators.plant import simulate
from simulators.scenario import load_scenario

SHIPPED = sorted((Path(__file__).parents[3] / "config" / "scenarios").glob("[a-z]*[0-9]*.yaml"))

LEAST = """
loop: FIC1
duration: 100
controller: {kc: 0.4, ti: 8, sp: 100}
process: {gain: 1.5, tau: 5}
"""


def load(folder, text):
    path = folder / "scenario.yaml"
    path.write_text(text, encoding="utf-8")
    return load_scenario(path)


def faults(folder, text):
    with pytest.raises(ConfigError) as caught:
        load(folder, text)
    path = f"{folder / 'scenario.yaml'}"
    assert all(fault.startswith(path) for fault in caught.value.faults)
    return [fault.removeprefix(path).removeprefix(": ") for fault in caught.value.faults]


def test_the_least_a_scenario_needs(tmp_path):
    scenario = load(tmp_path, LEAST)
    assert scenario.samples == 100
    assert scenario.truth.verdict == "no_stiction"
    assert scenario.truth.cause == "no_oscillation"


def test_all_faults_at_once(tmp_path):
    text = """
loop: ""
duration: -5
controller: {kc: fast, ti: 0, sp: 100, acting: sideways}
valve: {law: karnopp, f_s: 1, f_d: 2}
process: {kind: second_order, gain: 1, tau: 5}
noise: {std: .inf}
nosie: 3
"""
    found = faults(tmp_path, text)
    for where in (
        "loop",
        "duration",
        "controller.kc",
        "controller.ti",
        "controller.acting",
        "valve",
        "process",
        "noise.std",
        "nosie",
    ):
        assert sum(fault.startswith(f"{where}: ") for fault in found) == 1, where
    assert len(found) == 9
    assert "process: kind second_order takes tau and tau2" in found


@pytest.mark.parametrize(
    ("extra", "fault"),
    [
        ("valve: {f_s: 2}", "valve: f_s and f_d need a friction law: karnopp or lugre"),
        (
            "valve: {law: lugre, f_s: 2}",
            "valve: f_d must be > 0 with lugre: its bristles relax only with kinetic friction",
        ),
        ("valve: {law: karnopp}", "valve: expected 0 <= f_d <= f_s and f_s > 0, got f_s 0, f_d 0"),
        ("op_range: [100, 0]", "op_range: expected [low, high], got [100, 0]"),
        ("op_range: [60, 100]", "controller.op: 50 lies outside op_range"),
        ("set_points: [{time: 9, sp: 1}, {time: 3, sp: 2}]", "set_points: must be in order of time"),
        (
            "truth: {verdict: stiction, cause: no_oscillation, f_s: 0, f_d: 0}",
            "truth.verdict: stiction is stated, no_stiction follows from the parameters",
        ),
    ],
)
def test_parts_that_do_not_fit(tmp_path, extra, fault):
    assert faults(tmp_path, LEAST + extra) == [fault]


def test_gain_must_suit_the_controller(tmp_path):
    text = LEAST.replace("sp: 100", "sp: 100, acting: direct")
    assert faults(tmp_path, text) == ["process.gain: must lie below 0 with a direct controller"]


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("", "expected a scenario, keys and values"),
        ("- a\n- b", "expected a scenario, keys and values"),
        ("loop: [1, 2\nprocess: 3", ":2: not YAML: expected ',' or ']', but got ':'"),
    ],
)
def test_no_scenario_at_all(tmp_path, text, fault):
    assert faults(tmp_path, text) == [fault]


def test_unreadable_files(tmp_path):
    with pytest.raises(ConfigError, match=r"absent\.yaml: No such file or directory"):
        load_scenario(tmp_path / "absent.yaml")
    (tmp_path / "latin.yaml").write_bytes(b"loop: Ventil\xe4\n")
    with pytest.raises(ConfigError, match=r"latin\.yaml: not UTF-8 text"):
        load_scenario(tmp_path / "latin.yaml")


@pytest.mark.parametrize(
    "start", ["1000", "1970-01-01T00:16:40Z", "1970-01-01 00:16:40", "1970-01-01T01:16:40+01:00"]
)
def test_start_in_seconds_or_iso_8601(tmp_path, start):
    assert load(tmp_path, f"{LEAST}start: {start}").start == 1000.0


def test_truth_follows_from_the_parameters(tmp_path):
    def truth(text):
        found = load(tmp_path, text).truth
        return found.verdict, found.cause, found.f_s, found.f_d

    sticking = LEAST + "valve: {law: karnopp, f_s: 3, f_d: 1}\n"
    swinging = "disturbance: {amplitude: 2, period: 60}\n"
    assert truth(sticking + swinging) == ("stiction", "stiction", 3, 1)
    assert truth(LEAST + swinging) == ("no_stiction", "external_disturbance", 0, 0)
    assert truth(LEAST.replace("kc: 0.4", "kc: 8")) == ("no_stiction", "tight_tuning", 0, 0)


def test_enough_scenarios_are_shipped():
    assert len(SHIPPED) >= 8


@pytest.mark.parametrize("path", SHIPPED, ids=lambda path: path.stem)
def test_shipped_scenario_does_what_it_says(path):
    scenario = load_scenario(path)
    assert scenario.stated is not None
    record = simulate(scenario)
    assert scenario.op_range[0] < record.op.min()
    assert record.op.max() < scenario.op_range[1]
    period, strength = period_and_strength(record.mv)
    if scenario.truth.cause == "no_oscillation":
        assert strength < 0.4
    else:
        assert strength > 0.6
        assert 30 <= period * scenario.ts <= 150
    behind = np.abs(record.op[:-1] - record.mv[1:]).max()
    if scenario.truth.verdict == "stiction":
        assert behind == pytest.approx(scenario.truth.f_s, rel=0.05)
    else:
        assert behind < 0.1


def test_names_of_shipped_loops_differ():
    names = [load_scenario(path).loop for path in SHIPPED]
    assert len(set(names)) == len(names)
