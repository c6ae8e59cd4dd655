"""From evidence to verdict, cause, class and words; and no window that breaks it."""

import math
from dataclasses import replace

import numpy as np
import pytest

from agent.analysis.cause import coherent_share, line_power, swing_explained
from agent.analysis.diagnose import diagnose
from agent.analysis.record.recording import LoopHints, LoopWindow
from agent.analysis.results import CauseShare, StictionEstimate
from agent.analysis.stiction_class import stiction_class
from agent.report.advice import advice
from agent.report.reasons import reasons
from agent.units import FrictionBands
from connectors.recording import read_recording
from tests.unit.analysis.diagnoses import CALM, HEALTHY, SHAKEN, STICKING, WINDOW, N, T, judged


def test_sticking_valve():
    found = judged(WINDOW, STICKING)
    assert (found.verdict, found.cause) == ("stiction", "stiction")
    assert found.stiction_class == "dead_band_stick_slip"
    assert found.causes == (CauseShare("stiction", 1.0),)
    assert found.confidence == pytest.approx(0.99, abs=0.001)
    assert "bump test" in advice(found)[0]
    assert found.oscillation.detected
    assert found.methods["told"].index == 16.0
    assert found.seconds > 0
    assert any("period of 60" in reason for reason in reasons(found))
    assert any("S = 3" in reason and "J = 1" in reason for reason in reasons(found))


def test_swing_that_keeps_its_phase_comes_from_outside():
    found = judged(WINDOW, HEALTHY)
    assert (found.verdict, found.cause, found.stiction_class) == ("no_stiction", "external_disturbance", None)


def test_swing_that_op_explains_is_tight_tuning():
    found = judged(SHAKEN, replace(HEALTHY, model_pv=SHAKEN.pv))
    assert (found.verdict, found.cause, found.stiction_class) == ("no_stiction", "tight_tuning", None)


def test_swing_that_op_does_not_explain_comes_from_outside():
    found = judged(SHAKEN, replace(HEALTHY, model_pv=np.full(N, 20.0), linear_percent=5.0))
    assert (found.verdict, found.cause) == ("no_stiction", "external_disturbance")


def test_swing_that_op_explains_in_part_is_undecided():
    found = judged(SHAKEN, replace(HEALTHY, model_pv=20 + (1 - math.sqrt(0.35)) * (SHAKEN.pv - 20)))
    assert found.cause == "undecided"


def test_calm_loop():
    found = judged(CALM, HEALTHY)
    assert (found.verdict, found.cause) == ("no_stiction", "no_oscillation")


def test_stiction_that_a_moving_set_point_shows_needs_no_oscillation():
    assert judged(CALM, STICKING).cause == "stiction"


@pytest.mark.parametrize(
    "answer",
    [
        replace(STICKING, failure="the search did not converge"),
        replace(STICKING, stiction=None),
        replace(STICKING, decision="undecided", turns=0),
        replace(STICKING, decision="not_applicable"),
        replace(STICKING, free_run_percent=3.0),  # it follows PV to a few per cent only
    ],
)
def test_without_sound_evidence_nothing_is_claimed(answer):
    found = judged(WINDOW, answer)
    assert (found.verdict, found.confidence, found.stiction_class, found.cause) == (
        "undecided",
        0.0,
        None,
        "undecided",
    )


def test_an_s_that_no_positioner_resolves_is_no_fault():
    """0.1 % of a range of 100 is 0.1; a stated range of 20 makes the same S one that counts."""
    small = replace(STICKING, stiction=StictionEstimate.of(FrictionBands(0.03, 0.02)))
    found = judged(WINDOW, small)
    assert (found.verdict, found.confidence) == ("undecided", 0.0)
    assert any("no fault" in reason for reason in reasons(found))
    stated = judged(WINDOW.with_hints(LoopHints(op_range=(40.0, 60.0))), small)
    assert stated.verdict == "stiction"
    unknown = replace(WINDOW, op=WINDOW.op + 100)
    assert judged(unknown, small).verdict == "stiction"


def test_constant_op_is_not_testable():
    found = judged(replace(WINDOW, op=np.full(N, 40.0)), STICKING)
    assert (found.verdict, found.cause, found.confidence) == ("not_testable", "undecided", 0.0)
    assert found.quantification is None
    assert reasons(found) == ("OP does not move: it is constant at 40",)
    assert advice(found)[0].startswith("record the loop again")


