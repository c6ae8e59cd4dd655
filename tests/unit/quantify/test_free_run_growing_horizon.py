"""Populations over a growing record: where they begin, what they come to, and when that is believed."""

import numpy as np
import pytest

from agent.analysis.quantify.free_run import growing_horizon, second_search
from agent.analysis.quantify.free_run.fitted import start
from agent.analysis.quantify.free_run.growing_horizon import best_of_populations, random_valves
from agent.analysis.quantify.free_run.objective import DELAY, FOPDT, J_RATIO, S, in_bounds
from agent.analysis.quantify.free_run.search import Found
from agent.analysis.quantify.free_run.second_search import searched_by_populations, slides_by_shots_alone
from agent.analysis.recording import LoopHints
from tests.reference.test_shooting_twin import loop_whose_stem_rests_elsewhere_once

HINTS = LoopHints(False, 1)


def test_random_valves_are_possible_and_reach_over_the_whole_range():
    problem, _ = loop_whose_stem_rests_elsewhere_once(0.0)
    valves = random_valves(problem, np.random.default_rng(0), 2000)
    assert all(in_bounds(valve, problem) for valve in valves)
    assert np.quantile(valves[:, S] / problem.op_span, [0.05, 0.95]) == pytest.approx([0.02, 0.9], abs=0.05)
    assert 0.2 < np.mean(valves[:, J_RATIO] < 0.1) < 0.4
    small = valves[:, S] < 0.1 * problem.op_span
    assert np.ptp(valves[small, J_RATIO]) > 0.9  # both are spread by themselves
    given = random_valves(problem._replace(fixed_delay=7.0), np.random.default_rng(0), 20)
    assert (given[:, DELAY] == 7.0).all()


def test_populations_come_to_the_valve_from_nowhere():
    problem, candidate = loop_whose_stem_rests_elsewhere_once(0.0)
    best = best_of_populations(problem, HINTS, np.random.default_rng(0))
    assert best.candidate[S] == pytest.approx(candidate[S], rel=0.02)
    assert best.error < 0.05 * np.sum(problem.pv**2)


def test_only_a_valve_that_slides_by_shots_alone_is_sought_so():
    problem, candidate = loop_whose_stem_rests_elsewhere_once()
    candidate[J_RATIO] = 0.1
    best = start(candidate, FOPDT, problem)
    assert slides_by_shots_alone(Found(best, (), 0.5 * best.error))
    assert not slides_by_shots_alone(Found(best, (), best.error))
    candidate[J_RATIO] = 0.9
    jumping = start(candidate, FOPDT, problem)
    assert not slides_by_shots_alone(Found(jumping, (), 0.5 * jumping.error))


@pytest.mark.parametrize(("share", "believed"), [(0.7, True), (0.9, False)])
def test_a_free_run_is_believed_where_it_needs_clearly_less_than_shots(monkeypatch, share, believed):
    problem, candidate = loop_whose_stem_rests_elsewhere_once(0.0)
    right = start(candidate, FOPDT, problem)
    wrong = candidate.copy()
    wrong[S] *= 1.1
    before = Found(start(wrong, FOPDT, problem), (), right.error / share)
    tried = []
    monkeypatch.setattr(
        second_search,
        "best_of_populations",
        lambda *_: tried.append(1) or (right if len(tried) > 1 else None),
    )
    after = searched_by_populations(before, problem, HINTS)
    assert (after.best is right) == believed
    assert (after is before) == (not believed)
    assert len(tried) == (2 if believed else second_search.POPULATIONS)


def test_nowhere_to_go_is_no_answer(monkeypatch):
    problem, _ = loop_whose_stem_rests_elsewhere_once(0.0)
    monkeypatch.setattr(growing_horizon, "refine", lambda *_: [])
    monkeypatch.setattr(growing_horizon, "VALVES", 50)
    monkeypatch.setattr(growing_horizon, "random_valves", lambda p, rng: random_valves(p, rng, 50))
    assert best_of_populations(problem, HINTS, np.random.default_rng(0)) is None
