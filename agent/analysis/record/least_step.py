"""The smallest step of OP that a bump test can make and that a person can see."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray, LoopWindow

RESOLUTION = 0.001
"""Part of OP's range below which no step is made: the best positioners resolve so much."""
PER_CENT, FRACTION = (0.0, 100.0), (0.0, 1.0)
"""Ranges that OP has where nobody states one: per cent, or parts of one where it never exceeds that."""


def least_step(window: LoopWindow) -> float:
    """Return the larger of the resolution of OP and its own noise, OP units; 0 where neither is known."""
    op = window.op[np.isfinite(window.op)]
    if not op.size:
        return 0.0
    low, high = window.hints.op_range or usual_range(op)
    return max(RESOLUTION * (high - low), _noise(op))


def usual_range(op: FloatArray) -> tuple[float, float]:
    """Return the range that values of OP suggest, (0, 0) where they suggest none."""
    for low, high in (FRACTION, PER_CENT):
        if op.min() >= low and op.max() <= high:
            return low, high
    return 0.0, 0.0


def _noise(op: FloatArray) -> float:
    """Return the standard deviation of white noise on OP; its second differences leave out what moves evenly.

    The median does not see slips and reversals; 1.4826 makes it a standard deviation, and a second difference
    has six times the variance of the noise.
    """
    if op.size < 3:
        return 0.0
    return 1.4826 * float(np.median(np.abs(np.diff(op, 2)))) / math.sqrt(6)
