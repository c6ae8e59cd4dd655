"""One look at a window, and when a fit is due."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from agent.analysis import seen as seen_module
from agent.analysis.diagnose import diagnose
from agent.analysis.record.recording import LoopWindow
from agent.analysis.record.reversals import moves_beyond_noise, significant_reversals
from agent.analysis.results import Quantification
from agent.analysis.routine import first_look, routine_diagnosis
from agent.analysis.seen import look, worth_a_fit
from agent.report.advice import advice
from agent.report.reasons import reasons

T = np.arange(1000)
NOISE = np.random.default_rng(7).normal(size=T.size)


RESTING = 50 + T / 1000 + 0.1 * NOISE


def window(op, pv=None):
    pv = 50 + 0.1 * NOISE[::-1] if pv is None else pv
    return LoopWindow("FIC101", 0.0, 1.0, op=op, pv=pv, sp=np.full(T.size, 50.0))


def test_an_oscillation_is_worth_a_fit():
    wave = np.sin(2 * np.pi * T / 60)
    seen = look(window(50 + 5 * wave + 0.2 * NOISE, 50 + 3 * np.roll(wave, 15) + 0.2 * NOISE[::-1]))
    assert worth_a_fit(seen)
    assert seen.oscillation.detected
    assert seen.oscillation.period == pytest.approx(60, rel=0.05)


@pytest.mark.parametrize("swings", [0, 1, 3, 8])
def test_moves_without_a_rhythm_are_worth_a_fit(swings):
    """A ramp of an hour as well: a valve that sticks stands under it, and slips."""
    turns = np.linspace(0, T.size - 1, swings + 2)
    op = np.interp(T, turns, np.resize([40.0, 60.0], turns.size)) + 0.3 * NOISE
    seen = look(window(op))
    assert seen.op_moves
    assert worth_a_fit(seen)


def test_rest_is_not():
    found = routine_diagnosis(window(RESTING), diagnose)
    assert (found.fitted, found.diagnosis.verdict, found.diagnosis.cause) == (
        False,
        "no_stiction",
        "no_oscillation",
    )
    methods = found.diagnosis.methods.values()
    assert methods
    assert all(each.verdict != "stiction" and each.seen is None for each in methods)
    assert len(reasons(found.diagnosis)) == 1
    assert advice(found.diagnosis) == ()


def test_what_is_not_testable_is_diagnosed_so_that_the_diagnosis_states_why():
    still = window(np.full(T.size, 50.0))
    seen = look(still)
    assert not seen.testable
    assert seen.methods == {}
    whole, at_once = diagnose(still, seen), first_look(still)
    assert whole.verdict == "not_testable"
    assert not at_once.fitted, "it waits for no fit"
    assert replace(at_once.diagnosis, seconds=0.0) == replace(whole, seconds=0.0)


@dataclass
class Counted:
    """Calls of a function that each take a window first."""

    function: Callable
    calls: int = 0

    def __call__(self, *args):
        self.calls += 1
        return self.function(*args)


class NoFit:
    """A quantifier that has no result, so that only the rest of a diagnosis is made."""

    name = "none"

    def quantify(self, _window):
        return Quantification(self.name, None, None, None, None, None, "undecided", failure="not fitted here")


def test_a_window_is_looked_at_once(monkeypatch):
    """Also where a fit follows the look; and the diagnosis is the same as from the window alone."""
    wave = np.sin(2 * np.pi * T / 60)
    moved = window(50 + 5 * wave + 0.2 * NOISE, 50 + 3 * np.roll(wave, 15) + 0.2 * NOISE[::-1])
    alone = diagnose(moved, quantifier=NoFit())
    looks = ("detect_oscillation", "gates", "detect_stiction")
    counted = {name: Counted(getattr(seen_module, name)) for name in looks}
    for name, each in counted.items():
        monkeypatch.setattr(seen_module, name, each)
    found = routine_diagnosis(moved, lambda given, seen=None: diagnose(given, seen, quantifier=NoFit()))
    assert found.fitted
    assert {name: each.calls for name, each in counted.items()} == dict.fromkeys(counted, 1)
    assert replace(found.diagnosis, seconds=0.0) == replace(alone, seconds=0.0)


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


def loop_in_noise(seed, gain):
    """OP and PV of a sound loop whose controller answers noise of the measurement."""
    noise = np.random.default_rng(seed).normal(0.0, 0.5, T.size)
    process = integral = waiting = 50.0
    op, pv = np.empty(T.size), np.empty(T.size)
    for k in range(T.size):
        pv[k] = process + noise[k]
        integral += gain * (50.0 - pv[k]) / 20.0
        op[k] = integral + gain * (50.0 - pv[k])
        process += (waiting - process) / 10.0
        waiting = op[k]
    return op, pv


@pytest.mark.parametrize("seed", range(3))
def test_noise_alone_is_not_worth_a_fit(seed):
    seen = look(window(*loop_in_noise(seed, gain=0.8)))
    assert seen.testable
    assert not seen.op_moves
    assert not worth_a_fit(seen)


@given(st.lists(st.integers(-100, 100), max_size=80), st.sampled_from([-3.0, 0.5, 20.0]))
def test_neither_unit_nor_direction_matters_for_movement(op, factor):
    op = np.array(op, dtype=float)
    assert moves_beyond_noise(factor * op) == moves_beyond_noise(op)
