"""The valve of He and Wang: overshoot, and He's valve without it."""

import numpy as np
import pytest

from agent.physics.valves.he2007 import he2007
from agent.physics.valves.he_wang2014 import he_wang2014
from agent.physics.valves.stenman2003 import stenman2003

T = np.arange(1000)
WAVE = 10 * np.sin(2 * np.pi * T / 300)


def test_the_slip_jump_is_nearly_twice_that_of_he():
    ramp = np.arange(0, 6, 0.001)
    assert np.ptp(he_wang2014(ramp, 5.0, 2.0, 0.0)) == pytest.approx(1.99 * 3, abs=0.01)


def test_without_overshoot_it_is_hes_valve():
    np.testing.assert_allclose(
        he_wang2014(WAVE, 5.0, 2.0, 0.0, 1.0), he2007(WAVE, 5.0, 2.0, 0.0), rtol=0, atol=1e-12
    )


def test_without_overshoot_and_kinetic_friction_it_is_stenmans():
    np.testing.assert_allclose(
        he_wang2014(WAVE, 5.0, 0.0, 0.0, 1.0), stenman2003(WAVE, 5.0, 0.0), rtol=0, atol=1e-12
    )


def test_it_swings_about_a_held_op_while_the_force_exceeds_static_friction():
    position = he_wang2014(np.full(1000, 60.0), 5.0, 2.0, 0.0)
    assert position[0] > 60 + 5
    assert position[1] < 60 - 5
    assert np.abs(60 - position[-1]) <= 5
