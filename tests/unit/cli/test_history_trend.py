"""``slipjump history --trend``: text, JSON and pictures from a history file."""

import json

import numpy as np
import pytest
from typer.testing import CliRunner

from agent.cli.commands import app
from agent.runtime.store.history_file import Entry, HistoryFile, history_path

DAY = 86400.0
START = 1.7e9


def entry(day, s, loop="FIC101", probability=0.97, **more):
    content = more | {
        "verdict": "stiction",
        "probability": probability,
        "cause": "stiction",
        "stiction": {
            name: {"value": s, "low": 0.8 * s, "high": 1.2 * s} for name in ("s", "j", "f_s", "f_d")
        },
    }
    return Entry(START + day * DAY, loop, "diagnosis", content)


@pytest.fixture
def state(tmp_path):
    """A state file beside a history in which one valve wears and is repaired, and another was seen once."""
    path = tmp_path / "plant.sqlite"
    file = HistoryFile(history_path(path))
    worn = [entry(day, s) for day, s in enumerate(np.linspace(2.0, 5.0, 20))]
    mended = [entry(day, s) for day, s in enumerate(np.linspace(0.5, 1.0, 20), 20)]
    file.write([*worn, *mended, entry(3, 4.0, loop="PIC7")], START + 50 * DAY)
    file.close()
    return path


def run(*words):
    return CliRunner().invoke(app, ["history", *map(str, words)])


def test_the_text_has_repair_slope_and_forecast(state):
    said = run("--state", state, "--trend", "--limit", 3)
    assert said.exit_code == 0, said.output
    assert said.output.startswith("FIC101: S = ")
    assert "repair on 2023-12-04: S from" in said.output
    assert "worse since 2023-12-04" in said.output
    assert "reaches 3 on" in said.output
    assert "PIC7" not in said.output


def test_json_has_every_key(state):
    (line,) = run("--state", state, "--trend", "--json").output.splitlines()
    found = json.loads(line)
    assert set(found) == {"loop", "levels", "slope", "jumps", "repaired", "worse_since", "limit"}
    assert found["slope"]["value"] > 0
    assert [each["repair"] for each in found["jumps"]] == [True]
    assert found["limit"] is None


def test_a_picture_of_each_loop(state, tmp_path):
    assert run("--state", state, "--trend", "--plot", tmp_path / "p", "--limit", 4).exit_code == 0
    assert [each.name for each in (tmp_path / "p").iterdir()] == ["FIC101-trend.png"]


def test_a_limit_needs_a_trend(state):
    said = run("--state", state, "--limit", 3)
    assert said.exit_code == 2
    assert "--trend" in said.output


def test_no_loop_with_a_trend_is_said(state):
    said = run("--state", state, "--trend", "--loop", "PIC7")
    assert said.exit_code == 0
    assert "no trend" in said.output


def test_quiet_windows_that_do_not_agree_with_the_former_s_show_a_repair(tmp_path):
    path = tmp_path / "plant.sqlite"
    file = HistoryFile(history_path(path))
    sticks = [entry(day, 4.0, as_before={"s": 4.0, "log_ratio": 30.0}) for day in range(10)]
    none = dict.fromkeys(("value", "low", "high"))
    quiet = [
        Entry(
            START + day * DAY,
            "FIC101",
            "diagnosis",
            {"probability": 0.5, "stiction": {"s": none}, "as_before": {"s": 4.0, "log_ratio": -30.0}},
        )
        for day in (10, 11)
    ]
    file.write([*sticks, *quiet], START + 50 * DAY)
    file.close()
    found = json.loads(run("--state", path, "--trend", "--json").output)
    assert found["repaired"] == START + 10 * DAY
    assert run("--state", path, "--trend", "--plot", tmp_path / "plots").exit_code == 0
    assert (tmp_path / "plots" / "FIC101-trend.png").stat().st_size > 10_000
