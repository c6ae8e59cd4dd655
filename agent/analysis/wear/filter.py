"""A level with a slope, seen day by day: the Kalman filter of one stretch between two jumps.

The level walks a little from day to day, the slope stays (local linear trend). A day that lies far outside is
an outlier with a small probability; then it moves nothing.

Source: A. C. Harvey, "Forecasting, structural time series models and the Kalman filter", 1989, section 2.3.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray

OUTLIER = 0.05
"""Probability that a day is an outlier: windows whose fit is in a wrong valley."""


class LevelWalk(NamedTuple):
    """How a level may move, all in units of the level and days."""

    level_sd: float
    """Of the walk in a day."""
    slope_sd: float
    """Of the slope before anything is seen, a day."""
    spread: float
    """Standard deviation of a level after a jump, and of outliers."""
    middle: float
    """Mean of a level after a jump."""


class Filtered(NamedTuple):
    """State after a day."""

    time: float
    """days"""
    mean: FloatArray
    """Level and slope, (2,)."""
    covariance: FloatArray
    """(2, 2)"""
    log_likelihood: float
    """Of all days of the stretch so far, nats."""


def begin(walk: LevelWalk, time: float) -> Filtered:
    """Return the state just after a jump."""
    return Filtered(time, np.array([walk.middle, 0.0]), np.diag([walk.spread**2, walk.slope_sd**2]), 0.0)


def step(state: Filtered, walk: LevelWalk, time: float, value: float, sd: float) -> Filtered:
    """Return the state after one more day.

    Args:
        state: Before.
        walk: How the level moves.
        time: Of the day, days.
        value: What was seen of the level.
        sd: Its standard deviation.
    """
    ahead = forecast(state, walk, time)
    spread = ahead.covariance[0, 0] + sd * sd
    miss = value - ahead.mean[0]
    usual = math.log(1 - OUTLIER) + _log_normal(miss, spread)
    outside = math.log(OUTLIER) + _log_normal(value - walk.middle, walk.spread**2 + sd * sd)
    if outside > usual:
        return ahead._replace(log_likelihood=ahead.log_likelihood + outside)
    gain = ahead.covariance[:, 0] / spread
    return Filtered(
        time,
        ahead.mean + gain * miss,
        ahead.covariance - np.outer(gain, ahead.covariance[0]),
        ahead.log_likelihood + usual,
    )


def forecast(state: Filtered, walk: LevelWalk, time: float) -> Filtered:
    """Return the state at a later time, with nothing seen since."""
    days = time - state.time
    move = np.array([[1.0, days], [0.0, 1.0]])
    covariance = move @ state.covariance @ move.T
    covariance[0, 0] += walk.level_sd**2 * days
    return Filtered(time, move @ state.mean, covariance, state.log_likelihood)


def _log_normal(miss: float, variance: float) -> float:
    return -0.5 * (math.log(2 * math.pi * variance) + miss * miss / variance)
