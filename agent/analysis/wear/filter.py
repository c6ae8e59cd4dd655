"""The logarithm of S with a slope, seen day by day: the filter of one stretch between two jumps.

The level walks a little from day to day, the slope stays (local linear trend). S of a day lies about the true
one as its own interval says, or below it where its windows are short, or the day is an outlier and says
nothing; the state after it is the mean and covariance of that mixture. Windows are short where the model
misses slips of the stem: then S is too low, hardly ever too high.

A day that does not show S may still divide it: S is below a number rather than above it, or the other way,
and by how much likelier. It moves the level only where that number lies within what is known of it. Beyond,
it either says what is known already (such days of one valve are wrong together, and must not add up), or
contradicts it, and S does not fall by itself: then a jump may be likelier, and the level of a stretch stays.

Source: A. C. Harvey, "Forecasting, structural time series models and the Kalman filter", 1989, section 2.3;
H. W. Sorenson and D. L. Alspach, "Recursive Bayesian estimation using Gaussian sums", Automatica 7, 1971;
J. Tobin, "Estimation of relationships for limited dependent variables", Econometrica 26, 1958 (days that
divide).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from agent.analysis.results import NORMAL_90

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agent.analysis.record.recording import FloatArray

OUTLIER = 0.05
"""Probability that a day says nothing: windows whose fit is in a wrong valley."""


class LevelWalk(NamedTuple):
    """How the level may move, logarithm of S and days."""

    level_sd: float
    """Of the walk in a day."""
    slope_sd: float
    """Of the slope before anything is seen, a day."""
    spread: float
    """Standard deviation of a level of which nothing is seen, and of outliers."""
    middle: float
    """Mean of such a level."""
    lacks: float
    """Mean of what S of a day lacks, and the standard deviation of that; 0 where it is right."""


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


class SeenLevel(NamedTuple):
    """What a day shows of the level."""

    value: float
    """Logarithm of S, or of what divides it."""
    sd: float
    above: float | None = None
    """Log of how much likelier the day is where S is above ``value`` than below; None: S itself is seen."""
    agrees: float = 0.0
    """Nats by which the day is likelier in this kind of valve, whatever S is."""


def begin(walk: LevelWalk, time: float, fell: float = 0.0) -> Filtered:
    """Return the state before anything is seen, or after a jump: by ``fell`` lower in the mean."""
    return Filtered(
        time, np.array([walk.middle - fell, 0.0]), np.diag([walk.spread**2, walk.slope_sd**2]), 0.0
    )


def step(state: Filtered, walk: LevelWalk, time: float, seen: SeenLevel) -> Filtered:
    """Return the state after one more day.

    Args:
        state: Before.
        walk: How the level moves.
        time: Of the day, days.
        seen: What the day shows.
    """
    ahead = forecast(state, walk.level_sd, time)
    level, variance = float(ahead.mean[0]), float(ahead.covariance[0, 0])
    if seen.above is not None:
        parts = _divided(level, variance, seen, seen.above)
    else:
        outside = math.log(OUTLIER) + _log_normal(seen.value - walk.middle, walk.spread**2 + seen.sd**2)
        parts = [_about(level, variance, seen, walk.lacks), (outside, level, variance)]
    likeliest = max(each[0] for each in parts)
    weights, means, variances = np.array(parts).T
    shares = np.exp(weights - likeliest)
    total = float(shares.sum())
    mean = float(shares @ means) / total
    spread = float(shares @ (variances + (means - mean) ** 2)) / total
    found = ahead.log_likelihood + likeliest + math.log(total) + seen.agrees
    return _with_level(ahead, mean, spread)._replace(log_likelihood=found)


def forecast(state: Filtered, level_sd: float, time: float) -> Filtered:
    """Return the state at a later time, with nothing seen since.

    Args:
        state: Now.
        level_sd: As ``LevelWalk.level_sd``.
        time: Later, days.
    """
    days = time - state.time
    move = np.array([[1.0, days], [0.0, 1.0]])
    covariance = move @ state.covariance @ move.T
    covariance[0, 0] += level_sd**2 * days
    return Filtered(time, move @ state.mean, covariance, state.log_likelihood)


def mixed(shares: Sequence[float], states: Sequence[Filtered]) -> Filtered:
    """Return the mean and covariance of several states of one day; their shares add up to one."""
    mean = sum((share * each.mean for share, each in zip(shares, states, strict=True)), np.zeros(2))
    covariance = np.zeros((2, 2))
    for share, each in zip(shares, states, strict=True):
        miss = each.mean - mean
        covariance += share * (each.covariance + np.outer(miss, miss))
    return states[0]._replace(mean=mean, covariance=covariance)


def _about(level: float, variance: float, seen: SeenLevel, lacks: float) -> tuple[float, float, float]:
    """Return log weight, mean and variance of the level where the day is no outlier."""
    own = seen.sd**2 + lacks**2
    miss, both = seen.value + lacks - level, variance + own
    weight = math.log(1 - OUTLIER) + _log_normal(miss, both)
    return weight, level + variance / both * miss, variance * own / both


def _divided(
    level: float, variance: float, seen: SeenLevel, above: float
) -> list[tuple[float, float, float]]:
    """Return log weight, mean and variance of the level below what divides it, and above."""
    share, mean, left = _below(level, variance, seen.value, seen.sd)
    other, mirrored, rest = _below(-level, variance, -seen.value, seen.sd)
    if abs(seen.value - level) >= NORMAL_90 * math.sqrt(variance):
        return [(share, level, variance), (above + other, level, variance)]
    return [(share, mean, left), (above + other, -mirrored, rest)]


def _below(level: float, variance: float, value: float, sd: float) -> tuple[float, float, float]:
    """Return the log share of a normal level that is below a value, with mean and variance of that part."""
    both = variance + sd**2
    room = (value - level) / math.sqrt(both)
    share = max(0.5 * math.erfc(-room / math.sqrt(2)), 1e-300)
    ratio = math.exp(_log_normal(room, 1.0)) / share
    mean = level - variance / math.sqrt(both) * ratio
    left = variance - variance**2 / both * ratio * (room + ratio)
    return math.log(share), mean, max(left, 0.0)


def _with_level(state: Filtered, level: float, variance: float) -> Filtered:
    """Return the state with another mean and variance of the level, and of the slope what follows from it."""
    share = state.covariance[:, 0] / state.covariance[0, 0]
    fell = state.covariance[0, 0] - variance
    return state._replace(
        mean=state.mean + share * (level - state.mean[0]),
        covariance=state.covariance - fell * np.outer(share, share),
    )


def _log_normal(miss: float, variance: float) -> float:
    return -0.5 * (math.log(2 * math.pi * variance) + miss * miss / variance)
