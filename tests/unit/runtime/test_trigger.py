import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from agent.analysis.record.recording import LoopWindow
from agent.analysis.record.reversals import significant_reversals
from agent.analysis.results import MethodResult
from agent.runtime.loop.trigger import trigger

T = np.arange(1000)
NOISE = np.random.default_rng(7).normal(size=T.size)


def window(op, pv=None):
    pv = 50 + 0.1 * NOISE[::-1] if pv is None else pv
    return LoopWindow("FIC101", 0.0, 1.0, op=op, pv=pv, sp=np.full(T.size, 50.0))


def test_it_fires_where_the_loop_oscillates():
    wave = np.sin(2 * np.pi * T / 60)
    seen = trigger(window(50 + 5 * wave + 0.2 * NOISE, 50 + 3 * np.roll(wave, 15) + 0.2 * NOISE[::-1]))
    assert seen.fires
    assert seen.oscillation.detected
    assert seen.oscillation.period == pytest.approx(60, rel=0.05)


def test_it_fires_where_op_travels_to_and_fro_without_a_rhythm():
    turns = np.cumsum(np.random.default_rng(3).integers(20, 150, size=30))
    op = np.interp(T, turns, np.resize([40.0, 60.0], turns.size)) + 0.1 * NOISE
    assert trigger(window(op)).fires


def test_it_does_not_fire_at_rest():
    seen = trigger(window(50 + T / 1000 + 0.002 * NOISE))
    assert not seen.fires
    assert all(each.verdict != "stiction" and each.seen is None for each in seen.methods.values())


def test_it_fires_where_a_detector_says_stiction(monkeypatch):
    resting = window(50 + T / 1000 + 0.002 * NOISE)
    accused = {"damarla": MethodResult("stiction", 0.4)}
    monkeypatch.setattr("agent.runtime.loop.trigger.detect_stiction", lambda *_: accused)
    assert trigger(resting).fires


def test_it_fires_where_nothing_can_be_said_so_that_the_diagnosis_says_why():
    assert trigger(window(np.full(T.size, 50.0))).fires


@pytest.mark.parametrize("swings", [0, 1, 3, 8, 20])
def test_reversals_are_counted_through_noise_and_gaps(swings):
    turns = np.linspace(0, T.size - 1, swings + 2)
    op = np.interp(T, turns, np.resize([40.0, 60.0], turns.size)) + 0.3 * NOISE
    op[::13] = np.nan
    assert significant_reversals(op) == swings


@pytest.mark.parametrize("op", [[], [1.0], [np.nan] * 50, [3.0] * 50])
def test_there_are_no_reversals_where_there_is_no_movement(op):
    assert significant_reversals(np.array(op, dtype=float)) == 0


@given(st.lists(st.integers(-100, 100), min_size=3, max_size=80))
def test_neither_unit_nor_direction_matters(op):
    op = np.array(op, dtype=float)
    count = significant_reversals(op)
    assert significant_reversals(-op) == count
    assert significant_reversals(op * 2.0) == count
