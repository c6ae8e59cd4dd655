"""The compiled filter of an autoregression against scipy's."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from scipy.signal import lfilter

from agent.identify.noise.prediction_filter import PART, unpredicted


@given(st.integers(0, 2**32 - 1), st.integers(1, 3 * PART), st.integers(1, 5), st.integers(0, 40))
def test_leaves_what_scipys_filter_leaves(seed: int, samples: int, series: int, lags: int) -> None:
    random = np.random.default_rng(seed)
    given, coefficients = random.standard_normal((series, samples)), random.standard_normal(lags)
    by_scipy = lfilter(np.concatenate(([1.0], -coefficients)), [1.0], given)
    assert np.allclose(unpredicted(given, coefficients), by_scipy, rtol=1e-10, atol=1e-10)


def test_a_gap_spreads_over_the_samples_that_would_need_it() -> None:
    series = np.ones((2, 20))
    series[0, 5] = np.nan
    left = unpredicted(series, np.array([0.5, 0.25, 0.0]))
    assert np.flatnonzero(np.isnan(left[0])).tolist() == [5, 6, 7, 8]
    assert np.isfinite(left[1]).all()
