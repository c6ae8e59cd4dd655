"""Kernels of ``agent.identify`` against slow, obvious ways, on the loops of the twins of ``free_run``."""

import math

import numpy as np
import pytest
from hypothesis import given

from agent.identify.bounds import keep_in_bounds
from agent.identify.free_run_error import process_error
from agent.identify.objective import (
    BRISTLES,
    DELAY,
    FIRST,
    FOPDT,
    INTEGRATOR,
    J_RATIO,
    LEVEL,
    LOG_REST,
    LOG_TAU,
    LOG_TAU2,
    SIZE,
    SOPDT,
    S,
    in_bounds,
    valve_position,
)
from agent.identify.search.anywhere import valves_from_anywhere
from agent.identify.search.children import generation, scattered
from agent.identify.search.cycle import STRUCTURES, possible_of
from agent.identify.search.population import S_BINS, apart, reach, refit
from agent.identify.search.price import DEAR, DEAR_BRISTLES, price
from agent.identify.side_by_side.gauss_newton import ERROR, GIVE_UP, fit_processes, fits_for, processes_at
from agent.identify.side_by_side.positions import fill_positions, group_for, pass_filters
from agent.identify.side_by_side.process_columns import fill_products
from agent.identify.side_by_side.process_step import steps_of
from agent.jit import kernel
from agent.lanes import WIDTH, store
from tests.reference import gauss_newton_by_hand as slow
from tests.reference.test_free_run_twin import FEW, SEEDS, candidate_of, problem_of

POSSIBLE = possible_of(STRUCTURES)
SLOW = math.log(3.0)
"""Least log of a time constant here, samples: the start-up of a quicker one has faded where PV begins to
count, and is cut at another place than in ``fit_gain``."""
GUARDED = 1e-4
"""Relative: start-ups that hardly differ from response and nuisance are left out sooner than there."""


NONE, SOME = np.empty(0), np.array([0.7, -0.2, 0.1])
"""Coefficients of the autoregression behind which a record stands."""


def assert_guarded(error, exact):
    assert error == pytest.approx(exact, rel=GUARDED)


def prepared(seed, whitening=NONE):
    """A record, and a candidate with the room for its fits: alone in its group, so in each lane."""
    problem = problem_of(seed, acting="reverse")._replace(whitening=whitening)
    candidate = candidate_of(seed, problem)
    candidate[LOG_TAU] = max(candidate[LOG_TAU], SLOW)
    candidate[LOG_TAU2] = candidate[LOG_TAU] - 1.0
    keep_in_bounds(candidate, problem)
    group, fits = group_for(problem), fits_for(problem)
    fill_positions(candidate[None], ALONE, problem, group)
    pass_filters(problem, group)
    fits.values[GIVE_UP] = np.inf
    return problem, candidate, group.passed, fits


ALONE = np.zeros(1, dtype=np.int64)


@kernel
def first_step(candidates, structures, problem, passed, fits, found):
    """Fill error, predicted error, and step in log tau, delay and log tau2, (5, ``WIDTH``)."""
    processes = processes_at(candidates, structures, ALONE, fits)
    fill_products(processes, passed, problem, fits.passes)
    step = steps_of(processes, problem, fits.squares, fits.passes, fits.normal)
    store(found, 0, step.error)
    store(found, 1, step.predicted)
    store(found, 2, step.log_tau)
    store(found, 3, step.delay)
    store(found, 4, step.log_tau2)


def step_of(candidate, structure, problem, passed, fits):
    """Return the error, the predicted one, and the step in log tau and delay."""
    found = np.empty((5, WIDTH))
    first_step(candidate[None], np.array([structure]), problem, passed, fits, found)
    assert (found == found[:, :1]).all()
    return found[:4, 0]


def fitted(candidate, structure, problem, evaluations, passed, fits):
    """Fit the process of a candidate in place; return its error."""
    fit_processes(candidate[None], np.array([structure]), ALONE, problem, evaluations, passed, fits)
    return fits.values[ERROR, 0]


@pytest.mark.parametrize("whitening", [NONE, SOME])
@pytest.mark.parametrize("structure", [FOPDT, SOPDT, INTEGRATOR])
@FEW
@given(SEEDS)
def test_the_error_of_a_step_is_the_free_run_error(structure, whitening, seed):
    problem, candidate, passed, fits = prepared(seed, whitening)
    position = valve_position(candidate, problem)
    error, *_ = step_of(candidate, structure, problem, passed, fits)
    assert_guarded(error, process_error(position, candidate, structure, problem))
    assert_guarded(error, slow.error(candidate, structure, problem, position, problem.gain_sign))


