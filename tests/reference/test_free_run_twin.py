"""Every kernel of ``free_run`` against its slow twin, on loops whose valve sticks a little."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.optimize import minimize

from agent.analysis.quantify.free_run import coarse_grid, local_search, objective
from agent.analysis.quantify.free_run.objective import (
    DELAY,
    FOPDT,
    INTEGRATOR,
    LOG_TAU,
    LOG_TAU2,
    SOPDT,
    S,
)
from agent.analysis.quantify.free_run.problem import pose
from agent.analysis.quantify.free_run.search import STEMS
from agent.analysis.recording import LoopHints, LoopWindow
from tests.reference import free_run_twins as slow

SEEDS = st.integers(0, 2**32 - 1)
HE, TWO_STATE, DAMPED = STEMS
LAWS = st.sampled_from(STEMS)
STRUCTURES = st.sampled_from([FOPDT, SOPDT, INTEGRATOR])
TAUS = np.geomspace(0.7, 60.0, coarse_grid.TAUS)
DELAYS = np.array([0, 1, 7])


def problem_of(seed, acting=None, *, gaps=False, n=240):
    """OP swings and wanders; a valve between OP and PV sticks; PV is noisy and drifts."""
    random = np.random.default_rng(seed)
    op = 5 * np.sin(np.arange(n) / 8) + 0.3 * np.cumsum(random.standard_normal(n))
    f_s = random.uniform(0.5, 4.0)
    law = STEMS[random.integers(len(STEMS))]
    position = slow.valve(law, op, f_s, f_s * random.random(), op[0] - f_s * random.uniform(-1, 1))
    lagged = slow.first_order(position - position[0], random.uniform(2, 20))
    pv = 80 + 1.5 * np.roll(lagged, 3) + 0.01 * np.arange(n) + 0.2 * random.standard_normal(n)
    if gaps:
        for signal in (op, pv):
            start = random.integers(0, n - 30)
            signal[start : start + random.integers(1, 30)] = np.nan
    return pose(LoopWindow("FIC1", 0.0, 1.0, op, pv, hints=LoopHints(acting=acting)))


@st.composite
def candidates(draw):
    """Anywhere within the bounds, S in units of a swing of about 10."""
    log_tau = draw(st.floats(-1.0, np.log(80.0)))
    return np.array(
        [
            log_tau,
            draw(st.floats(1.0, 25.0)),
            draw(st.floats(-1.0, np.log(80.0))),
            draw(st.floats(0.05, 8.0)),
            draw(st.floats(0.0, 1.0)),
            draw(st.floats(-0.999, 0.999)),
            draw(st.floats(0.0, 0.6)),
            draw(st.floats(0.0, 1.0)),
        ]
    )


@settings(deadline=None)  # the first call compiles
@given(seed=SEEDS, candidate=candidates(), structure=STRUCTURES)
def test_the_response_is_the_filtered_and_shifted_valve(seed, candidate, structure):
    position = np.cumsum(np.random.default_rng(seed).standard_normal(150))
    fast = objective.process_response(position, candidate, structure)
    twin = slow.process_response(position, candidate, structure)
    np.testing.assert_allclose(fast, twin, rtol=0, atol=1e-9)


@pytest.mark.parametrize("delay", [1.0, 3.0, 3.25])
def test_pv_follows_first_after_the_delay(delay):
    position = np.where(np.arange(20) < 5, 0.0, 1.0)
    candidate = np.array([np.log(2.0), delay, 0.0, 0.0, 0.0, 0.0, *HE])
    response = objective.process_response(position, candidate, FOPDT)
    assert np.flatnonzero(np.diff(response) > 1e-12)[0] + 1 == 5 + int(delay)


@settings(max_examples=60, deadline=None)
@given(
    seed=SEEDS,
    candidate=candidates(),
    structure=STRUCTURES,
    acting=st.sampled_from(["reverse", "direct", None]),
    gaps=st.booleans(),
)
def test_the_error_is_that_of_least_squares(seed, candidate, structure, acting, gaps):
    problem = problem_of(seed, acting, gaps=gaps)
    assume(candidate[S] < 0.5 * problem.op_span)  # else the valve may never move, and nothing is a regressor
    response = objective.process_response(objective.valve_position(candidate, problem), candidate, structure)
    error, gain, startup = objective.fit_gain(response, candidate, structure, problem)
    slow_error, slow_gain, slow_startup = slow.fit_gain(response, candidate, structure, problem)
    total = np.sum(problem.pv**2)
    assert error == pytest.approx(slow_error, abs=1e-6 * total)
    assert gain == pytest.approx(slow_gain, rel=1e-4, abs=1e-6)
    if structure != INTEGRATOR:
        assert startup == pytest.approx(slow_startup, rel=1e-3, abs=1e-3)
    assert objective.free_run_error(candidate, structure, problem) == pytest.approx(
        slow.free_run_error(candidate, structure, problem), abs=1e-6 * total
    )


@pytest.mark.parametrize(
    ("axis", "value"),
    [
        (DELAY, 0.9),
        (DELAY, 1e3),
        (LOG_TAU, -2.0),
        (LOG_TAU, 20.0),
        (S, -0.1),
        (S, 1e3),
        (objective.J_RATIO, -0.1),
        (objective.J_RATIO, 1.1),
        (objective.START, 1.0),
        (objective.START, -1.0),
        (objective.LAG, -0.1),
        (objective.LAG, 0.7),
        (objective.REST, -0.1),
        (objective.REST, 1.1),
    ],
)
def test_out_of_bounds_is_infinitely_bad(axis, value):
    problem = problem_of(1)
    candidate = np.array([1.0, 4.0, 0.0, 1.0, 0.5, 0.0, *HE])
    assert np.isfinite(objective.free_run_error(candidate, FOPDT, problem))
    candidate[axis] = value
    assert objective.free_run_error(candidate, FOPDT, problem) == np.inf


@settings(max_examples=25, deadline=None)
@given(seed=SEEDS, pole=st.floats(0.2, 0.99))
def test_backward_sums_are_the_double_sum(seed, pole):
    pv = np.random.default_rng(seed).standard_normal(40)
    np.testing.assert_allclose(
        coarse_grid.backward_sums(pv, pole), slow.backward_sums(pv, pole), rtol=0, atol=1e-10
    )


@settings(max_examples=12, deadline=None)
@given(seed=SEEDS, law=LAWS, acting=st.sampled_from(["reverse", "direct", None]), share=st.floats(0.02, 0.6))
def test_the_bank_scores_as_least_squares_on_its_regressors(seed, law, acting, share):
    problem = problem_of(seed, acting)
    s_values = np.array([share, 1.3 * share]) * problem.op_span
    fast, places = coarse_grid.score_grid(problem, law, s_values, TAUS, DELAYS)
    twin, twin_places = slow.scan_scores(
        problem.op,
        problem.pv,
        problem.gain_sign,
        law,
        s_values,
        coarse_grid.J_RATIOS,
        coarse_grid.STARTS,
        TAUS,
        DELAYS,
    )
    np.testing.assert_allclose(fast, twin, rtol=0, atol=1e-6)
    alike = (places == twin_places) | (fast == 0)
    assert alike.mean() > 0.98, "two places of the bank may tie, but not often"


def test_the_comparison_above_sees_scores():
    problem = problem_of(3)
    scores, _ = coarse_grid.score_grid(problem, HE, np.array([0.1, 0.3]) * problem.op_span, TAUS, DELAYS)
    assert scores.max() > 0.5
    assert (scores > 0).sum() > 40


def start_of(problem, seed):
    random = np.random.default_rng(seed)
    s = random.uniform(0.05, 0.3) * problem.op_span
    return np.array([np.log(8.0), random.uniform(1, 6), np.log(2.0), s, 0.5, 0.0, *HE])


@settings(max_examples=15, deadline=None)
@given(seed=SEEDS, structure=st.sampled_from([FOPDT, SOPDT]))
def test_the_simplex_comes_as_far_as_scipys(seed, structure):
    problem = problem_of(seed)
    start = start_of(problem, seed)
    axes = np.array([LOG_TAU, DELAY] if structure == FOPDT else [LOG_TAU, DELAY, LOG_TAU2])
    step = np.array([0.5, 1.5, 0.5, 0.0, 0.0, 0.0, 0.0, 0.0])
    found, error = local_search.simplex(start, step, axes, structure, problem, 400)

    def objective_along_axes(x):
        candidate = start.copy()
        candidate[axes] = x
        return objective.free_run_error(candidate, structure, problem)

    theirs = minimize(
        objective_along_axes,
        start[axes],
        method="Nelder-Mead",
        options={
            "initial_simplex": np.vstack([start[axes], start[axes] + np.diag(step[axes])]),
            "maxfev": 400,
        },
    )
    assert error == objective.free_run_error(found, structure, problem)
    assert error <= objective.free_run_error(start, structure, problem)
    assert error == pytest.approx(theirs.fun, rel=0.02)
    np.testing.assert_allclose(np.delete(found, axes), np.delete(start, axes), rtol=1e-9)


@settings(max_examples=15, deadline=None)
@given(seed=SEEDS)
def test_random_steps_never_lose_and_never_leave_the_bounds(seed):
    problem = problem_of(seed)
    start = start_of(problem, seed)
    before = objective.free_run_error(start, FOPDT, problem)
    found, error = local_search.random_steps(
        start, before, 1.0, FOPDT, problem, 200, np.random.default_rng(seed)
    )
    again, _ = local_search.random_steps(start, before, 1.0, FOPDT, problem, 200, np.random.default_rng(seed))
    assert np.isfinite(error)
    assert error == objective.free_run_error(found, FOPDT, problem)
    assert error <= before
    np.testing.assert_array_equal(found, again)


def test_random_steps_find_a_needle_that_is_near():
    """The record is the model itself; S starts 2 % of the span beside the truth."""
    n = 400
    op = 5 * np.sin(np.arange(n) / 9) + 0.2 * np.cumsum(np.random.default_rng(2).standard_normal(n))
    truth = np.array([np.log(6.0), 3.0, 0.0, 3.0, 0.4, 0.3, *HE])
    pv = slow.process_response(slow.valve_position(truth, op), truth, FOPDT)
    problem = pose(LoopWindow("FIC1", 0.0, 1.0, op, pv, hints=LoopHints(acting="reverse")))
    start = truth.copy()
    start[S] += 0.02 * problem.op_span
    before = objective.free_run_error(start, FOPDT, problem)
    tries = [
        local_search.random_steps(start, before, 1.0, FOPDT, problem, 400, np.random.default_rng(seed))
        for seed in range(12)
    ]
    found, error = min(tries, key=lambda one: one[1])
    assert error < 1e-3 * before
    assert found[S] == pytest.approx(3.0, abs=0.01)
    assert np.median([each for _, each in tries]) < 0.3 * before
