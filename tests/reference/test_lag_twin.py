import math

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.signal import lfilter

from agent.physics.processes.lag import lag_of_lines


def by_filter(signal, level, tau, delay):
    """Return the same by numpy's interpolation and scipy's filter of the first-order-hold equivalent."""
    time = np.arange(float(len(signal)))
    late = np.interp(time - delay, time, signal)
    if tau > 0:
        keep = math.exp(-1 / tau)
        mean = tau * (1 - keep)
        late = late[0] + lfilter([1 - mean, mean - keep], [1, -keep], late - late[0])
    return late - level


@settings(deadline=None)  # the first call compiles
@given(
    seed=st.integers(0, 2**32 - 1),
    tau=st.one_of(st.sampled_from([0.0, -1.0]), st.floats(0.01, 300)),
    delay=st.one_of(st.integers(0, 60).map(float), st.floats(0, 60)),
    level=st.floats(-10, 10),
)
def test_the_kernel_is_an_interpolation_and_a_filter(seed, tau, delay, level):
    signal = np.random.default_rng(seed).standard_normal(50).cumsum()
    out = np.empty_like(signal)
    lag_of_lines(signal, level, tau, delay, out)
    np.testing.assert_allclose(out, by_filter(signal, level, tau, delay), rtol=0, atol=1e-11)
