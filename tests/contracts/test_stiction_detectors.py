"""What every member of stiction.DETECTORS promises, whatever it looks at."""

import math
import pickle
import time
from dataclasses import replace
from functools import cache
from typing import get_args

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from agent.analysis.oscillation import detect_oscillation
from agent.analysis.record.recording import LoopHints, LoopWindow
from agent.analysis.results import MethodKind, MethodVerdict, Oscillation
from agent.analysis.stiction import DETECTORS
from simulators.draws.random_plants import random_plant
from simulators.plant import simulate

EACH = pytest.mark.parametrize("member", DETECTORS, ids=lambda member: member.name)
LOOPS = pytest.mark.parametrize("kind", ["stiction", "sinusoid", "tuning"])
NO_VERDICT = ("not_applicable", "undecided")
NO_OSCILLATION = Oscillation(detected=False, period=None, regularity=None)


@cache
def simulated(kind):
    """A simulated loop with its set point and stem, and its oscillation."""
    record = simulate(random_plant(4, kind))
    window = LoopWindow(kind, 0.0, 1.0, record.op, record.pv, record.sp, record.mv)
    return window, detect_oscillation(window)


def swinging(period):
    return Oscillation(detected=True, period=period, regularity=3.0)


def sound(result):
    """Hold a result to the rules of MethodResult and hand it back."""
    assert result.verdict in get_args(MethodVerdict)
    assert result.reason
    assert result.index is None or (type(result.index) is float and math.isfinite(result.index))
    if result.verdict == "not_applicable":
        assert result.index is None
    if result.verdict in ("stiction", "no_stiction"):
        assert result.index is not None
        assert result.seen is not None
    return result


def same(one, other):
    """Whether two results say the same, up to the arithmetic's own noise in the index."""
    assert sound(other).verdict == sound(one).verdict
    assert (one.index is None) == (other.index is None)
    assert one.index is None or other.index == pytest.approx(one.index, rel=1e-3, abs=1e-6)


def changed(window, **signals):
    return replace(window, **{name: np.array(values) for name, values in signals.items()})


def test_their_names_differ():
    assert len({member.name for member in DETECTORS}) == len(DETECTORS)


@EACH
def test_it_says_what_it_looks_at_and_travels_to_other_processes(member):
    assert member.kind in get_args(MethodKind)
    assert pickle.loads(pickle.dumps(member)) == member  # noqa: S301 - our own bytes
    result = member.detect(*simulated("stiction"))
    assert pickle.loads(pickle.dumps(result)) == result  # noqa: S301 - our own bytes


@EACH
@LOOPS
def test_it_says_the_same_twice_and_leaves_its_input_alone(member, kind):
    window, oscillation = simulated(kind)
    before = [np.array(each) for each in (window.op, window.pv, window.sp, window.mv)]
    same(member.detect(window, oscillation), member.detect(window, oscillation))
    for values, kept in zip((window.op, window.pv, window.sp, window.mv), before, strict=True):
        np.testing.assert_array_equal(values, kept)


@EACH
@LOOPS
@pytest.mark.parametrize("with_mv", [True, False], ids=["mv", "no_mv"])
@pytest.mark.parametrize("factors", [(60.0, 0.07), (1e-9, 1e9), (1e9, 1e-9)], ids=str)
def test_units_and_offsets_change_nothing(member, kind, with_mv, factors):
    window, oscillation = simulated(kind)
    if not with_mv:
        window = replace(window, mv=None)
    of_op, of_pv = factors
    other = changed(
        window,
        op=of_op * (window.op - 500.0),
        pv=of_pv * (window.pv + 300.0),
        sp=of_pv * (window.sp + 300.0),
    )
    if with_mv:
        other = changed(other, mv=of_pv * (window.mv - 70.0))
    same(member.detect(window, oscillation), member.detect(other, oscillation))


@EACH
@LOOPS
@pytest.mark.parametrize("with_mv", [True, False], ids=["mv", "no_mv"])
def test_a_reversed_pv_changes_nothing(member, kind, with_mv):
    window, oscillation = simulated(kind)
    if not with_mv:
        window = replace(window, mv=None)
    other = changed(window, pv=-window.pv, sp=-window.sp)
    same(member.detect(window, oscillation), member.detect(other, oscillation))


@EACH
@LOOPS
def test_slower_time_changes_nothing(member, kind):
    window, oscillation = simulated(kind)
    slow = replace(window, ts=60.0, start=1e9)
    period = None if oscillation.period is None else 60.0 * oscillation.period
    same(member.detect(window, oscillation), member.detect(slow, replace(oscillation, period=period)))


