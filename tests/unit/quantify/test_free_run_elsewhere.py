"""From a model to the best that differs from it in one value."""

import numpy as np
import pytest
from agent.analysis.quantify.free_run.elsewhere import PLACES, moved_elsewhere, one_by_one

from agent.identify.fitted import start
from agent.identify.objective import (
    BRISTLES,
    DELAY,
    FOPDT,
    J_RATIO,
    LOG_REST,
    LOG_TAU,
    RIGID,
    S,
    in_bounds,
)
from tests.reference.test_shooting_twin import loop_whose_stem_rests_elsewhere_once


@pytest.mark.parametrize("rest", [-4.0, RIGID - 1])
def test_all_are_possible_and_the_process_stays_but_for_its_delay(rest):
    problem, candidate = loop_whose_stem_rests_elsewhere_once(0.0)
    candidate[LOG_REST] = rest
    moved = one_by_one(candidate, problem)
    assert len(moved) == (7 if rest > RIGID else 4)
    for places in moved:
        assert len(places) == PLACES
        assert all(in_bounds(each, problem) for each in places)
        assert (places[:, [LOG_TAU, BRISTLES]] == candidate[[LOG_TAU, BRISTLES]]).all()


def test_a_delay_that_is_given_stays():
    problem, candidate = loop_whose_stem_rests_elsewhere_once(0.0)
    given = problem._replace(fixed_delay=float(candidate[DELAY]))
    assert all((places[:, DELAY] == candidate[DELAY]).all() for places in one_by_one(candidate, given))


@pytest.mark.parametrize("axis", [J_RATIO, LOG_REST])
def test_a_value_that_is_far_off_is_found(axis):
    problem, candidate = loop_whose_stem_rests_elsewhere_once(0.0)
    wrong = candidate.copy()
    wrong[axis] = {J_RATIO: 0.02, LOG_REST: np.log(0.29)}[axis]
    begun = start(wrong, FOPDT, problem)
    found = moved_elsewhere(begun, problem, np.random.default_rng(0))
    assert found.error < 0.5 * begun.error
    assert found.candidate[S] == pytest.approx(candidate[S], rel=0.02)


def test_the_right_one_stays_where_it_is():
    problem, candidate = loop_whose_stem_rests_elsewhere_once(0.0)
    found = moved_elsewhere(start(candidate, FOPDT, problem), problem, np.random.default_rng(0))
    assert found.candidate[S] == pytest.approx(candidate[S], rel=0.01)
