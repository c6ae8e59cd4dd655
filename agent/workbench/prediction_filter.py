"""The filter of an autoregression: each sample less what those before it predict."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from agent.jit import fused_kernel

FloatArray = NDArray[np.float64]
PART = 1024
"""Numbers that are filtered together: they stay in the processor's nearest memory for all lags."""


@fused_kernel
def unpredicted(columns: FloatArray, coefficients: FloatArray) -> FloatArray:
    """Return e(t) = y(t) - a_1 y(t-1) - ... - a_p y(t-p) of several series.

    Args:
        columns: y, (n, k), any unit, one series beside the other in memory; NaN spreads over the p next.
        coefficients: a, (p,).

    Returns:
        e, (n, k); before the first sample all were zero. scipy's lfilter goes through a series at a time in
        Python where a filter has no poles, and takes four times as long.
    """
    width = columns.shape[1]
    given = columns.ravel()
    left = given.copy()
    for start in range(0, len(given), PART):
        end = min(start + PART, len(given))
        for lag in range(len(coefficients)):
            weight, back = coefficients[lag], (lag + 1) * width
            first = max(start, back)
            now, before = left[first:end], given[first - back : end - back]
            for i in range(len(now)):
                now[i] -= weight * before[i]
    return left.reshape(columns.shape)