@pytest.mark.parametrize("whitening", [NONE, SOME])
@pytest.mark.parametrize("structure", [FOPDT, SOPDT])
@FEW
@given(SEEDS)
def test_a_step_is_that_of_dense_least_squares(structure, whitening, seed):
    problem, candidate, passed, fits = prepared(seed, whitening)
    candidate[DELAY] = 4.3  # between two blocks the response has a derivative
    error, predicted, log_tau, delay = step_of(candidate, structure, problem, passed, fits)
    left, step = slow.step(candidate, structure, problem, valve_position(candidate, problem))
    if error < float(problem.pv @ problem.pv) and abs(step[0]) < 0.3 and abs(step[2]) < 1.0:
        assert predicted == pytest.approx(left, rel=0.02)
        if structure == FOPDT:  # two lags and a delay are so alike that the damping turns the step along them
            assert log_tau == pytest.approx(step[0], abs=0.05 + 0.4 * abs(step[0]))
            assert delay == pytest.approx(step[2], abs=0.15 + 0.4 * abs(step[2]))


@FEW
@given(SEEDS)
def test_fitting_a_process_never_makes_it_worse_and_reports_its_own_error(seed):
    problem, candidate, passed, fits = prepared(seed)
    before, *_ = step_of(candidate, FOPDT, problem, passed, fits)
    error = fitted(candidate, FOPDT, problem, 8, passed, fits)
    assert error <= before
    if candidate[LOG_TAU] >= SLOW:
        assert_guarded(error, process_error(valve_position(candidate, problem), candidate, FOPDT, problem))


@FEW
@given(SEEDS)
def test_an_error_is_the_same_alone_and_among_others(seed):
    problem = problem_of(seed)
    rng = np.random.default_rng(seed)
    begun = valves_from_anywhere(2 * WIDTH + 3, problem, problem, STRUCTURES, rng)
    together = generation(begun, 2, 0.05, problem, POSSIBLE, rng)
    for k in range(0, len(together.costs), 7):
        alone = together.take(np.array([k]))
        refit(alone, problem, 1)
        among = together.take(np.arange(len(together.costs)))
        refit(among, problem, 1)
        assert alone.costs[0] == among.costs[k]


@FEW
@given(SEEDS)
def test_populations_stay_in_bounds_and_cost_what_they_cost(seed):
    problem = problem_of(seed, acting="reverse")
    rng = np.random.default_rng(seed)
    begun = valves_from_anywhere(60, problem, problem, STRUCTURES, rng)
    kept = begun.take(apart(begun, 12, 0.02, 12, reach(problem), problem.op_span))
    grown = generation(kept, 3, 0.05, problem, POSSIBLE, rng)
    around = scattered(kept, 10, 0.02, problem, rng)
    for population in (begun, grown, around):
        assert all(in_bounds(each, problem) for each in population.candidates)
    for k in range(len(kept.costs), len(grown.costs)):
        candidate, structure = grown.candidates[k], int(grown.structures[k])
        if candidate[LOG_TAU] < SLOW:
            continue
        error = process_error(valve_position(candidate, problem), candidate, structure, problem)
        cost = error * price(candidate, structure, problem, float(problem.weight.sum()))
        assert_guarded(grown.costs[k], cost)


def test_a_price_is_that_of_its_formula():
    problem = problem_of(1)
    candidate = np.zeros(SIZE)
    candidate[S], candidate[J_RATIO] = 0.5 * problem.op_span, 0.4
    candidate[LOG_REST], candidate[BRISTLES] = math.log(0.1), 0.2
    count = 300.0
    expected = (1 + DEAR * 0.2 * (0.1 + DEAR_BRISTLES * 0.04)) * count ** (2 / count)
    assert price(candidate, SOPDT, problem, count) == pytest.approx(expected)


def niche_of(candidate, structure, span):
    return min(S_BINS - 1, int(S_BINS * candidate[S] / span)), structure


def chosen_by_hand(population, most, distance, per_niche, ranges, span):
    """The same as ``apart``, member by member."""
    chosen = []
    for i in sorted(range(len(population.costs)), key=lambda k: (population.costs[k], k)):
        one, structure = population.candidates[i], population.structures[i]
        niche = niche_of(one, structure, span)
        of_niche = sum(
            niche
            == (min(S_BINS - 1, int(S_BINS * population.candidates[k][S] / span)), population.structures[k])
            for k in chosen
        )
        differs = all(
            population.costs[i] > (1 + 1e-5) * population.costs[k]
            and (
                structure != population.structures[k]
                or one[FIRST] != population.candidates[k][FIRST]
                or bool(np.any((np.abs(one - population.candidates[k]) > distance * ranges) & (ranges > 0)))
            )
            for k in chosen
        )
        if of_niche < per_niche and differs and len(chosen) < most:
            chosen.append(i)
    return chosen


@FEW
@given(SEEDS)
def test_members_that_are_apart_are_those_found_by_hand(seed):
    problem = problem_of(seed, acting="reverse")
    rng = np.random.default_rng(seed)
    population = valves_from_anywhere(40, problem, problem, STRUCTURES, rng)
    population.candidates[20:, LEVEL] = population.candidates[:20, LEVEL]
    found = apart(population, 15, 0.1, 3, reach(problem), problem.op_span)
    by_hand = chosen_by_hand(population, 15, 0.1, 3, reach(problem), problem.op_span)
    assert list(found) == by_hand
