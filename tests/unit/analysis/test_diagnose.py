"""From evidence to verdict, cause, class and words; and no window that breaks it."""

import json
import math
import pickle
from dataclasses import dataclass, replace

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from agent.analysis.cause import coherent_share, line_power, swing_explained
from agent.analysis.diagnose import diagnose
from agent.analysis.quantify import QUANTIFIERS
from agent.analysis.record.recording import LoopHints, LoopWindow
from agent.analysis.results import CauseShare, Estimate, ProcessEstimate, Quantification, StictionEstimate
from agent.analysis.stiction import DETECTORS
from agent.analysis.stiction_class import stiction_class
from agent.report.advice import advice
from agent.report.diagnosis_json import diagnosis_json
from agent.report.reasons import reasons
from agent.units import FrictionBands
from connectors.recording import read_recording

N = 600
T = np.arange(N)
WAVE = np.sin(2 * np.pi * T / 60)
NOISE = np.random.default_rng(0).normal(size=N)
WINDOW = LoopWindow("FIC101", 0.0, 1.0, op=50 + 5 * WAVE + 0.1 * NOISE, pv=20 + 2 * WAVE + 0.1 * NOISE)
LOST_PHASE = np.sin(2 * np.pi * T / 60 + 1.5 * np.sin(2 * np.pi * T / 400))
SHAKEN = LoopWindow("FIC101", 0.0, 1.0, op=50 + 5 * LOST_PHASE, pv=20 + 2 * LOST_PHASE + 0.1 * NOISE)
"""As a loop close to instability swings: regular, but its phase wanders."""
CALM = LoopWindow("FIC101", 0.0, 1.0, op=50 + NOISE, pv=20 + np.roll(NOISE, 100))

STICKING = Quantification(
    quantifier="told",
    stiction=StictionEstimate.of(FrictionBands(2.0, 1.0)),
    process=ProcessEstimate("fopdt", 1.0, 5.0, 2.0),
    free_run_percent=90.0,
    linear_percent=60.0,
    evidence=16.0,
    decision="stiction",
    model_pv=WINDOW.pv,
    model_mv=WINDOW.op,
    quick_evidence=16.0,
    turns=20,
    log_likelihood_ratio=300.0,
)
HEALTHY = replace(
    STICKING,
    stiction=None,
    free_run_percent=95.0,
    linear_percent=95.0,
    evidence=1.0,
    decision="no_stiction",
    quick_evidence=1.0,
    turns=0,
    log_likelihood_ratio=0.0,
)


@dataclass(frozen=True)
class Told:
    """A quantifier that answers what the test wants."""

    answer: Quantification
    name: str = "told"

    def quantify(self, _window):
        return self.answer


def judged(window, answer):
    return diagnose(window, quantifier=Told(answer))


def test_sticking_valve():
    found = judged(WINDOW, STICKING)
    assert (found.verdict, found.cause) == ("stiction", "stiction")
    assert found.stiction_class == "dead_band_stick_slip"
    assert found.causes == (CauseShare("stiction", 1.0),)
    assert found.confidence == pytest.approx(0.99)
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


def test_other_quantifier_has_the_word_alone():
    found = judged(WINDOW, replace(STICKING, quick_evidence=None))
    assert (found.verdict, found.confidence) == ("stiction", 0.5)
    assert judged(WINDOW, replace(HEALTHY, quick_evidence=None)).verdict == "no_stiction"


def test_gaps_and_duplicates_are_told():
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


KEYS = {
    "recording": None,
    "loop": None,
    "verdict": None,
    "confidence": None,
    "probability": None,
    "samples_per_period": None,
    "manual_percent": None,
    "cause": None,
    "causes": None,
    "class": None,
    "reasons": None,
    "advice": None,
    "oscillation": {"detected", "period_s", "regularity"},
    "stiction": {"f_s", "f_d", "s", "j", "identifiable"},
    "process": {"kind", "gain", "tau_s", "delay_s", "intervals"},
    "fit": {"free_run_percent", "linear_percent"},
    "methods": None,
    "seconds": None,
}


