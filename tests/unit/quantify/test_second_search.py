"""When a search is taken up once more, and what it may change."""

import numpy as np
import pytest
from agent.analysis.quantify.free_run.coarse_grid import COARSE, Family
from agent.analysis.quantify.free_run.search import Found
from agent.analysis.quantify.free_run.second_search import (
    OF_ALL,
    STARTS,
    SURE_OF_A_FAMILY,
    clearly_less,
    converged,
    converged_search,
    going_on,
    searched_again,
)

from agent.analysis.quantify.free_run import second_search
from agent.analysis.record.recording import LoopHints
from agent.identify.fitted import Fitted, start
from agent.identify.objective import FOPDT, INTEGRATOR, J_RATIO, SIZE, SOPDT, S
from tests.reference.test_shooting_twin import loop_whose_stem_rests_elsewhere_once


def found_of(problem, candidate, by_shots=np.inf):
    return Found(start(candidate, FOPDT, problem), (), by_shots)


def test_the_true_valve_has_converged_and_is_kept():
    problem, candidate = loop_whose_stem_rests_elsewhere_once(0.0)
    found = found_of(problem, candidate)
    assert converged(found, problem)
    assert converged_search(found, problem, LoopHints()) is found


def test_a_wrong_valve_is_replaced_by_the_true_one():
    problem, candidate = loop_whose_stem_rests_elsewhere_once(0.0)
    wrong = candidate.copy()
    wrong[S] *= 1.3
    first = found_of(problem, wrong)
    found = converged_search(first, problem, LoopHints(False, 1))
    assert found.best.candidate[S] == pytest.approx(candidate[S], rel=0.02)
    assert clearly_less(found, first)
    assert converged(found, problem)


def test_a_valve_that_loses_its_way_has_not_converged():
    problem, candidate = loop_whose_stem_rests_elsewhere_once()
    assert not converged(found_of(problem, candidate), problem)


def test_a_valve_that_needs_shots_has_not_converged():
    problem, candidate = loop_whose_stem_rests_elsewhere_once(0.0)
    error = start(candidate, FOPDT, problem).error
    assert not converged(found_of(problem, candidate, 0.5 * error), problem)


def test_what_needs_more_by_shots_changes_nothing():
    problem, candidate = loop_whose_stem_rests_elsewhere_once()
    found = found_of(problem, candidate, by_shots=0.0)
    again = searched_again(found, STARTS[1], problem, LoopHints(False, 1), np.random.default_rng(0))
    assert again is found


@pytest.mark.parametrize("off", [0.3, -0.3])
def test_it_finds_the_valve_that_the_first_search_missed(off):
    problem, candidate = loop_whose_stem_rests_elsewhere_once(0.0)
    wrong = candidate.copy()
    wrong[S] *= 1 + off
    wrong[J_RATIO] = 0.4
    hints = LoopHints(False, 1)
    again = searched_again(found_of(problem, wrong), STARTS[0], problem, hints, np.random.default_rng(0))
    assert again.best.candidate[S] == pytest.approx(candidate[S], rel=0.02)
    assert again.best.error < start(wrong, FOPDT, problem).error


def test_some_of_each_family_go_on_and_the_best_of_all():
    good, bad = ([Fitted(least + i, FOPDT, np.zeros(SIZE)) for i in range(50)] for least in (0.0, 100.0))
    errors = [each.error for each in going_on([good, bad])]
    of_good = OF_ALL - SURE_OF_A_FAMILY
    assert sorted(errors) == [*range(of_good), *range(100, 100 + SURE_OF_A_FAMILY)]
    assert going_on([good[:3]]) == good[:3]


def test_each_family_has_its_processes_alone():
    ratios = np.array([0.0, 0.3, 0.6])
    assert list(Family(None).of(ratios)) == list(ratios)
    assert list(Family(False, False).of(ratios)) == [0.0]
    assert list(Family(False, True).of(ratios)) == [0.3, 0.6]
    assert set(second_search.FAMILIES) == {FOPDT, SOPDT, INTEGRATOR}


@pytest.mark.parametrize("grid", [COARSE, *(begin.grid for begin in STARTS)])
def test_the_groups_of_a_grid_hold_each_j_once(grid):
    places = np.concatenate(grid.group_places())
    np.testing.assert_array_equal(places, np.arange(len(grid.j_ratios)))
