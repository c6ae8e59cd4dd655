"""A damped stem against the bench tests of a valve (reference methods.md 1.5, after ISA-75.25)."""

import numpy as np
import pytest

from agent.physics.valves.damped_stem import damped_stem

F_S, F_D, LAG, REST = 5.0, 2.0, 0.2, 0.5


def stem(op, x0=0.0, lag=LAG, rest=REST):
    return damped_stem(np.array(op, dtype=float), F_S, F_D, x0, lag, rest)


def test_a_step_below_static_friction_moves_nothing_and_steps_add_up():
    assert stem([4.9, 4.9]).tolist() == [0.0, 0.0]
    assert stem([3.0, 6.0])[-1] > 0


def test_a_slip_leaves_a_part_of_its_way_after_each_sample():
    way = 10.0 - F_D
    assert stem([10.0] * 3) == pytest.approx([way * (1 - 0.2), way * (1 - 0.04), way * (1 - 0.008)])


def test_a_constant_command_brings_it_to_rest():
    position = stem([10.0] * 30)
    assert np.ptp(position[5:]) == 0
    assert 10.0 - F_D - position[-1] < REST


def test_a_fast_ramp_slides_at_the_distance_of_kinetic_friction_and_lag():
    slope = 1.0
    op = slope * np.arange(100)
    lagging = op - stem(op)
    assert lagging[-1] == pytest.approx(F_D + slope * LAG / (1 - LAG))
    assert np.all(np.diff(stem(op))[20:] > 0)


def test_a_slow_ramp_sticks_and_slips():
    op = 0.3 * np.arange(200)  # slower than what counts as rest
    still = np.diff(stem(op)) == 0
    assert 0.5 < still.mean() < 1


def test_a_reversal_needs_both_frictions():
    up = np.linspace(0, 20, 21)
    for back, moves in ((F_S + F_D - 0.3, False), (F_S + F_D + 0.3, True)):
        op = np.concatenate([up, np.full(20, 20.0), 20 - np.linspace(0, back, 30)])
        position = stem(op, lag=0.0)
        assert bool(position[-1] < position[40]) is moves


def test_the_force_on_it_never_exceeds_static_friction_without_lag():
    op = 10 * np.sin(np.arange(800) / 30) + np.random.default_rng(0).standard_normal(800)
    assert np.abs(op - stem(op, x0=op[0], lag=0.0)).max() <= F_S


def test_no_friction_and_no_lag_follow_the_command():
    op = np.random.default_rng(1).standard_normal(50)
    np.testing.assert_array_equal(damped_stem(op, 0.0, 0.0, op[0], 0.0, 0.0), op)
