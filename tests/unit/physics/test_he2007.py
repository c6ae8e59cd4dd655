"""Test vectors of reference methods.md, sections 1.5 and 9."""

import numpy as np
import pytest

from agent.physics.valves.he2007 import he2007

RANDOM = np.random.default_rng(0)
T = np.arange(3000)
NOISY_SINE = np.sin(2 * np.pi * T / 300) + 0.05 * RANDOM.standard_normal(T.size)


def test_a_force_of_f_s_holds_and_more_slips_until_f_d_is_left():
    op = np.array([0.0, 2.0, 5.0, 5.5, 5.5, 0.6, 0.4])
    assert he2007(op, 5.0, 2.0, 0.0).tolist() == [0.0, 0.0, 0.0, 3.5, 3.5, 3.5, 3.5]
    assert he2007(np.array([-1.6]), 5.0, 2.0, 3.5).tolist() == [pytest.approx(0.4)]


def test_a_valve_without_friction_follows_op():
    np.testing.assert_array_equal(he2007(NOISY_SINE, 0.0, 0.0, NOISY_SINE[0]), NOISY_SINE)


def test_a_swing_below_f_s_moves_nothing():
    assert np.ptp(he2007(3 * NOISY_SINE, 5.0, 2.0, 0.0)) == 0


def test_the_force_on_the_stem_never_exceeds_f_s():
    op = 10 * NOISY_SINE
    assert np.abs(op - he2007(op, 5.0, 2.0, op[0])).max() <= 5.0


def test_the_stroke_on_a_triangle_is_the_published_one():
    triangle = 10 * (2 / np.pi) * np.arcsin(np.sin(2 * np.pi * T / 500))
    position = he2007(triangle, 5.0, 2.0, 0.0)[500:]
    assert (position.min(), position.max()) == (pytest.approx(-6.08, abs=0.01), pytest.approx(6.08, abs=0.01))


def test_a_missing_op_holds_the_position_and_is_made_up_for_afterwards():
    position = he2007(np.array([0.0, 6.0, np.nan, np.nan, 20.0]), 5.0, 2.0, 0.0)
    assert position.tolist() == [0.0, 4.0, 4.0, 4.0, 18.0]
