"""Turning points of OP that its noise cannot explain: where a valve that sticks shows it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray

NOISES = 4.0
"""Standard deviations of OP's noise that a swing must exceed to count."""
PART_OF_SPAN = 0.1
"""Part of OP's span that a swing must exceed to count."""


def op_noise(op: FloatArray) -> float:
    """Return the standard deviation of the noise of ``op`` (n,), n >= 2, no NaN.

    It comes out too large where OP never rests. The median of the steps sees the noise and not the jumps;
    1.4826 makes it a standard deviation.
    """
    return 1.4826 * float(np.median(np.abs(np.diff(op)))) / math.sqrt(2)


def significant_reversals(op: FloatArray) -> int:
    """Count the turning points of ``op`` (n,) that its noise cannot explain; NaN is left out."""
    finite = op[np.isfinite(op)]
    if finite.size < 3:
        return 0
    least = max(NOISES * op_noise(finite), PART_OF_SPAN * float(np.ptp(finite)))
    if least == 0:
        return 0
    reversals, rising, extreme = 0, None, float(finite[0])
    low = high = extreme
    for value in finite.tolist():
        if rising is None:
            low, high = min(low, value), max(high, value)
            if high - low > least:
                rising, extreme = value == high, value
        elif (value > extreme) == rising:
            extreme = value if value != extreme else extreme
        elif abs(value - extreme) > least:
            reversals, rising, extreme = reversals + 1, not rising, value
    return reversals
