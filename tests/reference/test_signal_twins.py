"""The compiled waves and steps against cosines and exponentials, one sample after the other."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from agent.physics.signals.steps import lagged_steps
from agent.physics.signals.waves import waves


@settings(deadline=None)  # the first call compiles
@given(st.floats(-100, 100), st.floats(0, 3), st.integers(0, 200), st.integers(1, 5))
def test_waves_are_cosines_and_sines(first, step, count, harmonics):
    expected = [
        [function(multiple * (first + step * i)) for i in range(count)]
        for multiple in range(1, harmonics + 1)
        for function in (math.cos, math.sin)
    ]
    found = waves(first, step, count, harmonics)
    assert found.shape == (2 * harmonics, count)
    np.testing.assert_allclose(found, np.array(expected), rtol=0, atol=1e-11)


@settings(deadline=None)
@given(
    st.lists(st.floats(-10, 300), max_size=4), st.one_of(st.just(0.0), st.floats(1e-3, 1e4)), st.floats(0, 9)
)
def test_steps_come_after_their_instants_behind_the_lag(instants, tau, start):
    time = start + 1.5 * np.arange(150)

    def height(since):
        if since <= 0.0:
            return 0.0
        return -math.expm1(-since / tau) if tau else 1.0

    expected = np.array([[height(each - instant) for each in time.tolist()] for instant in instants])
    found = lagged_steps(time, np.array(instants), tau)
    np.testing.assert_allclose(found, expected.reshape(len(instants), 150), rtol=0, atol=1e-12)


@pytest.mark.parametrize("count", [0, 1])
def test_a_record_of_no_length_has_no_more(count):
    assert lagged_steps(np.zeros(count), np.array([-1.0]), 5.0).shape == (1, count)
