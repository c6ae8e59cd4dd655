"""The search around a model: near it, with any stem, and only to less by shots."""

import numpy as np
import pytest
from agent.analysis.quantify.free_run.scatter import SPREADS, scattered, searched_around
from agent.analysis.quantify.free_run.search import Found

from agent.analysis.record.recording import LoopHints
from agent.identify.fitted import start
from agent.identify.objective import (
    DELAY,
    FIRST,
    FOPDT,
    J_RATIO,
    LEVEL,
    LOG_DAMPING,
    LOG_REST,
    S,
    in_bounds,
)
from tests.reference.test_shooting_twin import loop_whose_stem_rests_elsewhere_once

HINTS = LoopHints(False, 1)


def many(problem, candidate, spread, count=300):
    rng = np.random.default_rng(0)
    best = start(candidate, FOPDT, problem)
    return np.array([scattered(best, spread, problem, rng).candidate for _ in range(count)])


@pytest.mark.parametrize("spread", SPREADS)
def test_scattered_valves_are_possible_and_as_far_off_as_requested(spread):
    problem, candidate = loop_whose_stem_rests_elsewhere_once(0.0)
    valves = many(problem, candidate, spread)
    assert all(in_bounds(valve, problem) for valve in valves)
    off = (valves[:, S] - candidate[S]) / problem.op_span
    assert np.std(off) == pytest.approx(spread.s, rel=0.15)
    j = valves[:, S] * valves[:, J_RATIO] - candidate[S] * candidate[J_RATIO]
    assert 0.3 * spread.j < np.std(j) / problem.op_span < 1.2 * spread.j


def test_delay_and_first_slip_go_along_with_s_and_the_stem_is_any():
    problem, candidate = loop_whose_stem_rests_elsewhere_once(0.0)
    valves = many(problem, candidate, SPREADS[0])
    more = valves[:, S] - candidate[S]
    expected = np.clip(candidate[DELAY] - more / problem.op_speed, 1.0, problem.max_delay)
    np.testing.assert_allclose(valves[:, DELAY], expected)
    np.testing.assert_allclose(valves[:, LEVEL], candidate[LEVEL] + 0.5 * candidate[FIRST] * more)
    assert (np.std(valves[:, LOG_DAMPING : LOG_REST + 1], axis=0) > 0.5).all()


def test_a_delay_that_is_given_stays():
    problem, candidate = loop_whose_stem_rests_elsewhere_once(0.0)
    given = problem._replace(fixed_delay=float(candidate[DELAY]))
    assert (many(given, candidate, SPREADS[2])[:, DELAY] == candidate[DELAY]).all()


def test_it_finds_the_valve_beside_a_wrong_one():
    problem, candidate = loop_whose_stem_rests_elsewhere_once(0.0)
    wrong = candidate.copy()
    wrong[S] *= 1.05
    wrong[LOG_DAMPING] += 0.7
    before = Found(start(wrong, FOPDT, problem), ())
    after = searched_around(before, problem, HINTS, np.random.default_rng(0))
    assert after.best.candidate[S] == pytest.approx(candidate[S], rel=0.01)
    assert after.best.error < before.best.error


def test_what_needs_more_by_shots_changes_nothing():
    problem, candidate = loop_whose_stem_rests_elsewhere_once()
    found = Found(start(candidate, FOPDT, problem), (), by_shots=0.0)
    assert searched_around(found, problem, HINTS, np.random.default_rng(0)) is found
