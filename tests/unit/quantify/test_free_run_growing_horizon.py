"""Populations over a growing record: where they begin, what they come to, and when that is believed."""

import numpy as np
import pytest
from agent.analysis.quantify.free_run.growing_horizon import (
    best_of_populations,
    from_around,
    population,
    random_valves,
    ways_of,
)
from agent.analysis.quantify.free_run.populations import (
    WHITE,
    leaves_noise,
    searched_by_populations,
)
from agent.analysis.quantify.free_run.search import Found

from agent.analysis.quantify.free_run import growing_horizon, populations
from agent.analysis.record.recording import LoopHints
from agent.identify.fitted import start
from agent.identify.objective import (
    DELAY,
    FOPDT,
    J_RATIO,
    LOG_REST,
    S,
    free_run_error,
    in_bounds,
)
from agent.identify.residuals import LEAST_LAG
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


@pytest.mark.bench  # three searches of 5 s
def test_populations_come_to_the_valve_from_nowhere():
    problem, candidate = loop_whose_stem_rests_elsewhere_once(0.0)
    orders = (best_of_populations(problem, HINTS, np.random.default_rng(seed)) for seed in range(3))
    best = min(orders, key=lambda found: found.error)  # which of them comes there depends on last digits
    assert best.candidate[S] == pytest.approx(candidate[S], rel=0.02)
    assert best.error < 0.05 * np.sum(problem.pv**2)


@pytest.fixture
def sent(monkeypatch):
    """A record, the right model, a wrong one, and the times that populations come to the right one."""
    problem, candidate = loop_whose_stem_rests_elsewhere_once(0.0)
    right = start(candidate, FOPDT, problem)
    wrong = candidate.copy()
    wrong[S] *= 1.1
    times = []
    monkeypatch.setattr(populations, "best_of_populations", lambda *_: times.append(1) or right)
    return problem, right, start(wrong, FOPDT, problem), times


@pytest.mark.parametrize(("share", "believed"), [(0.7, True), (0.9, False)])
def test_a_free_run_is_believed_where_it_needs_clearly_less_than_shots(sent, share, believed):
    problem, right, wrong, times = sent
    before = Found(wrong, (), right.error / share)
    after = searched_by_populations(before, problem, HINTS)
    assert (after.best is right) == believed
    assert (after is before) == (not believed)
    assert times == [1]


def test_none_are_sent_where_noise_is_left(sent, monkeypatch):
    problem, right, wrong, times = sent
    monkeypatch.setattr(populations, "converged", lambda *_: True)
    monkeypatch.setattr(populations, "autocorrelation", lambda *_: WHITE - 0.01)
    found = Found(wrong, (), right.error)
    assert searched_by_populations(found, problem, HINTS) is found
    assert not times


@pytest.mark.parametrize(("left", "is_noise"), [((0.1, 0.1), True), ((0.5, 0.2), True), ((0.5, 0.4), False)])
def test_noise_is_forgotten_at_an_even_pace(sent, monkeypatch, left, is_noise):
    problem, _, wrong, _ = sent
    told = dict(zip((LEAST_LAG, 2 * LEAST_LAG), left, strict=True))
    monkeypatch.setattr(populations, "autocorrelation", lambda *asked: told[asked[-1]])
    assert leaves_noise(Found(wrong, ()), problem) is is_noise


def test_none_is_believed_where_nothing_was_found(sent, monkeypatch):
    problem, _, wrong, _ = sent
    monkeypatch.setattr(populations, "best_of_populations", lambda *_: None)
    found = Found(wrong, (), wrong.error)
    assert searched_by_populations(found, problem, HINTS) is found


def test_those_that_begin_around_others_have_other_stems():
    problem, candidate = loop_whose_stem_rests_elsewhere_once(0.0)
    wrong = candidate.copy()
    wrong[LOG_REST] += 2.0
    begun = population(wrong[None, :], FOPDT)
    begun.errors[:] = free_run_error(wrong, FOPDT, problem)
    came = from_around(begun, problem, ways_of(problem), np.random.default_rng(0))
    assert came.errors[0] < 0.5 * begun.errors[0]
    assert (came.structures == FOPDT).all()


@pytest.mark.bench  # a search of 5 s
def test_nowhere_to_go_is_no_answer(monkeypatch):
    problem, _ = loop_whose_stem_rests_elsewhere_once(0.0)
    monkeypatch.setattr(growing_horizon, "refine", lambda *_: [])
    monkeypatch.setattr(growing_horizon, "VALVES", 50)
    monkeypatch.setattr(growing_horizon, "random_valves", lambda p, rng: random_valves(p, rng, 50))
    assert best_of_populations(problem, HINTS, np.random.default_rng(0)) is None
