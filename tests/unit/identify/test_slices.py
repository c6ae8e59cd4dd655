"""Loops over models in slices: on several cores at once, with the same result."""

from threading import Barrier

import numpy as np
import pytest

from agent.identify.objective import SIZE
from agent.identify.search.anywhere import valves_from_anywhere
from agent.identify.search.children import generation
from agent.identify.search.cycle import STRUCTURES, possible_of
from agent.identify.search.grid import valves_of_grid
from agent.identify.search.population import Candidates, refit
from agent.identify.slices import FEWEST, in_slices, on_cores
from tests.reference.test_free_run_twin import problem_of

TOGETHER = 20.0
"""Longest wait of one slice for the other, s."""


@pytest.mark.parametrize("first", [0, 7])
def test_slices_run_at_the_same_time_and_cover_all(first):
    meet, seen = Barrier(2), []

    def work(begin, end):
        meet.wait(TOGETHER)
        seen.extend(range(begin, end))

    with on_cores(2):
        in_slices(work, first, first + 2 * FEWEST)
    assert sorted(seen) == list(range(first, first + 2 * FEWEST))


@pytest.mark.parametrize(("cores", "count"), [(1, 100), (2, 2 * FEWEST - 1), (4, 0)])
def test_one_core_or_few_models_are_one_slice(cores, count):
    seen = []
    with on_cores(cores):
        in_slices(lambda begin, end: seen.append((begin, end)), 0, count)
    assert seen == [(0, count)]


def test_a_fault_in_a_slice_is_raised_and_cores_are_given_back():
    def work(begin, _):
        if begin:
            raise ArithmeticError

    with pytest.raises(ArithmeticError), on_cores(2):
        in_slices(work, 0, 2 * FEWEST)
    seen = []
    in_slices(lambda begin, end: seen.append((begin, end)), 0, 2 * FEWEST)
    assert seen == [(0, 2 * FEWEST)]


def searched(cores):
    problem = problem_of(3)
    rng = np.random.default_rng(5)
    with on_cores(cores):
        grid = valves_of_grid(problem, STRUCTURES)
        begun = valves_from_anywhere(3 * FEWEST, problem, problem, STRUCTURES, rng)
        refit(begun, problem, 3)
        grown = generation(begun.sorted(20), 4, 0.05, problem, possible_of(STRUCTURES), rng)
    return [part for population in (grid, begun, grown) for part in population]


def test_a_search_finds_the_same_on_any_number_of_cores():
    for one, several in zip(searched(1), searched(3), strict=True):
        np.testing.assert_array_equal(one, several)


def test_no_parents_have_no_children():
    problem = problem_of(3)
    none = Candidates(np.empty((0, SIZE)), np.empty(0, dtype=np.int64), np.empty(0))
    rng = np.random.default_rng(5)
    assert len(generation(none, 4, 0.05, problem, possible_of(STRUCTURES), rng).costs) == 0
