"""The record behind the autoregression of what a model leaves: the noise is white there."""

import numpy as np
import pytest
from scipy.signal import lfilter

from agent.analysis.quantify.free_run.problem import FINE, SLOW, pose
from agent.analysis.record.recording import LoopWindow
from agent.identify.fitted import start
from agent.identify.objective import (
    DELAY,
    FIRST,
    FOPDT,
    J_RATIO,
    LEVEL,
    LOG_DAMPING,
    LOG_REST,
    LOG_SUPPLY,
    LOG_TAU,
    LOG_TAU2,
    SIZE,
    SOPDT,
    S,
    process_response,
    valve_position,
)
from agent.identify.residuals import autocorrelation
from agent.identify.search.cycle import next_cycle, nothing, possible_of
from agent.identify.search.elites import ROUNDS, elites_of, met_by
from agent.identify.search.likeliest import likeliest_of
from agent.identify.search.population import counted_blocks
from agent.identify.white_view import behind_autoregression, noise_of

POLE = 0.9
"""Of the load: neither white nor a walk."""


def valve(s, j_ratio):
    candidate = np.zeros(SIZE)
    candidate[[LOG_TAU, DELAY, LOG_TAU2]] = np.log(8.0), 4.0, -5.0
    candidate[[S, J_RATIO, LEVEL, FIRST]] = s, j_ratio, 3.0, 1.0
    candidate[[LOG_DAMPING, LOG_SUPPLY, LOG_REST]] = np.log([0.01, 0.01, 1e-8])
    return candidate


TRUE = valve(6.0, 0.4)


def record(load=0.25, seed=0, gap=None):
    rng = np.random.default_rng(seed)
    op = 10.0 * np.sin(np.arange(1500) / 9) + lfilter([1.0], [1.0, -0.95], rng.normal(size=1500))
    problem = pose(LoopWindow("FIC1", 0.0, 1.0, op, op))
    pv = 2.0 * process_response(valve_position(TRUE, problem), TRUE, FOPDT, 1, 1.0)
    pv = pv + lfilter([load], [1.0, -POLE], rng.normal(size=1500))
    if gap is not None:
        pv[gap] = np.nan
    return LoopWindow("FIC1", 0.0, 1.0, op, pv)


def problem_of(window):
    return pose(window, SLOW, FINE)


def test_what_the_true_model_leaves_is_white_there():
    problem = problem_of(record())
    white = behind_autoregression(problem, noise_of(TRUE, FOPDT, problem))
    plain, behind = (autocorrelation(start(TRUE, FOPDT, each), each, 1) for each in (problem, white))
    assert plain > 0.7
    assert abs(behind) < 0.06


def test_its_squares_are_those_of_the_innovations():
    problem = problem_of(record())
    noise = noise_of(TRUE, FOPDT, problem)
    error = start(TRUE, FOPDT, behind_autoregression(problem, noise)).error
    assert error == pytest.approx(np.nansum(noise.values**2), rel=0.02)


def test_a_sample_counts_with_all_that_its_prediction_needs():
    problem = problem_of(record(gap=slice(700, 710)))
    noise = noise_of(TRUE, FOPDT, problem)
    white = behind_autoregression(problem, noise)
    lags = len(noise.coefficients)
    known = np.convolve(problem.weight, np.ones(lags + 1))[: len(problem.weight)]
    np.testing.assert_array_equal(white.weight, known > lags + 0.5)
    assert not white.weight[700 : 710 + lags].any()


def searched(window):
    problem = problem_of(window)
    return problem, next_cycle(nothing(), problem, (FOPDT, SOPDT))


def test_the_likeliest_is_likelier_than_what_the_search_found_and_near_the_truth():
    window = record(load=0.5)
    problem, found = searched(window)
    best = start(found.finalists.candidates[0], int(found.finalists.structures[0]), problem)
    likeliest = likeliest_of(found, best, problem, possible_of((FOPDT, SOPDT)))
    candidate, structure = likeliest.models.candidates[0], int(likeliest.models.structures[0])

    def innovations_of(one, its_structure):
        noise = noise_of(one, its_structure, problem)
        white = behind_autoregression(problem, noise)
        return start(one, its_structure, white).error / counted_blocks(white)

    assert innovations_of(candidate, structure) <= innovations_of(best.candidate, best.structure)
    assert candidate[S] == pytest.approx(TRUE[S], abs=0.01 * window.op_span)
    assert candidate[S] * candidate[J_RATIO] == pytest.approx(2.4, abs=0.02 * window.op_span)


def test_where_no_samples_in_a_row_are_known_the_elites_are_those_of_the_record_itself():
    problem, found = searched(record())
    few = problem._replace(weight=problem.weight * (np.arange(len(problem.weight)) % 2))
    best = start(found.finalists.candidates[0], int(found.finalists.structures[0]), few)
    possible = possible_of((FOPDT, SOPDT))
    likeliest = likeliest_of(found, best, few, possible, ROUNDS[::8])
    assert likeliest.noise is None
    plain = elites_of(met_by(found, few), few, possible, ROUNDS[::8])
    np.testing.assert_array_equal(likeliest.models.candidates, plain.candidates)