def test_disturbance_beside_stiction():
    beside = 1.5 * np.sin(2 * np.pi * T / 43)
    found = judged(replace(WINDOW, pv=WINDOW.pv + beside), STICKING)
    assert [each.cause for each in found.causes] == ["stiction", "external_disturbance"]
    assert found.causes[1].share == pytest.approx(np.var(beside) / np.var(WINDOW.pv + beside), rel=0.05)
    assert any("43 s" in step or "upstream" in step for step in advice(found))


def test_what_the_loop_does_is_said_where_the_valve_is_undecided():
    found = judged(CALM, replace(STICKING, decision="undecided", turns=0, log_likelihood_ratio=20.0))
    assert (found.verdict, found.cause) == ("undecided", "no_oscillation")


def test_gate_that_closes_some_methods_is_reported():
    found = judged(CALM, STICKING)
    assert any("the loop does not oscillate" in reason for reason in reasons(found))
    assert found.methods["he_curve_fit"].verdict == "not_applicable"


def test_a_valve_is_called_sound_with_less_confidence_where_nothing_would_show():
    said = [judged(WINDOW, replace(HEALTHY, would_show=shown)) for shown in (0.0, 1.0)]
    assert {each.verdict for each in said} == {"no_stiction"}
    assert said[0].probability == said[1].probability  # the evidence as it was learnt
    assert said[0].confidence < said[1].confidence == pytest.approx(1 - said[1].probability)
    stem = replace(WINDOW, mv=WINDOW.op.copy())  # which shows what PV does not
    seen = [judged(stem, replace(HEALTHY, would_show=shown)).confidence for shown in (0.0, 1.0)]
    assert seen[0] == seen[1]


def test_other_quantifier_has_the_word_alone():
    found = judged(WINDOW, replace(STICKING, quick_evidence=None))
    assert (found.verdict, found.confidence) == ("stiction", 0.5)
    assert judged(WINDOW, replace(HEALTHY, quick_evidence=None)).verdict == "no_stiction"


def test_gaps_and_duplicates_are_reported():
    pv = WINDOW.pv.copy()
    pv[10:20] = np.nan
    pv[30] = 1e30
    words = reasons(judged(replace(WINDOW, pv=pv, duplicates=3), STICKING))
    assert words[0] == "11 of 600 samples are gaps and were skipped"
    assert words[1] == "3 samples repeat a timestamp and were discarded"


@pytest.mark.parametrize(
    ("s", "j", "name"),
    [
        (0.0, 0.0, "weak"),
        (0.49, 0.4, "weak"),
        (5.0, 0.99, "dead_band"),
        (5.0, 4.1, "stick_slip"),
        (5.0, 3.9, "dead_band_stick_slip"),
        (5.0, 1.0, "dead_band_stick_slip"),
    ],
)
def test_classes_of_fig_2(s, j, name):
    assert stiction_class(FrictionBands.from_s_j(s, j), op_span=10.0) == name


def test_line_power_of_a_wave_with_gaps_on_a_drift():
    wave = 3 * np.cos(2 * np.pi * T / 70 + 1) + 0.02 * T + 7
    wave[100:150] = np.nan
    assert line_power(wave, 70.0) == pytest.approx(4.5, rel=1e-6)
    assert swing_explained(replace(WINDOW, pv=wave), wave, 70.0) == pytest.approx(1)


def test_coherent_share_of_a_wave_a_wandering_wave_and_noise():
    assert coherent_share(WINDOW, 62.0) > 0.95  # also where the period is only roughly known
    assert coherent_share(SHAKEN, 60.0) < 0.65
    assert coherent_share(CALM, 60.0) < 0.1
    assert coherent_share(replace(WINDOW, pv=np.full(N, 3.0)), 60.0) == 0


@pytest.mark.parametrize(
    ("name", "verdict"),
    [
        pytest.param("CHEM10", "stiction", marks=pytest.mark.bench),  # sought for 10 s
        pytest.param("CHEM12", "stiction", marks=pytest.mark.bench),  # sought again: half a minute
        ("CHEM13", "no_stiction"),
        ("PAP2", "stiction"),
    ],
)
def test_industrial_loops(recordings, name, verdict):
    loop = read_recording(recordings / "isdb" / f"{name}.csv")
    window = LoopWindow(name, 0.0, loop.time[1] - loop.time[0], op=loop.op, pv=loop.pv)
    assert diagnose(window).verdict == verdict
