"""A stem of bristles takes the place of a stiff one where it explains the record better, and only there."""

from functools import cache

import numpy as np
import pytest
from agent.analysis.quantify.free_run.bristles import JUMPS, bristly, with_bristles
from agent.analysis.quantify.free_run.fitted import refine
from agent.analysis.quantify.free_run.search import SURER, Found

from agent.analysis.quantify.free_run.problem import pose
from agent.analysis.record.recording import LoopWindow
from agent.identify.fitted import start
from agent.identify.objective import (
    BRISTLES,
    DELAY,
    FIRST,
    FOPDT,
    J_RATIO,
    LEVEL,
    LOG_DAMPING,
    LOG_TAU,
    SIZE,
    S,
)
from agent.physics.valves.damped_stem import damped_stem
from tests.reference import free_run_twins as slow

F_S, F_D, GIVE = 4.5, 0.5, 0.15
STEM = (0.3, 0.15, 0.01)


@cache
def loop(give):
    """A noisy loop with a stem of bristles, and the candidate that it is but for them."""
    random = np.random.default_rng(2)
    t = np.arange(900)
    op = 50 + 6 * np.sin(t / 9) + 1.5 * np.sin(t / 37) + 0.05 * random.standard_normal(t.size)
    position = damped_stem(op, F_S, F_D, op[0], *STEM, give)
    pv = 80 + 2 * np.r_[np.zeros(2), slow.first_order(position - position[0], 9.0)[:-2]]
    pv += 0.05 * random.standard_normal(t.size)
    problem = pose(LoopWindow("FIC1", 0.0, 1.0, op, pv))
    candidate = np.zeros(SIZE)
    s = F_S + F_D
    candidate[[LOG_TAU, DELAY, S, J_RATIO]] = np.log(9.0), 3.0, s, (F_S - F_D) / s
    candidate[[LEVEL, FIRST]] = op[0] + F_S, 1.0
    candidate[LOG_DAMPING : LOG_DAMPING + 3] = np.log(STEM)
    return problem, candidate


def found_stiff(give, loosened=0.0):
    problem, candidate = loop(give)
    stiff = candidate.copy()
    stiff[S] -= loosened
    stiff[J_RATIO] = (F_S - F_D - loosened) / stiff[S]
    stiff[LEVEL] -= loosened
    best = start(stiff, FOPDT, problem)
    return problem, Found(best, (best,))


def test_bristles_are_found_with_s_and_j():
    problem, stiff = found_stiff(GIVE, 0.3)
    found = with_bristles(stiff, problem)
    candidate = found.best.candidate
    assert found.best.error < 0.9 * stiff.best.error
    assert found.others[0].error <= found.best.error
    assert candidate[BRISTLES] > 0
    off = candidate[S] - F_S - F_D, candidate[S] * candidate[J_RATIO] - F_S + F_D
    assert np.abs(off) == pytest.approx(0.0, abs=0.02 * problem.op_span)


def test_a_stiff_stem_stays_stiff():
    problem, stiff = found_stiff(0.0)
    best = stiff.best
    for scale in (0.1, 0.03):  # as a search leaves it
        (best,) = refine([best], problem, scale, (100, 300), np.random.default_rng(0))
    polished = Found(best, (best,))
    assert with_bristles(polished, problem) is polished


def test_what_the_shots_decided_is_left():
    problem, stiff = found_stiff(GIVE, 0.3)
    by_shots = Found(stiff.best, stiff.others, 0.5 * SURER * stiff.best.error)
    assert with_bristles(by_shots, problem) is by_shots


def test_a_valve_that_slides_is_not_tried():
    problem, stiff = found_stiff(GIVE)
    sliding = stiff.best.candidate.copy()
    sliding[J_RATIO] = 0.9 * JUMPS
    slides = Found(start(sliding, FOPDT, problem), ())
    assert with_bristles(slides, problem) is slides


def test_a_start_with_bristles_keeps_f_d_and_where_the_stem_rests():
    problem, stiff = found_stiff(GIVE)
    before, after = stiff.best.candidate, bristly(stiff.best, 0.1, 1.0, problem).candidate
    assert after[S] * (1 - after[J_RATIO]) == pytest.approx(before[S] * (1 - before[J_RATIO]))
    rests = [c[LEVEL] - c[FIRST] * c[S] * (1 + c[J_RATIO]) / 2 for c in (before, after)]
    assert rests[0] == pytest.approx(rests[1])
    assert after[S] > before[S]
    assert after[BRISTLES] == 0.1