def assert_object(written):
    assert list(written) == list(KEYS)
    for key, members in KEYS.items():
        if members is not None:
            assert set(written[key]) == members
    for name in ("f_s", "f_d", "s", "j"):
        assert set(written["stiction"][name]) == {"value", "low", "high"}
    assert set(written["stiction"]["identifiable"]) == {"s", "j"}
    json.dumps(written, allow_nan=False)


@pytest.mark.parametrize(
    "answer", [STICKING, HEALTHY, replace(HEALTHY, failure="no", process=None, evidence=math.nan)]
)
def test_json_has_all_keys_and_no_nan(answer):
    assert_object(diagnosis_json(judged(WINDOW, answer), "FIC101.csv"))
    assert_object(diagnosis_json(judged(replace(WINDOW, op=np.full(N, 1.0)), answer), "FIC101.csv"))


def test_json_numbers():
    low = replace(STICKING.stiction, s=Estimate(3.0, 2.5, math.inf), identifiable_s=True)
    written = diagnosis_json(judged(WINDOW, replace(STICKING, stiction=low)), "FIC101.csv")
    assert written["stiction"]["s"] == {"value": 3.0, "low": 2.5, "high": None}
    assert written["stiction"]["identifiable"] == {"s": True, "j": None}
    assert written["process"] == {
        "kind": "fopdt",
        "gain": 1.0,
        "tau_s": 5.0,
        "delay_s": 2.0,
        "intervals": None,
    }
    assert written["methods"]["told"] == {"verdict": "stiction", "index": 16.0, "reason": ""}
    assert set(written["methods"]) == {"told", *(each.name for each in DETECTORS)}
    assert written["class"] == "dead_band_stick_slip"


def test_diagnosis_travels_between_processes():
    found = pickle.loads(pickle.dumps(judged(WINDOW, STICKING)))  # noqa: S301 - our own bytes
    assert found.verdict == "stiction"


def _signal(kind, scale, offset, seed):
    rng = np.random.default_rng(seed)
    shape = {
        "wave": np.sin(2 * np.pi * np.arange(160) / 20),
        "steps": np.sign(np.sin(2 * np.pi * np.arange(160) / 32)),
        "noise": rng.normal(size=160),
        "ramp": np.arange(160.0),
        "flat": np.zeros(160),
        "one_spike": np.where(np.arange(160) == 80, 1.0, 0.0),
    }[kind]
    return offset + scale * (shape + 1e-3 * rng.normal(size=160) * (kind != "flat"))


SIGNALS = st.builds(
    _signal,
    st.sampled_from(["wave", "steps", "noise", "ramp", "flat", "one_spike"]),
    st.sampled_from([1.0, -5.0, 1e-12, 1e12, 1e-300, 1e300]),
    st.sampled_from([0.0, 50.0, -1e9]),
    st.integers(0, 5),
)
STORMS = st.lists(
    st.tuples(
        st.integers(0, 159), st.integers(1, 30), st.sampled_from([math.nan, math.inf, -1e308, 1e30, 0.0])
    ),
    max_size=3,
)


@settings(max_examples=25, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(SIGNALS, SIGNALS, STORMS, STORMS, st.sampled_from(QUANTIFIERS))
def test_no_window_breaks_it(op, pv, op_storms, pv_storms, method):
    for values, storms in ((op, op_storms), (pv, pv_storms)):
        for start, length, value in storms:
            values[start : start + length] = value
    window = LoopWindow("x", 0.0, 1.0, op=op, pv=pv, sp=pv, hints=LoopHints(delay=2, order=1))
    found = diagnose(window, quantifier=method)
    assert found.verdict in ("stiction", "no_stiction", "undecided", "not_testable")
    assert reasons(found)
    assert 0 <= found.confidence <= 1
    assert_object(diagnosis_json(found, "x.csv"))


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
