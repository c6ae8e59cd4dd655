"""Every kernel of ``free_run`` against its slow twin, on loops whose valve sticks a little."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.signal import lfilter

from agent.analysis.innovations import load_wave, local_search
from agent.analysis.quantify.free_run.problem import pose
from agent.analysis.record.recording import LoopHints, LoopWindow
from agent.identify import bank as banks
from agent.identify import bank_score as scores
from agent.identify import objective
from agent.identify.first_slip import first_slip
from agent.identify.free_run_error import free_run_error, free_run_errors, response_to
from agent.identify.objective import (
    BRISTLES,
    DELAY,
    FIRST,
    FOPDT,
    INTEGRATOR,
    J_RATIO,
    LEVEL,
    LOG_DAMPING,
    LOG_TAU,
    LOG_TAU2,
    RIGID,
    SOPDT,
    S,
)
from agent.identify.problem import high_pass
from agent.identify.search import grid
from agent.identify.search.grid import STEMS
from agent.identify.simplex import STEP, simplex
from agent.physics.valves.damped_stem import damped_stem
from tests.reference import free_run_twins as slow
from tests.reference.damped_stem_branches import damped_stem_in_small_steps

SEEDS = st.integers(0, 2**32 - 1)
STRUCTURES = st.sampled_from([FOPDT, SOPDT, INTEGRATOR])
ACTING = st.sampled_from(["reverse", "direct", None])
FEW = settings(max_examples=20, deadline=None)  # the first call compiles
DELAYS = np.arange(1, 7)


def problem_of(seed, acting=None, slowness=8, n=480):
    """OP swings and wanders; a valve between OP and PV sticks; PV is noisy and drifts."""
    random = np.random.default_rng(seed)
    op = 5 * np.sin(np.arange(n) / slowness) + 0.1 * np.cumsum(random.standard_normal(n))
    f_s = random.uniform(0.5, 2.0)
    position = damped_stem(op, f_s, 0.5 * f_s, op[0], 0.15, 0.1, 0.003)
    lagged = slow.first_order(position - position[0], random.uniform(2, 20))
    pv = 80 + 1.5 * np.roll(lagged, 3) + 0.01 * np.arange(n) + 0.2 * random.standard_normal(n)
    return pose(LoopWindow("FIC1", 0.0, 1.0, op, pv, hints=LoopHints(acting=acting)))


def candidate_of(seed, problem):
    random = np.random.default_rng(seed)
    taus = random.uniform(0.0, 3.0, 2)
    s = random.uniform(0.05, 0.3) * problem.op_span
    stem = np.log(STEMS[random.integers(len(STEMS))])
    process = taus[0], random.uniform(1, 8), taus[1]
    valve = s, random.random(), problem.op[0], *stem, 1.0
    bristles = random.choice([0.0, 0.2]) if stem[2] > RIGID else 0.0
    return np.array([*process, *valve, bristles])


@FEW
@given(seed=SEEDS, structure=STRUCTURES, block=st.integers(1, 5), keep=st.floats(0.8, 1.0))
def test_the_response_is_the_averaged_filtered_and_shifted_valve(seed, structure, block, keep):
    position = np.cumsum(np.random.default_rng(seed).standard_normal(151))
    candidate = candidate_of(seed, problem_of(1))
    np.testing.assert_allclose(
        objective.process_response(position, candidate, structure, block, keep),
        slow.process_response(position, candidate, structure, block, keep),
        atol=1e-8,
    )


@FEW
@given(seed=SEEDS, structure=STRUCTURES)
def test_behind_an_autoregression_the_response_is_less_what_its_past_predicts(seed, structure):
    problem = problem_of(seed)._replace(whitening=np.array([0.9, -0.3, 0.05]))
    candidate = candidate_of(seed, problem)
    plain = objective.process_response(problem.op, candidate, structure, problem.block, problem.keep)
    found = response_to(problem.op, candidate, structure, problem)
    np.testing.assert_allclose(found, lfilter([1.0, -0.9, 0.3, -0.05], [1.0], plain), atol=1e-10)


@pytest.mark.parametrize("direction", [-1.0, 1.0])
def test_the_stem_first_slips_where_op_passes_the_level(direction):
    upward = problem_of(1)
    problem = upward._replace(op=direction * upward.op)
    stem = (0.3, 0.15, 0.01)
    candidate = candidate_of(1, problem)
    candidate[[S, J_RATIO, LEVEL, FIRST]] = 3.0, 0.5, problem.op[0] + 2.0 * direction, direction
    candidate[LOG_DAMPING : LOG_DAMPING + 3], candidate[BRISTLES] = np.log(stem), 0.0
    position = objective.valve_position(candidate, problem)
    x0 = candidate[LEVEL] - direction * 2.25
    by_hand = damped_stem_in_small_steps(problem.op, 2.25, 0.75, x0, *stem, steps=200)
    assert np.median(np.abs(position - by_hand)) < 0.02
    slipped = np.flatnonzero(position != position[0])[0]
    passed = np.flatnonzero(direction * (problem.op - candidate[LEVEL]) > 0)[0]
    assert slipped - passed in {0, 1}  # air comes late
    assert np.sign(position[slipped] - position[0]) == direction


def test_without_stiction_the_stem_is_op():
    problem = problem_of(1)
    candidate = candidate_of(1, problem)
    candidate[S] = 0.0
    np.testing.assert_array_equal(objective.valve_position(candidate, problem), problem.op)


@FEW
@given(seed=SEEDS, s=st.floats(0.5, 12.0), share=st.floats(0.0, 1.0))
def test_the_first_slip_is_at_the_end_of_the_band_that_is_passed_first(seed, s, share):
    op = problem_of(seed).op
    up = op.min() + s + share * (np.ptp(op) - s)
    assert first_slip(op, s, up) == slow.first_slip(op, s, up)


@FEW
@given(seed=SEEDS, structure=STRUCTURES, acting=ACTING, slowness=st.sampled_from([8, 30]), wave=st.booleans())
def test_the_error_is_that_of_least_squares(seed, structure, acting, slowness, wave):
    """With a wave of the load as well, which goes at the rhythm of OP."""
    problem = problem_of(seed, acting, slowness)
    if wave:
        problem = load_wave.beside_wave(problem, problem.block / (2 * np.pi * slowness))
    candidate = candidate_of(seed, problem)
    position = objective.valve_position(candidate, problem)
    response = objective.process_response(position, candidate, structure, problem.block, problem.keep)
    error, gain, _ = objective.fit_gain(response, candidate, structure, problem)
    slow_error, slow_gain = slow.fit_gain(response, candidate, structure, problem)
    assert error == pytest.approx(slow_error, abs=1e-6 * np.sum(problem.pv**2))
    assert gain == pytest.approx(slow_gain, rel=1e-4, abs=1e-6)
    assert free_run_error(candidate, structure, problem) == pytest.approx(error, rel=1e-9)


@pytest.mark.parametrize(
    ("axis", "value"),
    [(DELAY, 0.9), (DELAY, 1e3), (LOG_TAU, -2.0), (LOG_TAU, 20.0), (S, -0.1), (S, 1e3)],
)
def test_out_of_bounds_is_infinitely_bad(axis, value):
    problem = problem_of(1)
    candidate = candidate_of(1, problem)
    assert np.isfinite(free_run_error(candidate, FOPDT, problem))
    candidate[axis] = value
    assert free_run_error(candidate, FOPDT, problem) == np.inf


def test_a_second_lag_that_vanishes_is_none():
    problem = problem_of(1)
    candidate = candidate_of(1, problem)
    alone = free_run_error(candidate, FOPDT, problem)
    candidate[LOG_TAU2] = -1000.0  # as far as a simplex may run
    assert free_run_error(candidate, SOPDT, problem) == pytest.approx(alone)


@FEW
@given(seed=SEEDS, keep=st.floats(0.5, 0.999))
def test_the_adjoint_is_the_transpose(seed, keep):
    a, b = np.random.default_rng(seed).standard_normal((2, 60))
    np.testing.assert_allclose(high_pass(a, keep), slow.high_pass(a, keep), atol=1e-10)
    assert banks.adjoint_high_pass(b, keep) @ a == pytest.approx(b @ slow.high_pass(a, keep), abs=1e-9)


@FEW
@given(seed=SEEDS, pole=st.floats(0.2, 1.0), second=st.floats(0.0, 0.9))
def test_backward_sums_are_the_double_sum(seed, pole, second):
    signal = np.random.default_rng(seed).standard_normal(40)
    sums = np.zeros((44, 1))
    banks.backward_sums(signal, np.array([pole]), np.array([second]), np.array([0.3]), sums)
    np.testing.assert_allclose(sums[:40, 0], slow.backward_sums(signal, pole, second, 0.3), atol=1e-8)


@FEW
@given(seed=SEEDS, acting=ACTING, slowness=st.sampled_from([8, 30]))
def test_the_bank_scores_as_least_squares_on_its_regressors(seed, acting, slowness):
    problem = problem_of(seed, acting, slowness)
    near = banks.bank(problem, np.array([2.0, 9.0, np.inf]), np.array([0.0, 0.5, 0.0]), 10.0)
    m = near.op.size // near.block
    op = near.op.copy()
    op[: near.block] = op[0]  # a stem that moves before the record's first mean is known to neither
    means, at, by = np.empty(m), np.empty(m, np.int64), np.empty(m)
    moves = scores.moves_of(damped_stem(op, 1.0, 0.5, op[0], 0.01, 0.01, 1e-8), near.block, means, at, by)
    assert np.sum(by[:moves]) == pytest.approx(means[-1])
    room = scores.room_for(near, DELAYS)
    scores.response_sums(means, near, DELAYS, room.response)
    scores.covariances(at, by, moves, room.delayed, room.covariance)
    response = room.response[:, :, :3]
    assert not room.response[:, :, 3:].any()  # the group is filled up
    late = np.array([[slow.bank_response(means, d, i, near) for i in range(3)] for d in DELAYS])
    np.testing.assert_allclose(response[0], late[:, :, near.burn :].sum(axis=2), rtol=1e-6, atol=1e-6)
    np.testing.assert_allclose(response[1], (late[:, :, near.burn :] ** 2).sum(axis=2), rtol=1e-6)
    fits = [[slow.bank_share(one, problem.pv[:m], near) for one in row] for row in late]
    shares = np.array([[f[0] if f[1] * near.gain_sign >= 0 else 0.0 for f in row] for row in fits])
    best, q, i = scores.best_process(room.response, room.covariance.reshape(6, -1), room.fading, near)
    assert best == pytest.approx(shares.max(), abs=1e-6)
    assert best == pytest.approx(shares[q, i], abs=1e-6)


@pytest.mark.parametrize("acting", ["reverse", None])
@pytest.mark.parametrize("seed", [3, 4])
def test_the_scan_keeps_the_best_first_slip_of_each_cell(seed, acting):
    problem = problem_of(seed, acting)
    near = banks.bank(problem, np.array([4.0, np.inf]), np.array([0.0, 0.5]), 4.0)
    s_values, j_ratios = np.array([0.1, 0.3, 1.0]) * problem.op_span, np.array([0.0, 0.6])
    delays, step = np.array([1, 3, 6]), 0.06 * problem.op_span
    scores, places, levels = grid.scan(near, STEMS[:1], s_values, j_ratios, step, delays)
    pv = problem.pv[: len(near.op) // near.block]
    for i, s in enumerate(s_values):
        for j, ratio in enumerate(j_ratios):
            valve = s * (1 + ratio) / 2, s * (1 - ratio) / 2
            share, place, level = slow.best_of_cell(near, pv, valve, STEMS[0], step, delays)
            assert scores[0, i, j] == pytest.approx(share, abs=1e-6)
            if share > 0:
                assert (places[0, i, j], levels[0, i, j]) == (place, pytest.approx(level))


@pytest.mark.parametrize("seed", range(6))
def test_searches_never_lose_and_repeat_themselves(seed):
    problem = problem_of(seed)
    start = candidate_of(seed, problem)
    before = free_run_error(start, FOPDT, problem)
    axes = np.array([LOG_TAU, DELAY, LOG_TAU2])
    runs = [
        lambda rng: local_search.random_steps(start, before, 1.0, FOPDT, problem, 150, rng),
        lambda _: simplex(start, STEP, axes, objective.valve_position(start, problem), SOPDT, problem, 150),
    ]
    for run, structure in zip(runs, (FOPDT, SOPDT), strict=True):
        found, error = run(np.random.default_rng(seed))
        again, _ = run(np.random.default_rng(seed))
        np.testing.assert_array_equal(found, again)
        assert error == pytest.approx(free_run_error(found, structure, problem), rel=1e-9)
        assert error <= free_run_error(start, structure, problem)


@pytest.mark.parametrize("structure", [FOPDT, SOPDT, INTEGRATOR])
def test_many_candidates_have_the_errors_of_each(structure):
    problem = problem_of(4)
    several = np.array([candidate_of(seed, problem) for seed in range(5)])
    np.testing.assert_array_equal(
        free_run_errors(several, structure, problem),
        [free_run_error(each, structure, problem) for each in several],
    )
