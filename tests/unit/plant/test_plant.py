"""Loops that oscillate together: groups, roots and paths, on waves whose way is known."""

import json

import numpy as np
import pytest
from scipy.signal import lfilter

from agent.analysis.plant.drives import drives
from agent.analysis.plant.plant import plant_finding
from agent.analysis.record.recording import LoopWindow
from agent.cli import main
from agent.plots.plant import plant_figure
from agent.report.fleet.plant_words import plant_json, plant_lines
from simulators.plant import SimulatedPlant
from simulators.scenario import load_scenario
from tests.conftest import ROOT

N = 2000


def noise(seed, size=1.0):
    return size * lfilter([1.0], [1.0, -0.7], np.random.default_rng(seed).standard_normal(N))


def passed_on(signal, seed, delay=3, size=0.3):
    """What follows a signal behind a lag and a dead time, with noise of its own."""
    late = np.concatenate((np.zeros(delay), signal[:-delay]))
    through = lfilter([0.3], [1.0, -0.7], late)
    return through / np.std(through) * np.std(signal) + noise(seed, size)


def chain(seed, names, root):
    """Windows of loops that follow each other; the first is the root."""
    found, signal = [], root + noise(seed, 0.3)
    for k, name in enumerate(names):
        signal = signal if k == 0 else passed_on(signal, seed + k)
        found.append(LoopWindow(name, 0.0, 1.0, 50 - 2 * signal, 20 + signal))
    return found


def square(period):
    return np.sign(np.sin(2 * np.pi * np.arange(N) / period + 0.3))


def wave(period):
    return 1.4 * np.sin(2 * np.pi * np.arange(N) / period)


STICKING = chain(10, ("FIC3", "TIC1", "LIC2"), square(50.0))
LOADED = chain(20, ("PIC4", "FIC5"), wave(90.0))
QUIET = [LoopWindow(f"AIC{k}", 0.0, 1.0, noise(90 + k), noise(80 + k)) for k in range(3)]


@pytest.fixture(scope="module")
def finding():
    return plant_finding([*QUIET, *STICKING[::-1], *LOADED[::-1]])


def test_each_oscillation_is_a_group_and_a_quiet_loop_is_in_none(finding):
    members = {frozenset(each.loop for each in group.suspects) for group in finding.groups}
    assert members == {frozenset({"FIC3", "TIC1", "LIC2"}), frozenset({"PIC4", "FIC5"})}
    periods = sorted(group.period for group in finding.groups)
    assert periods == [pytest.approx(50, rel=0.02), pytest.approx(90, rel=0.02)]
    assert len(finding.compared) == 8


def test_the_root_is_first_and_the_path_leads_from_it(finding):
    by_root = {group.root: group for group in finding.groups}
    assert set(by_root) == {"FIC3", "PIC4"}
    assert by_root["FIC3"].path == (("FIC3", "TIC1"), ("TIC1", "LIC2"))
    for group in finding.groups:
        assert sum(each.probability for each in group.suspects) == pytest.approx(1.0)


def test_one_loop_may_have_two_oscillations():
    both = LoopWindow("LIC9", 0.0, 1.0, noise(1), STICKING[1].pv + LOADED[1].pv)
    found = plant_finding([*STICKING, *LOADED, both])
    assert [("LIC9" in {each.loop for each in group.suspects}) for group in found.groups] == [True, True]


def test_periods_that_agree_are_not_enough():
    """Two loops whose waves wander by themselves, with one mean period."""
    loops = []
    for seed in range(2):
        phase = 2 * np.pi * np.arange(N) / 50 + np.cumsum(np.random.default_rng(seed).normal(0, 0.15, N))
        loops.append(LoopWindow(f"FIC{seed}", 0.0, 1.0, np.cos(phase), np.sin(phase) + noise(seed, 0.05)))
    assert plant_finding(loops).groups == ()


