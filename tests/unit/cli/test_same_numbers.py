"""One diagnosis in text, JSON, pictures and report: each number is the same number everywhere."""

import re

import pytest
from matplotlib.text import Text

from agent.analysis.data_quality import data_quality
from agent.analysis.diagnose import diagnose
from agent.analysis.record.recording import LoopWindow
from agent.cli.common.pictures import figures_of
from agent.report.diagnosis_json import diagnosis_json
from agent.report.diagnosis_text import diagnosis_lines
from agent.report.fleet.page import fleet_html
from agent.report.fleet.rows import finding_of, valve_rows
from agent.report.fleet.table import fleet_csv, fleet_lines
from simulators.plant import simulate
from simulators.scenario import load_scenario
from tests.conftest import ROOT

pytestmark = pytest.mark.timeout(240)  # a cold cache of kernels takes a minute
LOOPS = ("fic101_stick_slip", "fic104_tight_tuning", "fic103_healthy")


def made(name):
    scenario = load_scenario(ROOT / "config" / "scenarios" / f"{name}.yaml")
    run = simulate(scenario)
    return LoopWindow(scenario.loop, 0.0, scenario.ts, run.op[:1200], run.pv[:1200])


@pytest.fixture(scope="module", params=LOOPS)
def printed(request):
    """What one run prints, draws and writes of one loop."""
    window = made(request.param)
    found = diagnose(window)
    pictures = {
        suffix: " | ".join(each.get_text() for each in figure.findobj(Text))
        for suffix, figure in figures_of(window, found)
    }
    rows = valve_rows([finding_of("a.csv", found, data_quality(window, found))], [0], ["a"])
    report = fleet_html(rows, "a") + fleet_csv(rows) + "".join(fleet_lines(rows))
    return found, diagnosis_json(found, "a.csv"), "\n".join(diagnosis_lines(found)), pictures, report


def numbers(pattern, *texts):
    """All that a pattern finds in texts, as a set."""
    return {match for text in texts for match in re.findall(pattern, text)}


def test_s_and_j_have_the_same_value_and_interval(printed):
    found, as_json, text, pictures, report = printed
    for name in ("s", "j"):
        value = as_json["stiction"][name]
        if value["value"] is None:
            continue
        shown = f"{value['value']:.4g}"
        everywhere = numbers(rf"\b{name.upper()} = ([\d.e+-]*\d)", text, *pictures.values())
        assert everywhere <= {shown}
        ends = {(f"{value['low']:.4g}", f"{value['high']:.4g}")} if value["low"] is not None else set()
        pattern = rf"\b{name.upper()} = {re.escape(shown)} \(([\d.]+) to ([\d.]+)\)"
        assert numbers(pattern, *pictures.values()) <= ends
        line = rf"^  {name.upper()} = .*?([\d.]+) to ([\d.]+)$"
        assert set(re.findall(line, text, re.MULTILINE)) <= ends
        if name == "s" and found.verdict == "stiction":
            assert f"{shown} ({ends and next(iter(ends))[0]} to {ends and next(iter(ends))[1]})" in report
            assert any(shown in each for each in pictures.values())


def test_the_fit_of_the_picture_is_one_of_the_text(printed):
    _, as_json, text, pictures, _ = printed
    drawn = numbers(r"\(fit ([\d.e+-]+) %\)", pictures[""])
    known = {f"{each:.3g}" for each in as_json["fit"].values() if each is not None}
    assert drawn <= known
    if drawn and "fits PV to" in text:
        assert all(f"{each} %" in text for each in drawn)


def test_probability_and_period_are_the_same(printed):
    found, as_json, text, pictures, report = printed
    period = as_json["oscillation"]["period_s"]
    if as_json["oscillation"]["detected"]:
        assert numbers(r"period of ([\d.e+]*\d) s", text) == {f"{period:.4g}"}
        assert f"period {period:.4g} s" in pictures[""]
    sticks = as_json["sticks"]["probability"]
    assert f"{sticks:.2f}" in report
    assert str(sticks) in report
    assert f"P(sticks) = {sticks:.2f}" in text
    assert found.sticks.probability == sticks
    assert found.probability == as_json["probability"]
