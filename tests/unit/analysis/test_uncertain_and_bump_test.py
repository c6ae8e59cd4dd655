"""Answers that are uncertain, bump tests that can be carried out, a stem that others say sticks."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from agent.analysis.diagnose import as_decided
from agent.analysis.record.least_step import least_step
from agent.analysis.record.recording import LoopHints, LoopWindow
from agent.analysis.results import (
    IntervalEstimate,
    ProcessEstimate,
    Quantification,
    SimulatedModel,
    StictionEstimate,
)
from agent.report.advice import bump_test
from agent.report.diagnosis_text import estimate_line
from agent.units import FrictionBands

ONES = np.ones(3)
PROCESS = ProcessEstimate("fopdt", 1.0, 5.0, 1.0)
FOUND = Quantification(
    quantifier="free_run",
    stiction=StictionEstimate.of(FrictionBands(2.0, 1.0)),
    process=PROCESS,
    free_run_percent=80.0,
    linear_percent=70.0,
    evidence=1.1,
    decision="no_stiction",
    model_pv=ONES,
    model_mv=ONES,
    sticking=SimulatedModel(replace(PROCESS, gain=2.0), 2 * ONES, 3 * ONES),
)


@pytest.mark.parametrize(
    ("estimate", "identifiable", "words"),
    [
        (IntervalEstimate(1.655, 1.493, 1.764), False, "S = 1.655 OP units, uncertain: 1.493 to 1.764"),
        (IntervalEstimate(1.655, 1.493, 1.764), True, "S = 1.655 OP units, 90 % interval 1.493 to 1.764"),
        (
            IntervalEstimate(1.0, 0.2, 2.0),
            False,
            "S = 1 OP units, but not identifiable: the record allows 0.2 to 2",
        ),
        (
            IntervalEstimate(1.0),
            False,
            "S = 1 OP units, but not identifiable: the record does not determine it",
        ),
    ],
)
def test_an_interval_that_is_narrow_enough_is_an_answer(estimate, identifiable, words):
    assert estimate_line("S", estimate, identifiable=identifiable) == words


def stiction(low, value, high):
    whole = StictionEstimate.of(FrictionBands(value, 0.0))
    return replace(whole, s=IntervalEstimate(value, low, high))


def test_a_bump_test_that_cannot_be_carried_out_is_not_proposed():
    assert "then back by 1.5 (a sticking valve" in bump_test(stiction(3.0, 3.5, 4.0), 0.1)
    assert "then back by 0.3: " in bump_test(stiction(0.1, 0.15, 0.2), 0.1)
    words = bump_test(stiction(0.008, 0.016, 0.02), 0.1)
    assert words.startswith("no bump test: S is at most 0.02 OP units, steps below 0.1 are not resolved")


def test_the_least_step_is_the_resolution_of_the_range_or_the_noise():
    rng = np.random.default_rng(5)
    wave = 50 + 5 * np.sin(np.arange(2000) / 20)
    window = LoopWindow("L", 0.0, 1.0, wave, wave)
    assert least_step(window) == pytest.approx(0.1, rel=0.01)
    assert least_step(window.with_hints(LoopHints(op_range=(0.0, 1000.0)))) == pytest.approx(1.0, rel=0.01)
    noisy = LoopWindow("L", 0.0, 1.0, wave + rng.normal(0, 0.5, 2000), wave)
    assert least_step(noisy) == pytest.approx(0.5, rel=0.1)
    assert least_step(LoopWindow("L", 0.0, 1.0, 2 * (wave - 50), wave)) < 0.02
    assert least_step(LoopWindow("L", 0.0, 1.0, np.full(5, np.nan), np.zeros(5))) == 0.0


def test_a_valve_that_others_say_sticks_is_drawn_and_an_s_that_cannot_be_seen_is_left_out():
    decided = as_decided(FOUND, op_span=10.0)
    assert decided.sticking is None
    assert decided.process == replace(PROCESS, gain=2.0)
    assert decided.model_pv is FOUND.sticking.pv
    assert decided.model_mv is FOUND.sticking.mv
    assert decided.stiction == FOUND.stiction
    assert as_decided(FOUND, op_span=1000.0).stiction is None
