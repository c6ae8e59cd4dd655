"""Which of a population stand apart, against the slow twin; what generations keep and where children go."""

import numpy as np
import pytest
from agent.analysis.quantify.free_run.evolution import Population, apart, evolved, mutated
from agent.analysis.quantify.free_run.growing_horizon import population, random_valves, ways_of
from hypothesis import given, settings
from hypothesis import strategies as st

from agent.analysis.quantify.free_run import evolution
from agent.identify.objective import (
    DELAY,
    FIRST,
    FOPDT,
    INTEGRATOR,
    SIZE,
    SOPDT,
    free_run_error,
    in_bounds,
)
from tests.reference import evolution_by_hand as slow
from tests.reference.test_shooting_twin import loop_whose_stem_rests_elsewhere_once

GENERATIONS = np.array([(0.05, 8, 5), (0.02, 5, 5)])


@settings(max_examples=30, deadline=None)  # the first call compiles
@given(seed=st.integers(0, 2**32 - 1), most=st.integers(1, 40), distance=st.floats(0.0, 0.5))
def test_those_that_stand_apart_are_those_of_the_slow_twin(seed, most, distance):
    random = np.random.default_rng(seed)
    candidates = random.integers(0, 4, (40, SIZE)) * 0.1
    candidates[:, FIRST] = random.choice((-1.0, 1.0), 40)
    errors = random.choice((1.0, 1.0 + 1e-6, 1.1, 1.3, 1.7, 2.0, np.inf), 40) + 1e-9 * np.arange(40)
    people = Population(candidates, random.integers(0, 3, 40), errors)
    ranges = random.choice((0.0, 1.0, 2.0), SIZE)
    assert apart(people, most, distance, ranges).tolist() == slow.apart(people, most, distance, ranges)


@pytest.mark.parametrize("structure", [FOPDT, SOPDT, INTEGRATOR])
@pytest.mark.parametrize("crossed", [0.0, 1.0])
def test_children_are_possible_and_their_parents_stay_as_they_are(structure, crossed):
    problem, candidate = loop_whose_stem_rests_elsewhere_once(0.0)
    rng = np.random.default_rng(0)
    parents = np.vstack((candidate, random_valves(problem, rng, 9)))
    before, ways = parents.copy(), ways_of(problem)
    children = [mutated(parents, i % 10, structure, 0.3, crossed, ways, problem, rng) for i in range(300)]
    np.testing.assert_array_equal(parents, before)
    assert all(in_bounds(child, problem) for child in children)
    changed = [np.sum(child != parents[i % 10]) for i, child in enumerate(children)]
    assert min(changed) >= 0
    # S takes J/S, level and delay along, and a second pole stays behind the first.
    assert crossed > 0 or max(changed) <= evolution.MUTATED + 4


def test_a_delay_that_is_given_stays():
    problem, candidate = loop_whose_stem_rests_elsewhere_once(0.0)
    given = problem._replace(fixed_delay=float(candidate[DELAY]))
    people = population(random_valves(given, np.random.default_rng(0), 40), FOPDT)
    left = evolved(people, GENERATIONS, 0.5, 10, ways_of(given), given, np.random.default_rng(0))
    assert (left.candidates[:, DELAY] == candidate[DELAY]).all()


def test_generations_keep_the_best_report_its_error_and_repeat_themselves():
    problem, candidate = loop_whose_stem_rests_elsewhere_once(0.0)
    valves = np.vstack((candidate, random_valves(problem, np.random.default_rng(0), 60)))
    runs = [
        evolved(
            population(valves.copy(), FOPDT),
            GENERATIONS,
            0.5,
            10,
            ways_of(problem),
            problem,
            np.random.default_rng(3),
        )
        for _ in range(2)
    ]
    left, again = runs
    np.testing.assert_array_equal(left.candidates, again.candidates)
    assert (np.diff(left.errors) > 0).all()
    assert left.errors[0] <= free_run_error(candidate, FOPDT, problem)
    for each, structure, error in zip(*left, strict=True):
        assert free_run_error(each, structure, problem) == pytest.approx(error)
