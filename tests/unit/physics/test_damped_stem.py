"""A damped stem against the bench tests of a valve (reference methods.md 1.5, after ISA-75.25)."""

import math

import numpy as np
import pytest

from agent.physics.valves.damped_stem import damped_stem, damped_stem_by_direction

F_S, F_D = 5.0, 2.0
DAMPING, SUPPLY, REST = 0.6, 0.001, 0.1
KEEPS = math.exp(-1 / DAMPING)  # of the way that is left, in a sample
STOPS = F_D + REST * (F_S - F_D)
ROUGHLY = 0.01  # OP units; the air is not quite at once there


def stem(op, x0=0.0, damping=DAMPING, supply=SUPPLY, rest=REST):
    return damped_stem(np.array(op, dtype=float), F_S, F_D, x0, damping, supply, rest)


def test_a_step_below_static_friction_moves_nothing_and_steps_add_up():
    assert stem([4.9, 4.9]).tolist() == [0.0, 0.0]
    assert stem([3.0, 6.0])[-1] > 0


def test_a_slip_leaves_a_part_of_its_way_in_the_mean_of_each_sample():
    way = 10.0 - F_D
    expected = [way * (1 - DAMPING * KEEPS**before * (1 - KEEPS)) for before in (0, 1, 2)]
    assert stem([10.0] * 3, rest=0.0) == pytest.approx(expected, abs=ROUGHLY)


def test_a_stem_stops_where_the_force_has_fallen_to_that_of_rest():
    position = stem([10.0] * 30)
    assert np.ptp(position[5:]) == 0
    assert 10.0 - position[-1] == pytest.approx(STOPS, abs=ROUGHLY)


def test_slow_air_delays_break_away():
    position = stem([0.0, 6.0, 6.0], supply=1.0)  # the force is 3.8, then 5.2
    assert position[1] == 0
    assert 0 < position[2] < F_S - F_D


def test_the_way_within_a_sample_is_shorter_the_later_the_air():
    moved = [stem([0.0, 8.0], supply=supply)[-1] for supply in (0.01, 0.1, 0.3, 0.6)]
    assert moved == sorted(moved, reverse=True)
    assert len(set(moved)) == 4


def test_a_fast_ramp_slides_at_the_distance_of_kinetic_friction_and_damping():
    slope = 2.0
    op = slope * np.arange(100)
    position = stem(op)
    assert op[-1] - position[-1] == pytest.approx(F_D + slope * DAMPING, abs=ROUGHLY)
    assert np.all(np.diff(position)[20:] > 0)


def test_a_slow_ramp_sticks_and_slips():
    op = 0.3 * np.arange(200)
    still = np.diff(stem(op)) == 0
    assert 0.5 < still.mean() < 1


def test_a_stem_that_moves_goes_on_without_breaking_away_again():
    onward = [6.0, 6.5, 7.0]
    sliding, resting = stem(onward, rest=0.0), stem(onward, rest=0.5)
    assert np.all(np.diff(sliding) > 0)
    assert resting[0] < resting[1] == resting[2]


def test_a_reversal_needs_both_frictions_less_what_rest_left():
    turn = F_S + STOPS
    for back, moves in ((turn - 0.3, False), (turn + 0.3, True)):
        op = np.concatenate([np.full(20, 20.0), 20 - np.linspace(0, back, 30)])
        position = stem(op)
        assert bool(position[-1] < position[19]) is moves


def test_equal_time_constants_are_the_limit_of_nearly_equal_ones():
    op = 10 * np.sin(np.arange(100) / 5)
    equal, nearly = stem(op, supply=DAMPING), stem(op, supply=DAMPING * 1.0001)
    np.testing.assert_allclose(equal, nearly, rtol=0, atol=ROUGHLY)
    assert np.ptp(equal) > 5


def test_a_turn_takes_a_sample_to_rest_and_breaks_away_in_the_next():
    position = stem([10.0, 12.0, 14.0, 0.0, 0.0])
    assert position[3] > position[2]  # where it was at the end of its way up
    assert position[4] < position[3] - 4


def test_no_friction_and_hardly_a_lag_follow_a_rising_command():
    op = np.cumsum(np.random.default_rng(1).random(50))
    position = damped_stem(op, 0.0, 0.0, op[0], 0.01, 0.01, 0.0)
    np.testing.assert_allclose(position, op, rtol=0, atol=1e-9)


def test_the_same_force_is_left_at_rest_in_both_directions():
    """Damping at low speed makes it, so that the smaller jump has as much of it."""
    f_s_up, f_s_down = 3.0, 9.0
    op = np.repeat([0.0, f_s_up + 0.1, -f_s_down], 30)
    position = damped_stem_by_direction(op, f_s_up, f_s_down, F_D, 0.0, DAMPING, SUPPLY, REST)
    up, down = op[59] - position[59], position[-1] - op[-1]
    assert position[59] > 0
    assert position[-1] < position[59]
    assert up == pytest.approx(F_D + REST * (f_s_down - F_D), abs=ROUGHLY)
    assert down == pytest.approx(up, abs=2 * ROUGHLY)


def test_a_jump_smaller_than_what_is_left_at_rest_is_none():
    op = np.repeat([0.0, F_D + 0.3], 30)
    position = damped_stem_by_direction(op, F_D + 0.2, 60.0, F_D, 0.0, DAMPING, SUPPLY, REST)
    assert position[-1] == pytest.approx(0.1, abs=ROUGHLY)