@EACH
@LOOPS
def test_gaps_at_its_ends_are_as_if_not_recorded(member, kind):
    window, oscillation = simulated(kind)
    gaps = np.full(200, np.nan)
    signals = {name: getattr(window, name) for name in ("op", "pv", "sp", "mv")}
    longer = changed(window, **{name: np.r_[gaps, values, gaps] for name, values in signals.items()})
    same(member.detect(window, oscillation), member.detect(longer, oscillation))


@EACH
@LOOPS
def test_half_of_it_missing_is_as_if_not_recorded(member, kind):
    window, oscillation = simulated(kind)
    half = len(window) // 2
    rest = changed(window, op=np.where(np.arange(len(window)) < half, window.op, np.nan))
    first = changed(window, **{name: getattr(window, name)[:half] for name in ("op", "pv", "sp", "mv")})
    same(member.detect(first, oscillation), member.detect(rest, oscillation))


@EACH
@LOOPS
def test_a_storm_of_gaps_is_no_verdict(member, kind):
    window, oscillation = simulated(kind)
    lost = np.random.default_rng(0).random((2, len(window))) < 0.4
    stormy = changed(window, op=np.where(lost[0], np.nan, window.op), pv=np.where(lost[1], np.nan, window.pv))
    assert sound(member.detect(stormy, oscillation)).verdict in NO_VERDICT


@EACH
def test_nothing_there_is_not_applicable(member):
    window, oscillation = simulated("stiction")
    nothing = np.full(len(window), np.nan)
    for name in ("op", "pv"):
        lost = sound(member.detect(changed(window, **{name: nothing}), oscillation))
        assert lost.verdict == "not_applicable"


@EACH
@pytest.mark.parametrize("level", [0.0, 50.0, 1e14, 1e-14])
@pytest.mark.parametrize("still", [("op", "mv"), ("pv", "sp", "mv"), ("op", "pv", "sp", "mv")], ids=str)
def test_what_stands_still_does_not_stick(member, still, level):
    window, oscillation = simulated("stiction")
    constant = np.full(len(window), level)
    result = sound(member.detect(changed(window, **dict.fromkeys(still, constant)), oscillation))
    assert result.verdict != "stiction"


@EACH
@pytest.mark.parametrize("samples", [0, 1, 2, 3, 5, 10, 20])
@pytest.mark.parametrize("period", [None, 0.5, 4.0, 1e6])
def test_a_few_samples_are_no_verdict(member, samples, period):
    window, _ = simulated("stiction")
    few = changed(window, **{name: getattr(window, name)[:samples] for name in ("op", "pv", "sp", "mv")})
    oscillation = NO_OSCILLATION if period is None else swinging(period)
    assert sound(member.detect(few, oscillation)).verdict in NO_VERDICT


@EACH
@LOOPS
def test_a_shape_needs_an_oscillation(member, kind):
    window, _ = simulated(kind)
    result = sound(member.detect(window, NO_OSCILLATION))
    if member.kind == "limit_cycle":
        assert result.verdict in NO_VERDICT


@EACH
@LOOPS
@pytest.mark.parametrize("integrating", [True, False, None])
def test_it_lives_with_any_hint(member, kind, integrating):
    window, oscillation = simulated(kind)
    sound(member.detect(window.with_hints(LoopHints(integrating=integrating)), oscillation))


@EACH
@settings(max_examples=30, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1),
    samples=st.integers(1, 400),
    walk=st.booleans(),
    gaps=st.sampled_from([0.0, 0.01, 0.5]),
    scale=st.sampled_from([1e-14, 1.0, 1e14]),
    steps=st.sampled_from([None, 0.5, 3.0]),
    period=st.sampled_from([0.5, 2.0, 7.3, 50.0, 300.0]),
)
def test_it_lives_with_anything(member, seed, samples, walk, gaps, scale, steps, period):
    rng = np.random.default_rng(seed)
    noise = rng.normal(size=(4, samples))
    signals = np.cumsum(noise, axis=1) if walk else noise
    if steps is not None:
        signals = steps * np.round(signals / steps)
    signals[rng.random((4, samples)) < gaps] = np.nan
    op, pv, sp, mv = scale * signals
    sound(member.detect(LoopWindow("any", 0.0, 1.0, op, pv, sp, mv), swinging(period)))


@EACH
@pytest.mark.parametrize("period", [10.0, 60.0, 3000.0])
def test_twenty_thousand_samples_in_bounded_time(member, period):
    rng = np.random.default_rng(1)
    phase = 2 * np.pi * np.arange(20_000) / period
    op, pv = np.sin(phase) + 0.1 * rng.normal(size=(2, 20_000))
    window = LoopWindow("long", 0.0, 1.0, op, pv)
    started = time.process_time()
    sound(member.detect(window, swinging(period)))
    assert time.process_time() - started < 3.0
