"""Moving on to a better model beside the best."""

from agent.analysis.quantify.free_run.neighbours import BETTER, better_beside, moved_on
from agent.analysis.quantify.free_run.search import SURER, Found

from agent.identify.fitted import Fitted, start
from agent.identify.objective import FOPDT, LEVEL, SOPDT, S
from tests.reference.test_shooting_twin import loop_whose_stem_rests_elsewhere_once


def right_beside_wrong(by_shots=float("inf"), structure=FOPDT):
    problem, candidate = loop_whose_stem_rests_elsewhere_once(0.0)
    wrong = candidate.copy()
    wrong[S] += 0.02 * problem.op_span
    wrong[LEVEL] += 0.01 * problem.op_span
    right = start(candidate, structure, problem)
    best = start(wrong, FOPDT, problem)
    return problem, right, Found(best, (right, best), by_shots * best.error)


def test_the_better_model_beside_becomes_the_best():
    problem, right, found = right_beside_wrong()
    moved = moved_on(found, problem)
    assert moved.best.error <= right.error < BETTER * found.best.error
    assert abs(moved.best.candidate[S] - right.candidate[S]) < 0.01 * problem.op_span
    assert better_beside(moved) is None
    assert {id(each) for each in found.others} <= {id(each) for each in moved.others}


def test_one_that_is_hardly_better_changes_nothing():
    problem, right, _ = right_beside_wrong()
    found = Found(right, (Fitted(0.99 * right.error, FOPDT, right.candidate),))
    assert moved_on(found, problem) is found


def test_another_process_is_left():
    problem, _, found = right_beside_wrong(structure=SOPDT)
    assert moved_on(found, problem) is found


def test_what_the_shots_decided_is_left():
    problem, _, found = right_beside_wrong(by_shots=0.9 * SURER)
    assert moved_on(found, problem) is found
