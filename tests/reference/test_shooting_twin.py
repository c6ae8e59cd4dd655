"""The free run in shots against its slow twin, and what it is for."""

import numpy as np
import pytest
from agent.analysis.quantify.free_run.fitted import STEP
from agent.analysis.quantify.free_run.random_shots import random_shots
from agent.analysis.quantify.free_run.shooting import Aim, Shots, aim_by, shot_error, track_for
from hypothesis import given, settings
from hypothesis import strategies as st

from agent.analysis.quantify.free_run.problem import pose
from agent.analysis.record.recording import LoopWindow
from agent.identify.objective import (
    DELAY,
    FIRST,
    FOPDT,
    J_RATIO,
    LEVEL,
    LOG_DAMPING,
    LOG_TAU,
    SIZE,
    S,
    free_run_error,
)
from agent.physics.valves.damped_stem import damped_stem, stem_at, stem_motion, strokes
from tests.reference import free_run_twins as slow
from tests.reference.shooting_by_hand import Shooting
from tests.reference.test_free_run_twin import ACTING, FEW, SEEDS, STRUCTURES, candidate_of, problem_of

STEM = (0.3, 0.15, 0.01)
SHOTS = Shots(0.5, 4.0)


def aim_of(candidate, structure, problem, part):
    """What a first round is judged by: the free run, and a part of its mean square."""
    track = track_for(problem)
    error, _ = shot_error(candidate, structure, problem, Aim(problem.pv, 1.0, 0.0), SHOTS, track)
    return aim_by(track, candidate, structure, problem, part * error / problem.weight.sum()), track


@settings(max_examples=30, deadline=None)
@given(seed=SEEDS, cuts=st.lists(st.integers(1, 479), max_size=5), damping=st.sampled_from([0.01, 0.3]))
def test_a_stem_goes_on_where_it_was_left(seed, cuts, damping):
    op = problem_of(seed).op
    op[100:103] = np.nan
    stem = (damping, 0.15, 0.01)
    position, state, t = np.empty(len(op)), stem_at(op[0] - 0.3, op[0]), 0
    for cut in [*sorted(cuts), len(op)]:
        while t < cut:
            t = strokes(op, t, cut, state, (1.5, 1.5, 0.5), stem_motion(*stem), position, t)
            assert state[2] == 0 or t == cut  # at rest, or asked to stop
    np.testing.assert_array_equal(position, damped_stem(op, 1.5, 0.5, op[0] - 0.3, *stem))


@FEW
@given(seed=SEEDS, structure=STRUCTURES, acting=ACTING, slowness=st.sampled_from([8, 30]))
def test_without_a_set_off_stem_it_is_the_free_run(seed, structure, acting, slowness):
    problem = problem_of(seed, acting, slowness)
    candidate = candidate_of(seed, problem)
    aim, track = aim_of(candidate, structure, problem, 0.0)
    error, count = shot_error(candidate, structure, problem, aim, SHOTS, track)
    assert count == 0
    assert error == pytest.approx(free_run_error(candidate, structure, problem), rel=1e-6)


@settings(max_examples=12, deadline=None)
@given(seed=SEEDS, structure=STRUCTURES, slowness=st.sampled_from([8, 30]), part=st.floats(0.02, 1.0))
def test_shots_are_those_made_by_hand(seed, structure, slowness, part):
    problem = problem_of(seed, None, slowness, 300)
    candidate = candidate_of(seed, problem)
    aim, track = aim_of(candidate, structure, problem, part)
    error, count = shot_error(candidate, structure, problem, aim, SHOTS, track)
    response, by_hand = Shooting(candidate, structure, problem, aim, SHOTS).run()
    assert count == by_hand
    np.testing.assert_allclose(track.response, response, atol=1e-8)
    squares, _ = slow.fit_gain(response, candidate, structure, problem)
    expected = squares + SHOTS.price * aim.variance * count
    assert error == pytest.approx(expected, rel=1e-6, abs=1e-6 * np.sum(problem.pv**2))


def loop_whose_stem_rests_elsewhere_once(off=0.2):
    """A noisy loop and its true candidate; once amid the record the stem rests ``off`` S off."""
    random = np.random.default_rng(1)
    t = np.arange(600)
    op = 50 + 4 * np.sin(t / 8) + 1.5 * np.sin(t / 37) + 0.05 * random.standard_normal(len(t))
    s, j = 4.0, 3.9  # it jumps, and never finds back by itself
    f_s, f_d = (s + j) / 2, (s - j) / 2
    position, state = np.empty(len(op)), stem_at(op[0], op[0])
    rest = strokes(op, 0, len(op), state, (f_s, f_s, f_d), stem_motion(*STEM), position, 300)
    state[0] -= off * s
    strokes(op, rest, len(op), state, (f_s, f_s, f_d), stem_motion(*STEM), position, len(op))
    answer = 2 * slow.first_order(position - position[0], 12.0)
    pv = 80 + np.concatenate([np.zeros(3), answer[:-3]]) + 0.02 * random.standard_normal(len(t))
    problem = pose(LoopWindow("FIC1", 0.0, 1.0, op, pv))
    candidate = np.zeros(SIZE)
    candidate[[LOG_TAU, DELAY, S, J_RATIO, LEVEL, FIRST]] = np.log(12.0), 3.0, s, j / s, op[0] + f_s, 1.0
    candidate[LOG_DAMPING : LOG_DAMPING + 3] = np.log(STEM)
    return problem, candidate


def test_one_stem_that_rests_elsewhere_costs_one_shot():
    problem, candidate = loop_whose_stem_rests_elsewhere_once()
    free = free_run_error(candidate, FOPDT, problem)
    aim, track = aim_of(candidate, FOPDT, problem, 0.05)
    for _ in range(4):  # gain and level follow what is set off
        error, count = shot_error(candidate, FOPDT, problem, aim, SHOTS, track)
        aim = aim_by(track, candidate, FOPDT, problem, aim.variance)
    assert count == 1
    assert error - SHOTS.price * aim.variance < 0.1 * free


@pytest.mark.parametrize(("off", "within"), [(-0.1, 0.1), (0.03, 0.02)])
def test_the_search_by_shots_goes_back_and_repeats_itself(off, within):
    problem, candidate = loop_whose_stem_rests_elsewhere_once()
    start = candidate.copy()
    start[S] *= 1 + off
    axes = np.array([LOG_TAU, DELAY])
    found, error = random_shots(start, 0.4, STEP, axes, FOPDT, problem, SHOTS, 150, np.random.default_rng(0))
    again, _ = random_shots(start, 0.4, STEP, axes, FOPDT, problem, SHOTS, 150, np.random.default_rng(0))
    np.testing.assert_array_equal(found, again)
    assert error < 0.1 * free_run_error(start, FOPDT, problem)
    assert abs(found[S] / candidate[S] - 1) < within