def test_loops_of_other_clocks_and_spans_are_compared_where_they_overlap():
    first, second, third = STICKING
    slow = LoopWindow("TIC1", 0.0, 2.0, second.op[::2], second.pv[::2])
    late = LoopWindow("LIC2", 400.0, 1.0, third.op[400:], third.pv[400:])
    elsewhere = LoopWindow("FIC8", 1e6, 1.0, first.op, first.pv)
    found = plant_finding([first, slow, late, elsewhere])
    assert set(found.compared) == {"FIC3", "TIC1", "LIC2"}
    assert found.seconds == pytest.approx(1600, abs=5)
    (group,) = found.groups
    assert {each.loop for each in group.suspects} == {"FIC3", "TIC1", "LIC2"}


def test_units_and_the_order_of_loops_change_nothing(finding):
    other = [
        LoopWindow(each.loop, each.start, each.ts, 0.01 * each.op, 1e4 - 250 * each.pv)
        for each in reversed([*QUIET, *STICKING, *LOADED])
    ]
    again = plant_finding(other)
    assert {group.root for group in again.groups} == {group.root for group in finding.groups}
    assert {frozenset(each.loop for each in group.suspects) for group in again.groups} == {
        frozenset(each.loop for each in group.suspects) for group in finding.groups
    }


def test_what_is_no_plant_has_no_groups():
    assert plant_finding([]).groups == ()
    assert plant_finding(STICKING[:1]).groups == ()
    gaps = LoopWindow("FIC1", 0.0, 1.0, np.full(N, np.nan), np.full(N, np.nan))
    still = LoopWindow("FIC2", 0.0, 1.0, np.full(N, 42.0), np.full(N, 7.0))
    assert plant_finding([gaps, still, STICKING[0]]).groups == ()


def test_who_drives_whom():
    first = noise(5)
    second = passed_on(first, 6)
    ahead, behind = drives([first, second], 50.0)
    assert ahead > 1 > -1 > behind
    assert np.abs(drives([noise(1), noise(2)], 50.0)).max() < 1


def test_words_and_json_have_the_same_and_a_picture_is_drawn(finding):
    told = json.loads(json.dumps(plant_json(finding), allow_nan=False))
    text = "\n".join(plant_lines(finding))
    for group in told["groups"]:
        assert f"likeliest root: {group['root']}, probability {group['loops'][0]['probability']:.2f}" in text
        assert all(reason in text for reason in group["reasons"])
    assert "no two of 1 loops" in next(plant_lines(plant_finding([QUIET[0]])))
    windows = [*QUIET, *STICKING, *LOADED]
    assert len(plant_figure(finding, windows).axes) == 2


def test_the_command_says_it_of_a_folder(tmp_path, capsys):
    for each in STICKING[:2]:
        rows = [f"{t},{u:.4f},{y:.4f}" for t, (u, y) in enumerate(zip(each.op, each.pv, strict=True))]
        (tmp_path / f"{each.loop}.csv").write_text("\n".join(["time,OP,PV", *rows, ""]))
    with pytest.raises(SystemExit) as left:
        main(["diagnose", "--plant", str(tmp_path), "--quantifier", "stenman2003", "--json"])
    lines = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert left.value.code == 0
    assert [each.get("loop") for each in lines] == ["FIC3", "TIC1", None]
    (group,) = lines[-1]["plant"]["groups"]
    assert (group["root"], group["path"]) == ("FIC3", [["FIC3", "TIC1"]])


def test_a_load_of_another_loop_moves_pv():
    scenario = load_scenario(ROOT / "config" / "scenarios" / "fic103_healthy.yaml")
    alone, loaded = (SimulatedPlant(scenario) for _ in range(2))
    rows = [(alone.advance().values["pv"], loaded.advance(5.0).values["pv"]) for _ in range(60)]
    assert rows[0][0] == rows[0][1]
    assert max(abs(a - b) for a, b in rows) > 0.5
