"""The logarithm of S with a slope, seen day by day: the filter of one stretch between two jumps.

The level walks a little from day to day, the slope stays (local linear trend). S of a day lies about the
level as its own interval says, or it is astray and less sure, or the day is an outlier and says nothing; the
state after it is the mean and covariance of that mixture.

Most of what an interval allows for is the same in all windows of a valve, as the models lack the same every
day. It cannot be separated from the level, so the filter follows the level that windows show; how far that is
from S of the valve is added at the end (``of_valve``), and no number of windows averages it away.

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
from typing import NamedTuple

from agent.analysis.results import NORMAL_90

SHORT, COMMON = 0.45, 0.55
"""What log S of windows lacks, over the standard deviation of their intervals: mean and standard deviation of
what all of a valve have in common."""
ASTRAY, ASTRAY_SD = 0.09, 0.22
"""Share of the windows that are less sure than that, and the standard deviation of log S of these, beside it:
fits in a neighbouring valley. All four are the likeliest values for simulated valves (``python -m benchmarks
s_errors``)."""
OUTLIER = 0.005
"""Share of the windows that say nothing. None of 193 was so; with Jeffreys' prior 0.003."""

SOFT = 0.05
"""Standard deviation of what divides S, logarithm: it is known from windows, which are wrong by as much."""


class LevelWalk(NamedTuple):
    """How the level may move, logarithm of S and days."""

    level_sd: float
    """Of the walk in a day."""
    spread: float
    """Standard deviation of a level of which nothing is seen, and of outliers."""
    middle: float
    """Mean of such a level."""
    own: float
    """Standard deviation of what a day has for itself, over that of its interval."""


class Slope(NamedTuple):
    """A slope of log S before anything is seen."""

    share: float
    """Of the stretches that have such a slope."""
    mean: float
    sd: float
    """a day"""


class Filtered(NamedTuple):
    """State after a day; the level is that which windows show."""

    time: float
    """days"""
    level: float
    slope: float
    """a day"""
    level_var: float
    shared: float
    """Covariance of level and slope."""
    slope_var: float
    inverse: float
    """Sum of 1 / sd of the days that showed S."""
    precision: float
    """Sum of 1 / sd**2 of these."""
    log_likelihood: float
    """Of all days of the stretch so far, nats."""


class SeenLevel(NamedTuple):
    """What a day shows of the level."""

    value: float
    """Logarithm of S."""
    sd: float
    divides: tuple[tuple[float, float], ...] = ()
    """Where S is not seen: log of what divides it, and of how much likelier the day is if S is above."""
    agrees: float = 0.0
    """Nats by which the day is likelier in this kind of valve, whatever S is."""


def begin(walk: LevelWalk, slope: Slope, time: float, fell: float = 0.0) -> Filtered:
    """Return the state before anything is seen, or after a jump: by ``fell`` lower in the mean."""
    return Filtered(time, walk.middle - fell, slope.mean, walk.spread**2, 0.0, slope.sd**2, 0.0, 0.0, 0.0)


def of_valve(state: Filtered) -> Filtered:
    """Return the state with S of the valve in place of what its windows show."""
    if not state.precision:
        return state
    common = state.inverse / state.precision
    return state._replace(
        level=state.level + SHORT * common, level_var=state.level_var + (COMMON * common) ** 2
    )


def forecast(state: Filtered, level_sd: float, time: float) -> Filtered:
    """Return the state at a later time, with nothing seen since.

    Args:
        state: Now.
        level_sd: As ``LevelWalk.level_sd``.
        time: Later, days.
    """
    days = time - state.time
    shared = state.shared + days * state.slope_var
    return Filtered(
        time,
        state.level + days * state.slope,
        state.slope,
        state.level_var + days * (state.shared + shared + level_sd**2),
        shared,
        state.slope_var,
        state.inverse,
        state.precision,
        state.log_likelihood,
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
    if not seen.divides:
        return _shown(ahead, walk, seen)
    for value, above in seen.divides:
        ahead = _divided(ahead, value, above)
    return ahead._replace(log_likelihood=ahead.log_likelihood + seen.agrees)


def _shown(state: Filtered, walk: LevelWalk, seen: SeenLevel) -> Filtered:
    """Return the state after a day that shows S: as sure as its windows are, less sure, or worth nothing."""
    miss = seen.value - state.level
    sure = state.level_var + (walk.own * seen.sd) ** 2
    unsure = sure + ASTRAY_SD**2
    logs = (
        math.log(1 - ASTRAY - OUTLIER) + _log_normal(miss, sure),
        math.log(ASTRAY) + _log_normal(miss, unsure),
        math.log(OUTLIER) + _log_normal(seen.value - walk.middle, walk.spread**2 + seen.sd**2),
    )
    top = max(logs)
    shares = [math.exp(each - top) for each in logs]
    total = sum(shares)
    usual, astray = shares[0] / total, shares[1] / total
    moved = usual * miss / sure + astray * miss / unsure
    squares = usual * (miss / sure) ** 2 + astray * (miss / unsure) ** 2
    narrower = usual / sure + astray / unsure - (squares - moved * moved)
    found = _moved(state, moved, narrower, top + math.log(total) + seen.agrees)
    return found._replace(inverse=state.inverse + 1 / seen.sd, precision=state.precision + 1 / seen.sd**2)


def _divided(state: Filtered, value: float, above: float) -> Filtered:
    """Return the state after a day that shows on which side of a value S is."""
    level, variance = state.level, state.level_var
    room = (value - level) / math.sqrt(variance + SOFT**2)
    below, other = _share(room), math.exp(above) * _share(-room)
    found = math.log(below + other)
    if abs(value - level) >= NORMAL_90 * math.sqrt(variance):
        return state._replace(log_likelihood=state.log_likelihood + found)
    share = below / (below + other)
    mean, left = _below(level, variance, value, SOFT)
    mirrored, rest = _below(-level, variance, -value, SOFT)
    middle = share * mean - (1 - share) * mirrored
    spread = share * (left + (mean - middle) ** 2) + (1 - share) * (rest + (mirrored + middle) ** 2)
    return _moved(state, (middle - level) / variance, (variance - spread) / variance**2, found)


def _share(room: float) -> float:
    """Return the share of a normal distribution below ``room`` standard deviations."""
    return max(0.5 * math.erfc(-room / math.sqrt(2)), 1e-300)


def _below(level: float, variance: float, value: float, sd: float) -> tuple[float, float]:
    """Return mean and variance of the part of a normal level that is below a value."""
    both = variance + sd**2
    room = (value - level) / math.sqrt(both)
    ratio = math.exp(_log_normal(room, 1.0)) / _share(room)
    mean = level - variance / math.sqrt(both) * ratio
    return mean, max(variance - variance**2 / both * ratio * (room + ratio), 0.0)


def _moved(state: Filtered, moved: float, narrower: float, nats: float) -> Filtered:
    """Return the state after something that concerns the level, and the slope by what they share.

    Args:
        state: Before.
        moved: By how much of its variance the level moves.
        narrower: By how much of its square the variance falls.
        nats: Log likelihood of what is seen.
    """
    to_level, to_slope = state.level_var, state.shared
    return Filtered(
        state.time,
        state.level + moved * to_level,
        state.slope + moved * to_slope,
        state.level_var - narrower * to_level * to_level,
        state.shared - narrower * to_level * to_slope,
        state.slope_var - narrower * to_slope * to_slope,
        state.inverse,
        state.precision,
        state.log_likelihood + nats,
    )


def _log_normal(miss: float, variance: float) -> float:
    return -0.5 * (math.log(2 * math.pi * variance) + miss * miss / variance)
