"""A long recording is weighed by its stretches together; stretches are short here, so that this is quick."""

import json

import numpy as np
import pytest

from agent.analysis import recording_stretches
from agent.analysis.data_quality import data_quality
from agent.analysis.diagnose import diagnose
from agent.analysis.quantify import quantifier
from agent.analysis.record.recording import LoopWindow
from agent.analysis.recording_diagnosis import diagnose_recording
from agent.report.diagnosis_json import diagnosis_json
from agent.report.reasons import reasons
from simulators.draws.random_plants import random_plant
from simulators.plant import simulate

SHORT = 700


@pytest.fixture
def short_stretches(monkeypatch):
    monkeypatch.setattr(recording_stretches, "LONGEST", SHORT)


def loop(kind, seed):
    scenario = random_plant(seed, kind)
    record = simulate(scenario)
    return LoopWindow("loop", 0.0, scenario.ts, record.op, record.pv), scenario.truth


def test_a_recording_no_longer_than_a_window_is_judged_as_before():
    window, _ = loop("none_noise", 98501)
    found, shown = diagnose_recording(window)
    assert shown is window
    assert found.stretches is None
    assert (found.verdict, found.weighed) == (diagnose(window).verdict, diagnose(window).weighed)
    assert diagnosis_json(found, "x.csv")["stretches"]["count"] == 1


@pytest.mark.usefixtures("short_stretches")
def test_a_valve_that_sticks_in_each_stretch():
    window, truth = loop("stiction", 98500)
    found, shown = diagnose_recording(window)
    assert found.verdict == "stiction"
    assert found.stretches is not None
    assert found.stretches.verdicts == ("stiction",) * 3
    s = found.quantification.stiction.s
    assert s.value == pytest.approx(truth.f_s + truth.f_d, rel=0.03)
    # All that a picture shows is of one stretch; samples and gaps are those of the recording.
    assert len(shown) == len(found.quantification.model_pv) < len(window)
    assert shown.op[0] == window.op[round(found.stretches.begin / window.ts)]
    assert found.record.samples == len(window)
    low, high = found.stretches.s
    assert low <= s.value <= high
    assert found.sticks.windows == 3
    assert found.probability == found.stretches.together


@pytest.mark.usefixtures("short_stretches")
def test_a_sound_valve_and_what_is_printed_of_it():
    window, _ = loop("sinusoid", 98500)
    pv = window.pv.copy()
    pv[100:150] = np.nan
    window = LoopWindow("loop", 0.0, window.ts, window.op, pv)
    found, _ = diagnose_recording(window)
    assert found.verdict != "stiction"
    words = reasons(found)
    assert "was judged by 3 stretches of 11.1 min" in words[0]
    assert found.record.gaps == 50
    assert data_quality(window, found).gaps_percent == pytest.approx(2.5)
    printed = json.loads(json.dumps(diagnosis_json(found, "x.csv"), allow_nan=False))["stretches"]
    assert printed["count"] == 3
    assert sum(printed["alone"].values()) == 3


@pytest.mark.usefixtures("short_stretches")
def test_one_stretch_that_cannot_be_tested_spoils_nothing():
    window, _ = loop("stiction", 98500)
    pv = window.pv.copy()
    pv[:650] = np.nan
    found, shown = diagnose_recording(LoopWindow("loop", 0.0, window.ts, window.op, pv))
    assert found.verdict == "stiction"
    assert found.stretches.verdicts[0] == "not_testable"
    assert found.stretches.begin > 0
    assert np.isfinite(shown.pv).all()


@pytest.mark.usefixtures("short_stretches")
def test_a_recording_without_any_pv_is_not_testable():
    window, _ = loop("stiction", 98500)
    found, _ = diagnose_recording(LoopWindow("loop", 0.0, window.ts, window.op, np.full(len(window), np.nan)))
    assert found.verdict == "not_testable"
    assert found.probability is None
    assert len(reasons(found)) > 1


@pytest.mark.usefixtures("short_stretches")
def test_another_quantifier_decides_by_the_most_frequent_verdict():
    window, _ = loop("stiction", 98500)
    found, _ = diagnose_recording(window, quantifier=quantifier("lee2008"))
    assert found.verdict == max({*found.stretches.verdicts}, key=found.stretches.verdicts.count)
    assert found.quantification.quantifier == "lee2008"
