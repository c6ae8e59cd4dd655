"""Each thing that makes a record untestable is named; a good record passes."""

from dataclasses import replace

import numpy as np
import pytest

from agent.analysis.gates import ALL_KINDS, closed_kinds, gates
from agent.analysis.oscillation import detect_oscillation
from agent.analysis.record.recording import LoopHints, LoopWindow
from agent.analysis.results import Oscillation
from connectors.recording import read_recording

N = 400
T = np.arange(N)
WAVE = np.sin(2 * np.pi * T / 50)


STEADY = Oscillation(detected=True, period=50.0, regularity=3.0)
SHAPE = {"limit_cycle", "travel"}


def found(op=50 + 10 * WAVE, pv=100 + WAVE, oscillation=STEADY, ts=1.0, **rest):
    return gates(LoopWindow("x", 0.0, ts, op=np.asarray(op), pv=np.asarray(pv), **rest), oscillation)


def faults(**case):
    return [fault.name for fault in found(**case)]


def noisy(seed):
    return WAVE + 0.05 * np.random.default_rng(seed).normal(size=N)


def by_exception(values, band):
    """What arrives from a bus that sends a value only when it has moved by more than ``band``."""
    sent = values.copy()
    for k in range(1, sent.size):
        if abs(values[k] - sent[k - 1]) <= band:
            sent[k] = sent[k - 1]
    return sent


def with_gaps(values, count):
    lost = values.copy()
    lost[:count] = np.nan
    return lost


def test_good_record():
    assert faults() == []
    assert faults(op=with_gaps(50 + WAVE, 100)) == []


@pytest.mark.parametrize(
    ("case", "expected"),
    [
        ({"op": [], "pv": []}, "few_samples"),
        ({"pv": np.full(N, np.nan)}, "few_samples"),
        ({"pv": np.where(T < 330, np.inf, WAVE)}, "few_samples"),
        ({"pv": with_gaps(WAVE, 250)}, "gaps"),
        ({"automatic": T % 3 == 0}, "manual"),
        ({"automatic": T < 0}, "manual"),
        ({"op": np.full(N, 55.5)}, "op_constant"),
        ({"op": np.zeros(N)}, "op_constant"),
        ({"op": 1e6 + 1e-7 * WAVE}, "op_constant"),
        ({"op": 50 + 0.05 * WAVE, "hints": LoopHints(op_range=(0.0, 100.0))}, "op_still"),
        ({"op": np.round(2 * WAVE)}, "op_quantised"),
        ({"op": np.maximum(WAVE, 0)}, "op_saturated"),
        ({"op": np.clip(50 + 90 * WAVE, 0, 100), "hints": LoopHints(op_range=(0.0, 100.0))}, "op_saturated"),
        ({"pv": np.full(N, -3.0)}, "pv_constant"),
        ({"pv": np.round(WAVE)}, "pv_quantised"),
    ],
)
def test_faults(case, expected):
    assert faults(**case) == [expected]


@pytest.mark.parametrize(
    ("case", "expected", "closes"),
    [
        ({"op": np.round(3 * WAVE)}, "op_quantised", SHAPE),
        ({"pv": np.round(3 * WAVE)}, "pv_quantised", SHAPE),
        ({"pv": np.round(WAVE)}, "pv_quantised", ALL_KINDS),
        ({"op": np.where(T < 10, 20.0, 50 + 0.01 * T)}, "op_few_reversals", SHAPE),
        ({"pv": np.where(T < 250, WAVE, 0.3)}, "pv_frozen", ALL_KINDS),
        ({"pv": np.repeat(noisy(2)[::4], 4)}, "pv_slow_scan", SHAPE),
        ({"op": np.repeat(noisy(3)[::10], 10)}, "op_slow_scan", SHAPE),
        ({"pv": by_exception(noisy(4), 0.15)}, "pv_by_exception", SHAPE),
        ({"op": by_exception(noisy(5), 0.3)}, "op_by_exception", ALL_KINDS),
        ({"pv": np.interp(T, T[::9], noisy(6)[::9])}, "pv_interpolated", SHAPE),
        ({"op": np.round(np.interp(T, T[::9], noisy(6)[::9]), 4)}, "op_interpolated", SHAPE),
        ({"sp": np.where(T < 200, 100.0, 101.0)}, "sp_moves", {"limit_cycle"}),
        (
            {"oscillation": Oscillation(detected=False, period=None, regularity=None)},
            "no_oscillation",
            {"limit_cycle"},
        ),
        (
            {"oscillation": Oscillation(detected=True, period=50.0, regularity=None)},
            "unsteady",
            {"limit_cycle"},
        ),
        ({"oscillation": replace(STEADY, period=90.0)}, "few_periods", {"limit_cycle"}),
        ({"ts": 6.0}, "coarse", ALL_KINDS),
    ],
)
def test_a_fault_closes_only_what_it_concerns(case, expected, closes):
    (fault,) = found(**case)
    assert fault.name == expected
    assert closed_kinds((fault,)) == fault.closes == closes


