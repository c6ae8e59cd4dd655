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


def noise_range(n: int) -> float:
    """Return the range that n samples of white noise span, in its standard deviations.

    The expected extreme of n normal samples is sqrt(2 ln n) at most (Gumbel,
    Statistics of Extremes, 1958, 4.2).
    """
    return 2 * math.sqrt(2 * math.log(max(n, 2)))


def noise_hides_reversals(op: FloatArray, noises: float = NOISES) -> bool:
    """Return whether ``op`` (n,), NaN left out, moves no farther than its noise may: none can be seen.

    So it is where OP moves from one sample to the next as far as in all: at few samples a period.
    """
    finite = op[np.isfinite(op)]
    return finite.size >= 3 and 0 < float(np.ptp(finite)) <= noises * op_noise(finite)


def moves_beyond_noise(op: FloatArray) -> bool:
    """Return whether ``op`` (n,), NaN left out, moves by at least as much as its noise spans, beside that."""
    finite = op[np.isfinite(op)]
    if finite.size < 3 or np.ptp(finite) == 0:
        return False
    return not noise_hides_reversals(finite, 2 * noise_range(finite.size))


def significant_reversals(op: FloatArray, noises: float = NOISES) -> int:
    """Count the turning points of ``op`` (n,) that its noise cannot explain; NaN is left out.

    Args:
        op: Controller output.
        noises: Standard deviations of the noise that a swing must exceed.
    """
    return len(reversal_places(op, noises))


def reversal_places(op: FloatArray, noises: float = NOISES) -> list[int]:
    """Return the samples at which ``op`` (n,) is seen to have turned beyond its noise; NaN is left out."""
    known = np.flatnonzero(np.isfinite(op))
    finite = op[known]
    if finite.size < 3:
        return []
    least = max(noises * op_noise(finite), PART_OF_SPAN * float(np.ptp(finite)))
    if least == 0:
        return []
    places: list[int] = []
    rising, extreme = None, float(finite[0])
    low = high = extreme
    for place, value in zip(known.tolist(), finite.tolist(), strict=True):
        if rising is None:
            low, high = min(low, value), max(high, value)
            if high - low > least:
                rising, extreme = value == high, value
        elif (value > extreme) == rising:
            extreme = value if value != extreme else extreme
        elif abs(value - extreme) > least:
            places.append(place)
            rising, extreme = not rising, value
    return places
