"""A diagnosis as JSON: all keys, no NaN, whatever the window."""

import json
import math
import pickle
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from agent.analysis.diagnose import diagnose
from agent.analysis.indices import INDICES, performance
from agent.analysis.quantify import QUANTIFIERS
from agent.analysis.record.recording import LoopHints, LoopWindow
from agent.analysis.results import IntervalEstimate
from agent.analysis.stiction import DETECTORS
from agent.report.diagnosis_json import diagnosis_json
from agent.report.reasons import reasons
from tests.unit.analysis.diagnoses import (
    HEALTHY,
    STICKING,
    WINDOW,
    N,
    judged,
)

KEYS = {
    "recording": None,
    "loop": None,
    "verdict": None,
    "confidence": None,
    "probability": None,
    "sticks": {"probability", "base_rate", "windows", "suspected"},
    "samples_per_period": None,
    "manual_percent": None,
    "cause": None,
    "causes": None,
    "class": None,
    "reasons": None,
    "advice": None,
    "oscillation": {"detected", "period_s", "regularity"},
    "no_response": {
        "found",
        "cause",
        "possible",
        "probability",
        "op_travel",
        "op_spans",
        "pv",
        "expected_pv",
        "deviations",
        "samples",
    },
    "as_before": {"s", "log_ratio"},
    "stretches": {"count", "alone", "begin_s", "seconds", "s_low", "s_high"},
    "stiction": {"f_s", "f_d", "s", "j", "identifiable"},
    "repair": {"as_is", "repaired", "retuned", "simc"},
    "process": {"kind", "gain", "tau_s", "delay_s", "intervals"},
    "fit": {"free_run_percent", "linear_percent", "search_spent", "slip_scatter", "would_show"},
    "methods": None,
    "indices": {each.name for each in INDICES},
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
    low = replace(STICKING.stiction, s=IntervalEstimate(3.0, 2.5, math.inf), identifiable_s=True)
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


def test_indices_are_those_of_the_window_with_the_delay_of_the_fit():
    found = judged(replace(WINDOW, sp=np.full(N, 20.0)), STICKING)
    assert diagnosis_json(found, "x")["indices"] == pytest.approx(
        performance(replace(WINDOW, sp=np.full(N, 20.0)), STICKING.process.delay), nan_ok=True
    )
    assert found.indices["reversals"] == pytest.approx(120.0, rel=0.1)  # two a period of 60 s