def test_fast_enough_a_scan_does_no_harm():
    held = np.repeat(noisy(7)[::2], 2)
    assert faults(pv=held) == []


@pytest.mark.parametrize("digits", [2, 4, 8])
def test_a_rounded_wave_is_not_drawn_as_lines(digits):
    assert faults(pv=np.round(100 + WAVE, digits), op=np.round(50 + 10 * WAVE, digits)) == []


def test_gaps_are_no_rest_and_no_line():
    assert faults(pv=np.where(T % 7 == 0, np.nan, noisy(8)), op=np.where(T % 5 == 0, np.nan, noisy(9))) == []


def controlled(shift):
    """A loop under a PI law, PV recorded ``shift`` samples after the controller saw it."""
    rng = np.random.default_rng(0)
    op, pv, op_now, flow = np.zeros(N), np.zeros(N), 50.0, 0.0
    for k in range(N):
        flow += 0.2 * (op_now - 50 - flow)
        pv[k] = flow + rng.normal()
        op_now += -0.5 * (pv[k] - (pv[k - 1] if k else 0.0)) - 0.1 * pv[k]
        op[k] = op_now
    return op, np.roll(pv, shift)


@pytest.mark.parametrize(("shift", "words"), [(2, "2 samples before"), (-1, "1 sample late")])
def test_clocks_that_differ_are_seen_through_the_controller(shift, words):
    op, pv = controlled(shift)
    (fault,) = [each for each in found(op, pv, replace(STEADY, period=15.0)) if each.name == "clock_skew"]
    assert words in fault.reason
    assert fault.closes == SHAPE
    assert "clock_skew" not in [each.name for each in found(op, pv, replace(STEADY, period=200.0))]
    assert "clock_skew" not in [each.name for each in found(*controlled(0), replace(STEADY, period=15.0))]


def test_nothing_closed_without_a_fault():
    assert closed_kinds(()) == frozenset()


@pytest.mark.parametrize("unit", [1e-6, 1.0, 1e6])
def test_units_do_not_matter(unit):
    assert faults(
        pv=unit * by_exception(noisy(4), 0.15), op=unit * np.round(np.interp(T, T[::9], noisy(6)[::9]), 4)
    ) == [
        "op_interpolated",
        "pv_by_exception",
    ]


def test_reasons_are_sentences_with_numbers():
    (fault,) = found(op=np.full(N, 55.5))
    assert fault.reason == "OP does not move: it is constant at 55.5"


def test_several_faults_are_all_reported():
    assert faults(op=np.full(N, 1.0), pv=np.full(N, 1.0)) == ["op_constant", "pv_constant"]


def test_a_record_never_in_automatic_says_so():
    (fault,) = found(automatic=T < 0)
    assert (
        fault.reason
        == "the loop was never in automatic; OP shows the valve only where the controller moves it"
    )
    (fault,) = found(automatic=T < N / 4)
    assert "in automatic for only 25 % of the record" in fault.reason


@pytest.mark.parametrize("name", ["CHEM1", "CHEM10", "CHEM11", "CHEM12", "CHEM13", "PAP2", "PAP4"])
def test_industrial_loops_pass(recordings, name):
    loop = read_recording(recordings / "isdb" / f"{name}.csv")
    window = LoopWindow(name, 0.0, 1.0, op=loop.op, pv=loop.pv)
    closed = closed_kinds(gates(window, detect_oscillation(window)))
    assert "model" not in closed
