"""A record of few periods once more, sample by sample: when, and what is believed."""

import math

import numpy as np
import pytest
from agent.analysis.quantify.free_run.few_periods import (
    CLEARLY_LESS,
    FEW,
    FINE,
    best_by_samples,
    searched_by_samples,
)
from agent.analysis.quantify.free_run.search import SURER, Found

from agent.analysis.quantify.free_run import few_periods
from agent.analysis.quantify.free_run.problem import pose
from agent.analysis.record.recording import LoopHints, LoopWindow
from agent.identify.fitted import Fitted, start
from agent.identify.objective import (
    DELAY,
    FIRST,
    FOPDT,
    J_RATIO,
    LEVEL,
    LOG_DAMPING,
    LOG_TAU,
    SIZE,
    S,
    process_response,
    valve_position,
)

PERIOD = 200
HINTS = LoopHints(integrating=False, acting="reverse", order=1)


def slow_loop(periods=8):
    """Return a window, its valve and process, and those with S and the level a tenth too large."""
    t = np.arange(periods * PERIOD)
    rng = np.random.default_rng(0)
    swing = 5 * np.sin(2 * np.pi * t / PERIOD) + 1.5 * np.sin(13 * t / PERIOD)
    op = 50 + swing + 0.02 * rng.standard_normal(t.size)
    candidate = np.zeros(SIZE)
    candidate[[LOG_TAU, DELAY, S, J_RATIO, LEVEL, FIRST]] = math.log(8.0), 9.0, 5.0, 0.6, 52.0, 1.0
    candidate[LOG_DAMPING : LOG_DAMPING + 3] = np.log((0.3, 0.15, 0.01))
    problem = pose(LoopWindow("FIC1", 0.0, 1.0, op, op + rng.standard_normal(t.size)), FINE)
    no_filter = 1.0
    pv = process_response(valve_position(candidate, problem), candidate, FOPDT, 1, no_filter)
    window = LoopWindow("FIC1", 0.0, 1.0, op, pv + 0.05 * rng.standard_normal(t.size), hints=HINTS)
    wrong = candidate.copy()
    wrong[[S, LEVEL]] *= 1.15, 1.01
    return window, candidate, wrong


def test_a_block_may_be_a_sample():
    window, _, _ = slow_loop()
    coarse, fine = pose(window), pose(window, FINE)
    assert (coarse.block, fine.block) == (5, 1)
    assert len(fine.pv) == len(window)


@pytest.fixture
def asked(monkeypatch):
    """Who is asked for the best by samples: a list that grows, with what is answered."""
    window, right, wrong = slow_loop()
    problem, fine = pose(window), pose(window, FINE)
    calls = []

    def best(*_):
        calls.append(1)
        return [start(right, FOPDT, fine)]

    def as_it_is(fits, problem, *_):
        return [start(each.candidate, each.structure, problem) for each in fits]

    monkeypatch.setattr(few_periods, "best_by_samples", best)
    monkeypatch.setattr(few_periods, "refine", as_it_is)
    return window, problem, right, wrong, calls


def test_what_explains_the_samples_clearly_better_is_believed(asked):
    window, problem, right, wrong, calls = asked
    before = Found(start(wrong, FOPDT, problem), ())
    after = searched_by_samples(before, window, problem)
    assert calls
    np.testing.assert_array_equal(after.best.candidate, right)
    assert after.best.error == start(right, FOPDT, problem).error


def test_white_residuals_leave_nothing_to_seek(asked):
    window, problem, right, _, calls = asked
    found = Found(start(right, FOPDT, problem), ())
    assert searched_by_samples(found, window, problem) is found
    assert not calls


def test_nothing_where_the_shots_decide(asked):
    window, problem, _, wrong, calls = asked
    best = start(wrong, FOPDT, problem)
    found = Found(best, (), 0.9 * SURER * best.error)
    assert searched_by_samples(found, window, problem) is found
    assert not calls


def test_nothing_in_a_record_of_many_periods_or_of_blocks_of_a_sample(asked):
    window, problem, _, wrong, calls = asked
    found = Found(start(wrong, FOPDT, problem), ())
    many = problem._replace(period=len(problem.op) / (FEW + 1))
    assert searched_by_samples(found, window, many) is found
    assert searched_by_samples(found, window, pose(window, FINE)) is found
    assert not calls


def test_a_little_less_changes_nothing(asked, monkeypatch):
    window, problem, _, wrong, _ = asked
    found = Found(start(wrong, FOPDT, problem), ())
    fine = pose(window, FINE)
    told = []
    monkeypatch.setattr(few_periods, "autocorrelation", lambda each, *_: told.append(each) or 1.0)
    little = CLEARLY_LESS + 0.01
    monkeypatch.setattr(
        few_periods,
        "best_by_samples",
        lambda *_: [Fitted(little * told[0].error, FOPDT, start(wrong, FOPDT, fine).candidate)],
    )
    assert searched_by_samples(found, window, problem) is found


@pytest.mark.bench  # a search of 8 s
def test_it_finds_the_valve():
    window, right, _ = slow_loop()
    problem, fine = pose(window), pose(window, FINE)
    found = best_by_samples(fine, problem, HINTS, np.random.default_rng(0))
    assert len(found) == 3
    best = min(found, key=lambda each: each.error)
    assert best.candidate[S] == pytest.approx(right[S], rel=0.03)
    assert best.structure == FOPDT
