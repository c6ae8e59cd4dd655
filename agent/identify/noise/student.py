"""Student's distribution of innovations: noise in bursts, and one step of a load, prove nothing."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from agent.identify.arrays import FloatArray

FREEDOM = 4.0
"""Degrees of freedom of Student's distribution: few, for loads step."""
SCALE_STEPS = 12
"""Of the iteration for its scale (expectation, maximisation)."""


def student_likelihood(values: FloatArray, least: float) -> float:
    """Return the log likelihood, nats, less a constant, of independent values of Student's distribution.

    Args:
        values: Shape (n,), n >= 1.
        least: Mean square below which they are rounding.
    """
    scale = student_scale(values, least)
    far = float(np.sum(np.log1p(values * values / (FREEDOM * scale))))
    return -0.5 * len(values) * math.log(scale) - 0.5 * (FREEDOM + 1) * far


def student_scale(values: FloatArray, least: float) -> float:
    """Return the square of the scale of Student's distribution that makes values (n,) most likely.

    ``least`` as in ``student_likelihood``.
    """
    squares = values * values
    scale = max(float(np.mean(squares)), least, 1e-300)
    for _ in range(SCALE_STEPS):
        weights = (FREEDOM + 1) / (FREEDOM + squares / scale)
        scale = max(float(np.mean(weights * squares)), least, 1e-300)
    return scale
