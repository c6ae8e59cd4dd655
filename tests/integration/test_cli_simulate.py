"""``slipjump simulate`` as a user calls it."""

from pathlib import Path

import pytest
import yaml

from agent.cli import main
from connectors.recording import read_recording
from simulators.hidden_faults import scenario_path
from simulators.plant import simulate
from simulators.scenario import load_scenario

SCENARIO = Path(__file__).parents[2] / "config" / "scenarios" / "fic101_stick_slip.yaml"


def run(capsys, *arguments):
    with pytest.raises(SystemExit) as ended:
        main([str(argument) for argument in arguments])
    return ended.value.code or 0, capsys.readouterr()


def test_recording_can_be_read_back_and_the_truth_lies_beside_it(tmp_path, capsys):
    code, said = run(capsys, "simulate", SCENARIO, "-o", tmp_path / "out.csv")
    assert code == 0
    assert said.out == ""
    assert "3000 samples" in said.err
    loop = read_recording(tmp_path / "out.csv")
    record = simulate(load_scenario(SCENARIO))
    assert loop.time == pytest.approx(record.time)
    for role in ("op", "pv", "sp", "mv"):
        assert getattr(loop, role) == pytest.approx(getattr(record, role), rel=1e-7)
    truth = yaml.safe_load((tmp_path / "out.truth.yaml").read_text())
    assert truth == {
        "loop": "FIC101",
        "verdict": "stiction",
        "cause": "stiction",
        "f_s": 6.0,
        "f_d": 0.6,
        "s": pytest.approx(6.6),
        "j": pytest.approx(5.4),
    }


def test_a_scenario_that_ships_is_known_by_its_name(tmp_path, capsys):
    code, said = run(capsys, "simulate", "workbench/nonesuch", "-o", tmp_path / "x.csv")
    assert (code, said.out) == (2, "")
    assert "workbench/nonesuch" in said.err
    assert scenario_path("fic101_stick_slip") == SCENARIO
    assert scenario_path("fic101_stick_slip.yaml") == SCENARIO
    assert scenario_path(str(SCENARIO)) == SCENARIO


def test_all_faults_of_a_scenario_are_reported(tmp_path, capsys):
    bad = tmp_path / "bad.yaml"
    bad.write_text(
        SCENARIO.read_text().replace("duration: 3000", "duration: 0").replace("seed: 101", "seed: x")
    )
    code, said = run(capsys, "simulate", bad, "-o", tmp_path / "out.csv")
    assert code == 2
    lines = said.err.splitlines()
    assert len(lines) == 2
    assert f"{bad}: duration: " in lines[0]
    assert f"{bad}: seed: " in lines[1]
    assert not (tmp_path / "out.csv").exists()


def test_output_that_cannot_be_written(tmp_path, capsys):
    code, said = run(capsys, "simulate", SCENARIO, "-o", tmp_path / "nowhere" / "out.csv")
    assert code == 2
    assert said.err.splitlines() == [
        f"slipjump: {tmp_path}/nowhere/out.csv: cannot be written: No such file or directory"
    ]
