"""The range of OP, what a valve resolves of it, and the least step that a person can see."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray, LoopWindow

RESOLUTION = 0.001
"""Part of OP's range that the best positioners resolve: below it no step is made, and no S is a fault."""
PER_CENT, FRACTION = (0.0, 100.0), (0.0, 1.0)
"""Ranges that OP has where nobody states one: per cent, or parts of one where it never exceeds that."""


def least_step(window: LoopWindow) -> float:
    """Return the larger of the resolution of OP and its own noise, OP units; 0 where neither is known."""
    op = window.op[np.isfinite(window.op)]
    if not op.size:
        return 0.0
    return max(resolution(window), _noise(op))


def resolution(window: LoopWindow) -> float:
    """Return what the best positioners resolve, OP units; 0 where the range of OP is not known."""
    low, high = op_range_of(window)
    return RESOLUTION * (high - low)


def op_range_of(window: LoopWindow) -> tuple[float, float]:
    """Return the range of OP as it was stated, or as its values suggest it; (0, 0) where it is not known."""
    op = window.op[np.isfinite(window.op)]
    return window.hints.op_range or (usual_range(op) if op.size else (0.0, 0.0))


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
