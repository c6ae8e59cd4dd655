"""Many stems for a valve: the best of them."""

import numpy as np
import pytest
from agent.analysis.quantify.free_run.stem_scan import with_best_stems

from agent.identify.fitted import start
from agent.identify.objective import DELAY, FOPDT, J_RATIO, LOG_DAMPING, LOG_REST, S
from tests.reference.test_shooting_twin import loop_whose_stem_rests_elsewhere_once


def with_another_stem():
    problem, candidate = loop_whose_stem_rests_elsewhere_once(0.0)
    wrong = candidate.copy()
    wrong[LOG_DAMPING : LOG_REST + 1] = np.log((0.8, 0.4, 0.2))
    return problem, start(candidate, FOPDT, problem), start(wrong, FOPDT, problem)


def test_a_wrong_stem_is_replaced_and_all_else_of_the_valve_stays():
    problem, right, wrong = with_another_stem()
    (found,) = with_best_stems([wrong], problem, np.random.default_rng(0))
    assert right.error < found.error < 0.5 * wrong.error
    assert found.error == start(found.candidate, FOPDT, problem).error
    np.testing.assert_array_equal(found.candidate[[S, J_RATIO]], wrong.candidate[[S, J_RATIO]])


def test_the_delay_goes_along_unless_it_is_given():
    problem, _, wrong = with_another_stem()
    rng = np.random.default_rng(0)
    (found,) = with_best_stems([wrong], problem, rng)
    before, after = (np.exp(each.candidate[LOG_DAMPING:LOG_REST]).sum() for each in (wrong, found))
    expected = max(1.0, wrong.candidate[DELAY] + before - after)
    assert found.candidate[DELAY] == pytest.approx(expected)
    (found,) = with_best_stems([wrong], problem._replace(fixed_delay=4.0), rng)
    assert found.candidate[DELAY] == wrong.candidate[DELAY]


def test_a_stem_that_fits_best_stays():
    problem, right, _ = with_another_stem()
    (found,) = with_best_stems([right], problem, np.random.default_rng(0))
    assert found.error <= right.error
