"""Acceptance tests of reference methods.md 1.5, and the test vectors of its section 9."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from agent.physics.valves.he2007 import he2007
from agent.physics.valves.two_state import two_state

F_S, F_D = 5.0, 2.0
T = np.arange(3000)
TRIANGLE = 10 * (2 / np.pi) * np.arcsin(np.sin(2 * np.pi * T / 500))
NOISY_SINE = np.sin(2 * np.pi * T / 300) + 0.05 * np.random.default_rng(0).standard_normal(T.size)


def move(*op, x0=0.0):
    return two_state(np.array(op, dtype=float), F_S, F_D, x0).tolist()


def test_a_step_up_to_f_s_does_not_move():
    assert move(0, 4.9, 4.9) == [0, 0, 0]
    assert move(0, 5, -5) == [0, 0, 0]


def test_steps_accumulate():
    assert move(0, 2, 4, 6) == [0, 0, 0, 4]


def test_a_ramp_slides_at_f_d_where_hes_valve_goes_in_jumps():
    ramp = np.arange(20.0)
    assert move(*ramp) == [*[0.0] * 6, *(ramp[6:] - F_D)]
    assert np.count_nonzero(np.diff(he2007(ramp, F_S, F_D, 0.0))) < 7


def test_it_rests_when_op_stops_and_needs_f_s_again():
    # at 4 under OP 6; OP stops, then goes on: the force must pass f_S once more
    assert move(0, 6, 6, 8, 9, 9.1) == [0, 4, 4, 4, 4, pytest.approx(7.1)]


def test_a_reversal_needs_f_s_and_f_d_of_op():
    assert move(0, 10, 10 - 6.9) == [0, 8, 8]
    assert move(0, 10, 10 - 7.1) == [0, 8, pytest.approx(4.9)]


def test_a_stroke_the_other_way_may_follow_in_the_next_sample():
    assert move(0, 10, -10, 10) == [0, 8, -8, 8]


def test_a_missing_op_brings_it_to_rest():
    assert move(0, 6, np.nan, 7, 9.1) == [0, 4, 4, 4, pytest.approx(7.1)]


def test_a_missing_first_op_holds_the_start():
    assert move(np.nan, 3, 6, x0=1.0) == [1, 1, 1]
    assert move(np.nan, 3, 7, x0=1.0) == [1, 1, 5]


def test_the_triangle_is_stroked_from_minus_8_to_8():
    position = two_state(TRIANGLE, F_S, F_D, 0.0)[500:]
    assert (position.min(), position.max()) == (pytest.approx(-8.0), pytest.approx(8.0))


def test_a_swing_below_f_s_moves_nothing():
    assert np.ptp(two_state(3 * NOISY_SINE, F_S, F_D, 0.0)) == 0


def test_without_friction_it_follows_op():
    np.testing.assert_array_equal(two_state(NOISY_SINE, 0.0, 0.0, NOISY_SINE[0]), NOISY_SINE)


@settings(deadline=None)  # the first call compiles
@given(
    seed=st.integers(0, 2**32 - 1),
    share=st.floats(0, 1),
    start=st.floats(-1, 1),
    amplitude=st.floats(0.01, 20),
)
def test_the_force_never_exceeds_f_s_and_a_still_op_leaves_the_stem_alone(seed, share, start, amplitude):
    op = amplitude * np.cumsum(np.random.default_rng(seed).standard_normal(200))
    op[100:150] = op[99]
    position = two_state(op, F_S, F_S * share, op[0] - start * F_S)
    assert np.abs(op - position).max() <= F_S + 1e-9
    assert np.ptp(position[99:150]) == 0


@settings(deadline=None)
@given(seed=st.integers(0, 2**32 - 1), start=st.floats(-1, 1))
def test_up_and_down_are_alike(seed, start):
    op = np.cumsum(np.random.default_rng(seed).standard_normal(200))
    up = two_state(op, F_S, F_D, op[0] - start * F_S)
    down = two_state(-op, F_S, F_D, -op[0] + start * F_S)
    np.testing.assert_array_equal(up, -down)
